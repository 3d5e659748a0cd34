// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Within a tolerance any number of samples can each be the only one that differs: no search finds
// them in constant time.
// message: ConstantTime takes GraspLift with MovedToOtherCell
#include "fingerpad/foam/preslip.hpp"

#ifdef FINGERPAD_MUST_NOT_COMPILE
using Centroid = fingerpad::MovedBeyond;
#else
using Centroid = fingerpad::MovedToOtherCell;
#endif
int main() {
  const fingerpad::Preslip<fingerpad::GraspLift<Centroid>, 2, fingerpad::ConstantTime> preslip;
  auto state = preslip.start();
  return preslip({}, state).alarm ? 1 : 0;
}
