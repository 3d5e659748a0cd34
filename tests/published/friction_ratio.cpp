// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/published/friction_ratio.hpp"

#include <cmath>
#include <limits>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;
using fingerpad::published::FrictionRatio;

namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();
}  // namespace

TEST_CASE("friction ratio: compared with the last slip", "[friction_ratio]") {
  FrictionRatio friction;
  CHECK(std::isnan(friction(1.0, 2.0, false)));
  CHECK(std::isnan(friction.mu_0()));
  CHECK(friction(1.6, 2.0, true) == 0);
  CHECK(friction.mu_0() == 0.8);
  CHECK(friction(2.0, 5.0, false) == Approx(0.5));
  CHECK(friction(3.65, 5.0, false) == Approx(1 - 0.73 / 0.8));
  CHECK(friction(8.0, 5.0, false) == Approx(-1));  // beyond it the margin is the excess
  // the last slip counts, and of it the last frame
  (void)friction(2.5, 5.0, true);
  (void)friction(2.0, 5.0, true);
  CHECK(friction.mu_0() == 0.4);
  FrictionRatio copy = friction;
  (void)friction(1.0, 5.0, true);
  CHECK(copy.mu_0() == 0.4);
}

TEST_CASE("friction ratio: forces that give no ratio", "[friction_ratio]") {
  FrictionRatio friction;
  (void)friction(0.8, 1.0, true);
  for (const bool slips : {false, true}) {
    for (const double bad : {none, infinity, -infinity, -1.0}) {
      CHECK(std::isnan(friction(bad, 1.0, slips)));
      CHECK(std::isnan(friction(0.3, bad, slips)));
    }
    CHECK(std::isnan(friction(0.3, 0.0, slips)));
    CHECK(friction(0.0, 1.0, slips) == 1);  // a slip without a tangential force has no friction
  }
  CHECK(friction.mu_0() == 0.8);
}

TEST_CASE("friction ratio: laws", "[friction_ratio][law]") {
  rc::prop("gripping harder never lessens the margin, pulling harder never adds to it", [] {
    const double force = test::uniform(0, 5), normal = test::uniform(0.1, 20);
    const double more = test::uniform(0, 5), factor = test::uniform(1, 10);
    FrictionRatio friction;
    (void)friction(test::uniform(0.1, 5), test::uniform(0.1, 5), true);
    const double margin = friction(force, normal, false);
    RC_ASSERT(friction(force, normal + more, false) >= margin);
    RC_ASSERT(friction(force + more, normal, false) <= margin);
    RC_ASSERT(std::abs(friction(factor * force, factor * normal, false) - margin) <
              1e-12 * (1 + std::abs(margin)));
  });
}
