// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/slip/spatial_stick_ratio.hpp"

#include "count.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "support/catch.hpp"
#include "support/slipping_patch.hpp"

using namespace fingerpad;

TEST_CASE("stick ratio in space and friction limit: no frame allocates", "[spatial_stick]") {
  const SpatialStickRatio<double> ratio(21, 21);
  FrictionLimit<double> limit;
  auto state = ratio.start();
  test::SlippingPatch patch;
  test::Image<DotState> states(21, 21);
  test::Random random(1);
  long taken = 0;
  int updated = 0;
  for (int k = 0; k < 10; ++k) {  // free frames, whose noise is measured
    const auto dots = noisy(patch.dots, 0.005, 0.025, random);
    const test::Image<std::uint8_t> none(21, 21, 0);
    const long before = test::allocations();
    (void)ratio(dots, none, states, state);
    taken += test::allocations() - before;
  }
  CHECK(state.lateral_mm() != 0.005);
  for (int k = 0; k < 40; ++k) {
    const auto dots = noisy(patch.dots, 0.005, 0.025, random);
    const long before = test::allocations();
    const auto r = ratio(dots, patch.contact, states, state);
    const auto load =
        contact_load(Point3<double>{0.1 * k, 0, -5}, Point3<double>{1, 2, 3}, dots, patch.contact);
    (void)limit(load, r);
    taken += test::allocations() - before;
    updated += r.updated() ? 1 : 0;
    patch.step(test::moved_by({0, 0.002, 0.002}, {0, 0, 28}, {0.1, 0, 0}), 1.2 - 0.03 * k);
  }
  CHECK(updated > 20);
  CHECK(taken == 0);
}
