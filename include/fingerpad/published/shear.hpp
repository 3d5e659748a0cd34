// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Tangential force and moment as printed: Ito, Kim, Obinata, "Acquisition of contact force and
// slippage using a vision-based tactile sensor with a fluid-type touchpad", eqs. 4 and 5:
// displacement and rotation normalised by area or depth, with one straight line for each. The
// slopes depend on the pad and the source prints no numbers, so the caller passes them.
#include "fingerpad/force/shear.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// The constants of "Measurement results of tangential force" and "... of rotational moment", by
/// contact area in mm^2 and by contact depth in mm.
template <scalar S = double>
ShearNormalisation<S> shear_normalisation_by_area() {
  return {S(100), S(0.65), S(1.7)};
}
template <scalar S = double>
ShearNormalisation<S> shear_normalisation_by_depth() {
  return {S(10), S(0.75), S(2.2)};
}

template <scalar S = double>
using Shear = fingerpad::Shear<RadialShear<1, S>>;

/// The measure is the contact's area in mm^2.
template <scalar S = double>
Shear<S> shear_by_area(const S& force_n_per_mm, const S& moment_n_mm_per_rad) {
  RadialShear<1, S> map;
  map.force.coefficients[0] = force_n_per_mm;
  map.moment.coefficients[0] = moment_n_mm_per_rad;
  return Shear<S>(shear_normalisation_by_area<S>(), map);
}
/// The measure is the contact's depth in mm.
template <scalar S = double>
Shear<S> shear_by_depth(const S& force_n_per_mm, const S& moment_n_mm_per_rad) {
  RadialShear<1, S> map;
  map.force.coefficients[0] = force_n_per_mm;
  map.moment.coefficients[0] = moment_n_mm_per_rad;
  return Shear<S>(shear_normalisation_by_depth<S>(), map);
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
