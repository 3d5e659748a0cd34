// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Forces by look-up: values by hand, laws for every curve, map and contact, and what is
// refused.
#include "fingerpad/force/look_up.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

#include "fingerpad/adapt/dual.hpp"
#include "support/catch.hpp"
#include "support/curves.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::begins_with;
using test::Digits50;
using test::refusal;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double missing = test::nan;
constexpr double ulp = std::numeric_limits<double>::epsilon();

const NormalForce by_area(test::curve_of_area());
const NormalForce by_depth(test::curve_of_depth());

/// Sums of printed decimals, computed by hand: only the roundoff of double may differ.
Approx printed(double n) {
  return Approx(n).epsilon(1e-14).margin(1e-14);
}

ForceCurve<> line(double slope = 2) {
  return {{0, slope}, 1, 10};
}
/// A residual of 0 and no other errors, so that forces have a variance.
ForceCurve<> with_errors(ForceCurve<> curve) {
  curve.residual_sd_n = 0;
  return curve;
}

std::string refused(const ForceCurve<>& curve) {
  return refusal([&] { (void)NormalForce(curve); });
}
std::string refused(const ShearMap<>& map) {
  return refusal([&] { (void)Shear(map); });
}

/// 1 N/mm and 1 N mm/rad: forces equal the normalised displacement.
ShearMap<> ones(double reference = 1, double of_displacement = 0, double of_rotation = 0) {
  return test::straight_map<double>(reference, of_displacement, of_rotation, 1, 1);
}
ShearMap<> ends() {
  return {1, {2, 0, 1.5}, {30, 0, 0.5}};
}

}  // namespace

// ---- normal force, by hand

TEST_CASE("normal force: the published curves", "[normal_force]") {
  CHECK(by_area(100).force_n == printed(3.3342));
  CHECK(by_area(478).force_n == printed(28.03272));
  CHECK(by_depth(4).force_n == printed(14.9847));
  CHECK(by_depth(5.62).force_n == printed(27.9794004));
  for (const double area : {18.0, 478.0}) {
    CHECK(by_area(area).status == ForceStatus::measured);
  }
  // by the slope: 0.00016 S + 0.0191, 1.552 D + 0.5563
  CHECK(test::curve_of_area().slope(100) == printed(0.0351));
  CHECK(test::curve_of_depth().slope(4) == printed(6.7643));
  CHECK(NormalForce(test::curve_of_area<float>())(100.0F).force_n == Approx(3.3342F));
}

TEST_CASE("normal force: every degree", "[normal_force]") {
  CHECK(NormalForce(ForceCurve<>{{3, 2}, 1, 10})(4).force_n == 11);
  const ForceCurve<> cubic{{1, 1, 1, 1}, 1, 10};
  CHECK(NormalForce(cubic)(2).force_n == 15);
  CHECK(cubic.slope(2) == 1 + 4 + 12);
  // 3 - 6 x + 3 x^2 is lowest at 1, between any ends below 1 at the upper one
  const ForceCurve<> level{{0, 3, -3, 1}, 0.25, 4};
  CHECK(level.lowest_slope(0.5) == 0);
  CHECK(level.lowest_slope(2) == 3);
  CHECK(line().lowest_slope(0) == 2);
}

TEST_CASE("normal force: below the range it fades out", "[normal_force]") {
  const auto r = by_area(9);  // half the start: half of 0.00648 + 0.1719 + 0.6242
  CHECK(r.status == ForceStatus::below_range);
  CHECK(r.force_n == printed(0.40129));
  CHECK(by_area(18 - 1e-9).status == ForceStatus::below_range);
  CHECK(by_area(18 - 1e-9).force_n == Approx(0.99392).epsilon(1e-9));
  CHECK(by_area(1e-9).force_n < 1e-19);
  CHECK(by_area(1e-9).force_n > 0);
  // at a quarter of the range's start: 3/16 - 2/64 of the force
  CHECK(NormalForce(line())(0.25).force_n == printed(0.15625 * 0.5));
  // a curve identified from 0 on is not faded
  CHECK(NormalForce(ForceCurve<>{{0, 2}, 0, 10})(1e-9).force_n == printed(2e-9));
  CHECK(NormalForce(ForceCurve<>{{0, 2}, 0, 10})(1e-9).status == ForceStatus::measured);
}

TEST_CASE("normal force: beyond the range it goes on along the tangent", "[normal_force]") {
  const auto r = by_area(578);  // 28.03272 + 100 (0.00016 * 478 + 0.0191)
  CHECK(r.status == ForceStatus::beyond_range);
  CHECK(r.force_n == printed(37.59072));
  CHECK(by_area(1478).force_n == printed(28.03272 + 95.58));
  CHECK(by_area(std::nextafter(478.0, 500.0)).status == ForceStatus::beyond_range);
  // a cubic that would turn down beyond the range continues along its tangent
  const ForceCurve<> cubic{{0, 3, 0, -1}, 0.25, 0.9};
  CHECK(NormalForce(cubic)(5).force_n == printed(2.7 - 0.729 + 4.1 * (3 - 2.43)));
  // value and slope are continuous: differences on both sides
  for (const double h : {1e-3, 1e-4}) {
    const double end = by_area(478).force_n;
    CHECK((by_area(478 + h).force_n - end) / h == Approx(0.09558).epsilon(1e-7));
    CHECK((end - by_area(478 - h).force_n) / h == Approx(0.09558).margin(1e-4 * h + 1e-8));
  }
}

