// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// exp and the angle of a slope for per-pixel loops. For floats and vectors of them they are free of
// branches and calls. Every other number uses its own functions. Coefficients: near-minimax fits on
// the stated intervals.
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>

#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// A float, or a vector of them.
template <class V>
concept float_lanes = std::same_as<V, float> ||
    (!scalar<V> && std::same_as<V, lanes<float, lanes_in<V, float>>>);
/// A 32-bit integer, or a vector with as many of them as V has lanes.
template <float_lanes V>
using bits_of = lanes<std::int32_t, lanes_in<V, float>>;

/// exp(x) with x clamped to [-80, 80], which is finite for every x. Float: relative error 1e-6 for
/// |x| <= 10.
template <class V>
[[gnu::always_inline]] inline V quick_exp(const V& x) {
  if constexpr (float_lanes<V>) {
    // One integer comparison: GCC 12 turns two float comparisons into branches.
    using Bits = bits_of<V>;
    const Bits bits = std::bit_cast<Bits>(x);
    const Bits size = bits & 0x7FFFFFFF;
    const Bits limit = Bits{} + std::bit_cast<std::int32_t>(80.0F);
    const V held = std::bit_cast<V>((size < limit ? size : limit) | (bits ^ size));
    const V doublings = held * 1.44269504F;
    const Bits whole = each_as<Bits>(doublings + 128.5F) - 128;
    const V f = doublings - each_as<V>(whole);  // in [-1/2, 1/2]
    V power = V{} + 1.54780177e-4F;
    power = power * f + 1.34004317e-3F;
    power = power * f + 9.61799453e-3F;
    power = power * f + 5.55032722e-2F;
    power = power * f + 2.40226515e-1F;
    power = power * f + 6.93147207e-1F;
    power = power * f + 1.0F;
    return power * std::bit_cast<V>(Bits((whole + 127) << 23));
  } else {
    using std::exp;
    const V above = value(x) > -80 ? x : V(-80);
    return exp(value(above) < 80 ? above : V(80));
  }
}

/// 1 / sqrt(x) for normal x > 0 up to a quarter of the largest, with a relative error of 2.1e-5;
/// finite at 0 and NaN for NaN. Halving the exponent gives y to within some percent; a polynomial
/// in x y^2 corrects it. y is chosen such that the highest coefficient is 1 and needs no
/// multiplication.
template <float_lanes V>
[[gnu::always_inline]] inline V rough_inverse_sqrt(const V& x) {
  using Bits = lanes<std::uint32_t, lanes_in<V, float>>;
  const V y = std::bit_cast<V>(Bits(0x5F111000U - (std::bit_cast<Bits>(x) >> 1)));
  const V t = x * y * y;  // y * y would be subnormal, and slow, where x is NaN
  return y * ((t - 2.25330492F) * t + 2.28251864F);
}

/// atan(sqrt(slope_sq)), the inclination in rad of a surface whose slope has this square; in [0,
/// pi/2]. Its derivative at 0 is taken as 0. Float: absolute error 4e-7 rad; a slope that is NaN or
/// above 1e12 counts as 1e12.
template <class V>
[[gnu::always_inline]] inline V inclination(const V& slope_sq) {
  if constexpr (float_lanes<V>) {
    const V largest = V{} + 1e24F;
    const V smallest = V{} + 1e-36F;  // at 0, the square of `near` would overflow
    const V square = slope_sq < largest ? slope_sq : largest;
    const V held = square > smallest ? square : smallest;
    const V near = rough_inverse_sqrt<V>(held);
    const V inverse = near * (1.5F - 0.5F * held * near * near);
    const V slope = square * inverse;
    const auto steep = slope > V{} + 1.0F;
    const V ratio = steep ? inverse : slope;
    const V u = ratio * ratio;
    V p = V{} - 4.78039436e-3F;
    p = p * u + 2.45569541e-2F;
    p = p * u - 5.99044278e-2F;
    p = p * u + 9.94273973e-2F;
    p = p * u - 1.40294131e-1F;
    p = p * u + 1.99713741e-1F;
    p = p * u - 3.33320934e-1F;
    p = p * u + 9.99999911e-1F;
    const V angle = ratio * p;
    return steep ? 1.57079633F - angle : angle;
  } else {
    using std::atan;
    using std::sqrt;
    return value(slope_sq) > 0 ? V(atan(sqrt(slope_sq))) : V(0);
  }
}

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
