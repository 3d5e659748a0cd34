// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Compensation of a normal force by look-up.
#include "fingerpad/force/normal_force.hpp"

using namespace fingerpad;

extern "C" double switched_off(const NormalForce<>& look_up, double area_mm2) {
  return look_up(area_mm2).force_n;
}

extern "C" double without_effect(const detail::WholeCurve<PolynomialForce<>>& curve,
                                 double area_mm2) {
  const double force = curve.force_n(area_mm2);
  if (!is_finite(area_mm2) || !is_finite(force)) {
    return not_a_number<double>();
  }
  return force > 0 ? force : 0;
}
