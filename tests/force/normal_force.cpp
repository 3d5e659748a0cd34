// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/normal_force.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/published/normal_force.hpp"
#include "support/catch.hpp"
#include "support/foreign_image.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::refusal;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double missing = test::nan;
constexpr double degree = std::numbers::pi / 180;

using Published = published::Compensation<>;
using Scaled = ScaledCompensation<>;

const NormalForce by_area(published::force_of_area());
const NormalForce by_depth(published::force_of_depth());
const NormalForce area_in_motion(published::force_of_area(), published::compensation_by_area());
const NormalForce depth_in_motion(published::force_of_depth(), published::compensation_by_depth());

/// Sums of printed decimals, computed by hand: only the roundoff of double may differ.
Approx printed(double n) {
  return Approx(n).epsilon(1e-14).margin(1e-14);
}

PolynomialForce<> line(double slope = 2) {
  return {{0, slope, 0}, 1, 10};
}
PowerLawForce<> hertz() {  // F = (r / 2)^3
  return {2, 1.0 / 3, 0.5, 8};
}

template <class Curve>
std::string refused(const Curve& curve) {
  return refusal([&] { NormalForce<Curve>{curve}; });
}
template <class Compensation>
std::string refused_with(const Compensation& compensation) {
  return refusal([&] { NormalForce<PolynomialForce<>, Compensation>(line(), compensation); });
}
std::string refused_with(const CurveErrors<3>& errors) {
  return refusal([&] { NormalForce<>(line(), {}, errors); });
}

}  // namespace

TEST_CASE("normal force: names of statuses", "[normal_force]") {
  CHECK(std::string(name_of(ForceStatus::measured)) == "measured");
  CHECK(std::string(name_of(ForceStatus::below_range)) == "below range");
  CHECK(std::string(name_of(ForceStatus::beyond_range)) == "beyond range");
  CHECK(std::string(name_of(ForceStatus::held_at_zero)) == "held at zero");
  CHECK(std::string(name_of(ForceStatus::no_contact)) == "no contact");
  CHECK(std::string(name_of(ForceStatus::disagreeing)) == "disagreeing");
  CHECK(std::string(name_of(ForceStatus::not_finite)) == "not finite");
  CHECK(std::string(name_of(static_cast<ForceStatus>(99))) == "unknown");
}

TEST_CASE("normal force: eq. 18", "[normal_force]") {
  // 0.00008 S^2 + 0.0191 S + 0.6242
  CHECK(by_area(50).force_n == printed(0.2 + 0.955 + 0.6242));
  CHECK(by_area(100).force_n == printed(3.3342));
  CHECK(by_area(250).force_n == printed(10.3992));
  CHECK(by_area(478).force_n == printed(28.03272));
  // 0.776 D^2 + 0.5563 D + 0.3435
  CHECK(by_depth(1).force_n == printed(1.6758));
  CHECK(by_depth(2.5).force_n == printed(6.58425));
  CHECK(by_depth(4).force_n == printed(14.9847));
  CHECK(by_depth(5.62).force_n == printed(27.9794004));
  for (const double area : {18.0, 478.0}) {
    CHECK(by_area(area).status == ForceStatus::measured);
  }
  for (const double depth : {0.63, 5.62}) {
    CHECK(by_depth(depth).status == ForceStatus::measured);
  }
  // both ranges are about 1 to 28 N
  CHECK(by_area(18).force_n == printed(0.99392));
  CHECK(by_depth(0.63).force_n == printed(1.0019634));
  // by the slope: 0.00016 S + 0.0191, 1.552 D + 0.5563
  CHECK(by_area.curve().slope(100) == printed(0.0351));
  CHECK(by_depth.curve().slope(4) == printed(6.7643));
  CHECK((by_depth.curve().gradient(4) == std::array<double, 3>{1, 4, 16}));
  CHECK(NormalForce(published::force_of_area<float>())(100.0F).force_n == Approx(3.3342F));
}

