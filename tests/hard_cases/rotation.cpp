// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <cmath>
#include <numbers>

#include "fingerpad/published/object_motion.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/rolling.hpp"

using namespace fingerpad;
using fingerpad::detail::motion::common_dots;
using fingerpad::detail::motion::CommonDots;
using fingerpad::detail::motion::Neighbourhood;
using fingerpad::published::AnchoredComposition;
using fingerpad::published::PublishedBasis;
using fingerpad::published::SymmetricFrame;
using test::Digits50;

namespace {

template <class S>
double largest_difference(const Rotation<S>& a, const Rotation<Digits50>& b) {
  double worst = 0;
  for (int i = 0; i < 9; ++i) {
    const Digits50 d = Digits50(a.m[i / 3][i % 3]) - b.m[i / 3][i % 3];
    worst = (std::max)(worst, std::abs(static_cast<double>(d)));
  }
  return worst;
}

template <class To, class From>
Neighbourhood<To> as(const Neighbourhood<From>& n) {
  Neighbourhood<To> out;
  out.found = n.found;
  for (std::size_t k = 0; k < 9; ++k) {
    out.dot[k] = {To(n.dot[k].x), To(n.dot[k].y), To(n.dot[k].z)};
  }
  return out;
}

/// A curved, bumpy neighbourhood anywhere on the pad.
Neighbourhood<double> any_neighbourhood() {
  Neighbourhood<double> n;
  const double x0 = test::uniform(-15, 15), y0 = test::uniform(-15, 15);
  for (std::size_t k = 0; k < 9; ++k) {
    const double u = static_cast<double>(k % 3) - 1, v = static_cast<double>(k / 3) - 1;
    n.dot[k] = {x0 + 1.5 * u + test::uniform(-0.2, 0.2), y0 + 1.5 * v + test::uniform(-0.2, 0.2),
                10 + 0.06 * (u * u + v * v) + test::uniform(-0.1, 0.1)};
    n.found[k] = true;
  }
  return n;
}

Angles<double> any_angles() {
  return {test::uniform(-3.1, 3.1), test::uniform(-1.5, 1.5), test::uniform(-3.1, 3.1)};
}

/// The neighbourhood after a rigid motion, with noise of the size `bumps`.
Neighbourhood<double> moved(Neighbourhood<double> n, double bumps) {
  const auto turn = rotation_of(any_angles());
  for (auto& p : n.dot) {
    p = turn(p);
    p = {p.x + 3 + bumps * test::uniform(-1, 1), p.y - 2 + bumps * test::uniform(-1, 1),
         p.z + bumps * test::uniform(-1, 1)};
  }
  return n;
}

}  // namespace

TEMPLATE_TEST_CASE("local rotations follow 50 digits",
                   "[rotation]",
                   PublishedBasis,
                   SymmetricFrame) {
  rc::prop("to 1e-12 in double, whatever the neighbourhood and the noise", [] {
    auto before = any_neighbourhood();
    const auto after = moved(before, test::uniform(0, 0.1));
    for (int lost = static_cast<int>(test::whole(0, 4)); lost > 0; --lost) {
      before.found[static_cast<std::size_t>(test::whole(0, 8))] = false;
    }
    const auto turn = TestType::turn(before, after);
    const auto exact = TestType::turn(as<Digits50>(before), as<Digits50>(after));
    RC_ASSERT(turn.status == exact.status);
    RC_ASSERT(turn.status != MotionStatus::ok ||
              largest_difference(turn.rotation, exact.rotation) < 1e-12);
  });
}

TEST_CASE("the rigid fit is the best there is", "[rotation]") {
  rc::prop("any small turn away from it fits worse, in 50 digits", [] {
    const auto before = as<Digits50>(any_neighbourhood());
    const auto after = as<Digits50>(any_neighbourhood());
    const auto misfit = [&](const Rotation<Digits50>& turn) {
      const CommonDots all = common_dots(before, after);
      const auto from = detail::motion::center(before, all),
                 to = detail::motion::center(after, all);
      Digits50 sum(0);
      for (std::size_t k = 0; k < 9; ++k) {
        const auto there = turn(before.dot[k] - from);
        sum += squared_norm(after.dot[k] - to - there);
      }
      return sum;
    };
    const auto dot_of = [](const auto& n) {
      return [&n](Index k) { return n.dot[static_cast<std::size_t>(k)]; };
    };
    const auto best =
        fit_rigid<Digits50>(9, dot_of(before), dot_of(after), [](Index) { return Digits50(1); });
    RC_ASSERT(best.determined);
    const double size = test::log_uniform(1e-12, 1);
    const auto nudge = rotation_of(Angles<Digits50>{Digits50(size * test::uniform(-1, 1)),
                                                    Digits50(size * test::uniform(-1, 1)),
                                                    Digits50(size * test::uniform(0.1, 1))});
    RC_ASSERT(misfit(best.pose.rotation) < misfit(nudge * best.pose.rotation));
  });
}

