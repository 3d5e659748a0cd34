// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Six-axis force without a pressure gauge. The balance of a frame gives the ratio of pressure to
// mu t. If mu t is calibrated (calibrate/rim.hpp), this gives the pressure, and with it the forces.
// Source of the balance: Ito, Kim, Obinata 2011, eq. 12; the paper measures the pressure.
#include <cmath>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/wrench.hpp"

namespace fingerpad {
inline namespace v0 {

/// Force, moment and pressure (`pressure_mpa`) of a frame. The pressure is that at which `wrench`
/// finds the mu t `modulus_n_per_mm`, which must be in [0.005, 50] (otherwise `refused`). A
/// relative error of mu t causes the same relative error of the pressure, F_z and all else. There
/// is no covariance. Without contact the forces are 0 and the pressure is NaN. The status is
/// `not_solved` if no pressure up to `max_pressure_mpa` fits. Takes 2 calls of `wrench` with OneRow
/// or TwoRows, about 8 with OneRow{inclination}; allocates nothing.
template <class Solver,
          class Row,
          class Law,
          class Lines,
          scalar S,
          class Shape,
          spatial_dot_grid Dots>
WrenchResult<S> pressure_from_rim(const Wrench<Solver, Row, Law, Lines, S>& wrench,
                                  const Shape& shape,
                                  const Dots& side_dots_mm,
                                  const S& modulus_n_per_mm,
                                  typename Wrench<Solver, Row, Law, Lines, S>::Workspace& work) {
  static_assert(Solver::magnitude != detail::membrane::Magnitude::given && Law::tells_magnitude,
                "a direction alone does not determine the pressure: use BalancedRim or "
                "LeastSquares with ClampedRim");
  if (!detail::membrane::is_modulus(modulus_n_per_mm)) {
    return {};
  }
  // a first guess within a factor of three of the truth; otherwise the frame looks like another
  // pad's
  WrenchResult<S> found;
  S pressure = S(0);
  for (const double share : {0.1, 0.0125, 0.8}) {
    pressure = wrench.options().max_pressure_mpa * S(share);
    found = wrench(shape, side_dots_mm, pressure, work);
    if (found.status != WrenchStatus::modulus_not_as_calibrated) {
      break;
    }
  }
  if (found.by_modulus) {  // without a shape any pressure fits the modulus
    found.status = WrenchStatus::no_level_line;
  }
  const auto is_answer = [&] {
    return found.status == WrenchStatus::ok || found.status == WrenchStatus::pad_has_changed;
  };
  for (int round = 0; round < 40 && is_answer(); ++round) {
    const S ratio = modulus_n_per_mm / found.modulus_n_per_mm;
    const S change = ratio - S(1);
    if (value(S(change * change)) < 1e-10) {
      return found;
    }
    pressure = pressure * ratio;
    found = wrench(shape, side_dots_mm, pressure, work);
    if (found.by_modulus) {
      found.status = WrenchStatus::no_level_line;
    }
  }
  if (found.status == WrenchStatus::no_contact) {  // no force at any pressure
    found.pressure_mpa = not_a_number<S>();
    return found;
  }
  WrenchResult<S> none;
  none.status = is_answer() ? WrenchStatus::not_solved : found.status;
  return none;
}

}  // namespace v0
}  // namespace fingerpad