TEST_CASE("normal force: eqs. 21 and 22 beyond the blend", "[normal_force]") {
  const auto area = [](double s, Point2<double> d, double deg = 0) {
    return area_in_motion(s, d, deg * degree).force_n;
  };
  const auto depth = [](double h, Point2<double> d, double deg = 0) {
    return depth_in_motion(h, d, deg * degree).force_n;
  };
  // 0.748 F_S - 0.637 d + 1.7
  CHECK(area(100, {1.8, 2.4}) == printed(2.2829816));
  CHECK(area(250, {-3, 4}) == printed(6.2936016));
  CHECK(area(250, {1, 0}) == printed(7.7786016 - 0.637 + 1.7));  // at the end of the blend
  // 1.2 F_D + 0.509 d - 3.5
  CHECK(depth(4, {0, -2}) == printed(15.49964));
  CHECK(depth(2.5, {1.2, 0.9}) == printed(7.9011 + 0.7635 - 3.5));
  // 1.2 F_S + 0.00171 theta - 1.8
  CHECK(area(250, {0, 0}, 10) == printed(10.69614));
  CHECK(area(100, {0, 0}, -20) == printed(4.00104 + 0.0342 - 1.8));
  // 0.8 F_D - 0.00102 theta - 0.0518
  CHECK(depth(2.5, {0, 0}, 10) == printed(5.2054));
  CHECK(depth(4, {0, 0}, -2.5) == printed(11.98776 - 0.00255 - 0.0518));
  // both at once: gain 1 - 0.252 + 0.2, and both shifts
  CHECK(area(250, {3, 4}, 10) == printed(9.8584416 - 1.485 - 1.7829));
  CHECK(depth(4, {2, 0}, 10) == printed(14.9847 + 1.018 - 3.5 - 0.0102 - 0.0518));
  // plain without motion
  for (const double s : {50.0, 100.0, 250.0, 400.0}) {
    CHECK(area(s, {0, 0}) == by_area(s).force_n);
    CHECK(area(s, {0, 0}, -0.0) == by_area(s).force_n);
  }
  for (const double h : {1.0, 2.5, 4.0}) {
    CHECK(depth(h, {0, 0}) == by_depth(h).force_n);
  }
  // half of it at half the blend: gain 0.874, shift (1.7 - 0.3185) / 2
  CHECK(area(250, {0, 0.5}) == printed(9.0889008 + 0.69075));
  CHECK(area(250, {0, 0}, 0.0085 / degree) ==
        printed(1.1 * 10.3992 + (0.00171 * 0.0085 / degree - 1.8) / 2));
  // and at a quarter, where the weight is 3/16 - 2/64 = 0.15625: gain 0.960625
  CHECK(area(250, {0.25, 0}) == printed(0.960625 * 10.3992 + 0.15625 * (1.7 - 0.15925)));
}

TEST_CASE("normal force: an affine equation is what it says", "[normal_force]") {
  const Published by_area_moved = published::compensation_by_area();
  CHECK(by_area_moved.displaced(10.3992, 5) == printed(6.2936016));
  CHECK(by_area_moved.rotated(10.3992, 10 * degree) == printed(10.69614));
  CHECK(published::compensation_by_depth().displaced(14.9847, 2) == printed(15.49964));
  CHECK(published::compensation_by_depth().rotated(6.58425, 10 * degree) == printed(5.2054));
  CHECK(published::AffineForce<>()(7, 3) == 7);
}

TEST_CASE("normal force: the scaled compensation", "[normal_force]") {
  const NormalForce force(line(), Scaled{.per_mm_sq = 0.02, .per_rad_sq = -3});
  CHECK(force(4).force_n == 8);
  CHECK(force(4, {3, 4}).force_n == printed(8 * 1.5));
  CHECK(force(4, {0, 0}, 0.2).force_n == printed(8 * 0.88));
  CHECK(force(4, {-4, 3}, -0.2).force_n == printed(8 * 1.38));
  CHECK(NormalForce(line(), Scaled{})(4, {3, 4}, 0.2).force_n == 8);
}

