// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Forces by look-up as printed: each equation by hand, and by its known errors.
#include "fingerpad/published/look_up.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "fingerpad/adapt/dual.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;
using test::Digits50;

namespace {

constexpr double degree = std::numbers::pi / 180;

const auto by_area = published::normal_force_by_area();
const auto by_depth = published::normal_force_by_depth();

/// Sums of printed decimals, computed by hand: only the roundoff of double may differ.
Approx printed(double n) {
  return Approx(n).epsilon(1e-14).margin(1e-14);
}

}  // namespace

TEST_CASE("published look-up: eq. 1 and its inverse", "[published]") {
  CHECK(published::contact_radius_mm(8.0, 2.0, 1 / 3.0) == printed(4));
  CHECK(published::force_of_radius_n(4.0, 2.0, 1 / 3.0) == printed(8));
  CHECK(published::force_of_radius_n(1.0, 2.0, 1 / 3.0) == printed(0.125));
  CHECK(published::contact_radius_mm(9.0, 2.0, 0.5) == printed(6));
  rc::prop("there and back", [] {
    const double c = test::log_uniform(0.5, 20), gamma = test::uniform(0.05, 2);
    const double radius = test::log_uniform(1e-3, 1e3);
    const double again =
        published::contact_radius_mm(published::force_of_radius_n(radius, c, gamma), c, gamma);
    // roundoff of the exponent is multiplied by the logarithm
    const double length = 2 + std::abs(std::log(radius / c));
    RC_ASSERT(std::abs(again - radius) <=
              4 * length * std::numeric_limits<double>::epsilon() * radius);
  });
  const auto slope =
      published::force_of_radius_n(Dual<1>::parameter(4.0, 0), Dual<1>(2.0), Dual<1>(1 / 3.0));
  CHECK(slope.slopes[0] == printed(6));  // 3 r^2 / 8
}

TEST_CASE("published look-up: eq. 2", "[published]") {
  CHECK(published::flat_contact_force_n(0.02, 300.0) == Approx(6.0));
  CHECK(published::flat_contact_force_n(0.0, 300.0) == 0);
}

TEST_CASE("published look-up: eq. 18", "[published]") {
  // 0.00008 S^2 + 0.0191 S + 0.6242
  CHECK(by_area(50) == printed(0.2 + 0.955 + 0.6242));
  CHECK(by_area(100) == printed(3.3342));
  CHECK(by_area(250) == printed(10.3992));
  CHECK(by_area(478) == printed(28.03272));
  // 0.776 D^2 + 0.5563 D + 0.3435
  CHECK(by_depth(1) == printed(1.6758));
  CHECK(by_depth(2.5) == printed(6.58425));
  CHECK(by_depth(4) == printed(14.9847));
  CHECK(by_depth(5.62) == printed(27.9794004));
  CHECK(published::normal_force_by_area<float>()(100.0F) == Approx(3.3342F));
  // both ranges are about 1 to 28 N
  const auto area = published::force_of_area(), depth = published::force_of_depth();
  CHECK(area(area.from) == printed(0.99392));
  CHECK(area(area.to) == Approx(28).margin(0.05));
  CHECK(depth(depth.from) == printed(1.0019634));
  CHECK(depth(depth.to) == Approx(28).margin(0.05));
  // as printed, there is a force without contact
  CHECK(by_area(0) == printed(0.6242));
  CHECK(by_depth(0) == printed(0.3435));
}

TEST_CASE("published look-up: eqs. 21 and 22", "[published]") {
  // 0.748 F_S - 0.637 d + 1.7
  CHECK(by_area(100, {1.8, 2.4}) == printed(2.2829816));
  CHECK(by_area(250, {-3, 4}) == printed(6.2936016));
  CHECK(by_area(250, {1, 0}) == printed(7.7786016 - 0.637 + 1.7));  // at the end of the blend
  // 1.2 F_D + 0.509 d - 3.5
  CHECK(by_depth(4, {0, -2}) == printed(15.49964));
  CHECK(by_depth(2.5, {1.2, 0.9}) == printed(7.9011 + 0.7635 - 3.5));
  // 1.2 F_S + 0.00171 theta - 1.8
  CHECK(by_area(250, {0, 0}, 10 * degree) == printed(10.69614));
  CHECK(by_area(100, {0, 0}, -20 * degree) == printed(4.00104 + 0.0342 - 1.8));
  // 0.8 F_D - 0.00102 theta - 0.0518
  CHECK(by_depth(2.5, {0, 0}, 10 * degree) == printed(5.2054));
  CHECK(by_depth(4, {0, 0}, -2.5 * degree) == printed(11.98776 - 0.00255 - 0.0518));
  // both at once: gain 1 - 0.252 + 0.2, and both shifts
  CHECK(by_area(250, {3, 4}, 10 * degree) == printed(9.8584416 - 1.485 - 1.7829));
  CHECK(by_depth(4, {2, 0}, 10 * degree) == printed(14.9847 + 1.018 - 3.5 - 0.0102 - 0.0518));
  // half of it at half the blend: gain 0.874, shift (1.7 - 0.3185) / 2
  CHECK(by_area(250, {0, 0.5}) == printed(9.0889008 + 0.69075));
  CHECK(by_area(250, {0, 0}, 0.0085) ==
        printed(1.1 * 10.3992 + (0.00171 * 0.0085 / degree - 1.8) / 2));
  // and at a quarter, where the weight is 3/16 - 2/64 = 0.15625: gain 0.960625
  CHECK(by_area(250, {0.25, 0}) == printed(0.960625 * 10.3992 + 0.15625 * (1.7 - 0.15925)));
  // as printed, a shallow contact that is displaced pulls
  CHECK(by_depth(1, {1, 0}) == printed(1.2 * 1.6758 + 0.509 - 3.5));
  CHECK(published::AffineForce<>()(7, 3) == 7);
}

