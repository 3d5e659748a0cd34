// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Curves and maps of the default look-ups with the numbers of the published ones.
#include "fingerpad/force/look_up.hpp"
#include "fingerpad/published/look_up.hpp"

namespace test {

template <class S>
fingerpad::ForceCurve<S> curve_of(const fingerpad::published::Quadratic<S>& printed) {
  fingerpad::ForceCurve<S> curve;
  curve.coefficients[0] = printed.c_0;
  curve.coefficients[1] = printed.c_1;
  curve.coefficients[2] = printed.c_2;
  curve.from = printed.from;
  curve.to = printed.to;
  return curve;
}
template <class S = double>
fingerpad::ForceCurve<S> curve_of_area() {
  return curve_of(fingerpad::published::force_of_area<S>());
}
template <class S = double>
fingerpad::ForceCurve<S> curve_of_depth() {
  return curve_of(fingerpad::published::force_of_depth<S>());
}

/// Straight lines; `to` is not known.
template <class S = double>
fingerpad::ShearMap<S> straight_map(const S& reference,
                                    const S& displacement_exponent,
                                    const S& rotation_exponent,
                                    const S& force_n_per_mm,
                                    const S& moment_n_mm_per_rad) {
  fingerpad::ShearMap<S> map;
  map.reference = reference;
  map.force.slope = force_n_per_mm;
  map.force.exponent = displacement_exponent;
  map.moment.slope = moment_n_mm_per_rad;
  map.moment.exponent = rotation_exponent;
  return map;
}
template <class S>
fingerpad::ShearMap<S> map_of(const fingerpad::published::Shear<S>& printed) {
  return straight_map(printed.reference, printed.displacement_exponent, printed.rotation_exponent,
                      printed.force_n_per_mm, printed.moment_n_mm_per_rad);
}

}  // namespace test
