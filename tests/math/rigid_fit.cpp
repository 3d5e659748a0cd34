// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/math/rigid_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "fingerpad/adapt/dual.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;
using test::Digits50;

namespace {

template <class S>
struct Points {
  std::vector<Point3<S>> from, to;
  std::vector<S> weight;

  std::optional<Pose<S>> fit() const {
    const auto at = [](Index k) { return static_cast<std::size_t>(k); };
    return fit_rigid<S>(
        static_cast<Index>(from.size()), [&](Index k) { return from[at(k)]; },
        [&](Index k) { return to[at(k)]; }, [&](Index k) { return weight[at(k)]; });
  }
  /// Weighted sum of the squared residuals of a pose.
  S left(const Pose<S>& pose) const {
    S sum = S(0);
    for (std::size_t k = 0; k < from.size(); ++k) {
      sum = sum + weight[k] * squared_norm(to[k] - pose(from[k]));
    }
    return sum;
  }
};

Pose<double> any_pose(double size = 10) {
  const double pi = std::numbers::pi;
  return {rotation_of(Angles<double>{test::uniform(-pi, pi), test::uniform(-1.5, 1.5),
                                     test::uniform(-pi, pi)}),
          {test::uniform(-size, size), test::uniform(-size, size), test::uniform(-size, size)}};
}

/// Dots of a contact: a disc with some height, moved by a pose, with noise.
Points<double> any_points(const Pose<double>& pose, double noise_mm) {
  Points<double> points;
  for (std::ptrdiff_t k = test::whole(4, 40); k > 0; --k) {
    const Point3<double> p{test::uniform(-6, 6), test::uniform(-6, 6), test::uniform(-1, 1)};
    const auto off = [&] { return noise_mm * test::uniform(-1, 1); };
    points.from.push_back(p);
    points.to.push_back(pose(p) + Point3<double>{off(), off(), off()});
    points.weight.push_back(test::uniform(0.1, 2));
  }
  return points;
}

template <class S>
Points<S> cast(const Points<double>& points) {
  Points<S> wide;
  const auto of = [](const Point3<double>& p) { return Point3<S>{S(p.x), S(p.y), S(p.z)}; };
  for (std::size_t k = 0; k < points.from.size(); ++k) {
    wide.from.push_back(of(points.from[k]));
    wide.to.push_back(of(points.to[k]));
    wide.weight.push_back(S(points.weight[k]));
  }
  return wide;
}

double difference(const Pose<double>& a, const Pose<double>& b) {
  return angle_between(a.rotation, b.rotation) + norm(a.translation_mm - b.translation_mm) / 10;
}

/// Whether the points are far enough from a line that no digits are lost.
bool well_spread(const Points<double>& points) {
  double xx = 0, xy = 0, yy = 0, x = 0, y = 0;
  const double n = static_cast<double>(points.from.size());
  for (const auto& p : points.from) {
    x += p.x / n;
    y += p.y / n;
  }
  for (const auto& p : points.from) {
    xx += (p.x - x) * (p.x - x);
    xy += (p.x - x) * (p.y - y);
    yy += (p.y - y) * (p.y - y);
  }
  return xx * yy - xy * xy > 0.1 * (xx + yy) * (xx + yy);
}

}  // namespace

TEST_CASE("a rigid motion is found to rounding", "[math]") {
  rc::prop("whatever the rotation", [] {
    const auto pose = any_pose();
    const auto points = any_points(pose, 0);
    RC_PRE(well_spread(points));
    const auto fit = points.fit();
    RC_ASSERT(fit.has_value());
    RC_ASSERT(difference(*fit, pose) < 1e-13);
  });
}

TEST_CASE("the best motion moves with what it is measured in", "[math]") {
  rc::prop("equivariance, inverse, order and weights", [] {
    const auto points = any_points(any_pose(), 0.5);
    RC_PRE(well_spread(points));
    const auto best = points.fit().value();
    const auto a = any_pose(), b = any_pose();
    Points<double> seen = points, back = points, reversed = points, heavier = points;
    for (std::size_t k = 0; k < points.from.size(); ++k) {
      seen.from[k] = a(points.from[k]);
      seen.to[k] = b(points.to[k]);
      heavier.weight[k] = 8 * points.weight[k];
    }
    RC_ASSERT(difference(seen.fit().value(), b * best * inverse(a)) < 1e-12);
    std::swap(back.from, back.to);
    RC_ASSERT(difference(back.fit().value(), inverse(best)) < 1e-12);
    std::reverse(reversed.from.begin(), reversed.from.end());
    std::reverse(reversed.to.begin(), reversed.to.end());
    std::reverse(reversed.weight.begin(), reversed.weight.end());
    RC_ASSERT(difference(reversed.fit().value(), best) < 1e-12);
    RC_ASSERT(difference(heavier.fit().value(), best) < 1e-13);
    Points<double> more = points;  // a point of weight 0 is ignored
    more.from.push_back({100, 0, 0});
    more.to.push_back({0, 0, 300});
    more.weight.push_back(0);
    RC_ASSERT(difference(more.fit().value(), best) < 1e-13);
  });
}