TEST_CASE("normal force: the variance beyond the range is that of the tangent, and of the curve",
          "[normal_force]") {
  ForceCurve<> curve = with_errors(test::curve_of_area());
  curve.covariance[0][0] = 0.01;
  curve.covariance[1][1] = 1e-6;
  curve.covariance[2][2] = 1e-12;
  const NormalForce force(curve);
  const double area = 578, past = 100;
  const double tangent = 0.01 + 1e-6 * area * area + 1e-12 * square(478.0 * 478 + past * 2 * 478);
  const double bend = 0.00008 * past * past;  // distance of the curve from its tangent
  CHECK(force(area).variance_n2 == Approx(tangent + bend * bend).epsilon(1e-12));
  CHECK_FALSE(force(area).ok());
  CHECK(force(area).has_force());
  // no step at the end of the range
  CHECK(force(478.001).variance_n2 == Approx(force(478).variance_n2).epsilon(1e-5));
}

TEST_CASE("normal force: what is no number gives none", "[normal_force]") {
  const auto expect_none = [](const ForceResult<double>& r) {
    CHECK(r.status == ForceStatus::not_finite);
    CHECK_FALSE(r.has_force());
    CHECK(std::isnan(r.force_n));
    CHECK(std::isnan(r.variance_n2));
  };
  for (const double bad : {missing, infinity, -infinity}) {
    CAPTURE(bad);
    expect_none(by_area(bad));
  }
  expect_none(ForceResult<double>());
  // what overflows
  const NormalForce steep(ForceCurve<>{{0, 1e10}, 1, 10});
  expect_none(steep(1e299));
}

TEST_CASE("normal force: curves that are refused", "[normal_force]") {
  using C = ForceCurve<>;
  CHECK(refused(test::curve_of_area()) == "accepted");
  CHECK(refused(test::curve_of_depth()) == "accepted");
  const std::string owner = "ForceCurve: ";
  CHECK(refused(C{{missing, 1}, 1, 2}) == owner + "coefficients = nan, must be finite");
  CHECK(refused(C{{0, infinity}, 1, 2}) == owner + "coefficients = inf, must be finite");
  CHECK(refused(C{{0, 1, -infinity}, 1, 2}) == owner + "coefficients = -inf, must be finite");
  CHECK(refused(C{}) == owner + "from = nan, must be finite and >= 0");
  CHECK(refused(C{{0, 1}, -0.5, 2}) == owner + "from = -0.5, must be finite and >= 0");
  CHECK(refused(C{{0, 1}, infinity, 2}) == owner + "from = inf, must be finite and >= 0");
  CHECK(refused(C{{0, 1}, 0, 2}) == "accepted");
  CHECK(refused(C{{0, 1}, 1}) == owner + "to = nan, must be finite and > 1");
  CHECK(refused(C{{0, 1}, 2, 2}) == owner + "to = 2, must be finite and > 2");
  CHECK(refused(C{{0, 1}, 2, infinity}) == owner + "to = inf, must be finite and > 2");
  // at either end and in between
  const std::string slope = owner + "slope within the range = ";
  CHECK(begins_with(refused(C{{0, 1, -0.25}, 1, 3}), slope + "-0.5"));
  CHECK(begins_with(refused(C{{0, -3, 1}, 1, 3}), slope + "-1"));
  CHECK(begins_with(refused(C{{1, -1}, 1, 3}), slope + "-1"));
  CHECK(begins_with(refused(C{{0, 11, -6, 1}, 1, 3}), slope + "-1"));
  CHECK(refused(C{{0, 12, -6, 1}, 1, 3}) == "accepted");
  CHECK(refused(C{{3}, 1, 3}) == "accepted");  // constant
  CHECK(begins_with(refused(C{{0, 1e308, 1e308}, 1, 10}), owner + "force at to = inf"));
  // no curve begins with a step
  CHECK(begins_with(refused(C{{1, 1}, 0, 10}), owner + "c_0 of a curve from 0 on = 1"));
  CHECK(NormalForce(C{{1, 1}, 1e-310, 10})(0).force_n == 0);
  // a constant curve does not fall, whatever its sign
  CHECK(NormalForce(C{{-3}, 1, 3})(2).status == ForceStatus::held_at_zero);
}

