// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A vector whose memory begins on a cache line.
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

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
