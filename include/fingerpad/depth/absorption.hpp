// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The law that relates depth and colour. Light is absorbed along its path k l through the red
// fluid, and in the red channel the fluid also scatters light back from every depth z < l.
// Source: Ito, Kim, Obinata, "Shape sensing by vision-based tactile sensor" (slides), theory of the
// intensity of light and modification of equation; printed errors are E001-E005 of docs/errata.md.
//
//   green = B exp(-c_green k l)
//   kappa red = green exp(delta k l) + g W(l),  delta = c_green - c_red
//   W(l) = c_red Int_0^l (z + h_m)(z + h_s) exp(-c_red k z) dz
//
// B is the membrane's brightness in green at depth 0, which depends on its inclination, colour and
// dots. The second equation does not contain B, so these do not affect the depth: its root is the
// depth, by newton_depth() in any scalar. Whole frames go by polynomials, depth/depth.hpp. Colours
// are grey levels, lengths mm, g grey levels per mm^2.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v1 {

/// Optical properties of the fluid; the defaults are the published values.
template <scalar S = double>
struct Absorption {
  S c_red_per_mm = S(290) / S(10000);    ///< c_R, absorption of red, > 0
  S c_green_per_mm = S(336) / S(10000);  ///< c_G, absorption of green, >= c_R
  S kappa =
      S(9924) / S(10000);  ///< alpha_G beta_G / (alpha_R beta_R), light source and camera, > 0
  S max_depth_mm = S(14);  ///< the largest depth searched, > 0
};

/// Says which value is out of range; "" if none is.
template <scalar S>
std::string check(const Absorption<S>& fluid) {
  const auto c_red_per_mm = static_cast<double>(value(fluid.c_red_per_mm));
  return check("Absorption", {{"c_red_per_mm", fluid.c_red_per_mm, positive},
                              {"c_green_per_mm", fluid.c_green_per_mm, at_least(c_red_per_mm)},
                              {"kappa", fluid.kappa, positive},
                              {"max_depth_mm", fluid.max_depth_mm, positive}});
}

/// The same fluid in another scalar.
template <scalar To, scalar From>
Absorption<To> cast(const Absorption<From>& f) {
  return {To(f.c_red_per_mm), To(f.c_green_per_mm), To(f.kappa), To(f.max_depth_mm)};
}

namespace detail {

/// Int_0^1 s^n exp(-t s) ds for n = 0, 1, 2.
template <scalar S>
struct ExponentialMoments {
  S zeroth;
  S first;
  S second;
};

/// The moments for t >= 0, with an error of a few epsilon everywhere. Below t = 4 the second moment
/// is a series of positive terms and the others follow by downward recurrence, so that nothing
/// cancels even at small t. From t = 4 on, upward recurrence loses no digits. At most 80 terms in
/// 50 digits.
template <scalar S>
ExponentialMoments<S> exponential_moments(const S& t) {
  using std::exp;
  const S decay = exp(-t);
  if (value(t) < scalar_real_t<S>(4)) {
    S term = S(1) / S(3);
    S sum = term;
    for (int j = 4; j < 200 && value(term) > epsilon<S>() * value(sum) / 4; ++j) {
      term = term * t / S(j);
      sum = sum + term;
    }
    const S second = decay * sum;
    const S first = (t * second + decay) / S(2);
    const S zeroth = t * first + decay;
    return {zeroth, first, second};
  }
  const S zeroth = (S(1) - decay) / t;
  const S first = (zeroth - decay) / t;
  const S second = (S(2) * first - decay) / t;
  return {zeroth, first, second};
}

}  // namespace detail

/// W(l): light scattered back by the fluid between the plate and depth l >= 0, in mm^2, for any
/// c >= 0 (W = 0 at c = 0). Relative error <= 4 epsilon for c in [1e-6, 1] per mm. The published
/// form Q1 (1 - E) + Q2 loses all digits to cancellation at small c l; this sum has positive terms
/// only.
template <scalar S>
S scattered_light(const S& depth_mm, const S& c_per_mm, const Ray<S>& ray) {
  const S t = c_per_mm * (ray.path_factor * depth_mm);
  const auto m = detail::exponential_moments(t);
  const S& h_m = ray.meridional_mm;
  const S& h_s = ray.sagittal_mm;
  const S sum = h_m * h_s * m.zeroth + depth_mm * ((h_m + h_s) * m.first + depth_mm * m.second);
  return c_per_mm * depth_mm * sum;
}

/// dW/dl = c (l + h_m)(l + h_s) exp(-c k l), in mm.
template <scalar S>
S scattered_light_slope(const S& depth_mm, const S& c_per_mm, const Ray<S>& ray) {
  using std::exp;
  const S decay = exp(-(c_per_mm * (ray.path_factor * depth_mm)));
  return c_per_mm * (depth_mm + ray.meridional_mm) * (depth_mm + ray.sagittal_mm) * decay;
}

/// Red and green of one pixel, in grey levels.
template <scalar S = double>
struct Colour {
  S red;
  S green;
};

