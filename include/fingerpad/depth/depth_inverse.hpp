// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Depth of one pixel from its colour: the root of the depth equation F(l) = 0 in [0, max_depth].
// Three ways, which differ in speed and in how far they trust the mathematics:
//   bisect_depth   the published bisection on the quotient f(l), with its first step repaired
//   newton_depth   Newton's method on F, bracketed, to the roundoff of any scalar
//   (the exponential-free form for whole rows is in scatter_polynomial.hpp)
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/absorption.hpp"

namespace fingerpad {
inline namespace v0 {

// What became of a pixel. Where the status is not `ok` the depth is NaN; it is never clamped.

enum class PixelStatus : std::uint8_t {
  ok = 0,            ///< the depth is right
  below_range = 1,   ///< the colours ask for a depth below zero
  above_range = 2,   ///< the colours ask for a depth above max_depth_mm
  not_a_number = 3,  ///< a colour is NaN or infinite
  dark = 4,          ///< a colour is at or below the dark limit
  saturated = 5,     ///< a colour is at or above the saturation limit
  outside_pad = 6,   ///< the reference has no depth here
};
inline constexpr std::size_t pixel_status_count = 7;

/// A depth and whether it may be used; depth_mm is NaN unless the status is ok.
template <scalar S>
struct DepthRoot {
  S depth_mm;
  PixelStatus status;
};

namespace detail {

/// Why there can be no root in [0, max_depth], or ok. F rises, so two signs decide.
template <scalar S>
PixelStatus range_of_root(const Absorption<S>& fluid,
                          const Pencil<S>& pencil,
                          const S& scattering,
                          const Colour<S>& colour) {
  const S at_zero = colour.green - fluid.kappa * colour.red;
  if (!is_finite(at_zero) || !is_finite(scattering)) {
    return PixelStatus::not_a_number;
  }
  if (value(at_zero) > 0) {
    return PixelStatus::below_range;
  }
  const S at_end = depth_equation(fluid, pencil, scattering, colour, fluid.max_depth_mm).value;
  return value(at_end) < 0 ? PixelStatus::above_range : PixelStatus::ok;
}

}  // namespace detail

/// The published quotient f(l) = g at the depth l > 0 of a pixel, as printed after the repairs
/// E003-E005: (b_G e^{c_G k l} - kappa b_R e^{c_R k l}) / (Q1 (1 - e^{c_R k l}) + Q2). It is 0/0 at
/// l = 0, so never ask for it there.
template <scalar S>
S published_quotient(const Absorption<S>& fluid,
                     const Pencil<S>& pencil,
                     const Colour<S>& colour,
                     const S& depth_mm) {
  using std::exp;
  const S& c = fluid.c_red_per_mm;
  const S& k = pencil.path_factor;
  const S& l = depth_mm;
  const S product = pencil.height.meridional_mm * pencil.height.sagittal_mm;
  const S sum = pencil.height.meridional_mm + pencil.height.sagittal_mm;
  const S ck = c * k;
  const S q1 = (product + (sum + S(2) / ck) / ck) / k;
  const S q2 = (l * l + sum * l + S(2) * l / ck) / k;
  const S e_red = exp(S(ck * l));
  const S e_green = exp(S(fluid.c_green_per_mm * k * l));
  return S((colour.green * e_green - fluid.kappa * colour.red * e_red) /
           (q1 * (S(1) - e_red) + q2));
}

/// The published bisection of `halvings` halvings: half-width max_depth / 2^(halvings - 1) at the
/// end (0.43 um for 16 and 14 mm). As printed it starts at l = 0, where f is 0/0 and every pixel
/// goes astray (E006); here the first step is taken unconditionally, to the middle.
template <scalar S>
DepthRoot<S> bisect_depth(const Absorption<S>& fluid,
                          const Pencil<S>& pencil,
                          const S& scattering,
                          const Colour<S>& colour,
                          int halvings = 16) {
  const PixelStatus range = detail::range_of_root(fluid, pencil, scattering, colour);
  if (range != PixelStatus::ok) {
    return {not_a_number<S>(), range};
  }
  S depth = fluid.max_depth_mm / S(2);
  S step = depth / S(2);
  for (int i = 2; i < halvings; ++i) {
    const bool root_is_deeper = !(published_quotient(fluid, pencil, colour, depth) < scattering);
    depth = root_is_deeper ? S(depth + step) : S(depth - step);
    step = step / S(2);
  }
  return {depth, PixelStatus::ok};
}

/// Newton's method on F from `start_mm` (last frame's depth, or 0), kept inside the bracket that
/// the signs of F close around the root. Converges to the roundoff of F: <= 1e-12 mm in double for
/// depths up to 14 mm. Five steps are typical from 0, four from last frame; 60 at most. A dual
/// number gets the exact derivative of the root with respect to whatever is seeded.
template <scalar S>
DepthRoot<S> newton_depth(const Absorption<S>& fluid,
                          const Pencil<S>& pencil,
                          const S& scattering,
                          const Colour<S>& colour,
                          const S& start_mm = S(0)) {
  using Real = scalar_real_t<S>;
  const PixelStatus range = detail::range_of_root(fluid, pencil, scattering, colour);
  if (range != PixelStatus::ok) {
    return {not_a_number<S>(), range};
  }
  S low = S(0);
  S high = fluid.max_depth_mm;
  const Real enough = 16 * epsilon<S>() * value(high);
  const bool start_is_inside = value(start_mm) > 0 && value(start_mm) < value(high);
  S depth = start_is_inside ? start_mm : low;
  for (int i = 0; i < 60; ++i) {
    const auto f = depth_equation(fluid, pencil, scattering, colour, depth);
    (value(f.value) < 0 ? low : high) = depth;
    S next = depth - f.value / f.slope;
    // Written so that a NaN step (no slope) also falls back on the bracket.
    if (!(value(next) >= value(low) && value(next) <= value(high))) {
      next = (low + high) / S(2);
    }
    const Real step = value(next) - value(depth);
    depth = next;
    if (step <= enough && -step <= enough) {
      break;
    }
  }
  return {depth, PixelStatus::ok};
}

}  // namespace v0
}  // namespace fingerpad
