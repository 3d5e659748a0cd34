// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The load on the oscillator while a contact point slips (paper, eqs. 5-8 and the second case).
//
//   x = H t                                       slip                                        (6)
//   f = (c_a H + k_a (H t - x_ie)) / mu           both suspensions carry the same force       (7)
//   1/mu = y^(1 - beta) / K,  y = z^2 / 2p        deformation; the load N is set equal to y   (8)
//   y = z^2 / 2p + sin(a t)                       while lifting
#include <cmath>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/sim/contact_friction.hpp"
#include "fingerpad/sim/mass_spring_damper.hpp"

namespace fingerpad {
inline namespace v0 {

/// The suspension along the slip.
template <scalar S = double>
struct SlipDrag {
  S damping_n_s_per_mm = S(1);  ///< c_a >= 0
  S stiffness_n_per_mm = S(1);  ///< k_a >= 0
  S speed_mm_per_s = S(1);      ///< H
  S frame_mm = S(0);            ///< x_ie; 0 in eq. 7
};

/// Refuses values out of range (parameter_error).
template <scalar S>
void expects_valid(const SlipDrag<S>& drag) {
  const auto check = [](bool good, const char* name, const S& given, const char* range) {
    expects(good && is_finite(given), "SlipDrag", name, given, range);
  };
  check(value(drag.damping_n_s_per_mm) >= 0, "damping_n_s_per_mm", drag.damping_n_s_per_mm,
        "finite and >= 0");
  check(value(drag.stiffness_n_per_mm) >= 0, "stiffness_n_per_mm", drag.stiffness_n_per_mm,
        "finite and >= 0");
  check(true, "speed_mm_per_s", drag.speed_mm_per_s, "finite");
  check(true, "frame_mm", drag.frame_mm, "finite");
}

/// y = z^2 / 2p: the deformation of the surface at z from the middle of the contact, mm. p is the
/// radius of curvature there, mm; p <= 0 gives NaN.
template <scalar S>
S deformation(const S& z_mm, const S& radius_mm) {
  if (!(value(radius_mm) > 0)) {
    return not_a_number<S>();
  }
  return S(square(z_mm) / S(radius_mm + radius_mm));
}

/// c_a H - k_a x_ie + k_a H t: the drag without friction, with A and B as in eq. 10.
template <scalar S>
RampLoad<S> drag_load(const SlipDrag<S>& drag) {
  const S damped = drag.damping_n_s_per_mm * drag.speed_mm_per_s;
  const S at_start = damped - S(drag.stiffness_n_per_mm * drag.frame_mm);
  return {at_start, S(drag.stiffness_n_per_mm * drag.speed_mm_per_s)};
}

/// A + B t of eq. 8, for a deformation y in mm that counts as a load of y N. The printed factor
/// z^(2/3) holds for 2p = 1 and K = 1.
template <scalar S>
RampLoad<S> slip_load(const SlipDrag<S>& drag,
                      const PolymerFriction<S>& friction,
                      const S& deformation_mm) {
  const RampLoad<S> load = drag_load(drag);
  const S factor = inverse_friction_coefficient(friction, deformation_mm);
  return {S(load.start_n * factor), S(load.rise_n_per_s * factor)};
}

/// cbrt(C + D sin(a t)) (A + B t), the load while lifting.
template <scalar S = double>
struct LiftLoad {
  S middle = S(2);               ///< C >= |D|, otherwise friction would pull
  S swing = S(1);                ///< D
  S frequency_rad_per_s = S(1);  ///< a
  RampLoad<S> drag = {S(1), S(1)};

  S operator()(const S& time_s) const {
    using std::sin;
    const S wave = S(sin(S(frequency_rad_per_s * time_s)));
    const S root = detail::foam::positive_cube_root(S(middle + S(swing * wave)));
    return S(root * drag(time_s));
  }
};

/// Refuses values out of range (parameter_error).
template <scalar S>
void expects_valid(const LiftLoad<S>& load) {
  const auto check = [](bool good, const char* name, const S& given, const char* range) {
    expects(good && is_finite(given), "LiftLoad", name, given, range);
  };
  check(true, "swing", load.swing, "finite");
  const auto size = value(load.swing) < 0 ? -value(load.swing) : value(load.swing);
  check(value(load.middle) >= size, "middle", load.middle, "finite and >= |swing|");
  check(true, "frequency_rad_per_s", load.frequency_rad_per_s, "finite");
  check(true, "drag.start_n", load.drag.start_n, "finite");
  check(true, "drag.rise_n_per_s", load.drag.rise_n_per_s, "finite");
}

/// The load while lifting, for friction with exponent 2/3: C = z^2 / (2p K^3), D = 1 mm / K^3.
template <scalar S>
LiftLoad<S> lift_load(const SlipDrag<S>& drag,
                      const S& friction_factor,
                      const S& deformation_mm,
                      const S& frequency_rad_per_s) {
  const S cube = S(friction_factor * friction_factor) * friction_factor;
  return {S(deformation_mm / cube), S(S(1) / cube), frequency_rad_per_s, drag_load(drag)};
}

}  // namespace v0
}  // namespace fingerpad