TEST_CASE("normal force: the power law and its inverse", "[normal_force]") {
  const PowerLawForce<> curve = hertz();
  const NormalForce force(curve);
  CHECK(force(4).force_n == printed(8));
  CHECK(force(1).force_n == printed(0.125));
  CHECK(force(2).force_n == printed(1));
  CHECK(curve.radius_mm(8) == printed(4));
  CHECK(curve.radius_mm(0.125) == printed(1));
  CHECK(curve.slope(4) == printed(6));  // 3 r^2 / 8
  CHECK(curve.force_n(0) == 0);
  CHECK(curve.force_n(-1) == 0);
  CHECK(curve.slope(0) == 0);
  CHECK(curve.radius_mm(0) == 0);
  CHECK(curve.radius_mm(-3) == 0);
  CHECK((curve.gradient(0) == std::array<double, 2>{0, 0}));
  // dF/dc = -3 r^3 / c^4, dF/dgamma = -F log(r/c) / gamma^2
  CHECK(curve.gradient(4)[0] == printed(-12));
  CHECK(curve.gradient(4)[1] == printed(-72 * std::log(2.0)));
  const PowerLawForce<> square{2, 0.5, 0.5, 8};
  CHECK(NormalForce(square)(6).force_n == printed(9));
  CHECK(square.radius_mm(9) == printed(6));
}

TEST_CASE("normal force: every degree", "[normal_force]") {
  CHECK(NormalForce(PolynomialForce<1>{{3, 2}, 1, 10})(4).force_n == 11);
  CHECK(NormalForce(PolynomialForce<3>{{1, 0, 0, 2}, 1, 10})(2).force_n == 17);
  CHECK(NormalForce(PolynomialForce<4>{{1, 0, 0, 0, 2}, 1, 10})(2).force_n == 33);
  const PolynomialForce<5> fifth{{1, 1, 1, 1, 1, 1}, 1, 10};
  CHECK(NormalForce(fifth)(2).force_n == 63);
  CHECK(fifth.slope(2) == 1 + 4 + 12 + 32 + 80);
  CHECK((fifth.gradient(2) == std::array<double, 6>{1, 2, 4, 8, 16, 32}));
}

TEST_CASE("normal force: no contact, no force", "[normal_force]") {
  for (const double none : {0.0, -0.0, -1e-300, -3.0, -1e300}) {
    CAPTURE(none);
    for (const auto& r :
         {by_area(none), by_depth(none), area_in_motion(none), area_in_motion(none, {3, 4}, 0.5),
          depth_in_motion(none, {3, 4}, -0.5), NormalForce(hertz())(none)}) {
      CHECK(r.status == ForceStatus::no_contact);
      CHECK(r.has_force());
      CHECK(r.force_n == 0);
      CHECK_FALSE(std::signbit(r.force_n));
    }
  }
}

TEST_CASE("normal force: below the range it fades out", "[normal_force]") {
  const auto r = by_area(9);  // half the start: half of 0.00648 + 0.1719 + 0.6242
  CHECK(r.status == ForceStatus::below_range);
  CHECK(r.force_n == printed(0.40129));
  // the part of the compensation fades, too: (0.748 * 0.80258 - 0.637 + 1.7) / 2
  const auto moved = area_in_motion(9, {0, 1});
  CHECK(moved.status == ForceStatus::below_range);
  CHECK(moved.force_n == printed(0.83166492));
  CHECK(by_area(18 - 1e-9).status == ForceStatus::below_range);
  CHECK(by_area(18 - 1e-9).force_n == Approx(0.99392).epsilon(1e-9));
  CHECK(by_area(1e-9).force_n < 1e-19);
  CHECK(by_area(1e-9).force_n > 0);
  // at a quarter of the range's start: 3/16 - 2/64 of the force
  CHECK(NormalForce(hertz())(0.125).force_n == printed(0.15625 * 0.000244140625));
  // a curve identified from 0 on is not faded
  CHECK(NormalForce(PolynomialForce<>{{0, 2, 0}, 0, 10})(1e-9).force_n == printed(2e-9));
  CHECK(NormalForce(PolynomialForce<>{{0, 2, 0}, 0, 10})(1e-9).status == ForceStatus::measured);
}