TEST_CASE("published look-up: the equations hold in all of 50 digits", "[published]") {
  const auto n = [](const char* digits) { return Digits50(digits); };
  const published::NormalForce<Digits50> area{
      {n("0.6242"), n("0.0191"), n("0.00008"), Digits50(18), Digits50(478)},
      {n("0.748"), n("-0.637"), n("1.7")},
      {n("1.2"), n("0.1"), n("-1.8")}};
  const Digits50 none(0);
  const auto off = [](const Digits50& a, const Digits50& b) {
    return std::abs(static_cast<double>(Digits50(a - b)));
  };
  CHECK(off(area(Digits50(250), {Digits50(-3), Digits50(4)}), n("6.2936016")) < 1e-47);
  CHECK(off(area(Digits50(250), {none, none}, n("0.5")), n("10.72904")) < 1e-47);
  CHECK(off(area(Digits50(250)), n("10.3992")) < 1e-47);
}

TEST_CASE("published look-up: the blend", "[published][law]") {
  rc::prop("lies between the plain force and the printed equation, without a step", [] {
    const auto any = [](double unit) {
      return published::AffineForce<>{test::uniform(-0.5, 2), test::uniform(-1, 1) * unit,
                                      test::uniform(-4, 4)};
    };
    const published::NormalForce<> force{published::force_of_area(), any(1), any(30),
                                         test::log_uniform(0.1, 3), test::log_uniform(0.002, 0.1)};
    const double m = test::uniform(0, 500), plain = force(m), margin = 1e-12 * (100 + plain);
    RC_ASSERT(force(m, {-0.0, 0.0}, -0.0) == plain);
    const auto between = [&](double found, double at_end) {
      return found >= (std::min)(plain, at_end) - margin &&
             found <= (std::max)(plain, at_end) + margin;
    };
    const double length = test::uniform(0, 1) * force.blend_mm;
    const double angle = test::uniform(0, 1) * force.blend_rad;
    RC_ASSERT(between(force(m, {0, -length}), force.displaced(plain, length)));
    RC_ASSERT(between(force(m, {0, 0}, -angle), force.rotated(plain, angle)));
    // beyond them each is as printed, and both together are the sum
    const double far = force.blend_mm * test::uniform(1, 4) + 1e-9;
    const double wide = force.blend_rad * test::uniform(1, 4) + 1e-9;
    const double by_length = force.displaced(plain, far), by_angle = force.rotated(plain, wide);
    RC_ASSERT(std::abs(force(m, {far, 0}) - by_length) <= margin);
    RC_ASSERT(std::abs(force(m, {0, 0}, wide) - by_angle) <= margin);
    RC_ASSERT(std::abs(force(m, {0, far}, wide) - (by_length + by_angle - plain)) <= margin);
    const double h = 1e-9;
    for (const double end : {0.0, 1.0}) {
      const double d = end * force.blend_mm, t = end * force.blend_rad;
      RC_ASSERT(std::abs(force(m, {d + h, 0}) - force(m, {d - h, 0})) < 1e-5);
      RC_ASSERT(std::abs(force(m, {0, 0}, t + h) - force(m, {0, 0}, t - h)) < 1e-4);
    }
  });
}

TEST_CASE("published look-up: eqs. 19 and 20, and falling with depth", "[published]") {
  const auto area = published::first_normal_force_by_area();
  const auto depth = published::first_normal_force_by_depth();
  CHECK(area.displaced(10, 3) == Approx(0.748 * 10 - 0.637 * 3 + 1.7));
  CHECK(depth.displaced(10, 3) == Approx(-0.356 * 10 + 0.548 * 3 + 0.2));
  CHECK(area.rotated(10, 20 * degree) == Approx(1.2 * 10 + 0.00171 * 20 - 1.0));
  CHECK(depth.rotated(10, 20 * degree) == Approx(-0.272 * 10 - 0.0074 * 20 + 0.5));
  // E029: the error that eqs. 21 and 22 correct
  CHECK(depth(5, {3, 0}) < depth(4, {3, 0}));
  CHECK(by_depth(5, {3, 0}) > by_depth(4, {3, 0}));
  CHECK(area(300, {3, 0}) == Approx(0.748 * area(300) - 0.637 * 3 + 1.7));
}

TEST_CASE("published look-up: eqs. 4 and 5", "[published]") {
  const auto area = published::shear_by_area(2.0, 300.0);
  CHECK(area.tangential_force_n(100, {0.5, 0}).x == Approx(1.0));
  CHECK(area.tangential_force_n(200, {0, 0.5}).y == Approx(std::pow(2, 0.65)));
  CHECK(area.moment_n_mm(100, 0.1) == Approx(30));
  CHECK(area.moment_n_mm(200, 0.1) == Approx(30 * std::pow(2, 1.7)));
  const auto depth = published::shear_by_depth(2.0, 300.0);
  CHECK(depth.tangential_force_n(20, {0.5, 0}).x == Approx(std::pow(2, 0.75)));
  CHECK(depth.moment_n_mm(20, 0.1) == Approx(30 * std::pow(2, 2.2)));
}