TEST_CASE("normal force: errors that are refused", "[normal_force]") {
  const std::string owner = "ForceCurve: ";
  const auto with = [](const auto& change) {
    ForceCurve<> curve = with_errors(line());
    change(curve);
    return refused(curve);
  };
  const auto of_variance = [&](double variance) {
    return with([&](auto& c) { c.covariance[2][2] = variance; });
  };
  CHECK(of_variance(1e-9) == "accepted");
  CHECK(begins_with(of_variance(-0.5), owner + "variance of a coefficient = -0.5"));
  CHECK(begins_with(of_variance(infinity), owner + "variance of a coefficient = inf"));
  CHECK(with([](auto& c) { c.residual_sd_n = -1; }) ==
        owner + "residual_sd_n = -1, must be finite and >= 0");
  CHECK(with([](auto& c) { c.residual_sd_n = infinity; }) ==
        owner + "residual_sd_n = inf, must be finite and >= 0");
  CHECK(with([](auto& c) { c.residual_sd_n = missing; }) == "accepted");  // no variance
}

TEST_CASE("normal force: variance by hand", "[normal_force]") {
  // gradient (1, 4, 16), slope 2
  ForceCurve<> curve = with_errors(line());
  const double c[3][3] = {{0.04, 0.01, 0}, {0.01, 0.09, -0.002}, {0, -0.002, 0.0004}};
  for (std::size_t i = 0; i < 3; ++i) {
    std::copy_n(c[i], 3, curve.covariance[i].begin());
  }
  const auto variance = [&](double m) { return NormalForce(curve)(m).variance_n2; };
  const double by_parameters = 0.04 + 2 * 4 * 0.01 + 16 * 0.09 - 2 * 64 * 0.002 + 256 * 0.0004;
  CHECK(variance(4) == printed(by_parameters));
  curve.residual_sd_n = 0.5;
  CHECK(variance(4) == printed(by_parameters + 0.25));
  CHECK(NormalForce(curve)(4, 0.09).variance_n2 == printed(by_parameters + 0.25 + 0.36));
  const auto refused = NormalForce(curve)(4, -1e6);
  CHECK(std::isnan(refused.variance_n2));
  CHECK(refused.force_n == NormalForce(curve)(4).force_n);
  CHECK(variance(0) == 0.25);
  CHECK(variance(-3) == 0.25);
  // no variance without errors
  CHECK(std::isnan(by_area(100).variance_n2));
}

TEST_CASE("normal force: two measures fused", "[normal_force]") {
  using R = ForceResult<double>;
  const auto at = [](double force, double variance) {
    return R{ForceStatus::measured, force, variance};
  };
  // weights 1/4 and 1: (2/4 + 7) / (5/4)
  const auto both = fused(at(2, 4), at(7, 1));
  CHECK(both.force_n == printed(6));
  CHECK(both.variance_n2 == printed(0.8));
  CHECK(both.disagreement == printed(-std::sqrt(5.0)));
  const auto twice = fused(at(3, 0.5), at(3, 0.5));
  CHECK(twice.force_n == 3);
  CHECK(twice.variance_n2 == 0.25);
  CHECK(twice.disagreement == 0);
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
  CHECK(exact_both.disagreement == -infinity);
  // only one force is usable
  for (const R& lacking :
       {R{}, at(9, missing), at(9, infinity), R{ForceStatus::not_finite, missing, 1}}) {
    for (const auto& one : {fused(at(3, 0.5), lacking), fused(lacking, at(3, 0.5))}) {
      CHECK(one.force_n == 3);
      CHECK(one.variance_n2 == 0.5);
      CHECK(std::isnan(one.disagreement));
    }
    const auto none = fused(lacking, lacking);
    CHECK_FALSE(none.has_force());
    CHECK(std::isnan(none.variance_n2));
    CHECK(std::isnan(none.disagreement));
  }
  // the worse status of the two, and none where they contradict each other
  CHECK(twice.ok());
  CHECK(fused(at(3, 1), R{ForceStatus::beyond_range, 4, 1}).status == ForceStatus::beyond_range);
  CHECK(fused(R{ForceStatus::no_contact, 0, 1}, at(2, 1)).status == ForceStatus::measured);
  CHECK(fused(at(3, 0.5), R{}).status == ForceStatus::measured);
  CHECK_FALSE(fused(R{}, R{}).ok());
  CHECK(fused(at(3, 0.5), at(6.1, 0.5)).status == ForceStatus::disagreeing);
  CHECK(fused(at(3, 0.5), at(5.9, 0.5)).ok());
  CHECK(exact_both.status == ForceStatus::disagreeing);
  // an implausible one counts even without a variance
  CHECK(fused(at(3, 0.5), R{ForceStatus::implausible, 1e7}).status == ForceStatus::implausible);
  // zero forces take part as well
  CHECK(fused(R{ForceStatus::no_contact, 0, 1}, at(2, 1)).force_n == 1);
}

// ---- normal force, laws for every curve

