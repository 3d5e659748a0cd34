// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/slip/stick_ratio.hpp"

#include "fingerpad/published/stick_ratio.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/slipping_dots.hpp"
#include "support/slipping_patch.hpp"

using namespace fingerpad;

TEMPLATE_TEST_CASE(
    "stick ratio: a frame allocates nothing", "[stick_ratio]", float, double, long double) {
  const long before_all = test::allocations();
  StickRatio<TestType> stick(21, 21, {.noise = 0.14});
  CHECK(test::allocations() > before_all);  // all memory is allocated here
  test::SlippingDots truth;
  test::Random random(1);
  const test::ContactFlags nothing(21, 21);
  long taken = 0;
  int updated = 0;
  const auto steps = test::steps_of(test::SlipScene::everything, 1);
  for (int k = 0; k < 100; ++k) {
    truth.step(steps[static_cast<std::size_t>(k) % steps.size()]);
    auto dots = noisy(truth.dots, 0.14, random);
    dots(10, 10).x = test::nan;
    if (k == 40) {
      dots = test::PointsPx(21, 21, {test::nan, test::nan});
    }
    const auto& contact = k == 50 ? nothing : truth.contact;
    const double time_s = k == 60 ? -1 : k;  // backward once
    const long before = test::allocations();
    const auto r = stick(dots, contact, time_s);
    taken += test::allocations() - before;
    updated += r.updated() ? 1 : 0;
  }
  CHECK(updated > 60);
  CHECK(taken == 0);
  const StickRatio<TestType> fresh(21, 21, {.noise = 0.14});
  const long before = test::allocations();
  stick.reset();
  stick = fresh;
  CHECK(test::allocations() == before);
}

TEST_CASE("stick ratio in space and friction limit: no frame allocates", "[stick_ratio]") {
  StickRatio<> stick(21, 21);  // its noise is measured
  FrictionLimit<double> limit;
  test::SlippingPatch patch;
  test::Random random(1);
  long taken = 0;
  int updated = 0;
  for (int k = 0; k < 40; ++k) {
    const auto dots = noisy(patch.dots, 0.005, 0.025, random);
    const long before = test::allocations();
    const auto r = stick(dots, patch.contact);
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

TEMPLATE_TEST_CASE("published stick ratio: a frame allocates nothing",
                   "[stick_ratio][published]",
                   float,
                   double) {
  const long before_all = test::allocations();
  published::StickRatio<TestType> ratio(21, 21, {.capacity = 16});
  CHECK(test::allocations() > before_all);  // all memory is allocated here
  test::SlippingDots truth;
  test::Random random(1);
  const auto steps = test::steps_of(test::SlipScene::everything, 1);
  int updated = 0;
  long taken = 0;
  for (int k = 0; k < 100; ++k) {
    truth.step(steps[static_cast<std::size_t>(k) % steps.size()]);
    const auto dots = noisy(truth.dots, 0.14, random);
    const long before = test::allocations();
    updated += ratio(dots, truth.contact).ok() ? 1 : 0;
    taken += test::allocations() - before;
  }
  CHECK(updated > 60);
  CHECK(taken == 0);
}
