// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <numbers>

#include "fingerpad/motion/object_motion.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/rolling.hpp"

using namespace fingerpad;
using test::Digits50;

namespace {

using Nine = std::array<Point3<Digits50>, 9>;

/// A curved, bumpy neighbourhood anywhere on the pad.
Nine any_neighbourhood() {
  Nine n;
  const double x0 = test::uniform(-15, 15), y0 = test::uniform(-15, 15);
  for (std::size_t k = 0; k < 9; ++k) {
    const double u = static_cast<double>(k % 3) - 1, v = static_cast<double>(k / 3) - 1;
    n[k] = {Digits50(x0 + 1.5 * u + test::uniform(-0.2, 0.2)),
            Digits50(y0 + 1.5 * v + test::uniform(-0.2, 0.2)),
            Digits50(10 + 0.06 * (u * u + v * v) + test::uniform(-0.1, 0.1))};
  }
  return n;
}

Angles<double> any_angles() {
  return {test::uniform(-3.1, 3.1), test::uniform(-1.5, 1.5), test::uniform(-3.1, 3.1)};
}

}  // namespace

TEST_CASE("the rigid fit is the best there is", "[rotation]") {
  rc::prop("any small turn away from it fits worse, in 50 digits", [] {
    const auto before = any_neighbourhood(), after = any_neighbourhood();
    const auto center = [](const Nine& n) {
      Point3<Digits50> sum = {Digits50(0), Digits50(0), Digits50(0)};
      for (const auto& p : n) {
        sum += p;
      }
      return sum / Digits50(9);
    };
    const auto misfit = [&](const Rotation<Digits50>& turn) {
      Digits50 sum(0);
      for (std::size_t k = 0; k < 9; ++k) {
        const auto there = turn(before[k] - center(before));
        sum += squared_norm(after[k] - center(after) - there);
      }
      return sum;
    };
    const auto dot_of = [](const Nine& n) {
      return [&n](Index k) { return n[static_cast<std::size_t>(k)]; };
    };
    const auto best =
        fit_rigid<Digits50>(9, dot_of(before), dot_of(after), [](Index) { return Digits50(1); });
    RC_ASSERT(best.has_value());
    const double size = test::log_uniform(1e-12, 1);
    const auto nudge = rotation_of(Angles<Digits50>{Digits50(size * test::uniform(-1, 1)),
                                                    Digits50(size * test::uniform(-1, 1)),
                                                    Digits50(size * test::uniform(0.1, 1))});
    RC_ASSERT(misfit(best->rotation) < misfit(nudge * best->rotation));
  });
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

TEST_CASE("the object's motion follows in 50 digits", "[rotation]") {
  using S = Digits50;
  const test::RollingBall ball;
  test::Rolling roll(ball, -3, 1);
  ObjectMotion<S> digits(21, 21);
  ObjectMotion<> in_double(21, 21);
  test::Gauss gauss(3);
  for (int k = 0; k < 8; ++k) {
    const auto dots = noisy(roll.dots, roll.contact, gauss);
    const auto exact = digits(dots, roll.contact);
    const auto close = in_double(dots, roll.contact);
    REQUIRE(exact.ok());
    for (int i = 0; i < 9; ++i) {
      const S error = exact.pose.rotation.m[i / 3][i % 3] - S(close.pose.rotation.m[i / 3][i % 3]);
      CHECK(std::abs(static_cast<double>(error)) < 1e-12);
    }
    roll.step(-3 + 0.5 * (k + 1), 1);
  }
}