namespace {

using Vector = Point2<double>;

/// A curve that rises everywhere: no coefficient is negative.
ForceCurve<> any_rising(int degree) {
  ForceCurve<> curve;
  curve.from = test::log_uniform(0.01, 20);
  curve.to = curve.from * test::uniform(2, 40);
  double power = 1;
  for (int k = 0; k <= degree; ++k) {
    curve.coefficients[static_cast<std::size_t>(k)] =
        test::whole(0, 3) == 0 ? 0 : test::uniform(0, 10) / power;
    power *= curve.to;
  }
  return curve;
}
ForceCurve<> any_rising() {
  return any_rising(static_cast<int>(test::whole(1, 3)));
}

/// Any valid quadratic: its slope is not negative at either end; all else is free.
ForceCurve<> any_quadratic() {
  const double from = test::log_uniform(0.01, 20), to = from * test::uniform(2, 40);
  const double slope_from = test::log_uniform(0.01, 10) / to;
  const double slope_to = test::log_uniform(0.01, 10) / to;
  const double bend = (slope_to - slope_from) / (2 * (to - from));
  return {{test::uniform(-5, 5), slope_from - 2 * bend * from, bend}, from, to};
}
ForceCurve<> any_curve() {
  return test::whole(0, 1) == 0 ? any_rising() : any_quadratic();
}

double scale_of(const ForceCurve<>& curve) {
  return 1 + std::abs(curve.force_n(curve.to));
}

}  // namespace

TEST_CASE("normal force: never negative, and the status says where it is from",
          "[normal_force][law]") {
  rc::prop("for any finite numbers", [] {
    const auto curve = any_curve();
    const NormalForce force(curve);
    const auto any = [](double largest) {
      return test::whole(0, 4) > 0 ? test::uniform(-largest, largest)
                                   : *rc::gen::element(0.0, -0.0, 5e-324, -5e-324, 1e-310, 1e-160,
                                                       1e-30, 1e30, 1e150, -1e150, 1e200, -1e200);
    };
    const double measure = test::whole(0, 9) == 0   ? curve.from
                           : test::whole(0, 9) == 0 ? curve.to
                                                    : any(1.5 * curve.to);
    const auto r = force(measure);
    RC_ASSERT(r.has_force());
    RC_ASSERT(r.force_n >= 0);
    RC_ASSERT((r.status == ForceStatus::no_contact) == (measure <= 0));
    RC_ASSERT(r.status != ForceStatus::no_contact || r.force_n == 0);
    RC_ASSERT(r.status != ForceStatus::held_at_zero || r.force_n == 0);
    RC_ASSERT(r.status != ForceStatus::measured || (measure >= curve.from && measure <= curve.to));
    RC_ASSERT(r.status != ForceStatus::below_range || (measure > 0 && measure < curve.from));
    RC_ASSERT(r.status != ForceStatus::beyond_range || measure > curve.to);
  });
  rc::prop("and none without contact", [] {
    const NormalForce force(any_curve());
    const double none = test::whole(0, 3) == 0 ? 0 : -test::log_uniform(1e-150, 1e150);
    const auto r = force(none);
    RC_ASSERT(r.status == ForceStatus::no_contact);
    RC_ASSERT(r.force_n == 0);
  });
}

TEST_CASE("normal force: a larger contact presses no less", "[normal_force][law]") {
  rc::prop("from no contact to beyond the range", [] {
    const auto curve = any_rising();
    const NormalForce force(curve);
    const double top = test::whole(0, 1) == 0 ? 1.5 * curve.to : 1.5 * curve.from;
    const double a = test::uniform(-0.1, 1) * top, b = test::uniform(-0.1, 1) * top;
    const double less = force((std::min)(a, b)).force_n;
    const double more = force((std::max)(a, b)).force_n;
    RC_ASSERT(less <= more * (1 + 64 * ulp));
  });
  rc::prop("by any accepted quadratic from the start of its range on, along a line beyond it", [] {
    const auto curve = any_quadratic();
    const NormalForce force(curve);
    const double a = test::uniform(curve.from, 2 * curve.to);
    const double b = test::uniform(curve.from, 2 * curve.to);
    const double margin = 1e-13 * scale_of(curve);
    RC_ASSERT(force((std::min)(a, b)).force_n <= force((std::max)(a, b)).force_n + margin);
    const double past = test::uniform(0, 1) * curve.to;
    const double expected = curve.force_n(curve.to) + past * curve.slope(curve.to);
    RC_ASSERT(std::abs(force(curve.to + past).force_n - (std::max)(0.0, expected)) <= margin);
  });
}

TEST_CASE("normal force: units do not matter", "[normal_force][law]") {
  rc::prop("to the last bit, if they differ by powers of 2", [] {
    auto curve = any_rising();
    curve.residual_sd_n = test::uniform(0, 1);
    curve.covariance[0][0] = test::uniform(0, 1);
    const auto unit = [] { return std::ldexp(1.0, static_cast<int>(test::whole(-9, 9))); };
    const double area = unit(), newton = unit(), noise = test::uniform(0, 1);
    auto other = curve;
    double power = newton;
    for (double& c : other.coefficients) {
      c *= power;
      power /= area;
    }
    other.from *= area, other.to *= area;
    other.residual_sd_n *= newton;
    other.covariance[0][0] *= newton * newton;
    const double m = test::uniform(0, 1.5) * curve.to;
    const auto a = NormalForce(curve)(m, noise);
    const auto b = NormalForce(other)(m * area, noise * area * area);
    RC_ASSERT(a.status == b.status || b.status == ForceStatus::implausible);
    RC_ASSERT(a.force_n * newton == b.force_n);
    RC_ASSERT(a.variance_n2 * newton * newton == b.variance_n2);
  });
}

