// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The object's motion as printed: Ito, Kim, Nagai, Obinata, "Acquisition of tactile information by
// vision-based tactile sensor for dexterous handling of robot hands", III.C, eqs. 13-19: the
// rotation of the contact reference dot from a basis of its neighbours, and Euler angles that are
// added up from frame to frame. The sum errs as rotations do not commute: docs/errata.md,
// E019-E024.
#include "fingerpad/motion/object_motion.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

template <scalar S = double>
using ObjectMotion = fingerpad::ObjectMotion<SumOfAngles<PublishedBasis>, S>;

/// `initial_mm` are the dots of the free pad. Refuses bad parameters (parameter_error).
template <scalar S = double, spatial_dot_grid Dots>
ObjectMotion<S> object_motion(const Dots& initial_mm) {
  return ObjectMotion<S>(initial_mm);
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
