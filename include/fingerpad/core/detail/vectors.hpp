// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Vectors of memory that is taken once, vectors that copies share, and a median.
#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// The upper one of an even number, NaN of none. Reorders the values.
inline double median(std::span<double> values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return values.empty() ? not_a_number<double>() : *middle;
}

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

/// A vector that its owner fills in its constructor and only reads afterwards: copies of the owner
/// share it.
template <class T>
class SharedVector {
 public:
  explicit SharedVector(std::size_t size = 0, const T& all = T())
      : cells_(std::make_shared<std::vector<T>>(size, all)) {}
  void push_back(const T& cell) { cells_->push_back(cell); }
  T* data() { return cells_->data(); }
  const T* data() const { return cells_->data(); }
  T& operator[](std::size_t k) { return (*cells_)[k]; }
  const T& operator[](std::size_t k) const { return (*cells_)[k]; }
  std::size_t size() const { return cells_->size(); }

 private:
  std::shared_ptr<std::vector<T>> cells_;
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
