// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/published/friction_ratio.hpp"

#include <cmath>
#include <limits>
#include <string>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using fingerpad::published::FrictionRatio;
using fingerpad::published::FrictionStatus;
using fingerpad::published::FrictionTest;

namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();
}  // namespace

TEST_CASE("friction ratio: compared with the last slip", "[friction_ratio]") {
  const FrictionRatio friction;
  auto state = friction.start();
  auto result = friction(1.0, 2.0, false, state);
  CHECK(result.status == FrictionStatus::no_slip_yet);
  CHECK(result.ratio == 0.5);
  CHECK(std::isnan(result.margin));
  CHECK(std::isnan(result.remembered_ratio));
  CHECK(!result.alarm);
  CHECK(!state.has_slipped());

  result = friction(1.6, 2.0, true, state);
  CHECK(result.status == FrictionStatus::sliding);
  CHECK(result.alarm);
  CHECK(result.remembered_ratio == 0.8);
  CHECK(result.margin == 0);
  CHECK(state.has_slipped());

  result = friction(2.0, 5.0, false, state);
  CHECK(result.status == FrictionStatus::held);
  CHECK(!result.alarm);
  CHECK(result.margin == Approx(0.5));

  result = friction(3.65, 5.0, false, state);  // 0.73 of 0.8
  CHECK(result.status == FrictionStatus::near_slip);
  CHECK(result.alarm);
  CHECK(result.margin == Approx(1 - 0.73 / 0.8));

  // beyond the remembered ratio the margin is the excess
  CHECK(friction(8.0, 5.0, false, state).margin == Approx(-1));

  // the last slip counts, and of it the last frame
  (void)friction(2.5, 5.0, true, state);
  result = friction(2.0, 5.0, true, state);
  CHECK(result.remembered_ratio == 0.4);
  CHECK(friction(1.75, 5.0, false, state).status == FrictionStatus::held);
  CHECK(friction(1.85, 5.0, false, state).status == FrictionStatus::near_slip);

  state.reset();
  CHECK(friction(2.0, 5.0, false, state).status == FrictionStatus::no_slip_yet);
}

TEST_CASE("friction ratio: the share of the alarm can be set", "[friction_ratio]") {
  const FrictionRatio early({.alarm_fraction = 0.5});
  auto state = early.start();
  (void)early(1.0, 1.0, true, state);
  CHECK(!early(0.49, 1.0, false, state).alarm);
  CHECK(early(0.5, 1.0, false, state).alarm);
}

TEST_CASE("friction ratio: forces that give no ratio", "[friction_ratio]") {
  const FrictionRatio friction;
  auto state = friction.start();
  (void)friction(0.8, 1.0, true, state);
  for (const double normal : {0.0, -1.0, -0.0, 0.049}) {
    for (const bool sliding : {false, true}) {
      const auto result = friction(0.3, normal, sliding, state);
      CHECK(result.status ==
            (normal < -0.05 ? FrictionStatus::negative_normal : FrictionStatus::no_contact));
      CHECK(std::isnan(result.ratio));
      CHECK(std::isnan(result.margin));
      CHECK(result.alarm == sliding);
      CHECK(result.remembered_ratio == 0.8);
    }
  }
  for (const double bad : {none, infinity, -infinity}) {
    CHECK(friction(bad, 1.0, true, state).status == FrictionStatus::no_force_known);
    CHECK(friction(0.3, bad, true, state).status == FrictionStatus::no_force_known);
    CHECK(friction(Point2<double>{bad, 0.1}, 1.0, true, state).status ==
          FrictionStatus::no_force_known);
    CHECK(friction(Point2<double>{0.1, bad}, 1.0, true, state).status ==
          FrictionStatus::no_force_known);
  }
  // none of these was remembered, nor is a slip without a tangential force
  (void)friction(0.0, 1.0, true, state);
  CHECK(friction(0.4, 1.0, false, state).margin == Approx(0.5));

  auto fresh = friction.start();
  CHECK(friction(0.0, 1.0, true, fresh).status == FrictionStatus::sliding);
  CHECK(!fresh.has_slipped());
}

TEST_CASE("friction ratio: bad parameters are refused by name", "[friction_ratio]") {
  for (const double bad : {0.0, -1.0, 1.1, none}) {
    CHECK(test::begins_with(test::refusal([&] { FrictionRatio({.alarm_fraction = bad}); }),
                            "FrictionTest: alarm_fraction = "));
  }
  for (const double bad : {0.0, -1.0, none, infinity}) {
    CHECK(test::begins_with(test::refusal([&] { FrictionRatio({.min_normal_n = bad}); }),
                            "FrictionTest: min_normal_n = "));
  }
}

