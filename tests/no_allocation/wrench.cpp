// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/wrench.hpp"

#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/rim_marks.hpp"

TEST_CASE("wrench: a frame of a copy allocates nothing", "[wrench]") {
  const test::RimScene& s = test::rim_scenes().front();
  test::SeenRim rim(s, test::SeenRim::options_of(s, true), 0.06, 1);
  auto copy = rim.wrench;
  int good = 0;
  long taken = 0;
  for (std::size_t k = 1; k < s.frames.size(); ++k) {
    rim.show(k);
    const double pressure = k == 2 ? -1 : s.frames[k].pressure_mpa;
    const long before = test::allocations();
    good += copy(rim.marks, pressure).ok() ? 1 : 0;
    taken += test::allocations() - before;
  }
  CHECK(test::allocations() > 0);
  CHECK(taken == 0);
  CHECK(good == 2);
}