TEST_CASE("no other rigid motion leaves less", "[math]") {
  rc::prop("of points with noise, or mirrored", [] {
    auto points = any_points(any_pose(), 1);
    RC_PRE(well_spread(points));
    const bool mirrored = test::whole(0, 3) == 0;
    for (auto& p : points.to) {
      p.z = mirrored ? -p.z : p.z;
    }
    const auto fit = points.fit();
    RC_PRE(fit.has_value());
    const auto& m = fit->rotation.m;
    const double det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                       m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                       m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    RC_ASSERT(std::abs(det - 1) < 1e-14);
    for (const double size : {1e-5, 1e-2, 1.0}) {
      const auto step = [&] { return size * test::uniform(-1, 1); };
      const Pose<double> other{rotation_of(Angles<double>{step(), step(), step()}) * fit->rotation,
                               fit->translation_mm + Point3<double>{step(), step(), step()}};
      RC_ASSERT(points.left(other) >= points.left(*fit) * (1 - 1e-13));
    }
  });
}

TEST_CASE("the best motion against fifty digits", "[math]") {
  // In fifty digits the optimum fulfils its own condition: the cross-covariance of the rotated
  // points is symmetric, and the centers coincide.
  rc::prop("of points with noise", [] {
    const auto points = any_points(any_pose(), 0.5);
    RC_PRE(well_spread(points));
    const auto wide = cast<Digits50>(points);
    const auto exact = wide.fit();
    RC_ASSERT(exact.has_value());
    Digits50 c[3][3] = {};
    Point3<Digits50> left{0, 0, 0};
    for (std::size_t k = 0; k < wide.from.size(); ++k) {
      const Point3<Digits50> a = exact->rotation(wide.from[k]);
      const Point3<Digits50> off = wide.to[k] - (*exact)(wide.from[k]);
      const Digits50 w = wide.weight[k];
      left += w * off;
      const Digits50 x[3] = {a.x, a.y, a.z}, y[3] = {off.x, off.y, off.z};
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          c[i][j] += w * x[i] * y[j];
        }
      }
    }
    const auto tiny = [](const Digits50& x) { return static_cast<double>(abs(x)) < 1e-44; };
    RC_ASSERT(tiny(left.x) && tiny(left.y) && tiny(left.z));
    RC_ASSERT(tiny(c[0][1] - c[1][0]) && tiny(c[0][2] - c[2][0]) && tiny(c[1][2] - c[2][1]));
    const auto fit = points.fit();
    for (Index i = 0; i < 3; ++i) {
      for (Index j = 0; j < 3; ++j) {
        const Digits50 off = fit->rotation(i, j) - exact->rotation(i, j);
        RC_ASSERT(static_cast<double>(abs(off)) < 1e-13);
      }
    }
  });
}

TEST_CASE("a dual number carries the derivatives of the best motion", "[math]") {
  // A flat square grid has an eigenvalue twice; at rest Horn's matrix is diagonal.
  using One = Dual<1>;
  for (const double turn : {0.0, 1e-9, 0.4}) {
    const auto pose = rotation_of(Angles<double>{turn, -turn / 2, 2 * turn});
    const auto angles_with_corner = [&](auto lift) {
      using S = decltype(lift);
      Points<double> points;
      for (int k = 0; k < 25; ++k) {
        points.from.push_back({k % 5 - 2.0, k / 5 - 2.0, 0});
        points.to.push_back(pose(points.from.back()));
        points.weight.push_back(1);
      }
      auto wide = cast<S>(points);
      wide.to[24].z = wide.to[24].z + lift;
      wide.to[24].x = wide.to[24].x - lift;
      return zyx_angles(wide.fit().value().rotation);
    };
    const auto dual = angles_with_corner(One::parameter(0, 0));
    const double h = 1e-4;
    const auto above = angles_with_corner(h), below = angles_with_corner(-h);
    CAPTURE(turn);
    CHECK(dual.x_rad.slopes[0] == Approx((above.x_rad - below.x_rad) / (2 * h)).margin(1e-9));
    CHECK(dual.y_rad.slopes[0] == Approx((above.y_rad - below.y_rad) / (2 * h)).margin(1e-9));
    CHECK(dual.z_rad.slopes[0] == Approx((above.z_rad - below.z_rad) / (2 * h)).margin(1e-9));
    CHECK(std::abs(dual.x_rad.slopes[0]) > 0.01);
  }
}

TEST_CASE("points that determine no rotation are said", "[math]") {
  const auto line = [](int count, double across_mm) {
    Points<double> points;
    for (int k = 0; k < count; ++k) {
      points.from.push_back({1.0 * k, across_mm * (k % 2), 0});
      points.weight.push_back(1);
    }
    points.to = points.from;
    return points;
  };
  CHECK_FALSE(line(0, 0).fit().has_value());
  CHECK_FALSE(line(1, 0).fit().has_value());
  CHECK_FALSE(line(2, 0).fit().has_value());
  CHECK_FALSE(line(9, 0).fit().has_value());
  CHECK_FALSE(line(9, 1e-3).fit().has_value());
  CHECK(line(9, 3).fit().has_value());
  CHECK_FALSE(line(9, 0.5).fit().has_value());
  auto narrow = line(9, 0.55);  // the largest eigenvalue hardly stands out
  CHECK(narrow.fit().has_value());
  const auto wide = cast<Digits50>(narrow).fit();
  CHECK(angle_between(narrow.fit().value().rotation, Rotation<double>{}) < 1e-13);
  CHECK(angle_between(wide->rotation, Rotation<Digits50>{}) < Digits50(1e-44));
  auto weightless = line(9, 3);
  weightless.weight.assign(9, 0.0);
  CHECK_FALSE(weightless.fit().has_value());
  auto same = line(9, 3);
  same.to.assign(9, {1, 2, 3});
  CHECK_FALSE(same.fit().has_value());
  auto far = line(9, 3);  // a spread that is only roundoff of the coordinates counts as none
  for (auto& p : far.from) {
    p = {1e17 + p.x, 1e17, 1e17};
  }
  CHECK_FALSE(far.fit().has_value());
}
