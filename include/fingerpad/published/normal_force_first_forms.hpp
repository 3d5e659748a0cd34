// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// First forms of the normal force in Ito, Kim, Obinata, "Acquisition of contact force and slippage
// using a vision-based tactile sensor with a fluid-type touchpad": the balance of a flat contact,
// eq. 2, and the compensations of eqs. 19 and 20, which eqs. 21 and 22 replace. By depth, the force
// of eqs. 19 and 20 falls while the contact grows (docs/errata.md, E028-E030). Eqs. 21 and 22 are
// in published/normal_force.hpp.
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/published/normal_force.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// F_z = p_in S_c, eq. 2: the force of a flat contact in N. NaN if pressure or area is negative or
/// missing. It does not hold for a curved or tilted object, on which the membrane beside the
/// contact also pulls.
template <scalar S>
S flat_contact_force_n(const S& pressure_mpa, const S& area_mm2) {
  const bool known = is_finite(pressure_mpa) && is_finite(area_mm2) && !(value(pressure_mpa) < 0) &&
                     !(value(area_mm2) < 0);
  return known ? S(pressure_mpa * area_mm2) : not_a_number<S>();
}

/// Eqs. 19 and 20 by the area: 0.748 F_S - 0.637 |d| + 1.7 and 1.2 F_S + 0.00171 |theta| - 1.0.
template <scalar S = double>
Compensation<S> first_compensation_by_area() {
  const S degrees_per_rad = S(57.295779513082320877);
  return {{S(0.748), S(-0.637), S(1.7)}, {S(1.2), S(S(0.00171) * degrees_per_rad), S(-1)}};
}
/// By the depth: -0.356 F_D + 0.548 |d| + 0.2 and -0.272 F_D - 0.0074 |theta| + 0.5. In both
/// constants the digit before the decimal point is illegible in the source; it is taken as 0.
template <scalar S = double>
Compensation<S> first_compensation_by_depth() {
  const S degrees_per_rad = S(57.295779513082320877);
  return {{S(-0.356), S(0.548), S(0.2)}, {S(-0.272), S(S(-0.0074) * degrees_per_rad), S(0.5)}};
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