// ---- shear, by hand

TEST_CASE("shear: normalised as published (eqs. 4 and 5)", "[shear]") {
  struct Factors {
    double measure, of_displacement, of_rotation;
  };
  const auto check_factors = [](const ShearMap<>& map, std::initializer_list<Factors> table) {
    const Shear shear(map);
    for (const Factors& f : table) {
      CAPTURE(f.measure);
      const auto r = shear(f.measure, {1, -2}, 1);
      CHECK(test::relative_error(r.tangential_force_n.x, f.of_displacement) < 1e-14);
      CHECK(r.tangential_force_n.y == -2 * r.tangential_force_n.x);
      CHECK(test::relative_error(r.moment_n_mm, f.of_rotation) < 1e-14);
      CHECK(r.status == (f.measure >= 1e6                  ? ForceStatus::implausible
                         : f.measure < map.reference / 100 ? ForceStatus::below_range
                                                           : ForceStatus::measured));
    }
  };
  // 2^20 to the 0.65 is 2^13, to the 1.7 is 2^34; 2^20 to the 0.75 is 2^15, to the 2.2 is 2^44
  check_factors(ones(100, 0.65, 1.7), {{100, 1, 1},
                                       {25, 0.40612619817811776130, 0.09473228540689988014},
                                       {50, 0.63728031365963107185, 0.30778610333622907112},
                                       {200, 1.56916819579350147144, 3.24900958542494209043},
                                       {300, 2.04234363194535116445, 6.47300783992377929866},
                                       {478, 2.76457344940414283662, 14.2898419122327119320},
                                       {104857600, 8192, 17179869184},
                                       {100 / 1048576.0, 1 / 8192.0, 1 / 17179869184.0}});
  check_factors(ones(10, 0.75, 2.2), {{10, 1, 1},
                                      {1, 0.17782794100389228012, 0.00630957344480193249},
                                      {2, 0.29906975624424410838, 0.02899118654710782125},
                                      {2.5, 0.35355339059327376220, 0.04736614270344994007},
                                      {3.5, 0.45504152822405842642, 0.09930010267962126659},
                                      {5.62, 0.64908599200608596565, 0.28146208095944221636},
                                      {10485760, 32768, 17592186044416},
                                      {10 / 1048576.0, 1 / 32768.0, 1 / 17592186044416.0}});
  // elastic pads by the radius
  check_factors(ones(5, 1, 3), {{5, 1, 1}, {10, 2, 8}, {2.5, 0.5, 0.125}, {15, 3, 27}});
}

TEST_CASE("shear: a straight line needs no range, but reports the one it has", "[shear]") {
  ShearMap<> map = test::straight_map<double>(1, 0, 0, 2, 3);
  const Shear open(map);
  map.force.to = 1.0;
  map.moment.to = 0.5;
  const Shear closed(map);
  for (const double size : {0.5, 5.0, 5e5}) {
    // neither 100 mm nor half a turn is plausible for a fingertip
    const bool far = size > 100, turned = size > 3.2;
    const auto wild = ForceStatus::implausible, beyond = ForceStatus::beyond_range;
    const auto a = open(1.0, {size, 0}, 0), b = closed(1.0, {size, 0}, 0);
    CHECK(a.status == (far ? wild : ForceStatus::measured));
    CHECK(b.status == (far ? wild : size > 1 ? beyond : ForceStatus::measured));
    CHECK(a.tangential_force_n.x == 2 * size);
    CHECK(b.tangential_force_n.x == 2 * size);
    const auto c = open(1.0, {0, 0}, size), d = closed(1.0, {0, 0}, size);
    CHECK(c.status == (turned ? wild : ForceStatus::measured));
    CHECK(d.status == (turned ? wild : size > 0.5 ? beyond : ForceStatus::measured));
    CHECK(c.moment_n_mm == 3 * size);
    CHECK(d.moment_n_mm == 3 * size);
  }
}

TEST_CASE("shear: force and moment fail each by itself", "[shear]") {
  const Shear shear(ends());
  const auto good = shear(80.0, {0.2, -0.1}, 0.05);
  const auto no_force = [](const ShearResult<double>& r) {
    return r.status == ForceStatus::not_finite && !r.has_force() &&
           std::isnan(r.tangential_force_n.x) && std::isnan(r.tangential_force_n.y);
  };
  const auto no_moment = [](const ShearResult<double>& r) {
    return r.status == ForceStatus::not_finite && !r.has_moment() && std::isnan(r.moment_n_mm);
  };
  for (const double bad : {missing, infinity, -infinity}) {
    CAPTURE(bad);
    for (const auto& d : {Vector{bad, 0.1}, {0.1, bad}, {bad, bad}, {bad, -bad}}) {
      const auto r = shear(80.0, d, 0.05);
      CHECK(no_force(r));
      CHECK(r.has_moment());
      CHECK(r.moment_n_mm == good.moment_n_mm);
      CHECK(shear(0.0, d, bad).status == ForceStatus::no_contact);
    }
    const auto turned = shear(80.0, {0.2, -0.1}, bad);
    CHECK(no_moment(turned));
    CHECK(turned.has_force());
    CHECK(turned.tangential_force_n.x == good.tangential_force_n.x);
    const auto r = shear(bad, {0.2, -0.1}, 0.05);
    CHECK(no_force(r));
    CHECK(no_moment(r));
  }
  CHECK(no_force(ShearResult<double>()));
  CHECK(no_moment(ShearResult<double>()));
}

