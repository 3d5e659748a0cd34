// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The look-up of the normal force as printed: Ito, Kim, Obinata, "Acquisition of contact force and
// slippage using a vision-based tactile sensor with a fluid-type touchpad", eqs. 18, 21 and 22, for
// the paper's own pad: by contact area and by contact depth. docs/errata.md, E029 and E030.
#include "fingerpad/force/normal_force.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

template <scalar S = double>
using NormalForce = fingerpad::NormalForce<PolynomialForce<2, S>, PublishedCompensation<S>>;

/// The measure is the contact's area in mm^2.
template <scalar S = double>
NormalForce<S> normal_force_by_area() {
  return NormalForce<S>(published_force_of_area<S>(), published_compensation_by_area<S>());
}
/// The measure is the contact's depth in mm.
template <scalar S = double>
NormalForce<S> normal_force_by_depth() {
  return NormalForce<S>(published_force_of_depth<S>(), published_compensation_by_depth<S>());
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
