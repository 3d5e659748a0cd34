// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A block of neighbouring windows: their sums along a row, what they hold of valid pixels, and by
// what their sums are weighed.
#include <cstdint>

#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

enum class Cover : std::uint8_t {
  none,   ///< no window of the block holds a valid pixel
  cut,    ///< anything in between
  whole,  ///< every window holds nothing but valid pixels
};

#if defined(FINGERPAD_HAS_VECTORS)
/// Sums along one row over windows of 2 r + 1 columns: differences of its running sum.
template <class T>
struct AlongRow {
  const T *right, *left;
  AlongRow(const T* running, Index r) : right(running + r), left(running - r - 1) {}
  template <int N>
  [[gnu::always_inline]] lanes<T, N> at(Index j) const {
    return load<T, N>(right + j) - load<T, N>(left + j);
  }
};

/// 1 / n in float, NaN where n is 0.
template <int N>
[[gnu::always_inline]] inline lanes<float, N> reciprocal(lanes<std::uint32_t, N> n) {
  using Floats = lanes<float, N>;
  const Floats count = convert<float, N>(lanes<std::int32_t, N>(n));
  const Floats one = Floats{} + 1.0f;
  const auto empty = count < one;
  return choose(empty, Floats{} + not_a_number<float>(), one / choose(empty, one, count));
}

/// The cover of N windows with counts n of at most `full`; where it is cut, `weight` becomes 1 / n.
template <int N>
[[gnu::always_inline]] inline Cover weigh(lanes<std::uint16_t, N> n,
                                          lanes<std::uint16_t, N> full,
                                          float* weight) {
  if (all_zero<std::uint16_t, N>(n ^ full)) {
    return Cover::whole;
  }
  if (all_zero<std::uint16_t, N>(n)) {
    return Cover::none;
  }
  constexpr int half = N / 2;
  const auto counts = widen<std::uint32_t, half>(n);
  store(weight, reciprocal<half>(counts.first));
  store(weight + half, reciprocal<half>(counts.second));
  return Cover::cut;
}
#endif

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
