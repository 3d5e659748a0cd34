// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/slip/grip_control.hpp"

#include "fingerpad/published/friction_ratio.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"

using namespace fingerpad;

TEST_CASE("grip control: nothing allocates", "[grip_control]") {
  const long before = test::allocations();
  const GripControl<double> control;
  auto state = control.start(3);
  double force_n = 0;
  for (int k = 0; k < 300; ++k) {
    const double ratio = k % 7 == 0 ? not_a_number<double>() : 0.004 * (k % 250);
    force_n += control({ratio, static_cast<RatioUpdate>(k % 3)}, 0.01, state).force_n;
    auto bookmark = state;
    bookmark.reset();
  }
  const long after = test::allocations();
  CHECK(force_n > 0);
  CHECK(after == before);
}

TEST_CASE("friction ratio: nothing allocates", "[friction_ratio]") {
  const long before = test::allocations();
  const published::FrictionRatio<double> friction;
  auto state = friction.start();
  bool alarm = false;
  for (int k = 0; k < 300; ++k) {
    const Point2<double> force{0.01 * k, k % 11 == 0 ? not_a_number<double>() : 0.3};
    alarm = friction(force, 0.01 * (k - 5), k % 50 == 20, state).alarm || alarm;
  }
  const long after = test::allocations();
  CHECK(alarm);
  CHECK(after == before);
}