TEST_CASE("friction ratio: any number type", "[friction_ratio]") {
  using test::Digits50;
  const FrictionRatio<Digits50> digits;
  auto state = digits.start();
  (void)digits(Point2<Digits50>{Digits50(3), Digits50(4)}, Digits50(10), true, state);
  const auto result = digits(Digits50(1), Digits50(3), false, state);
  CHECK(static_cast<double>(result.margin) == Approx(1.0 / 3).epsilon(1e-15));

  // derivative of the margin by the grip: F/N^2 over the remembered ratio
  using D = test::Dual<double>;
  const FrictionRatio<D> dual;
  auto s = dual.start();
  (void)dual(D(0.5), D(1), true, s);
  CHECK(dual(D(1), D(4, 1), false, s).margin.d == Approx(1.0 / 16 / 0.5));
  // and without any tangential force, where a square root has no slope
  CHECK(dual(Point2<D>{D(0), D(0)}, D(4, 1), false, s).margin.v == 1);
  CHECK(dual(Point2<D>{D(0), D(0)}, D(4, 1), false, s).margin.d == 0);
}

TEST_CASE("friction ratio: laws", "[friction_ratio][law]") {
  rc::prop("only the size of the tangential force counts, and only relative to the normal force",
           [] {
             const double force = test::uniform(0, 5), normal = test::uniform(0.1, 20);
             const double angle = test::uniform(-4, 4), factor = test::uniform(1, 10);
             const FrictionRatio friction;
             auto state = friction.start();
             (void)friction(test::uniform(0.1, 5), test::uniform(0.1, 5), true, state);
             const auto a = friction(force, normal, false, state);
             const Point2<double> rotated{force * std::cos(angle), force * std::sin(angle)};
             const auto b = friction(rotated, normal, false, state);
             const auto c = friction(-factor * force, factor * normal, false, state);
             RC_ASSERT(std::abs(a.margin - b.margin) < 1e-12 * (1 + std::abs(a.margin)));
             RC_ASSERT(std::abs(a.margin - c.margin) < 1e-12 * (1 + std::abs(a.margin)));
           });
  rc::prop("gripping harder never lessens the margin, pulling harder never adds to it", [] {
    const double force = test::uniform(0, 5), normal = test::uniform(0.1, 20);
    const double more = test::uniform(0, 5);
    const FrictionRatio friction;
    auto state = friction.start();
    (void)friction(test::uniform(0.1, 5), test::uniform(0.1, 5), true, state);
    const double margin = friction(force, normal, false, state).margin;
    RC_ASSERT(friction(force, normal + more, false, state).margin >= margin);
    RC_ASSERT(friction(force + more, normal, false, state).margin <= margin);
  });
  rc::prop("whatever is given: a ratio is never negative, margin and alarm agree with it", [] {
    const double odd[] = {0, -0.0, none, infinity, -infinity, -3, 1e-3, 0.05, 1, 2, 1e6};
    const auto any = [&] { return odd[test::whole(0, 10)]; };
    const FrictionRatio friction;
    auto state = friction.start();
    for (int k = 0; k < 30; ++k) {
      const bool sliding = test::whole(0, 3) == 0;
      const auto r = test::whole(0, 1) == 0
                         ? friction(any(), any(), sliding, state)
                         : friction(Point2<double>{any(), any()}, any(), sliding, state);
      RC_ASSERT(std::isnan(r.ratio) || (r.ratio >= 0 && std::isfinite(r.ratio)));
      RC_ASSERT(std::isnan(r.remembered_ratio) ||
                (r.remembered_ratio > 0 && std::isfinite(r.remembered_ratio)));
      RC_ASSERT(std::isnan(r.margin) || (r.margin <= 1 && std::isfinite(r.margin)));
      RC_ASSERT(std::isnan(r.margin) == (std::isnan(r.ratio) || !state.has_slipped()));
      RC_ASSERT(r.alarm == (sliding || r.status == FrictionStatus::near_slip));
      RC_ASSERT((r.status == FrictionStatus::near_slip || r.status == FrictionStatus::sliding ||
                 !(r.margin <= 0.0999)));
    }
  });
}
