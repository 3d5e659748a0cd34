// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Forces by look-up as printed: Ito, Kim, Obinata, "Acquisition of contact force and slippage using
// a vision-based tactile sensor with a fluid-type touchpad", eqs. 1 to 5 and 18 to 22, with the
// numbers of the paper's own pad. docs/errata.md, E028 to E031. No ranges are checked and nothing
// is repaired: the force is that of the equations, also without contact and below 0.
#include <cmath>

#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {
namespace published {

/// Eq. 1, elastic pads: the contact radius in mm, c f^gamma, for a force > 0 in N. gamma is 1/3 for
/// Hertz's contact; the paper prints neither c (in mm, the radius at 1 N) nor gamma.
template <scalar S>
S contact_radius_mm(const S& force_n, const S& c, const S& gamma) {
  using std::exp;
  using std::log;
  return c * exp(gamma * log(force_n));
}
/// Its inverse: the force in N for a radius > 0.
template <scalar S>
S force_of_radius_n(const S& radius_mm, const S& c, const S& gamma) {
  using std::exp;
  using std::log;
  return exp(log(radius_mm / c) / gamma);
}

/// Eq. 2: the force p S_c of a flat contact in N. It does not hold for a curved or tilted object,
/// on which the membrane beside the contact also pulls.
template <scalar S>
S flat_contact_force_n(const S& pressure_mpa, const S& area_mm2) {
  return pressure_mpa * area_mm2;
}

/// Eqs. 3 and 18: F_S or F_D = c_2 m^2 + c_1 m + c_0 in N, printed for about 1 to 28 N, where the
/// measure is in [from, to].
template <scalar S = double>
struct Quadratic {
  S c_0, c_1, c_2;
  S from, to;

  S operator()(const S& measure) const { return (c_2 * measure + c_1) * measure + c_0; }
};
/// The measure is the area in mm^2.
template <scalar S = double>
Quadratic<S> force_of_area() {
  return {S(0.6242), S(0.0191), S(0.00008), S(18), S(478)};
}
/// The measure is the depth in mm.
template <scalar S = double>
Quadratic<S> force_of_depth() {
  return {S(0.3435), S(0.5563), S(0.776), S(0.63), S(5.62)};
}

/// gain F + per_unit |x| + offset_n in N: one of eqs. 19 to 22.
template <scalar S = double>
struct AffineForce {
  S gain = S(1);
  S per_unit = S(0);  ///< N/mm or N/rad
  S offset_n = S(0);

  S operator()(const S& plain_n, const S& size) const {
    return gain * plain_n + per_unit * size + offset_n;
  }
};

/// Normal force of a contact that is displaced and rotated. Neither eq. 21 nor eq. 22 equals eq. 18
/// without motion, and the paper does not say how to combine them. Each is therefore blended in:
/// the weight of its change grows from 0 to 1 over `blend_mm` or `blend_rad`, beyond which it is
/// the printed equation. With both motions, the two changes add.
template <scalar S = double>
struct NormalForce {
  Quadratic<S> plain;
  AffineForce<S> displaced;       ///< eq. 19 or 21; of the displacement in mm (the paper says m)
  AffineForce<S> rotated;         ///< eq. 20 or 22; of the angle in rad (the paper: in degrees)
  S blend_mm = S(1);              ///< > 0
  S blend_rad = S(17) / S(1000);  ///< > 0; about a degree

  S operator()(const S& measure,
               const Point2<S>& displacement_mm = {S(0), S(0)},
               const S& rotation_rad = S(0)) const {
    using std::sqrt;
    const S plain_n = plain(measure), length_sq = squared_norm(displacement_mm);
    const S length = value(length_sq) > 0 ? sqrt(length_sq) : S(0);  // no derivative at 0
    const S angle = value(rotation_rad) < 0 ? -rotation_rad : rotation_rad;
    const auto change = [&](const AffineForce<S>& moved, const S& size, const S& blend) {
      const S x = value(size) < value(blend) ? size / blend : S(1);
      return x * x * (S(3) - S(2) * x) * (moved(plain_n, size) - plain_n);
    };
    return plain_n + change(displaced, length, blend_mm) + change(rotated, angle, blend_rad);
  }
};

inline constexpr double degrees_per_rad = 57.295779513082320877;

/// Eqs. 18, 21 and 22, by the area in mm^2.
template <scalar S = double>
NormalForce<S> normal_force_by_area() {
  return {force_of_area<S>(),
          {S(0.748), S(-0.637), S(1.7)},
          {S(1.2), S(0.00171) * S(degrees_per_rad), S(-1.8)}};
}
/// By the depth in mm.
template <scalar S = double>
NormalForce<S> normal_force_by_depth() {
  return {force_of_depth<S>(),
          {S(1.2), S(0.509), S(-3.5)},
          {S(0.8), S(-0.00102) * S(degrees_per_rad), S(-0.0518)}};
}
/// Eqs. 18, 19 and 20, which give the same quantities as 21 and 22 with other numbers.
template <scalar S = double>
NormalForce<S> first_normal_force_by_area() {
  return {force_of_area<S>(),
          {S(0.748), S(-0.637), S(1.7)},
          {S(1.2), S(0.00171) * S(degrees_per_rad), S(-1)}};
}
/// By depth; the gains of both are negative. In both constants the digit before the decimal point
/// is illegible: that of eq. 19 is `constant_n`, 0.2 or 8.2 (E029), that of eq. 20 is taken as 0.
template <scalar S = double>
NormalForce<S> first_normal_force_by_depth(const S& constant_n = S(0.2)) {
  return {force_of_depth<S>(),
          {S(-0.356), S(0.548), constant_n},
          {S(-0.272), S(-0.0074) * S(degrees_per_rad), S(0.5)}};
}

/// Eqs. 4 and 5, normalised by the size of the contact, with one straight line for each. The slopes
/// depend on the pad and the paper prints no numbers, so the caller gives them.
template <scalar S = double>
struct Shear {
  S reference;              ///< S_ref in mm^2 or D_ref in mm
  S displacement_exponent;  ///< T_S or T_D
  S rotation_exponent;      ///< R_S or R_D
  S force_n_per_mm;
  S moment_n_mm_per_rad;

  Point2<S> tangential_force_n(const S& measure, const Point2<S>& displacement_mm) const {
    return force_n_per_mm * factor(measure, displacement_exponent) * displacement_mm;
  }
  S moment_n_mm(const S& measure, const S& rotation_rad) const {
    return moment_n_mm_per_rad * factor(measure, rotation_exponent) * rotation_rad;
  }

  /// (measure / reference)^exponent.
  S factor(const S& measure, const S& exponent) const {
    using std::exp;
    using std::log;
    return exp(exponent * log(measure / reference));
  }
};
/// The constants of "Measurement results of tangential force" and "... of rotational moment", by
/// the area in mm^2.
template <scalar S = double>
Shear<S> shear_by_area(const S& force_n_per_mm, const S& moment_n_mm_per_rad) {
  return {S(100), S(0.65), S(1.7), force_n_per_mm, moment_n_mm_per_rad};
}
/// By the depth in mm.
template <scalar S = double>
Shear<S> shear_by_depth(const S& force_n_per_mm, const S& moment_n_mm_per_rad) {
  return {S(10), S(0.75), S(2.2), force_n_per_mm, moment_n_mm_per_rad};
}

}  // namespace published
}  // namespace v1
}  // namespace fingerpad
