// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/shear.hpp"

#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"

using namespace fingerpad;

TEST_CASE("shear: nothing allocates", "[shear]") {
  test::Image<double> samples(150, 4, 0.5), results(150, 3);
  samples(20, 1) = test::nan;
  samples(30, 0) = -1;
  const long before = test::allocations();
  CHECK(before > 0);
  const Shear radial(published_shear_by_area(), RadialShear<2>{{{2, 1}, 1}, {{30, 5}, 1}});
  const Shear linear(
      published_shear_by_depth(),
      LinearShear<>{.x_by_x = 2, .x_by_y = 0, .y_by_x = 0, .y_by_y = 2, .moment_n_mm_per_rad = 30});
  const long start = test::allocations();
  double sum = 0;
  Index answers = 0;
  for (int frame = 0; frame < 100; ++frame) {
    const double t = 0.01 * frame;
    sum += radial(100 * t, {t, -t}, t).tangential_force_n.x;
    sum += linear(10 * t, {t, -t}, t).moment_n_mm;
    sum += moment_about_origin(t, {t, t}, {3, 2});
  }
  answers += radial.for_samples(samples, results).not_finite;
  answers += linear.for_samples(samples, results).not_finite;
  const auto refused = radial.for_samples(results, results);
  const long after = test::allocations();
  CHECK(sum > 0);
  CHECK(answers == 2);
  CHECK(!refused.ok());
  CHECK(after == start);
}