TEST_CASE("derivatives of rotations are those of differences", "[rotation]") {
  const auto check = [](auto local) {
    using Local = decltype(local);
    rc::prop("by dual numbers in 50 digits", [] {
      using Dual = test::Dual<Digits50>;
      const auto before = any_neighbourhood();
      const auto after = moved(before, 0.05);
      const auto element = [&](const auto& x) {
        using S = std::remove_cvref_t<decltype(x)>;
        auto n = as<S>(after);
        n.dot[2].z = n.dot[2].z + x;
        return Local::turn(as<S>(before), n).rotation.m[0][2];
      };
      const Digits50 dual =
          test::slope_by_dual<Digits50>([&](const Dual& x) { return element(x); }, Digits50(0));
      const Digits50 steps = test::slope_by_difference<Digits50>(
          [&](const Digits50& x) { return element(x); }, Digits50(0), Digits50("1e-16"));
      RC_ASSERT(abs(Digits50(dual - steps)) < Digits50("1e-25"));
    });
  };
  check(PublishedBasis());
  check(SymmetricFrame());
}

TEST_CASE("angles and rotations follow 50 digits, near gimbal lock as well", "[rotation]") {
  rc::prop("angles give the rotation back", [] {
    auto angles = any_angles();
    const double toward = test::whole(0, 2) == 0 ? 1 : test::log_uniform(1e-18, 1);
    angles.y_rad = std::copysign(std::numbers::pi / 2 * (1 - toward), angles.y_rad);
    // a product: its elements have the roundoff of 1, however small they are
    const auto other = rotation_of(any_angles());
    const auto turn = other * (inverse(other) * rotation_of(angles));
    const auto again = rotation_of(zyx_angles(turn));
    for (int i = 0; i < 9; ++i) {
      RC_ASSERT(std::abs(again.m[i / 3][i % 3] - turn.m[i / 3][i % 3]) < 1e-14);
    }
  });
  rc::prop("angles away from the lock are right to roundoff", [] {
    const auto angles = any_angles();
    const Angles<Digits50> exact{Digits50(angles.x_rad), Digits50(angles.y_rad),
                                 Digits50(angles.z_rad)};
    const auto a = zyx_angles(rotation_of(exact));
    RC_ASSERT(abs(Digits50(a.x_rad - exact.x_rad)) < Digits50("1e-45"));
    RC_ASSERT(abs(Digits50(a.y_rad - exact.y_rad)) < Digits50("1e-45"));
    RC_ASSERT(abs(Digits50(a.z_rad - exact.z_rad)) < Digits50("1e-45"));
  });
}

TEST_CASE("in gimbal lock only x -+ z is defined, and z is 0", "[rotation]") {
  for (const double sign : {1.0, -1.0}) {
    // cos(pi/2) in double is 6e-17: in practice a gimbal lock
    const auto turn = rotation_of(Angles<double>{0.7, sign * std::numbers::pi / 2, 0.2});
    const auto a = zyx_angles(turn);
    CHECK(a.z_rad == 0);
    CHECK(a.y_rad == Approx(sign * std::numbers::pi / 2));
    CHECK(a.x_rad == Approx(0.7 - sign * 0.2));
  }
}

TEST_CASE("whole ways follow in 50 digits", "[rotation]") {
  using S = Digits50;
  const test::RollingBall ball;
  test::Rolling roll(ball, -3, 1);
  const ObjectMotion<ContactMap, S> map(ball.initial());
  const ObjectMotion<AnchoredComposition, S> chain(ball.initial());
  const ObjectMotion<ContactMap> in_double(ball.initial());
  auto map_state = map.start();
  auto chain_state = chain.start();
  auto double_state = in_double.start();
  test::Gauss gauss(3);
  for (int k = 0; k < 8; ++k) {
    const auto dots = noisy(roll.dots, roll.contact, gauss);
    const auto exact = map(dots, roll.contact, map_state);
    const auto close = in_double(dots, roll.contact, double_state);
    REQUIRE(exact.ok());
    REQUIRE(chain(dots, roll.contact, chain_state).ok());
    for (int i = 0; i < 9; ++i) {
      const S error = exact.pose.rotation.m[i / 3][i % 3] - S(close.pose.rotation.m[i / 3][i % 3]);
      CHECK(std::abs(static_cast<double>(error)) < 1e-12);
    }
    roll.step(-3 + 0.5 * (k + 1), 1);
  }
}