/// Forward model: the colour of a membrane of brightness B (grey levels, green at depth 0) at
/// depth l >= 0, in a fluid that scatters g (grey levels per mm^2).
template <scalar S>
Colour<S> colour_at_depth(const Absorption<S>& fluid,
                          const Ray<S>& ray,
                          const S& brightness,
                          const S& scattering,
                          const S& depth_mm) {
  using std::exp;
  const S path = ray.path_factor * depth_mm;
  const S scattered = scattering * scattered_light(depth_mm, fluid.c_red_per_mm, ray);
  const S green = brightness * exp(-(fluid.c_green_per_mm * path));
  const S red = (brightness * exp(-(fluid.c_red_per_mm * path)) + scattered) / fluid.kappa;
  return {red, green};
}

/// F and dF/dl of the depth equation F(l) = green exp(delta k l) - kappa red + g W(l) = 0. F rises
/// strictly where green >= 0, g > 0 and delta >= 0, so it has at most one root. It replaces the
/// published quotient f(l) = g - F/W, which is 0/0 at l = 0 and overflows at large l.
template <scalar S>
std::pair<S, S> depth_equation(const Absorption<S>& fluid,
                               const Ray<S>& ray,
                               const S& scattering,
                               const Colour<S>& colour,
                               const S& depth_mm) {
  using std::exp;
  const S delta_k = (fluid.c_green_per_mm - fluid.c_red_per_mm) * ray.path_factor;
  const S membrane = colour.green * exp(delta_k * depth_mm);
  const S w = scattered_light(depth_mm, fluid.c_red_per_mm, ray);
  const S w_slope = scattered_light_slope(depth_mm, fluid.c_red_per_mm, ray);
  return {membrane - fluid.kappa * colour.red + scattering * w,
          membrane * delta_k + scattering * w_slope};
}

/// The outcome at a pixel. If the status is not `ok`, the depth is NaN; it is never clamped.
enum class PixelStatus : std::uint8_t {
  ok = 0,            ///< the depth is valid
  below_range = 1,   ///< the colours correspond to a depth below 0
  above_range = 2,   ///< the colours correspond to a depth above max_depth_mm
  not_a_number = 3,  ///< a colour is NaN or infinite
  dark = 4,          ///< a colour is at or below the dark limit
  saturated = 5,     ///< a colour is at or above the saturation limit
  outside_pad = 6,   ///< the reference has no depth or no g > 0 here
};
inline constexpr std::size_t pixel_status_count = 7;

/// "ok", "below range", ...
constexpr const char* name_of(PixelStatus status) {
  constexpr std::array<const char*, pixel_status_count> names = {
      "ok", "below range", "above range", "not a number", "dark", "saturated", "outside pad"};
  return names[static_cast<std::size_t>(status)];
}

/// A depth and whether it may be used; depth_mm is NaN unless the status is ok.
template <scalar S>
struct DepthRoot {
  S depth_mm;
  PixelStatus status;
};

namespace detail {

/// Whether there is a root in [0, max_depth] (ok), and if not, why. F rises, so its signs at both
/// ends decide.
template <scalar S>
PixelStatus range_of_root(const Absorption<S>& fluid,
                          const Ray<S>& ray,
                          const S& scattering,
                          const Colour<S>& colour) {
  const S at_zero = colour.green - fluid.kappa * colour.red;
  if (!is_finite(at_zero) || !is_finite(scattering) || !(value(scattering) > 0)) {
    return PixelStatus::not_a_number;
  }
  if (value(at_zero) > 0) {
    return PixelStatus::below_range;
  }
  const S at_end = depth_equation(fluid, ray, scattering, colour, fluid.max_depth_mm).first;
  return value(at_end) < 0 ? PixelStatus::above_range : PixelStatus::ok;
}

}  // namespace detail

/// Newton's method on F from depth 0. Every step stays inside the bracket around the root that the
/// signs of F give. Converges to the roundoff of F: <= 1e-12 mm in double for depths up to 14 mm.
/// Five steps are typical, 60 the most. A dual number gets the exact derivative of the root with
/// respect to whatever is seeded.
template <scalar S>
DepthRoot<S> newton_depth(const Absorption<S>& fluid,
                          const Ray<S>& ray,
                          const S& scattering,
                          const Colour<S>& colour) {
  using Real = scalar_real_t<S>;
  const PixelStatus range = detail::range_of_root(fluid, ray, scattering, colour);
  if (range != PixelStatus::ok) {
    return {not_a_number<S>(), range};
  }
  S low = S(0);
  S high = fluid.max_depth_mm;
  const Real enough = 16 * epsilon<S>() * value(high);
  S depth = low;
  for (int i = 0; i < 60; ++i) {
    const auto [f, slope] = depth_equation(fluid, ray, scattering, colour, depth);
    (value(f) < 0 ? low : high) = depth;
    S next = depth - f / slope;
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

}  // namespace v1
}  // namespace fingerpad