TEST_CASE("shear: bad parameters are refused by name", "[shear]") {
  const auto with = [](const ShearMap<>& good, const auto& change) {
    ShearMap<> map = good;
    change(map);
    return refused(map);
  };
  CHECK(refused(ones()) == "accepted");
  CHECK(refused(ends()) == "accepted");
  CHECK(refused(ShearMap<>()) == "ShearMap: force: slope = nan, must be finite and >= 0");
  for (const double bad : {0.0, -100.0, infinity, missing}) {
    CHECK(begins_with(with(ones(), [&](auto& m) { m.reference = bad; }), "ShearMap: reference = "));
  }
  for (ShearLaw<> ShearMap<>::*const law : {&ShearMap<>::force, &ShearMap<>::moment}) {
    const std::string owner =
        law == &ShearMap<>::force ? "ShearMap: force: " : "ShearMap: moment: ";
    for (const double bad : {infinity, missing, -2.5}) {
      CHECK(begins_with(with(ends(), [&](auto& m) { (m.*law).slope = bad; }), owner + "slope = "));
    }
    CHECK(begins_with(with(ends(), [&](auto& m) { (m.*law).exponent = infinity; }),
                      owner + "exponent = inf"));
    for (const double bad : {0.0, -1.0, infinity}) {
      CHECK(begins_with(with(ends(), [&](auto& m) { (m.*law).to = bad; }), owner + "to = "));
    }
    CHECK(with(ends(), [&](auto& m) { (m.*law).to = missing; }) == "accepted");
    CHECK(with(ends(), [&](auto& m) { (m.*law).slope = 0; }) == "accepted");  // of the other alone
  }
}

// ---- shear, laws for every pad, contact and shift

namespace {

template <class S = double>
ShearMap<S> any_map() {
  const auto law = [](double slope) {
    return ShearLaw<S>{static_cast<S>(slope), S(0), static_cast<S>(test::log_uniform(0.05, 5))};
  };
  const double slope = test::log_uniform(0.1, 100);
  // for a contact between 0.6 and 60 mm
  return {S(1), law(slope), law(slope * square(test::log_uniform(0.6, 60)))};
}
template <class S>
ShearMap<S> normalised(ShearMap<S> map) {
  map.reference = static_cast<S>(test::log_uniform(1, 1000));
  map.force.exponent = static_cast<S>(test::uniform(0.2, 2));
  map.moment.exponent = static_cast<S>(test::uniform(0.2, 3));
  return map;
}
double any_measure() {
  return test::log_uniform(0.1, 1000);
}
Vector any_shift() {
  const double angle = test::uniform(-std::numbers::pi, std::numbers::pi);
  const double length = test::log_uniform(1e-4, 10);
  return {length * std::cos(angle), length * std::sin(angle)};
}
double any_rotation() {
  return test::log_uniform(1e-4, 2) * (test::whole(0, 1) == 0 ? 1 : -1);
}
double length(const Vector& p) {
  return std::hypot(p.x, p.y);
}
bool near(double a, double b, double scale, double epsilons) {
  return std::abs(a - b) <= epsilons * ulp * std::abs(scale);
}
Vector rotated(const Vector& p, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * p.x - s * p.y, s * p.x + c * p.y};
}

}  // namespace

TEST_CASE("shear: a round pad looks the same from every side", "[shear][law]") {
  rc::prop("the force turns with the displacement, the moment does not", [] {
    const Shear shear(normalised(any_map()));
    const double measure = any_measure(), theta = any_rotation();
    const auto d = any_shift();
    const double angle = test::uniform(-std::numbers::pi, std::numbers::pi);
    const auto r = shear(measure, d, theta), t = shear(measure, rotated(d, angle), theta);
    const auto expected = rotated(r.tangential_force_n, angle);
    const double size = length(expected);
    RC_ASSERT(near(t.tangential_force_n.x, expected.x, size, 20));
    RC_ASSERT(near(t.tangential_force_n.y, expected.y, size, 20));
    RC_ASSERT(t.moment_n_mm == r.moment_n_mm);
  });
}