TEST_CASE("normal force: beyond the range it goes on along the tangent", "[normal_force]") {
  const auto r = by_area(578);  // 28.03272 + 100 (0.00016 * 478 + 0.0191)
  CHECK(r.status == ForceStatus::beyond_range);
  CHECK(r.force_n == printed(37.59072));
  CHECK(by_area(1478).force_n == printed(28.03272 + 95.58));
  CHECK(by_area(std::nextafter(478.0, 500.0)).status == ForceStatus::beyond_range);
  // 64 + 24 (r - 8) instead of r^3 / 8
  CHECK(NormalForce(hertz())(9).force_n == printed(88));
  CHECK(NormalForce(hertz())(9).status == ForceStatus::beyond_range);
  // a cubic that would turn down beyond the range continues along its tangent
  const PolynomialForce<3> bent{{0, 3, 0, -1}, 0.25, 0.9};
  CHECK(NormalForce(bent)(5).force_n == printed(2.7 - 0.729 + 4.1 * (3 - 2.43)));
  // value and slope are continuous: differences on both sides
  for (const double h : {1e-3, 1e-4}) {
    const double end = by_area(478).force_n;
    CHECK((by_area(478 + h).force_n - end) / h == Approx(0.09558).epsilon(1e-7));
    CHECK((end - by_area(478 - h).force_n) / h == Approx(0.09558).margin(1e-4 * h + 1e-8));
  }
}

TEST_CASE("normal force: the variance beyond the range is that of the tangent, and of the curve",
          "[normal_force]") {
  CurveErrors<3> errors;
  errors.covariance = {{{0.01, 0, 0}, {0, 1e-6, 0}, {0, 0, 1e-12}}};
  const NormalForce force(published::force_of_area(), NoCompensation{}, errors);
  const double area = 578, past = 100;
  const double tangent = 0.01 + 1e-6 * area * area + 1e-12 * square(478.0 * 478 + past * 2 * 478);
  const double bend = 0.00008 * past * past;  // distance of the curve from its tangent
  CHECK(force(area).variance_n2 == Approx(tangent + bend * bend).epsilon(1e-12));
  CHECK_FALSE(force(area).ok());
  CHECK(force(area).has_force());
  // no step at the end of the range
  CHECK(force(478.001).variance_n2 == Approx(force(478).variance_n2).epsilon(1e-5));
  const NormalForce power(hertz(), NoCompensation{}, CurveErrors<2>{{{{1e-4, 0}, {0, 1e-4}}}});
  const double h = 1e-6;
  auto wider = hertz(), steeper = hertz();
  wider.coefficient_mm += h;
  steeper.exponent += h;
  const double at = 9, plain = NormalForce(hertz())(at).force_n;
  const double by_c = (NormalForce(wider)(at).force_n - plain) / h;
  const double by_gamma = (NormalForce(steeper)(at).force_n - plain) / h;
  const double bent = at * at * at / 8 - plain;
  CHECK(power(at).variance_n2 ==
        Approx(1e-4 * (by_c * by_c + by_gamma * by_gamma) + bent * bent).epsilon(1e-4));
}

TEST_CASE("normal force: what a compensation makes negative is held at zero", "[normal_force]") {
  // 1.2 * 1.6758 + 0.509 - 3.5 < 0
  const auto r = depth_in_motion(1, {1, 0});
  CHECK(r.status == ForceStatus::held_at_zero);
  CHECK(r.force_n == 0);
  CHECK(r.has_force());
  const NormalForce scaled(line(), Scaled{.per_mm_sq = -1});
  CHECK(scaled(4, {0.9, 0}).status == ForceStatus::measured);
  CHECK(scaled(4, {1.1, 0}).status == ForceStatus::held_at_zero);
  CHECK(scaled(0.5, {1.1, 0}).status == ForceStatus::held_at_zero);
  CHECK(scaled(11, {1.1, 0}).status == ForceStatus::held_at_zero);
  CHECK(scaled(0, {1.1, 0}).status == ForceStatus::no_contact);
  CHECK(scaled(11, {1.1, 0}).force_n == 0);
}

TEST_CASE("normal force: what is no number gives none", "[normal_force]") {
  const auto expect_none = [](const NormalForceResult<double>& r) {
    CHECK(r.status == ForceStatus::not_finite);
    CHECK_FALSE(r.has_force());
    CHECK(std::isnan(r.force_n));
    CHECK(std::isnan(r.variance_n2));
  };
  for (const double bad : {missing, infinity, -infinity}) {
    CAPTURE(bad);
    expect_none(by_area(bad));
    expect_none(NormalForce(hertz())(bad));
    expect_none(area_in_motion(bad));
    expect_none(area_in_motion(100, {bad, 0}));
    expect_none(area_in_motion(100, {0, bad}));
    expect_none(area_in_motion(100, {0, 0}, bad));
    expect_none(area_in_motion(0, {0, 0}, bad));  // even without contact: no force was computed
    expect_none(NormalForce(line(), Scaled{})(4, {bad, 0}));
    expect_none(NormalForce(line(), Scaled{})(4, {0, bad}));
    expect_none(NormalForce(line(), Scaled{})(4, {0, 0}, bad));
    // unused input does no harm
    CHECK(by_area(100, {bad, bad}, bad).force_n == by_area(100).force_n);
  }
  expect_none(NormalForceResult<double>());
}

