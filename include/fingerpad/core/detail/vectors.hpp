// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Vectors of memory that is taken once.
#include <cstddef>
#include <vector>

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// A vector whose copies keep its capacity: a copied state must not allocate during a frame, but a
/// copied std::vector drops the reserved capacity.
template <class T>
class ReservedVector : public std::vector<T> {
 public:
  explicit ReservedVector(std::size_t capacity = 0) { this->reserve(capacity); }
  ReservedVector(const ReservedVector& other) : std::vector<T>() { *this = other; }
  ReservedVector(ReservedVector&&) noexcept = default;
  ReservedVector& operator=(const ReservedVector& other) {
    if (this != &other) {
      this->clear();
      this->reserve(other.capacity());
      this->insert(this->end(), other.begin(), other.end());
    }
    return *this;
  }
  ReservedVector& operator=(ReservedVector&&) noexcept = default;
  ~ReservedVector() = default;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
