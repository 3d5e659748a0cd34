// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Least squares and small matrices, by the public headers that use them.
#include <cmath>

#include "fingerpad/calibrate/depth.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "support/catch.hpp"

using namespace fingerpad;

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