TEST_CASE("normal force: curves that are refused", "[normal_force]") {
  CHECK(refused(published::force_of_area()) == "accepted");
  CHECK(refused(published::force_of_depth()) == "accepted");
  CHECK(refused(hertz()) == "accepted");
  const std::string owner = "PolynomialForce: ";
  CHECK(refused(PolynomialForce<>{{missing, 1, 0}, 1, 2}) ==
        owner + "coefficients = nan, must be finite");
  CHECK(refused(PolynomialForce<>{{0, infinity, 0}, 1, 2}) ==
        owner + "coefficients = inf, must be finite");
  CHECK(refused(PolynomialForce<>{{0, 1, -infinity}, 1, 2}) ==
        owner + "coefficients = -inf, must be finite");
  CHECK(refused(PolynomialForce<>{}) == owner + "from = nan, must be finite and >= 0");
  CHECK(refused(PolynomialForce<>{{0, 1, 0}, -0.5, 2}) ==
        owner + "from = -0.5, must be finite and >= 0");
  CHECK(refused(PolynomialForce<>{{0, 1, 0}, infinity, 2}) ==
        owner + "from = inf, must be finite and >= 0");
  CHECK(refused(PolynomialForce<>{{0, 1, 0}, 0, 2}) == "accepted");
  CHECK(refused(PolynomialForce<>{{0, 1, 0}, 1}) == owner + "to = nan, must be finite and > from");
  CHECK(refused(PolynomialForce<>{{0, 1, 0}, 2, 2}) == owner + "to = 2, must be finite and > from");
  CHECK(refused(PolynomialForce<>{{0, 1, 0}, 2, infinity}) ==
        owner + "to = inf, must be finite and > from");
  // at either end and in between
  const std::string slope = owner + "slope within the range = ";
  CHECK(refused(PolynomialForce<>{{0, 1, -0.25}, 1, 3}) == slope + "-0.5, must be >= 0");
  CHECK(refused(PolynomialForce<>{{0, -3, 1}, 1, 3}) == slope + "-1, must be >= 0");
  CHECK(refused(PolynomialForce<1>{{1, -1}, 1, 3}) == slope + "-1, must be >= 0");
  CHECK(refused(PolynomialForce<3>{{0, 11, -6, 1}, 1, 3}) == slope + "-0.25, must be >= 0");
  CHECK(refused(PolynomialForce<3>{{0, 12, -6, 1}, 1, 3}) == "accepted");
  CHECK(refused(PolynomialForce<>{{3, 0, 0}, 1, 3}) == "accepted");  // constant

  const std::string power = "PowerLawForce: ";
  CHECK(refused(PowerLawForce<>{}) == power + "coefficient_mm = nan, must be finite and > 0");
  CHECK(refused(PowerLawForce<>{0, 0.3, 0, 5}) ==
        power + "coefficient_mm = 0, must be finite and > 0");
  CHECK(refused(PowerLawForce<>{-2, 0.3, 0, 5}) ==
        power + "coefficient_mm = -2, must be finite and > 0");
  CHECK(refused(PowerLawForce<>{infinity, 0.3, 0, 5}) ==
        power + "coefficient_mm = inf, must be finite and > 0");
  CHECK(refused(PowerLawForce<>{2, missing, 0, 5}) == power + "exponent = nan, must be in (0, 2]");
  CHECK(refused(PowerLawForce<>{2, 0, 0, 5}) == power + "exponent = 0, must be in (0, 2]");
  CHECK(refused(PowerLawForce<>{2, 2.25, 0, 5}) == power + "exponent = 2.25, must be in (0, 2]");
  CHECK(refused(PowerLawForce<>{2, 2, 0, 5}) == "accepted");
  CHECK(refused(PowerLawForce<>{2, 0.3, -1, 5}) == power + "from = -1, must be finite and >= 0");
  CHECK(refused(PowerLawForce<>{2, 0.3}) == power + "from = nan, must be finite and >= 0");
  CHECK(refused(PowerLawForce<>{2, 0.3, 5, 5}) == power + "to = 5, must be finite and > from");
  CHECK(refused(PowerLawForce<>{2, 0.3, 1, infinity}) ==
        power + "to = inf, must be finite and > from");
  CHECK(refused(PowerLawForce<>{2, 0.3, 1}) == power + "to = nan, must be finite and > from");
}

