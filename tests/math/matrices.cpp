// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Least squares and small matrices, by the public headers that use them.
#include <cmath>
#include <vector>

#include "fingerpad/calibrate/depth.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "support/catch.hpp"

using namespace fingerpad;

TEST_CASE("least squares keep their digits where a column hardly differs from an axis", "[math]") {
  for (const double head : {1.0, -1.0}) {
    for (const double below : {1e-2, 1e-5, 1e-9, 1e-200}) {
      CAPTURE(head, below);
      const detail::Triangle<double> r(
          {head, 2, head + 4, below, 1, below + 2, below, 3, below + 6}, 3);
      const auto x = r.solve(2, 2);
      CHECK(std::abs(x[0] - 1) < 1e-14);
      CHECK(std::abs(x[1] - 2) < 1e-14);
      CHECK(std::abs(r(0, 0)) == Approx(std::sqrt(1 + 2 * below * below)).epsilon(1e-15));
      CHECK(std::abs(r(2, 2)) < 1e-14);
    }
  }
}

TEST_CASE("the covariance of least squares is the inverse of the normal equations", "[math]") {
  const std::vector<double> rows = {1, 2, 3, 0, 1, -1, 2, 1, 0.5, 1, -1, 0.8};
  const auto covariance = detail::Triangle<double>(rows, 3).covariance(3);
  detail::SmallMatrix<double, 3> a{};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (std::size_t j = 0; j < 3; ++j) {
      a[k % 3][j] += rows[k] * rows[k / 3 * 3 + j];
    }
  }
  const auto inverse = detail::NormalEquations<double, 3>(a).inverse();
  for (std::size_t k = 0; k < 9; ++k) {
    CHECK(covariance[k] == Approx(inverse[k / 3][k % 3]).epsilon(1e-13).margin(1e-15));
  }
  // fewer rows than columns: the rest of R is 0
  const detail::Triangle<double> two({1, 2, 3, 0, 4, 5}, 3);
  CHECK(two.solve(2, 2)[1] == Approx(1.25));
  CHECK(two(2, 2) == 0);
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
