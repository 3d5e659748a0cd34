// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The pull of the membrane at its rim, from the side dots printed slightly above it. The rim is
// clamped, so the membrane does not stretch along it. With e the unit tangent of the rim and d the
// derivative of the position along the stress-free membrane, away from the rim, the surface
// deformation gradient is [d, e]. Split d = s e + d_n, with d_n perpendicular to e and
// lambda = |d_n|, which is also the area ratio J.
//
// Published (Ito, Kim, Obinata 2011, III.E): the pull has the direction of d. This does not hold
// for a hyperelastic membrane. With W = mu t / 2 (|F|^2 + J^-2 - 3) per stress-free area
// (incompressible neo-Hookean) the force per length of rim is
//   T / (mu t) = dW / dd = s e + (lambda - lambda^-3) d_n / lambda.
// A small stretch gives little normal tension, but shear is resisted in full. So T leans further
// sideways than d, by the factor lambda^4 / (lambda^4 - 1).
//
// Other rubbers resist shear less where they are stretched. In the Mooney-Rivlin energy, C1 belongs
// to the form above and C2 to the second invariant. With mu = 2 (C1 + C2) and m = C2 / (C1 + C2),
//   T / (mu t) = (1 - m + m lambda^-2) s e + (lambda - (1 + m s^2) lambda^-3) d_n / lambda.
// Without shear m makes no difference. So the rim of a free pad does not show m, but its apex does
// (calibrate/rim.hpp).
#include <cmath>
#include <cstdint>
#include <optional>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail::membrane {

/// Status of a side dot.
enum class RimPullStatus : std::uint8_t {
  ok,
  missing,      ///< the dot was not found
  unstretched,  ///< stretched too little to give the direction of the pull
  slack,        ///< shorter than without stress: the membrane pushes, or has folded
};

/// Pull of the membrane at a rim point.
template <scalar S>
struct RimPull {
  RimPullStatus status = RimPullStatus::missing;
  Point3<S> pull = {S(0), S(0), S(0)};  ///< T / (mu t), or only its direction; acts on the base
};

/// A point of the rim.
template <scalar S>
struct RimPoint {
  Point3<S> border;
  Point3<S> tangent;  ///< unit vector along the rim, in the direction of growing angle
  S length_mm;        ///< from here to the side dot, along the stress-free membrane
  S radius_mm;        ///< of the rim
};

}  // namespace detail::membrane

/// T / (mu t) of a clamped rim; `along` is d, `tangent` the unit vector e, lambda > 0;
/// `mooney_share` is m.
template <scalar S>
Point3<S> clamped_rim_pull(const Point3<S>& along,
                           const Point3<S>& tangent,
                           const S& mooney_share = S(0)) {
  const S shear = dot(along, tangent);
  const Point3<S> across = along + S(-shear) * tangent;
  const S lambda_sq = squared_norm(across);
  const S inverse = S(1) / lambda_sq;
  const S stiffness = S(1) - mooney_share * (S(1) - inverse);
  const S share = S(1) - (S(1) + mooney_share * shear * shear) * inverse * inverse;
  return stiffness * shear * tangent + share * across;
}

/// The pull of a membrane of rubber at its clamped rim.
struct ClampedRim {
  static constexpr bool tells_magnitude = true;

  double min_stretch = 1.005;  ///< smallest lambda from which a direction can be found, in (1, 2]
  double mooney_share = 0;     ///< m = C2 / (C1 + C2), in [0, 1]; 0: neo-Hookean

  template <scalar S>
  detail::membrane::RimPull<S> pull(const Point3<S>& along, const Point3<S>& tangent) const {
    const S shear = dot(along, tangent);
    const S lambda_sq = squared_norm(along) - shear * shear;
    const scalar_real_t<S> least = static_cast<scalar_real_t<S>>(min_stretch);
    if (!(value(lambda_sq) >= least * least)) {
      using enum detail::membrane::RimPullStatus;
      return {value(lambda_sq) < 1 ? slack : unstretched, {S(0), S(0), S(0)}};
    }
    return {detail::membrane::RimPullStatus::ok, clamped_rim_pull(along, tangent, S(mooney_share))};
  }