TEST_CASE("normal force: compensations and errors that are refused", "[normal_force]") {
  CHECK(refused_with(NoCompensation{}) == "accepted");
  CHECK(refused_with(Scaled{-3, 4}) == "accepted");
  CHECK(refused_with(Scaled{missing, 0}) == "ScaledCompensation: per_mm_sq = nan, must be finite");
  CHECK(refused_with(Scaled{0, -infinity}) ==
        "ScaledCompensation: per_rad_sq = -inf, must be finite");
  CHECK(refused_with(Published{}) == "accepted");
  CHECK(refused_with(published::compensation_by_area()) == "accepted");
  CHECK(refused_with(published::compensation_by_depth()) == "accepted");
  const std::string owner = "published::Compensation: ";
  CHECK(refused_with(Published{.displaced = {missing, 0, 0}}) ==
        owner + "displaced: gain = nan, must be finite");
  CHECK(refused_with(Published{.displaced = {1, infinity, 0}}) ==
        owner + "displaced: per_unit = inf, must be finite");
  CHECK(refused_with(Published{.displaced = {1, 0, -infinity}}) ==
        owner + "displaced: offset_n = -inf, must be finite");
  CHECK(refused_with(Published{.rotated = {infinity, 0, 0}}) ==
        owner + "rotated: gain = inf, must be finite");
  CHECK(refused_with(Published{.rotated = {1, missing, 0}}) ==
        owner + "rotated: per_unit = nan, must be finite");
  CHECK(refused_with(Published{.rotated = {1, 0, missing}}) ==
        owner + "rotated: offset_n = nan, must be finite");
  for (const double bad : {0.0, -1.0, infinity, missing}) {
    const std::string given = bad == 0 ? "0" : bad < 0 ? "-1" : bad > 0 ? "inf" : "nan";
    CHECK(refused_with(Published{.blend_mm = bad}) ==
          owner + "blend_mm = " + given + ", must be finite and > 0");
    CHECK(refused_with(Published{.blend_rad = bad}) ==
          owner + "blend_rad = " + given + ", must be finite and > 0");
  }

  CHECK(refused_with(CurveErrors<3>{}) == "accepted");
  CurveErrors<3> errors;
  errors.covariance[1][2] = missing;
  CHECK(refused_with(errors) == "CurveErrors: covariance = nan, must be finite");
  errors = {};
  errors.covariance[2][2] = -0.5;
  CHECK(refused_with(errors) == "CurveErrors: variance of a parameter = -0.5, must be >= 0");
  const std::string no_covariance =
      "CurveErrors: covariance must be symmetric, without a negative eigenvalue";
  errors.covariance = {{{1, 0.5, 0}, {0.4, 1, 0}, {0, 0, 1}}};
  CHECK(refused_with(errors) == no_covariance);
  errors.covariance = {{{0, 0.5, 0}, {0.5, 1, 0}, {0, 0, 1}}};
  CHECK(refused_with(errors) == no_covariance);
  // each pair of parameters is possible, but not all three: the eigenvalue of (1, 1, 1) is -0.2
  errors.covariance = {{{1, -0.6, -0.6}, {-0.6, 1, -0.6}, {-0.6, -0.6, 1}}};
  CHECK(refused_with(errors) == no_covariance);
  errors.covariance = {{{1, -0.5, -0.5}, {-0.5, 1, -0.5}, {-0.5, -0.5, 1}}};  // singular
  CHECK(refused_with(errors) == "accepted");
  errors.covariance = {{{0, 0, 0}, {0, 1e-9, 1e-6}, {0, 1e-6, 1e-2}}};
  CHECK(refused_with(errors) == "accepted");
  CHECK(refused_with(CurveErrors<3>{.residual_sd_n = -1}) ==
        "CurveErrors: residual_sd_n = -1, must be finite and >= 0");
  CHECK(refused_with(CurveErrors<3>{.residual_sd_n = missing}) ==
        "CurveErrors: residual_sd_n = nan, must be finite and >= 0");
  CHECK(refused_with(CurveErrors<3>{.measure_sd = -0.25}) ==
        "CurveErrors: measure_sd = -0.25, must be finite and >= 0");
  CHECK(refused_with(CurveErrors<3>{.measure_sd = infinity}) ==
        "CurveErrors: measure_sd = inf, must be finite and >= 0");
}

