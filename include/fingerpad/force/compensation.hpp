// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How the normal force that a curve gives changes when the contact is also displaced or rotated.
// Every way is affine in the plain force: F = gain F_plain + shift, both functions of the
// displacement's length and of the angle.
#include <cmath>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/smooth_step.hpp"

namespace fingerpad {
inline namespace v0 {

/// F = gain * plain + shift.
template <scalar S>
struct ForceChange {
  S gain;
  S shift_n;
};

/// Measures of a contact that is pressed alone. Displacement and angle are not looked at.
struct NoCompensation {
  static constexpr bool reads_motion = false;
};

/// The consistent form: F = F_plain (1 + a |d|^2 + b theta^2). It is the plain force where nothing
/// is displaced or rotated, takes both at once, and is even and smooth in both, as the symmetry of
/// a round pad asks. The published one (eqs. 21 and 22) is none of that.
template <scalar S = double>
struct ScaledCompensation {
  static constexpr bool reads_motion = true;

  S per_mm_sq = S(0);   ///< a, 1/mm^2, finite
  S per_rad_sq = S(0);  ///< b, 1/rad^2, finite

  ForceChange<S> operator()(const S& displacement_sq_mm2, const S& rotation_rad) const {
    const S rotated = per_rad_sq * square(rotation_rad);
    return {S(S(S(1) + S(per_mm_sq * displacement_sq_mm2)) + rotated), S(0)};
  }
};

/// The published form of one equation: gain F + per_unit |x| + offset_n.
template <scalar S = double>
struct AffineForce {
  S gain = S(1);
  S per_unit = S(0);  ///< N/mm or N/rad
  S offset_n = S(0);

  S operator()(const S& plain_n, const S& size) const {
    return S(S(gain * plain_n) + S(S(per_unit * size) + offset_n));
  }
};

/// Eq. 21 for a displaced contact and eq. 22 for a rotated one. Neither equals the plain force
/// where nothing moved, and nothing is said of both at once. So each is blended in: its part grows
/// from 0 to 1 over `blend_mm` or `blend_rad`, beyond which it is the printed equation, and where
/// both act their changes add.
template <scalar S = double>
struct PublishedCompensation {
  static constexpr bool reads_motion = true;

  AffineForce<S> displaced = {};
  AffineForce<S> rotated = {};
  S blend_mm = S(1);              ///< finite, > 0
  S blend_rad = S(17) / S(1000);  ///< about a degree; finite, > 0

  ForceChange<S> operator()(const S& displacement_sq_mm2, const S& rotation_rad) const {
    using std::sqrt;
    const bool displaced_at_all = value(displacement_sq_mm2) > 0;
    const S length = displaced_at_all ? S(sqrt(displacement_sq_mm2)) : S(0);
    const S angle = value(rotation_rad) < 0 ? S(-rotation_rad) : rotation_rad;
    const S d = detail::smooth_step(S(length / blend_mm));
    const S t = detail::smooth_step(S(angle / blend_rad));
    const S d_shift = S(displaced.per_unit * length) + displaced.offset_n;
    const S t_shift = S(rotated.per_unit * angle) + rotated.offset_n;
    return {S(S(S(1) + S(d * S(displaced.gain - S(1)))) + S(t * S(rotated.gain - S(1)))),
            S(S(d * d_shift) + S(t * t_shift))};
  }
};

/// Eqs. 21 and 22 as printed, for published_force_of_area and published_force_of_depth. The
/// displacement is in mm (the paper says m) and the angle in rad (there in degrees). Eqs. 19 and 20
/// give the same twice more with other numbers, under which the force falls with depth and turns
/// negative: docs/errata.md, E029 and E030.
template <scalar S = double>
PublishedCompensation<S> published_compensation_by_area() {
  const S degrees_per_rad = S(57.295779513082320877);
  return {{S(0.748), S(-0.637), S(1.7)}, {S(1.2), S(S(0.00171) * degrees_per_rad), S(-1.8)}};
}
template <scalar S = double>
PublishedCompensation<S> published_compensation_by_depth() {
  const S degrees_per_rad = S(57.295779513082320877);
  return {{S(1.2), S(0.509), S(-3.5)}, {S(0.8), S(S(-0.00102) * degrees_per_rad), S(-0.0518)}};
}

/// Refuses what has no meaning (parameter_error).
inline void expects_valid(const NoCompensation&) {}
template <scalar S>
void expects_valid(const ScaledCompensation<S>& compensation) {
  expects(is_finite(compensation.per_mm_sq), "ScaledCompensation", "per_mm_sq",
          compensation.per_mm_sq, "finite");
  expects(is_finite(compensation.per_rad_sq), "ScaledCompensation", "per_rad_sq",
          compensation.per_rad_sq, "finite");
}
template <scalar S>
void expects_valid(const PublishedCompensation<S>& compensation) {
  const auto check = [](const AffineForce<S>& force, const char* name) {
    expects(is_finite(force.gain), name, "gain", force.gain, "finite");
    expects(is_finite(force.per_unit), name, "per_unit", force.per_unit, "finite");
    expects(is_finite(force.offset_n), name, "offset_n", force.offset_n, "finite");
  };
  check(compensation.displaced, "PublishedCompensation: displaced");
  check(compensation.rotated, "PublishedCompensation: rotated");
  expects(is_finite(compensation.blend_mm) && value(compensation.blend_mm) > 0,
          "PublishedCompensation", "blend_mm", compensation.blend_mm, "finite and > 0");
  expects(is_finite(compensation.blend_rad) && value(compensation.blend_rad) > 0,
          "PublishedCompensation", "blend_rad", compensation.blend_rad, "finite and > 0");
}

}  // namespace v0
}  // namespace fingerpad
