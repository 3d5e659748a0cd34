// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Each published method under its one name: a behaviour that only the printed form has shows that
// it is the method as printed.
#include <cmath>

#include "fingerpad/published/normal_force.hpp"
#include "fingerpad/published/shear.hpp"
#include "support/catch.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;

TEST_CASE("published normal force: the printed curves", "[published]") {
  const auto by_area = published::normal_force_by_area();
  const auto by_depth = published::normal_force_by_depth();
  CHECK(by_area(100).force_n == Approx(0.6242 + 0.0191 * 100 + 0.00008 * 100 * 100));
  CHECK(by_depth(3).force_n == Approx(0.3435 + 0.5563 * 3 + 0.776 * 9));
  // eq. 21 far beyond its blend
  const double plain = by_area(300).force_n;
  CHECK(by_area(300, {3, 0}).force_n == Approx(0.748 * plain - 0.637 * 3 + 1.7));
}

TEST_CASE("published normal force: both curves are of 1 to 28 N, eqs. 21 and 22 as printed",
          "[published]") {
  const auto area = published::force_of_area();
  const auto depth = published::force_of_depth();
  CHECK(area.force_n(area.from) == Approx(1).margin(0.01));
  CHECK(depth.force_n(depth.from) == Approx(1).margin(0.01));
  CHECK(area.force_n(area.to) == Approx(28).margin(0.05));
  CHECK(depth.force_n(depth.to) == Approx(28).margin(0.05));
  constexpr double degree = 0.017453292519943295;
  const auto by_area = published::compensation_by_area();
  const auto by_depth = published::compensation_by_depth();
  CHECK(by_area.rotated(10, 20 * degree) == Approx(1.2 * 10 + 0.00171 * 20 - 1.8));
  CHECK(by_depth.displaced(10, 3) == Approx(1.2 * 10 + 0.509 * 3 - 3.5));
  CHECK(by_depth.rotated(10, 20 * degree) == Approx(0.8 * 10 - 0.00102 * 20 - 0.0518));
}

TEST_CASE("published shear: straight lines, normalised by the printed exponents", "[published]") {
  const auto by_area = published::shear_by_area(2.0, 300.0);
  CHECK(by_area(100, {0.5, 0}, 0.1).tangential_force_n.x == Approx(1.0));
  CHECK(by_area(100, {0.5, 0}, 0.1).moment_n_mm == Approx(30));
  CHECK(by_area(200, {0.5, 0}, 0.1).tangential_force_n.x == Approx(std::pow(2, 0.65)));
  CHECK(by_area(200, {0.5, 0}, 0.1).moment_n_mm == Approx(30 * std::pow(2, 1.7)));
  const auto by_depth = published::shear_by_depth(2.0, 300.0);
  CHECK(by_depth(20, {0.5, 0}, 0.1).tangential_force_n.x == Approx(std::pow(2, 0.75)));
  CHECK(by_depth(20, {0.5, 0}, 0.1).moment_n_mm == Approx(30 * std::pow(2, 2.2)));
}