TEST_CASE("normal force: variance by hand", "[normal_force]") {
  // gradient (1, 4, 16), slope 2
  CurveErrors<3> errors;
  errors.covariance = {{{0.04, 0.01, 0}, {0.01, 0.09, -0.002}, {0, -0.002, 0.0004}}};
  const auto variance = [&](double measure) {
    return NormalForce(line(), NoCompensation{}, errors)(measure).variance_n2;
  };
  const double by_parameters = 0.04 + 2 * 4 * 0.01 + 16 * 0.09 - 2 * 64 * 0.002 + 256 * 0.0004;
  CHECK(variance(4) == printed(by_parameters));
  errors.residual_sd_n = 0.5;
  CHECK(variance(4) == printed(by_parameters + 0.25));
  errors.measure_sd = 0.3;
  CHECK(variance(4) == printed(by_parameters + 0.25 + 0.36));
  CHECK(variance(0) == 0.25);
  CHECK(variance(-3) == 0.25);
  // a compensation's gain multiplies all terms but the residual
  const NormalForce doubled(line(), Scaled{.per_mm_sq = 1}, errors);
  CHECK(doubled(4, {1, 0}).variance_n2 == printed(4 * (by_parameters + 0.36) + 0.25));
  CHECK(doubled(4, {0, 0}).variance_n2 == printed(by_parameters + 0.25 + 0.36));
  // no variance without errors
  CHECK(std::isnan(by_area(100).variance_n2));
}

TEST_CASE("normal force: two measures fused", "[normal_force]") {
  using R = NormalForceResult<double>;
  const auto at = [](double force, double variance) {
    return R{ForceStatus::measured, force, variance};
  };
  // weights 1/4 and 1: (2/4 + 7) / (5/4)
  const auto both = fused(at(2, 4), at(7, 1));
  CHECK(both.force_n == printed(6));
  CHECK(both.variance_n2 == printed(0.8));
  CHECK(both.disagreement == printed(-std::sqrt(5.0)));
  CHECK(both.sources == 2);
  const auto twice = fused(at(3, 0.5), at(3, 0.5));
  CHECK(twice.force_n == 3);
  CHECK(twice.variance_n2 == 0.25);
  CHECK(twice.disagreement == 0);
  CHECK(twice.sources == 2);
  // one force is exact
  const auto exact = fused(at(3, 0), at(5, 1));
  CHECK(exact.force_n == 3);
  CHECK(exact.variance_n2 == 0);
  CHECK(exact.disagreement == -2);
  CHECK(fused(at(5, 1), at(3, 0)).force_n == 3);
  // both are exact: their difference then has no measure
  CHECK(fused(at(3, 0), at(3, 0)).disagreement == 0);
  const auto exact_both = fused(at(3, 0), at(5, 0));
  CHECK(exact_both.force_n == 4);
  CHECK(exact_both.variance_n2 == 0);
  CHECK(std::isnan(exact_both.disagreement));
  CHECK(exact_both.sources == 2);
  // only one force is usable
  for (const R& lacking :
       {R{}, at(9, missing), at(9, infinity), R{ForceStatus::not_finite, missing, 1}}) {
    for (const auto& one : {fused(at(3, 0.5), lacking), fused(lacking, at(3, 0.5))}) {
      CHECK(one.force_n == 3);
      CHECK(one.variance_n2 == 0.5);
      CHECK(std::isnan(one.disagreement));
      CHECK(one.sources == 1);
    }
    const auto none = fused(lacking, lacking);
    CHECK(std::isnan(none.force_n));
    CHECK(std::isnan(none.variance_n2));
    CHECK(std::isnan(none.disagreement));
    CHECK(none.sources == 0);
  }
  // the worse status of the two, and none where they contradict each other
  CHECK(twice.ok());
  CHECK(fused(at(3, 1), R{ForceStatus::beyond_range, 4, 1}).status == ForceStatus::beyond_range);
  CHECK(fused(R{ForceStatus::no_contact, 0, 1}, at(2, 1)).status == ForceStatus::measured);
  CHECK(fused(at(3, 0.5), R{}).status == ForceStatus::measured);
  CHECK_FALSE(fused(R{}, R{}).ok());
  CHECK(fused(at(3, 0.5), at(6.1, 0.5)).status == ForceStatus::disagreeing);
  CHECK(fused(at(3, 0.5), at(6.1, 0.5), 4).ok());
  CHECK(exact_both.status == ForceStatus::disagreeing);
  // zero forces take part as well
  CHECK(fused(R{ForceStatus::no_contact, 0, 1}, at(2, 1)).force_n == 1);
  CHECK(fused(R{ForceStatus::held_at_zero, 0, 1}, at(2, 1)).sources == 2);
}

