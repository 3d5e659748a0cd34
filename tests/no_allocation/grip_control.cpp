// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/slip/grip_control.hpp"

#include "no_allocation/count.hpp"
#include "support/catch.hpp"

using namespace fingerpad;

TEST_CASE("grip control: nothing allocates", "[grip_control]") {
  const long before = test::allocations();
  GripControl<double> control({}, 3);
  double force_n = 0;
  for (int k = 0; k < 300; ++k) {
    const double ratio = k % 7 == 0 ? not_a_number<double>() : 0.004 * (k % 250);
    force_n += control(ratio, static_cast<RatioUpdate>(k % 3), 0.01).force_n;
    const auto bookmark = control;
    force_n += bookmark.force_n();
  }
  const long after = test::allocations();
  CHECK(force_n > 0);
  CHECK(after == before);
}