  template <scalar S>
  Point3<S> change_of_pull(const Point3<S>& along,
                           const Point3<S>& tangent,
                           const Point3<S>& change) const {
    const S m = S(mooney_share);
    const S shear = dot(along, tangent);
    const Point3<S> across = along + S(-shear) * tangent;
    const S shear_change = dot(change, tangent);
    const Point3<S> across_change = change + S(-shear_change) * tangent;
    const S inverse = S(1) / squared_norm(across);
    const S stretching = inverse * dot(across, change);  // relative change of lambda
    const S along_rim =
        (S(1) - m * (S(1) - inverse)) * shear_change - S(2) * m * inverse * stretching * shear;
    const S per = (S(1) + m * shear * shear) * inverse * inverse;
    const S per_change =
        S(2) * m * shear * shear_change * inverse * inverse - S(4) * per * stretching;
    return along_rim * tangent + S(S(1) - per) * across_change + S(-per_change) * across;
  }
};

/// Refuses values out of range (parameter_error).
inline void expects_valid(const ClampedRim& rim) {
  expects(rim.min_stretch > 1 && rim.min_stretch <= 2, "ClampedRim", "min_stretch", rim.min_stretch,
          "in (1, 2]");
  expects(rim.mooney_share >= 0 && rim.mooney_share <= 1, "ClampedRim", "mooney_share",
          rim.mooney_share, "in [0, 1]");
}

namespace detail::membrane {
/// m of a law; 0 (neo-Hookean) if it has none.
template <scalar S, class Law>
S mooney_share_of(const Law& law) {
  if constexpr (requires { law.mooney_share; }) {
    return S(law.mooney_share);
  } else {
    return S(0);
  }
}
}  // namespace detail::membrane

/// One row of side dots: d is the chord from the rim to the dot, divided by its stress-free length
/// L. If the inclination of the stress-free membrane is given, d is carried from the middle of the
/// chord to the rim. The balance of the membrane there gives how fast stretch, inclination and
/// shear change along the chord. With ds the arc length (dS without stress), a the radius of the
/// rim, phi the inclination (phi_0 without stress), r and rho the radius with and without stress,
/// and the tensions per mu t T1 = lambda - lambda^-3 and T2 = (1 - m + m lambda^2)
/// (1 - lambda^-2) / lambda:
///   inclination  kappa_1 = (p / (mu t) - T2 sin(phi) / a) / T1          (normal balance)
///   tension      dT1/ds = (T1 - T2) cos(phi) / a                        (balance along the line)
///   hoop stretch dlambda_2/dS = (cos(phi_0) - lambda cos(phi)) / a      (geometry)
///   shear        d(r rho P_e)/dS = 0, so with P_e = g s, g = 1 - m + m (lambda lambda_2)^-2,
///                chord = s (1 + (cos(phi_0) / a - g' / g) L / 2)            (torque)
/// Here s is the shear along the chord, in the last line that at the rim. What changes along the
/// rim is left out. With the inclination, Wrench includes it: it takes the pull from the balance of
/// the strip between the rim and the middles of the chords.
struct OneRow {
  static constexpr Index rows = 1;
  /// Noise of d, divided by (noise of a dot / length).
  static constexpr double noise_gain = 1;

  /// phi_0, in [0, pi / 2]; for a spherical cap 2 atan(height / radius). Empty: d is the chord.
  std::optional<double> stress_free_inclination_rad = {};

  /// Whether d depends on mu t.
  bool needs_modulus() const { return stress_free_inclination_rad.has_value(); }

  /// `load_per_mm`: pressure / (mu t), 1/mm; 0: not known yet, d is the chord.
  template <scalar S>
  Point3<S> along(const detail::membrane::RimPoint<S>& rim,
                  const Point3<S>* side_dots,
                  const S& load_per_mm,
                  const S& mooney_share = S(0)) const {
    const Point3<S> chord = (side_dots[0] - rim.border) / rim.length_mm;
    return needs_modulus() && !(value(load_per_mm) == 0)
               ? at_rim(rim, chord, load_per_mm, mooney_share)
               : chord;
  }

