// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Two channels of an interleaved row (BGR, RGBA, ...) as two contiguous rows.
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

#if defined(FINGERPAD_HAS_VECTORS)
/// 16 pixels of C interleaved bytes, as one vector per channel.
/// Riffling the two halves of 16 C bytes takes byte i to 2 i modulo 16 C - 1. Four riffles multiply
/// by 16, and so take channel c of pixel p, byte C p + c, to byte p + 16 c.
template <std::size_t C>
using Planes = std::array<lanes<std::uint8_t, 16>, C>;

/// Bytes of units a and b in turn, where unit u is half u % 2 of vector u / 2.
template <std::size_t A, std::size_t B, std::size_t C>
[[gnu::always_inline]] inline lanes<std::uint8_t, 16> riffle_units(const Planes<C>& v) {
  using V = lanes<std::uint8_t, 16>;
  using Words = lanes<std::uint64_t, 2>;
  const V a = v[A / 2];
  if constexpr (A % 2 == B % 2) {
    const Two<V> both = zip<16>(a, v[B / 2]);
    return A % 2 == 0 ? both.first : both.second;
  } else {
    const Words b = Words(v[B / 2]);
    const Two<V> both = zip<16>(a, V(__builtin_shufflevector(b, b, 1, 0)));
    return A % 2 == 0 ? both.first : both.second;
  }
}

template <std::size_t C, std::size_t... I>
[[gnu::always_inline]] inline Planes<C> riffle(const Planes<C>& v, std::index_sequence<I...>) {
  return {riffle_units<I, I + C>(v)...};
}
#endif

/// red[i] = from[channels i + red_offset], and likewise green, for i < n.
template <int channels, class Pixel, int VectorBytes = native_vector_bytes>
void load_interleaved_row(
    const Pixel* from, Index n, int red_offset, int green_offset, Pixel* red, Pixel* green) {
  Index i = 0;
#if defined(FINGERPAD_HAS_VECTORS)
  if constexpr (sizeof(Pixel) == 1 && channels >= 2 && channels <= 4) {
    constexpr std::size_t C = std::size_t(channels);
    constexpr auto all = std::make_index_sequence<C>{};
    for (; i + 16 <= n; i += 16) {
      Planes<C> planes;
      for (std::size_t c = 0; c < C; ++c) {
        planes[c] = load<std::uint8_t, 16>(from + channels * i + 16 * Index(c));
      }
      planes = riffle(riffle(riffle(riffle(planes, all), all), all), all);
      for (std::size_t c = 0; c < C; ++c) {
        if (int(c) == red_offset) {
          store(red + i, planes[c]);
        }
        if (int(c) == green_offset) {
          store(green + i, planes[c]);
        }
      }
    }
  }
#endif
  for (; i < n; ++i) {
    red[i] = from[channels * i + red_offset];
    green[i] = from[channels * i + green_offset];
  }
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