TEMPLATE_TEST_CASE("shear: whatever is measured, the answer says what it is worth",
                   "[shear][law]",
                   double,
                   float) {
  using S = TestType;
  const auto any_number = [] {
    using Limits = std::numeric_limits<S>;
    const S odd[] = {S(0),
                     S(-0.0),
                     Limits::denorm_min(),
                     -Limits::denorm_min(),
                     Limits::infinity(),
                     -Limits::infinity(),
                     Limits::quiet_NaN(),
                     S(1e6),
                     S(-1e6),
                     S(1),
                     S(-1)};
    const auto k = test::whole(0, 19);
    return k < 11 ? odd[k] : static_cast<S>(test::uniform(-10, 10));
  };
  rc::prop("finite where there is one, 0 without contact, else NaN", [=] {
    ShearMap<S> map = any_map<S>();
    map.reference = S(100), map.force.exponent = S(0.65), map.moment.exponent = S(1.7);
    const Shear shear(map);
    const S measure = any_number(), theta = any_number();
    const Point2<S> d{any_number(), any_number()};
    const auto r = shear(measure, d, theta);
    const auto& f = r.tangential_force_n;
    const bool known = is_finite(measure), gone = known && !(measure > 0);
    RC_ASSERT(r.has_force() == (gone || (known && is_finite(d))));
    RC_ASSERT(r.has_moment() == (gone || (known && is_finite(theta))));
    RC_ASSERT((r.status == ForceStatus::not_finite) == !(r.has_force() && r.has_moment()));
    RC_ASSERT((r.has_force() || (f.x != f.x && f.y != f.y)));
    RC_ASSERT((r.has_moment() || r.moment_n_mm != r.moment_n_mm));
    RC_ASSERT((r.status == ForceStatus::no_contact) == gone);
    RC_ASSERT(!gone || (f.x == 0 && f.y == 0 && r.moment_n_mm == 0));
  });
}

namespace {

/// Numbers that float holds exactly, so every type starts from the same ones.
double any(test::Random& random, double low, double high) {
  return static_cast<double>(static_cast<float>(random.uniform(low, high)));
}

/// A case in one list of any number type, so that each can be seeded with a derivative:
/// measure, displacement, angle, and the parameters of the look-up.
constexpr std::size_t inputs = 10;
using List = std::array<double, inputs>;
template <class S>
std::array<S, inputs> in(const List& list) {
  std::array<S, inputs> out;
  for (std::size_t k = 0; k < inputs; ++k) {
    out[k] = S(list[k]);
  }
  return out;
}

/// Normal force and variance. Parameters: from, to, c_0 to c_3; the second is the variance of the
/// measure.
struct Normal {
  template <class S>
  static std::array<S, 2> result(const std::array<S, inputs>& p) {
    ForceCurve<S> curve;
    curve.from = p[4];
    curve.to = p[5];
    std::copy_n(p.begin() + 6, 4, curve.coefficients.begin());
    for (std::size_t k = 0; k < 4; ++k) {
      curve.covariance[k][k] = S(0.0625);
    }
    curve.residual_sd_n = S(0.125);
    const auto r = NormalForce<S>(curve)(p[0], p[1]);
    return {r.force_n, r.variance_n2};
  }
  /// Below, within and beyond the range.
  static List draw(test::Random& random) {
    const double from = any(random, 0.5, 2), to = from + any(random, 4, 8);
    return {any(random, 0.02, 12),
            any(random, 0, 2),
            0,
            0,
            from,
            to,
            any(random, 0, 2),
            any(random, 0, 1),
            any(random, 0, 0.5),
            any(random, 0, 0.05)};
  }
};

/// Tangential force along x and moment. Parameters: T, R, and the slopes.
struct Sheared {
  template <class S>
  static std::array<S, 2> result(const std::array<S, inputs>& p) {
    ShearMap<S> map;
    map.reference = S(100);
    map.force = {p[6], p[4], S(0.75)};
    map.moment = {p[7], p[5], S(0.25)};
    const auto r = Shear<S>(map)(p[0], {p[1], p[2]}, p[3]);
    return {r.tangential_force_n.x, r.moment_n_mm};
  }
  static List draw(test::Random& random) {
    return {std::exp2(random.whole(-2, 9)),
            any(random, 0.1, 2),
            any(random, -2, 2),
            any(random, -0.5, 0.5),
            any(random, 0.2, 1),
            any(random, 1, 2),
            any(random, 1, 4),
            any(random, 20, 40)};
  }
};

template <class S>
double off(const S& a, const Digits50& b) {
  return std::abs(static_cast<double>(Digits50(Digits50(a) - b)));
}
template <class S>
double eps() {
  return static_cast<double>(std::numeric_limits<S>::epsilon());
}

template <class Case, class S>
double worst_off(const List& list) {
  const auto exact = Case::result(in<Digits50>(list));
  const auto found = Case::result(in<S>(list));
  double worst = 0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const double size = std::abs(static_cast<double>(exact[k]));
    worst = (std::max)(worst, size > 0 ? off(found[k], exact[k]) / size / eps<S>() : 0);
  }
  return worst;
}

}  // namespace