 private:
  template <scalar S>
  Point3<S> at_rim(const detail::membrane::RimPoint<S>& rim,
                   const Point3<S>& chord,
                   const S& load_per_mm,
                   const S& m) const {
    using std::cos;
    using std::sin;
    using std::sqrt;
    const S shear = dot(chord, rim.tangent);
    const Point3<S> across = chord + S(-shear) * rim.tangent;
    const S lambda = sqrt(squared_norm(across));
    if (!(lambda > S(1001) / S(1000))) {
      return chord;
    }
    // out of the pad, in the plane of the rim
    const Point3<S> outward = {rim.tangent.y, S(-rim.tangent.x), S(0)};
    const S sine = across.z / lambda;
    const S cosine = -dot(across, outward) / lambda;
    const S cosine_free = cos(S(*stress_free_inclination_rad));
    const S half = rim.length_mm / S(2);
    const S inverse = S(1) / lambda;
    const S inverse_cubed = inverse * inverse * inverse;
    const S t1 = lambda - inverse_cubed;
    const S t2 = (inverse - inverse_cubed) * (S(1) - m + m * lambda * lambda);

    const S turn = (load_per_mm - t2 * sine / rim.radius_mm) / t1 * lambda * half;
    const S tension_rise = lambda * (t1 - t2) * cosine / rim.radius_mm;
    const S hoop_rise = (cosine_free - lambda * cosine) / rim.radius_mm;
    // T1 = (lambda / lambda_2 - (lambda lambda_2)^-3) (1 - m + m lambda_2^2)
    const S per_hoop = S(3) * inverse_cubed - lambda + S(2) * m * t1;
    const S stretch_rise =
        (tension_rise - per_hoop * hoop_rise) / (S(1) + S(3) * inverse_cubed * inverse);
    const S at_rim = lambda - stretch_rise * half;
    const S area_rise = stretch_rise + lambda * hoop_rise;
    const S softening =
        S(2) * m * inverse_cubed * area_rise / (S(1) - m + m * inverse * inverse);  // -g' / g
    const S shear_at_rim = shear * (S(1) - (cosine_free / rim.radius_mm + softening) * half);
    const bool plausible = turn < S(1) / S(2) && turn > S(-1) / S(2);
    const S c = plausible ? S(cos(turn)) : S(1);
    const S s = plausible ? S(sin(turn)) : S(0);
    const S inward = at_rim * (cosine * c - sine * s);
    const S up = at_rim * (sine * c + cosine * s);
    return {S(shear_at_rim * rim.tangent.x - inward * outward.x),
            S(shear_at_rim * rim.tangent.y - inward * outward.y), up};
  }
};

/// Two rows of side dots, the second at twice the stress-free length of the first. They give the
/// derivative at the rim itself, to second order: d = (4 x1 - 3 x0 - x2) / (2 L).
struct TwoRows {
  static constexpr Index rows = 2;
  static constexpr bool needs_modulus() { return false; }
  static constexpr double noise_gain = 2.0615528128088303;  // sqrt(4^2 + 1) / 2

  template <scalar S>
  Point3<S> along(const detail::membrane::RimPoint<S>& rim,
                  const Point3<S>* side_dots,
                  const S&,
                  const S& = S(0)) const {
    const Point3<S> first = side_dots[0] - rim.border;
    const Point3<S> second = side_dots[1] - rim.border;
    return (S(4) * first - second) / S(S(2) * rim.length_mm);
  }
};

/// Refuses values out of range (parameter_error).
inline void expects_valid(const TwoRows&) {}
inline void expects_valid(const OneRow& row) {
  const double inclination = row.stress_free_inclination_rad.value_or(0);
  expects(inclination >= 0 && inclination <= 1.5707964, "OneRow", "stress_free_inclination_rad",
          inclination, "in [0, pi / 2]");
}

}  // namespace v0
}  // namespace fingerpad
