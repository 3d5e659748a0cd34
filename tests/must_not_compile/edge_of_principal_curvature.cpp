// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A principal curvature has no level that its mean has at the edge of contact.
// message: HalfLevelEdge compares mean curvatures
#include "fingerpad/contact/contact_region.hpp"

#ifdef FINGERPAD_MUST_NOT_COMPILE
using Statistic = fingerpad::HessianFit<18, fingerpad::FittedValue::larger>;
#else
using Statistic = fingerpad::HessianFit<18>;
#endif
int main() {
  const fingerpad::ContactRegion<Statistic> region({}, 20, 30);
  return static_cast<int>(region.rows()) - 20;
}
