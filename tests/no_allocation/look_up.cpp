// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/look_up.hpp"

#include <limits>

#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/curves.hpp"

using namespace fingerpad;

TEMPLATE_TEST_CASE(
    "look-ups: a frame allocates nothing", "[normal_force][shear]", float, double, long double) {
  using S = TestType;
  const S measures[] = {S(-1),  S(0),   S(5),
                        S(100), S(470), S(1000),
                        S(1e6), S(0.1), std::numeric_limits<S>::quiet_NaN()};
  ForceCurve<S> curve = test::curve_of_area<S>();
  curve.residual_sd_n = S(1);
  const long before = test::allocations();
  CHECK(before > 0);
  const NormalForce force(curve);
  const Shear shear(test::straight_map(S(100), S(0.65), S(1.7), S(2), S(60)));
  const long start = test::allocations();
  int answers = 0;
  for (int i = 0; i < 200; ++i) {
    const S measure = measures[i % 9], y = i % 31 == 0 ? std::numeric_limits<S>::quiet_NaN() : S(1);
    const S angle = S(0.001) * static_cast<S>(i % 29);
    const auto r = force(measure, angle);
    answers += r.has_force() ? 1 : 0;
    answers += fused(r, force(S(100))).has_force() ? 1 : 0;
    answers += shear(measure, {S(0.1), y}, angle).has_moment() ? 1 : 0;
  }
  const long after = test::allocations();
  CHECK(after == start);
  CHECK(answers > 500);
}
