// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Least squares and small matrices, by the public headers that use them.
#include <cmath>

#include "fingerpad/calibrate/depth.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"

using namespace fingerpad;
using Point = Point3<double>;

TEST_CASE("least squares keep their digits where a column hardly differs from an axis", "[math]") {
  using Qr = detail::HouseholderQr<double>;
  for (const double head : {1.0, -1.0}) {
    for (const double below : {1e-2, 1e-5, 1e-9, 1e-200}) {
      Qr::Matrix a(3, 2);
      a << head, 2, below, 1, below, 3;
      Qr::Vector b(3);
      b << head + 4, below + 2, below + 6;
      CAPTURE(head, below);
      const Qr qr(a);
      const Qr::Vector x = qr.solve(b);
      CHECK(std::abs(x(0) - 1) < 1e-14);
      CHECK(std::abs(x(1) - 2) < 1e-14);
      CHECK(std::abs(qr.diagonal(0)) == Approx(std::sqrt(1 + 2 * below * below)).epsilon(1e-15));
    }
  }
}

TEST_CASE("the frame of a normal is right-handed, and u lies in its plane with an axis", "[math]") {
  rc::prop("whatever the normal", [] {
    const Point n =
        normalized(Point{test::uniform(-1, 1), test::uniform(-1, 1), test::uniform(0.01, 1)});
    const auto frame = detail::SurfaceFrame<double>::around(n);
    const bool steep = n.x * n.x > 0.5;
    const auto is_near = [](double a, double b) { return std::abs(a - b) < 1e-14; };
    RC_ASSERT((frame.n.x == n.x && frame.n.y == n.y && frame.n.z == n.z));
    RC_ASSERT(is_near(squared_norm(frame.u), 1));
    RC_ASSERT(is_near(squared_norm(frame.v), 1));
    RC_ASSERT(is_near(dot(frame.u, frame.v), 0));
    RC_ASSERT(is_near(dot(cross(frame.u, frame.v), n), 1));
    // v is perpendicular to the axis
    RC_ASSERT((steep ? frame.v.y : frame.v.x) == 0);
    RC_ASSERT((steep ? frame.u.y : frame.u.x) > 0);
  });
}

TEST_CASE("a condition number does not depend on the matrix's unit", "[math]") {
  using Matrix = detail::HouseholderQr<double>::Matrix;
  for (const double unit : {1.0, 1e-20, 1e20}) {
    Matrix a(2, 2);  // symmetric, with eigenvalues 3 and 1
    a << 2 * unit, unit, unit, 2 * unit;
    CAPTURE(unit);
    CHECK(detail::condition_number(a) == Approx(3).epsilon(1e-14));
  }
}

TEST_CASE("the inverse of normal equations solves them for each unit vector", "[math]") {
  detail::SmallMatrix<double, 3> a{};
  const double columns[4][3] = {{1, 2, 300}, {0, 1, -100}, {2, 1, 50}, {1, -1, 80}};
  for (const auto& row : columns) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        a[i][j] += row[i] * row[j];
      }
    }
  }
  const detail::NormalEquations<double, 3> normal(a);
  REQUIRE(normal.good);
  const auto inverse = normal.inverse();
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      double product = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        product += a[i][k] * inverse[k][j];
      }
      CHECK(product == Approx(i == j ? 1 : 0).margin(1e-9));
    }
  }
}
