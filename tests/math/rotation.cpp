// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/math/rotation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;
using test::Digits50;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double eps = 2.3e-16;

Angles<double> any_angles(double largest_y = pi / 2) {
  return {test::uniform(-pi, pi), test::uniform(-largest_y, largest_y), test::uniform(-pi, pi)};
}
Rotation<double> any_rotation() {
  return rotation_of(any_angles());
}
Point3<double> any_point() {
  return {test::uniform(-9, 9), test::uniform(-9, 9), test::uniform(-9, 9)};
}
Pose<double> any_pose() {
  return {any_rotation(), any_point()};
}

template <class S, class T>
double difference(const Rotation<S>& a, const Rotation<T>& b) {
  using Wide = std::conditional_t<(sizeof(S) < sizeof(T)), T, S>;
  using std::abs;
  double worst = 0;
  for (Index i = 0; i < 3; ++i) {
    for (Index j = 0; j < 3; ++j) {
      worst =
          (std::max)(worst, static_cast<double>(Wide(abs(Wide(Wide(a(i, j)) - Wide(b(i, j)))))));
    }
  }
  return worst;
}
double difference(const Point3<double>& a, const Point3<double>& b) {
  return norm(a - b);
}
double difference(const Pose<double>& a, const Pose<double>& b) {
  return difference(a.rotation, b.rotation) + difference(a.translation_mm, b.translation_mm);
}

/// Rotation by an angle about one of the three axes.
Rotation<double> about(int axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Rotation<double> r;
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  r.m[i][i] = r.m[j][j] = c;
  r.m[j][i] = s;
  r.m[i][j] = -s;
  return r;
}

}  // namespace

TEST_CASE("rotations are a group that keeps lengths and hands", "[math]") {
  rc::prop("composition, inverse, identity", [] {
    const auto a = any_rotation(), b = any_rotation(), c = any_rotation();
    const auto v = any_point(), w = any_point();
    RC_ASSERT(difference((a * b)(v), a(b(v))) < 40 * eps);
    RC_ASSERT(difference((a * b) * c, a * (b * c)) < 8 * eps);
    RC_ASSERT(difference(inverse(a) * a, Rotation<double>{}) < 8 * eps);
    RC_ASSERT(difference(inverse(a * b), inverse(b) * inverse(a)) < 4 * eps);
    RC_ASSERT(difference(a * Rotation<double>{}, a) == 0);
    RC_ASSERT(std::abs(norm(a(v)) - norm(v)) < 20 * eps);
    RC_ASSERT(difference(a(cross(v, w)), cross(a(v), a(w))) < 2000 * eps);
  });
  rc::prop("of poses, too", [] {
    const auto a = any_pose(), b = any_pose();
    const auto v = any_point();
    RC_ASSERT(difference((a * b)(v), a(b(v))) < 100 * eps);
    RC_ASSERT(difference(inverse(a)(a(v)), v) < 100 * eps);
    RC_ASSERT(difference(inverse(a * b), inverse(b) * inverse(a)) < 200 * eps);
    RC_ASSERT(difference(Pose<double>{} * a, a) == 0);
  });
}

TEST_CASE("angles give the rotation back", "[math]") {
  rc::prop("forth and back", [] {
    const auto angles = any_angles(1.5);
    const auto found = zyx_angles(rotation_of(angles));
    RC_ASSERT(std::abs(found.x_rad - angles.x_rad) < 40 * eps / std::cos(angles.y_rad));
    RC_ASSERT(std::abs(found.y_rad - angles.y_rad) < 40 * eps);
    RC_ASSERT(std::abs(found.z_rad - angles.z_rad) < 40 * eps / std::cos(angles.y_rad));
  });
  rc::prop("back and forth, however near to gimbal lock", [] {
    auto angles = any_angles();
    const double near = test::whole(0, 1) == 0 ? 0 : test::log_uniform(1e-18, 0.1);
    angles.y_rad = (test::whole(0, 1) == 0 ? 1 : -1) * (pi / 2 - near);
    const auto r = rotation_of(angles);
    RC_ASSERT(difference(rotation_of(zyx_angles(r)), r) < 40 * eps);
  });
}

TEST_CASE("angles and rotations against fifty digits", "[math]") {
  rc::prop("each to a few epsilon", [] {
    const auto angles = any_angles(1.5);
    const Angles<Digits50> exact{angles.x_rad, angles.y_rad, angles.z_rad};
    using std::cos;
    using std::sin;
    const Digits50 cx = cos(exact.x_rad), sx = sin(exact.x_rad), cy = cos(exact.y_rad),
                   sy = sin(exact.y_rad), cz = cos(exact.z_rad), sz = sin(exact.z_rad);
    const Rotation<Digits50> written{
        {{Digits50(cy * cz), Digits50(sx * sy * cz - cx * sz), Digits50(cx * sy * cz + sx * sz)},
         {Digits50(cy * sz), Digits50(sx * sy * sz + cx * cz), Digits50(cx * sy * sz - sx * cz)},
         {Digits50(-sy), Digits50(sx * cy), Digits50(cx * cy)}}};
    RC_ASSERT(difference(rotation_of(angles), written) < 4 * eps);
    RC_ASSERT(difference(rotation_of(exact), written) < 1e-48);
    const auto back = zyx_angles(written);
    RC_ASSERT(abs(Digits50(back.x_rad - exact.x_rad)) < Digits50("1e-45"));
    RC_ASSERT(abs(Digits50(back.y_rad - exact.y_rad)) < Digits50("1e-45"));
    RC_ASSERT(static_cast<double>(abs(Digits50(back.z_rad - exact.z_rad))) < 1e-46);
  });
}

TEST_CASE("in gimbal lock only x -+ z is defined, and z is 0", "[math]") {
  for (const double sign : {1.0, -1.0}) {
    // cos(pi/2) in double is 6e-17: in practice a gimbal lock
    const auto turn = rotation_of(Angles<double>{0.7, sign * pi / 2, 0.2});
    const auto a = zyx_angles(turn);
    CHECK(a.z_rad == 0);
    CHECK(a.y_rad == Approx(sign * pi / 2));
    CHECK(a.x_rad == Approx(0.7 - sign * 0.2));
  }
}

TEST_CASE("the angle between rotations", "[math]") {
  rc::prop("of a rotation about an axis, however small", [] {
    const double angle = test::log_uniform(1e-150, pi);
    const auto a = any_rotation();
    const auto r = about(static_cast<int>(test::whole(0, 2)), angle);
    RC_ASSERT(std::abs(angle_between(Rotation<double>{}, r) - angle) < 4 * eps * angle + 1e-300);
    RC_ASSERT(std::abs(angle_between(a, r * a) - angle) < 20 * eps);
    RC_ASSERT(std::abs(angle_between(r * a, a) - angle) < 20 * eps);
  });
  rc::prop("is a distance, whatever rotates both", [] {
    const auto a = any_rotation(), b = any_rotation(), c = any_rotation();
    RC_ASSERT(angle_between(a, c) <= angle_between(a, b) + angle_between(b, c) + 40 * eps);
    RC_ASSERT(std::abs(angle_between(c * a, c * b) - angle_between(a, b)) < 1e-7);
    RC_ASSERT(std::abs(angle_between(a * c, b * c) - angle_between(a, b)) < 1e-7);
  });
}
