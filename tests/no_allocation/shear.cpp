// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/shear.hpp"

#include "fingerpad/published/shear.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"

using namespace fingerpad;

TEST_CASE("shear: nothing allocates", "[shear]") {
  const long before = test::allocations();
  CHECK(before > 0);
  const Shear radial(published::shear_normalisation_by_area(),
                     RadialShear<2>{{{2, 1}, 1}, {{30, 5}, 1}});
  const Shear linear(
      published::shear_normalisation_by_depth(),
      LinearShear<>{.x_by_x = 2, .x_by_y = 0, .y_by_x = 0, .y_by_y = 2, .moment_n_mm_per_rad = 30});
  const long start = test::allocations();
  double sum = 0;
  for (int frame = 0; frame < 100; ++frame) {
    const double t = 0.01 * frame;
    sum += radial(100 * t, {t, -t}, t).tangential_force_n.x;
    sum += linear(10 * t, {t, -t}, t).moment_n_mm;
    sum += moment_about_origin(t, {t, t}, {3, 2});
  }
  const long after = test::allocations();
  CHECK(sum > 0);
  CHECK(after == start);
}
