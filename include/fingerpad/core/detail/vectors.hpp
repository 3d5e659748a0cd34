// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Vectors of memory that is taken once: aligned to cache lines, or of a capacity that copies keep.
#include <cstddef>
#include <new>
#include <vector>

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Allocates memory that begins on a cache line, so that aligned SIMD vectors never straddle two
/// lines.
template <class T>
struct AlignedAllocator {
  using value_type = T;
  static constexpr std::align_val_t line{64};
  AlignedAllocator() = default;
  template <class U>
  constexpr AlignedAllocator(const AlignedAllocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), line)); }
  void deallocate(T* p, std::size_t) { ::operator delete(p, line); }
  friend bool operator==(const AlignedAllocator&, const AlignedAllocator&) { return true; }
};
template <class T>
using aligned_vector = std::vector<T, AlignedAllocator<T>>;

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