TEMPLATE_TEST_CASE("look-ups follow 50 digits", "[normal_force][shear]", Normal, Sheared) {
  test::Random random(5);
  for (int k = 0; k < 60; ++k) {
    const auto p = TestType::draw(random);
    CAPTURE(p[0], p[1], p[2], p[3], p[4], p[5]);
    CHECK(worst_off<TestType, float>(p) < 24);
    CHECK(worst_off<TestType, double>(p) < 24);
    CHECK(worst_off<TestType, long double>(p) < 24);
  }
}

TEMPLATE_TEST_CASE("derivatives of look-ups are those of differences",
                   "[normal_force][shear]",
                   Normal,
                   Sheared) {
  using D = fingerpad::Dual<inputs>;
  test::Random random(7);
  for (int k = 0; k < 14; ++k) {
    auto p = TestType::draw(random);
    switch (k) {  // no motion, no contact, ends of the range
      case 0:
        p[1] = p[2] = p[3] = 0;
        break;
      case 1:
        p[0] = 0;
        break;
      case 2:
        p[0] = -1;
        break;
      case 3:
        p[1] = 0;
        break;
      case 4:
        p[0] = p[4];
        break;
      case 5:
        p[0] = p[5];
        break;
      default:
        break;
    }
    std::array<D, inputs> seeded;
    for (std::size_t i = 0; i < inputs; ++i) {
      seeded[i] = D::parameter(p[i], i);
    }
    const auto r = TestType::result(seeded);
    for (std::size_t i = p[0] == 0 ? 1 : 0; i < inputs; ++i) {  // a power of 0 has no slope
      CAPTURE(k, i, p[0], p[1], p[2], p[3], p[4], p[5]);
      const Digits50 step("1e-15");
      const auto at = [&](const Digits50& change) {
        auto exact = in<Digits50>(p);
        exact[i] += change;
        return TestType::result(exact);
      };
      const auto above = at(step), below = at(Digits50(-step));
      // of the variance, a difference across the end of the range is no derivative
      for (std::size_t n = 0; n < (k > 5 ? 2U : 1U); ++n) {
        const Digits50 slope = (above[n] - below[n]) / (2 * step);
        // by roundoff of double, and of a difference across a change of curvature
        CHECK(off(r[n].slopes[i], slope) <=
              1e-12 * (1 + 100 * std::abs(static_cast<double>(slope))));
      }
    }
  }
}

TEMPLATE_TEST_CASE("a curve that is flat where it begins", "[normal_force]", float, double) {
  // (m - 8)^2 from its vertex on: the terms are 128 times their sum
  const auto force = []<class S>(S) {
    ForceCurve<S> curve;
    curve.coefficients[0] = S(64);
    curve.coefficients[1] = S(-16);
    curve.coefficients[2] = S(1);
    curve.from = S(8);
    curve.to = S(16);
    return NormalForce<S>(curve);
  };
  using S = TestType;
  for (const S above : {S(0), S(1e-6), S(1e-3), S(0.03), S(0.3), S(1), S(3)}) {
    const S m = S(8) + above;
    const auto r = force(S())(m);
    CHECK(r.force_n >= 0);
    CHECK(off(r.force_n, force(Digits50())(Digits50(m)).force_n) <= 2 * eps<S>() * 256);
  }
}

TEMPLATE_TEST_CASE("the largest and the smallest contacts", "[normal_force]", float, double) {
  using S = TestType;
  const S max = std::numeric_limits<S>::max(), least = std::numeric_limits<S>::denorm_min();
  const S normal = std::numeric_limits<S>::min();
  const ForceCurve<S> curve = test::curve_of_area<S>();
  const NormalForce<S> force(curve);
  ForceCurve<Digits50> exactly;
  std::copy(curve.coefficients.begin(), curve.coefficients.end(), exactly.coefficients.begin());
  exactly.from = Digits50(curve.from);
  exactly.to = Digits50(curve.to);
  const NormalForce<Digits50> exact(exactly);
  for (const S m : {S(1e6), S(1e20), S(1e37), S(max / 16), max}) {
    const auto r = force(m);
    CHECK(r.status == ForceStatus::implausible);
    CHECK(test::relative_error(Digits50(r.force_n), exact(Digits50(m)).force_n) < 8 * eps<S>());
  }
  for (const S m :
       {least, S(2 * least), normal, S(normal * 3), S(1e-30), S(1e-20), S(1e-10), S(1e-6)}) {
    const auto r = force(m);
    const Digits50 e = exact(Digits50(m)).force_n;
    CHECK(r.status == ForceStatus::below_range);
    CHECK(r.force_n >= 0);
    CHECK(off(r.force_n, e) <=
          20 * eps<S>() * static_cast<double>(e) + 4 * static_cast<double>(least));
  }
  // overflow is no answer
  ForceCurve<S> line;
  line.coefficients[1] = S(8);
  line.from = S(1);
  line.to = S(2);
  const NormalForce<S> steep(line);
  CHECK(steep(S(max / 16)).force_n == S(max / 2));
  CHECK(std::isnan(steep(max).force_n));
  CHECK(steep(max).status == ForceStatus::not_finite);
}
