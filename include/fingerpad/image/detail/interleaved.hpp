// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Two channels of an interleaved row of bytes (BGR, RGBA, ...) as two contiguous rows.
#include <array>
#include <cstddef>
#include <cstdint>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/image/detail/lanes.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

#if defined(FINGERPAD_HAS_VECTORS)
using Bytes16 = lanes<std::uint8_t, 16>;

/// Interleaves the low (or high) eight bytes of a with the low (or high) eight of b.
[[gnu::always_inline]] inline Bytes16 mix_low(Bytes16 a, Bytes16 b) {
  return __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
}
[[gnu::always_inline]] inline Bytes16 mix_high(Bytes16 a, Bytes16 b) {
  return __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15,
                                 31);
}
[[gnu::always_inline]] inline Bytes16 swap_halves(Bytes16 a) {
  using Words = lanes<std::uint64_t, 2>;
  return Bytes16(__builtin_shufflevector(Words(a), Words(a), 1, 0));
}

/// Interleaves the first and the second half of all bytes.
[[gnu::always_inline]] inline void mix(std::array<Bytes16, 3>& v) {
  v = {mix_low(v[0], swap_halves(v[1])), mix_high(v[0], swap_halves(v[2])),
       mix_low(v[1], swap_halves(v[2]))};
}
[[gnu::always_inline]] inline void mix(std::array<Bytes16, 4>& v) {
  v = {mix_low(v[0], v[2]), mix_high(v[0], v[2]), mix_low(v[1], v[3]), mix_high(v[1], v[3])};
}

/// red[i] = from[channels i + red_offset], and likewise green, for as many i < n as whole vectors
/// hold; returns how many. Interleaving the halves of 16 pixels four times brings byte C i + c to
/// i + 16 c.
template <std::size_t channels>
Index load_interleaved(const std::uint8_t* from,
                       Index n,
                       Index red_offset,
                       Index green_offset,
                       std::uint8_t* red,
                       std::uint8_t* green) {
  Index i = 0;
  for (; i + 16 <= n; i += 16) {
    std::array<Bytes16, channels> planes;
    for (std::size_t c = 0; c < channels; ++c) {
      planes[c] = load<Bytes16>(from + Index(channels) * i + 16 * Index(c));
    }
    mix(planes);
    mix(planes);
    mix(planes);
    mix(planes);
    store(red + i, planes[std::size_t(red_offset)]);
    store(green + i, planes[std::size_t(green_offset)]);
  }
  return i;
}
#else
template <std::size_t>
Index load_interleaved(const std::uint8_t*, Index, Index, Index, std::uint8_t*, std::uint8_t*) {
  return 0;
}
#endif

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
