// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/motion/object_motion.hpp"

#include "fingerpad/dots/spatial_dots.hpp"
#include "fingerpad/published/object_motion.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/rolling.hpp"

using namespace fingerpad;

TEST_CASE("object motion: a frame allocates nothing", "[object_motion]") {
  const test::RollingBall ball;
  const long before_all = test::allocations();
  ObjectMotion<> motion(21, 21);
  CHECK(test::allocations() > before_all);
  published::ObjectMotion printed(ball.initial());
  ObjectMotion<> copy = motion;
  test::Rolling roll(ball, -6, 0);
  test::Gauss gauss(1);
  long taken = 0;
  for (int k = 0; k < 30; ++k) {
    roll.step(-6 + 0.4 * k, 0.1 * k);
    auto dots = noisy(roll.dots, roll.contact, gauss);
    dots(10, 10).x = not_a_number<double>();
    auto flags = roll.contact;
    if (k == 20) {
      flags = test::Flags(21, 21, 0);  // start of a new object
    }
    const long before = test::allocations();
    (void)motion(dots, flags);
    (void)copy(dots, flags);
    (void)printed(dots, flags);
    copy = motion;
    taken += test::allocations() - before;
  }
  CHECK(taken == 0);
}

TEST_CASE("spatial dots: a frame allocates nothing", "[object_motion]") {
  const Camera<double> camera;
  test::Dots out(5, 6);
  test::Image<Point2<double>> dots(5, 6, {300, 200});
  test::Image<float> depth(480, 640, 9.0F);
  test::Flags mask(480, 640, 1), flags(5, 6, 0);
  const long before = test::allocations();
  const auto result = spatial_dots(camera, dots, depth, out);
  const bool sampled = contact_at_dots(dots, mask, flags);
  const long after = test::allocations();
  CHECK(result == 30);
  CHECK(sampled);
  CHECK(after == before);
}