TEST_CASE("normal force: forces by area and by depth that agree, fused", "[normal_force]") {
  CurveErrors<3> errors;
  errors.covariance[0][0] = 0.01;
  errors.residual_sd_n = 0.5;
  errors.measure_sd = 5;
  const NormalForce area(published::force_of_area(), NoCompensation{}, errors);
  errors.residual_sd_n = 0.27;
  errors.measure_sd = 0.02;
  const NormalForce depth(published::force_of_depth(), NoCompensation{}, errors);
  const auto a = area(225), d = depth(3);  // 9.0 and 9.0 N
  const auto both = fused(a, d);
  CHECK(both.force_n > (std::min)(a.force_n, d.force_n));
  CHECK(both.force_n < (std::max)(a.force_n, d.force_n));
  CHECK(both.variance_n2 < (std::min)(a.variance_n2, d.variance_n2));
  CHECK(std::abs(both.disagreement) < 1);
  // a sharper object: as deep, but half the area
  CHECK(std::abs(fused(area(110), depth(3)).disagreement) > 3);
}

TEST_CASE("normal force: what is too large for a number is no answer", "[normal_force]") {
  CHECK(refused(PowerLawForce<>{1, 1e-3, 0, 10}) ==  // 10^1000 N
        "PowerLawForce: to = 10, must be where force and slope are finite");
  CHECK(refused(PolynomialForce<>{{0, 1e308, 1e308}, 1, 10}) ==
        "PolynomialForce: to = 10, must be where force and slope are finite");
  const NormalForce<> force(PolynomialForce<>{{0, 1e10, 0}, 1, 10});
  CHECK(force(1e299).status == ForceStatus::not_finite);
  CHECK(std::isnan(force(1e299).force_n));
}

TEST_CASE("normal force: no curve begins with a step", "[normal_force]") {
  CHECK(refused(PolynomialForce<>{{1, 1, 0}, 0, 10}) ==
        "PolynomialForce: first of the coefficients = 1, must be 0 if from is 0, else the force "
        "would begin with a step");
  const NormalForce<> nearly(PolynomialForce<>{{1, 1, 0}, 1e-310, 10});
  CHECK(nearly(0).force_n == 0);
  // a constant curve does not fall, whatever its sign
  const NormalForce<> level(PolynomialForce<>{{-3, 0, 0}, 1, 3});
  CHECK(level(2).status == ForceStatus::held_at_zero);
}

TEST_CASE("normal force: the variance knows how a compensation fades", "[normal_force]") {
  CurveErrors<3> errors;
  errors.measure_sd = 0.1;
  const NormalForce force(published::force_of_area(), published::compensation_by_area(), errors);
  for (const double area_mm2 : {2.0, 5.0, 9.0, 17.0, 100.0, 600.0}) {
    const Point2<double> moved = {1, 0};
    const double step = 1e-6 * area_mm2;
    const double slope =
        (force(area_mm2 + step, moved).force_n - force(area_mm2 - step, moved).force_n) /
        (2 * step);
    // beyond the range, also the distance of the curve from its tangent
    const double bend = area_mm2 > 478 ? 0.748 * 0.00008 * square(area_mm2 - 478) : 0;
    CHECK(force(area_mm2, moved).variance_n2 ==
          Approx(square(0.1 * slope) + square(bend)).epsilon(2e-6));
  }
}
