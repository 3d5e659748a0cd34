// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every curve, every compensation and every contact.
#include "fingerpad/force/normal_force.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/published/normal_force.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/pad.hpp"

using namespace fingerpad;

namespace {

using Vector = Point2<double>;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double epsilon_of_double = std::numeric_limits<double>::epsilon();

/// A curve that rises everywhere: no coefficient is negative.
template <int Degree>
PolynomialForce<Degree> any_rising() {
  PolynomialForce<Degree> curve;
  curve.from = test::log_uniform(0.01, 20);
  curve.to = curve.from * test::uniform(2, 40);
  double power = 1;
  for (double& c : curve.coefficients) {
    c = test::whole(0, 3) == 0 ? 0 : test::uniform(0, 10) / power;
    power *= curve.to;
  }
  return curve;
}

/// Any valid quadratic: its slope is not negative at either end; all else is free.
PolynomialForce<2> any_accepted() {
  const double from = test::log_uniform(0.01, 20), to = from * test::uniform(2, 40);
  const double slope_from = test::log_uniform(0.01, 10) / to;
  const double slope_to = test::log_uniform(0.01, 10) / to;
  const double bend = (slope_to - slope_from) / (2 * (to - from));
  return {{test::uniform(-5, 5), slope_from - 2 * bend * from, bend}, from, to};
}

PowerLawForce<> any_power() {
  const double from = test::log_uniform(0.01, 5);
  return {test::log_uniform(0.5, 20), test::uniform(0.2, 1), from, from * test::uniform(2, 20)};
}

/// Generator of a kind of curve or compensation.
template <class Kind>
struct Any;
template <int Degree>
struct Any<PolynomialForce<Degree>> {
  static PolynomialForce<Degree> rising() { return any_rising<Degree>(); }
  static PolynomialForce<Degree> accepted() {
    if constexpr (Degree == 2) {
      return any_accepted();
    } else {
      return any_rising<Degree>();
    }
  }
};
template <>
struct Any<PowerLawForce<>> {
  static PowerLawForce<> rising() { return any_power(); }
  static PowerLawForce<> accepted() { return any_power(); }
};
template <>
struct Any<NoCompensation> {
  static NoCompensation compensation() { return {}; }
};
template <>
struct Any<ScaledCompensation<>> {
  static ScaledCompensation<> compensation() {
    return {test::uniform(-0.2, 0.2), test::uniform(-20, 20)};
  }
};
template <>
struct Any<published::Compensation<>> {
  static published::Compensation<> compensation() {
    const auto any = [](double unit) {
      return published::AffineForce<>{test::uniform(-0.5, 2), test::uniform(-1, 1) * unit,
                                      test::uniform(-4, 4)};
    };
    return {any(1), any(30), test::log_uniform(0.1, 3), test::log_uniform(0.002, 0.1)};
  }
};

template <class Curve_, class Compensation_>
struct Of {
  using Curve = Curve_;
  using Compensation = Compensation_;
  using Force = NormalForce<Curve, Compensation>;
};
using Plain = Of<PolynomialForce<>, NoCompensation>;
using Cubic = Of<PolynomialForce<3>, ScaledCompensation<>>;
using Scaled = Of<PolynomialForce<>, ScaledCompensation<>>;
using Published = Of<PolynomialForce<>, published::Compensation<>>;
using PlainPower = Of<PowerLawForce<>, NoCompensation>;
using ScaledPower = Of<PowerLawForce<>, ScaledCompensation<>>;
using PublishedPower = Of<PowerLawForce<>, published::Compensation<>>;

Vector any_displacement() {
  return {test::uniform(-4, 4), test::uniform(-4, 4)};
}
Vector along(double angle, double length) {
  return {length * std::cos(angle), length * std::sin(angle)};
}

/// Largest change of f between neighbouring numbers that bisection finds: it keeps the half in
/// which f changes more, until a single step is left.
template <class F>
double step_within(const F& f, double low, double high) {
  double at_low = f(low), at_high = f(high);
  for (int k = 0; k < 70; ++k) {
    const double middle = low + (high - low) / 2;
    const double at_middle = f(middle);
    if (std::abs(at_middle - at_low) > std::abs(at_high - at_middle)) {
      high = middle, at_high = at_middle;
    } else {
      low = middle, at_low = at_middle;
    }
  }
  return std::abs(at_high - at_low);
}

/// Whether f has no step at x or beside it, and no other value at x alone.
template <class F>
bool no_step_at(const F& f, double x, double width) {
  const double margin = 1e-11 * (1 + f(x));
  return step_within(f, x - width, x) <= margin && step_within(f, x, x + width) <= margin;
}

template <class Curve>
double scale_of(const Curve& curve) {
  return 1 + std::abs(curve.force_n(curve.to));
}

}  // namespace

TEMPLATE_TEST_CASE("normal force: never negative, and the status says where it is from",
                   "[normal_force][law]",
                   Plain,
                   Cubic,
                   Scaled,
                   Published,
                   PlainPower,
                   ScaledPower,
                   PublishedPower) {
  rc::prop("for any finite numbers", [] {
    const auto curve = Any<typename TestType::Curve>::accepted();
    const typename TestType::Force force(curve,
                                         Any<typename TestType::Compensation>::compensation());
    const auto any = [](double largest) {
      return test::whole(0, 4) > 0 ? test::uniform(-largest, largest)
                                   : *rc::gen::element(0.0, -0.0, 5e-324, -5e-324, 1e-310, 1e-160,
                                                       1e-30, 1e30, 1e150, -1e150, 1e200, -1e200);
    };
    const double measure = test::whole(0, 9) == 0   ? curve.from
                           : test::whole(0, 9) == 0 ? curve.to
                                                    : any(1.5 * curve.to);
    const Vector displacement{any(5), any(5)};
    const double rotation = any(0.5);
    const auto r = force(measure, displacement, rotation);
    if (r.status ==
        ForceStatus::not_finite) {  // squares of displacements, times the force, overflow
      RC_ASSERT(TestType::Compensation::reads_motion);
      RC_ASSERT(std::max({std::abs(displacement.x), std::abs(displacement.y),
                          std::abs(rotation)}) >= 1e100);
      RC_ASSERT(std::isnan(r.force_n));
      return;
    }
    RC_ASSERT(r.has_force());
    RC_ASSERT(r.force_n >= 0);
    RC_ASSERT((r.status == ForceStatus::no_contact) == (measure <= 0));
    RC_ASSERT(r.status != ForceStatus::no_contact || r.force_n == 0);
    RC_ASSERT(r.status != ForceStatus::held_at_zero || r.force_n == 0);
    RC_ASSERT(r.status != ForceStatus::measured || (measure >= curve.from && measure <= curve.to));
    RC_ASSERT(r.status != ForceStatus::below_range || (measure > 0 && measure < curve.from));
    RC_ASSERT(r.status != ForceStatus::beyond_range || measure > curve.to);
  });
}

TEMPLATE_TEST_CASE("normal force: without contact there is none, whatever moves",
                   "[normal_force][law]",
                   Scaled,
                   Cubic,
                   Published,
                   ScaledPower,
                   PublishedPower) {
  rc::prop("exactly", [] {
    const typename TestType::Force force(Any<typename TestType::Curve>::accepted(),
                                         Any<typename TestType::Compensation>::compensation());
    const double none = test::whole(0, 3) == 0 ? 0 : -test::log_uniform(1e-150, 1e150);
    const auto r = force(none, any_displacement(), test::uniform(-1, 1));
    RC_ASSERT(r.status == ForceStatus::no_contact);
    RC_ASSERT(r.force_n == 0);
  });
}

TEMPLATE_TEST_CASE("normal force: no step anywhere",
                   "[normal_force][law]",
                   Plain,
                   Cubic,
                   Scaled,
                   Published,
                   PlainPower,
                   ScaledPower,
                   PublishedPower) {
  rc::prop("in the measure, the displacement and the angle", [] {
    const auto curve = Any<typename TestType::Curve>::accepted();
    const auto compensation = Any<typename TestType::Compensation>::compensation();
    const typename TestType::Force force(curve, compensation);
    const Vector displacement = any_displacement();
    const double rotation = test::uniform(-0.3, 0.3);
    const auto of_measure = [&](double m) { return force(m, displacement, rotation).force_n; };
    const double width = 1e-5 * curve.from;
    for (const double measure : {0.0, curve.from, curve.to, test::uniform(0, 1) * curve.from,
                                 test::uniform(0, 1.5) * curve.to}) {
      RC_ASSERT(no_step_at(of_measure, measure, width));
    }
    if constexpr (TestType::Compensation::reads_motion) {
      double blend_mm = 1, blend_rad = 0.02;
      if constexpr (requires { compensation.blend_mm; }) {
        blend_mm = compensation.blend_mm;
        blend_rad = compensation.blend_rad;
      }
      const double measure = test::uniform(0.5, 1.2) * curve.to;
      const double direction = test::uniform(-3, 3);
      const auto of_length = [&](double d) {
        return force(measure, along(direction, d), rotation).force_n;
      };
      const auto of_angle = [&](double t) { return force(measure, displacement, t).force_n; };
      for (const double share : {-1.0, 0.0, 1.0, test::uniform(-1.5, 1.5)}) {
        RC_ASSERT(no_step_at(of_length, share * blend_mm, 1e-5 * blend_mm));
        RC_ASSERT(no_step_at(of_angle, share * blend_rad, 1e-5 * blend_rad));
      }
    }
  });
  rc::prop("from no contact on, by the square of the measure at least", [] {
    const auto curve = Any<typename TestType::Curve>::rising();
    const auto compensation = Any<typename TestType::Compensation>::compensation();
    const typename TestType::Force force(curve, compensation);
    const Vector displacement = any_displacement();
    const auto at = [&](double share) { return force(share * curve.from, displacement).force_n; };
    // 3 x^2 of at most the value at the start of the range, and 30 N by the compensation
    for (const double share : {1e-2, 1e-4, 1e-8}) {
      RC_ASSERT(at(share) <= 3 * share * share * 10 * (scale_of(curve) + 30));
    }
  });
}

TEMPLATE_TEST_CASE("normal force: a larger contact presses no less",
                   "[normal_force][law]",
                   Plain,
                   Cubic,
                   Scaled,
                   PlainPower,
                   ScaledPower) {
  rc::prop("with the same motion, from no contact to beyond the range", [] {
    const auto curve = Any<typename TestType::Curve>::rising();
    const typename TestType::Force force(curve,
                                         Any<typename TestType::Compensation>::compensation());
    const Vector displacement = any_displacement();
    const double rotation = test::uniform(-0.3, 0.3);
    const double top = test::whole(0, 1) == 0 ? 1.5 * curve.to : 1.5 * curve.from;
    const double a = test::uniform(-0.1, 1) * top, b = test::uniform(-0.1, 1) * top;
    const double less = force((std::min)(a, b), displacement, rotation).force_n;
    const double more = force((std::max)(a, b), displacement, rotation).force_n;
    RC_ASSERT(less <= more * (1 + 64 * epsilon_of_double));
  });
}

TEST_CASE("normal force: any accepted quadratic rises from the start of its range on",
          "[normal_force][law]") {
  rc::prop("and along a line beyond it", [] {
    const auto curve = any_accepted();
    const NormalForce force(curve);
    const double a = test::uniform(curve.from, 2 * curve.to);
    const double b = test::uniform(curve.from, 2 * curve.to);
    const double margin = 1e-13 * scale_of(curve);
    RC_ASSERT(force((std::min)(a, b)).force_n <= force((std::max)(a, b)).force_n + margin);
    const double past = test::uniform(0, 1) * curve.to;
    const double at_end = curve.force_n(curve.to);
    const double expected = at_end + past * curve.slope(curve.to);
    RC_ASSERT(std::abs(force(curve.to + past).force_n - (std::max)(0.0, expected)) <= margin);
  });
}

TEST_CASE("normal force: the inverse of the power law", "[normal_force][law]") {
  rc::prop("there and back", [] {
    PowerLawForce<> curve = any_power();
    curve.exponent = test::uniform(0.05, 2);
    const double radius = test::log_uniform(1e-3, 1e3);
    const double again = curve.radius_mm(curve.force_n(radius));
    // roundoff of the exponent is multiplied by the logarithm
    const double length = 2 + std::abs(std::log(radius / curve.coefficient_mm));
    RC_ASSERT(std::abs(again - radius) <= 4 * length * epsilon_of_double * radius);
    const double force = test::log_uniform(1e-6, 1e6);
    const double other = curve.force_n(curve.radius_mm(force));
    const double margin = 4 * (2 + std::abs(std::log(force)) + 2 / curve.exponent);
    RC_ASSERT(std::abs(other - force) <= margin * epsilon_of_double * force);
  });
}

TEMPLATE_TEST_CASE("normal force: a compensation knows no direction",
                   "[normal_force][law]",
                   Scaled,
                   Cubic,
                   Published,
                   ScaledPower,
                   PublishedPower) {
  rc::prop("nor anything where nothing moved", [] {
    const auto curve = Any<typename TestType::Curve>::rising();
    const typename TestType::Force force(curve,
                                         Any<typename TestType::Compensation>::compensation());
    const double measure = test::uniform(0, 1.5) * curve.to;
    const double plain = NormalForce(curve)(measure).force_n;
    RC_ASSERT(force(measure).force_n == plain);
    RC_ASSERT(force(measure, {-0.0, 0.0}, -0.0).force_n == plain);

    const Vector d = any_displacement();
    const double rotation = test::uniform(-0.3, 0.3);
    const double moved = force(measure, d, rotation).force_n;
    // mirrored, rotated by a right angle, twisted the other way: equal to the last bit
    for (const Vector& other : {Vector{-d.x, d.y}, Vector{d.x, -d.y}, Vector{-d.x, -d.y},
                                Vector{d.y, d.x}, Vector{-d.y, d.x}}) {
      RC_ASSERT(force(measure, other, rotation).force_n == moved);
      RC_ASSERT(force(measure, other, -rotation).force_n == moved);
    }
    const double turn = test::uniform(-3, 3), c = std::cos(turn), s = std::sin(turn);
    const double rotated = force(measure, {c * d.x - s * d.y, s * d.x + c * d.y}, rotation).force_n;
    RC_ASSERT(std::abs(rotated - moved) <= 1e-12 * (100 + 10 * scale_of(curve) + moved));
  });
}

TEST_CASE("normal force: the scaled compensation multiplies", "[normal_force][law]") {
  rc::prop("the plain force of any contact by the same factor", [] {
    const auto curve = any_rising<2>();
    const ScaledCompensation<> scaled{test::uniform(0, 0.2), test::uniform(0, 20)};
    const NormalForce force(curve, scaled);
    const NormalForce plain(curve);
    const Vector d = any_displacement();
    const double rotation = test::uniform(-0.3, 0.3);
    const double factor =
        1 + scaled.per_mm_sq * (d.x * d.x + d.y * d.y) + scaled.per_rad_sq * rotation * rotation;
    const double m = test::uniform(0, 1.5) * curve.to;
    const double expected = factor * plain(m).force_n;
    RC_ASSERT(std::abs(force(m, d, rotation).force_n - expected) <= 1e-14 * expected);
  });
}

TEST_CASE("normal force: the published compensation between its ends", "[normal_force][law]") {
  rc::prop("lies between the plain force and the printed equation at that place", [] {
    const auto curve = any_rising<2>();
    auto published = Any<published::Compensation<>>::compensation();
    const double m = test::uniform(1, curve.to / curve.from) * curve.from;
    const double plain = curve.force_n(m);
    const NormalForce force(curve, published);
    const double length = test::uniform(0, 1) * published.blend_mm;
    const double angle = test::uniform(0, 1) * published.blend_rad;
    const auto between = [&](double found, double printed) {
      const double margin = 1e-12 * (100 + scale_of(curve));
      const double low = (std::max)(0.0, (std::min)(plain, printed));
      const double high = (std::max)(0.0, (std::max)(plain, printed));
      return found >= low - margin && found <= high + margin;
    };
    RC_ASSERT(between(force(m, along(1, length)).force_n, published.displaced(plain, length)));
    RC_ASSERT(between(force(m, {0, 0}, -angle).force_n, published.rotated(plain, angle)));
    // beyond them each is as printed, and both together are the sum
    const double far = published.blend_mm * test::uniform(1, 4) + 1e-9;
    const double wide = published.blend_rad * test::uniform(1, 4) + 1e-9;
    const double margin = 1e-13 * (300 + 10 * scale_of(curve));
    const double by_length = published.displaced(plain, far);
    const double by_angle = published.rotated(plain, wide);
    const auto off = [&](double found, double expected) {
      return std::abs(found - (std::max)(0.0, expected));
    };
    RC_ASSERT(off(force(m, along(2, far)).force_n, by_length) <= margin);
    RC_ASSERT(off(force(m, {0, 0}, wide).force_n, by_angle) <= margin);
    RC_ASSERT(off(force(m, along(2, far), wide).force_n, by_length + by_angle - plain) <= margin);
  });
}

TEST_CASE("normal force: units do not matter", "[normal_force][law]") {
  rc::prop("to the last bit, if they differ by powers of 2", [] {
    const auto curve = any_rising<2>();
    const auto published = Any<published::Compensation<>>::compensation();
    const double area = std::ldexp(1.0, static_cast<int>(test::whole(-9, 9)));
    const double newton = std::ldexp(1.0, static_cast<int>(test::whole(-9, 9)));
    const double length = std::ldexp(1.0, static_cast<int>(test::whole(-9, 9)));
    const double angle = std::ldexp(1.0, static_cast<int>(test::whole(-9, 9)));
    const auto affine = [&](const published::AffineForce<>& a, double unit) {
      return published::AffineForce<>{a.gain, a.per_unit * newton / unit, a.offset_n * newton};
    };
    const auto& c = curve.coefficients;
    const PolynomialForce<> other_curve{
        {c[0] * newton, c[1] * newton / area, c[2] * newton / (area * area)},
        curve.from * area,
        curve.to * area};
    const published::Compensation<> other{affine(published.displaced, length),
                                          affine(published.rotated, angle),
                                          published.blend_mm * length, published.blend_rad * angle};
    CurveErrors<3> errors{.residual_sd_n = test::uniform(0, 1), .measure_sd = test::uniform(0, 1)};
    errors.covariance[0][0] = test::uniform(0, 1);
    CurveErrors<3> other_errors{.residual_sd_n = errors.residual_sd_n * newton,
                                .measure_sd = errors.measure_sd * area};
    other_errors.covariance[0][0] = errors.covariance[0][0] * newton * newton;
    const NormalForce force(curve, published, errors);
    const NormalForce other_force(other_curve, other, other_errors);
    const double m = test::uniform(0, 1.5) * curve.to;
    const Vector d = any_displacement();
    const double t = test::uniform(-0.3, 0.3);
    const auto a = force(m, d, t);
    const auto b = other_force(m * area, {d.x * length, d.y * length}, t * angle);
    RC_ASSERT(a.status == b.status || b.status == ForceStatus::implausible);
    RC_ASSERT(a.force_n * newton == b.force_n);
    RC_ASSERT(a.variance_n2 * newton * newton == b.variance_n2);
  });
}

namespace {

/// Linear combinations of independent normal numbers; their covariance is factor times its
/// transpose.
template <std::size_t N>
struct Spread {
  std::array<std::array<double, N>, N> factor = {};

  std::array<std::array<double, N>, N> covariance() const {
    std::array<std::array<double, N>, N> c = {};
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t j = 0; j < N; ++j) {
        for (std::size_t k = 0; k < N; ++k) {
          c[i][j] += factor[i][k] * factor[j][k];
        }
      }
    }
    return c;
  }
  std::array<double, N> draw(test::Random& random) const {
    std::array<double, N> normal, sum = {};
    for (double& n : normal) {
      n = random.normal();
    }
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t k = 0; k < N; ++k) {
        sum[i] += factor[i][k] * normal[k];
      }
    }
    return sum;
  }
};

PolynomialForce<> moved(PolynomialForce<> curve, const std::array<double, 3>& by) {
  for (std::size_t k = 0; k < 3; ++k) {
    curve.coefficients[k] += by[k];
  }
  return curve;
}
PowerLawForce<> moved(PowerLawForce<> curve, const std::array<double, 2>& by) {
  curve.coefficient_mm += by[0];
  curve.exponent += by[1];
  return curve;
}

/// Reported variance over that of forces with newly drawn parameters and measures.
template <class Curve, std::size_t N, class Compensation>
double said_over_drawn(const Curve& curve,
                       const Spread<N>& spread,
                       const Compensation& compensation,
                       double residual_sd,
                       double measure_sd,
                       double measure,
                       const Vector& displacement,
                       double rotation,
                       int draws) {
  const CurveErrors<N> errors{spread.covariance(), residual_sd, measure_sd};
  const NormalForce<Curve, Compensation> force(curve, compensation, errors);
  const auto said = force(measure, displacement, rotation);
  REQUIRE(said.force_n > 0);
  test::Random random(static_cast<std::uint64_t>(1000 * measure));
  double sum = 0, sum_sq = 0;
  for (int k = 0; k < draws; ++k) {
    const NormalForce<Curve, Compensation> other(moved(curve, spread.draw(random)), compensation);
    const double noisy = measure + measure_sd * random.normal();
    const double off =
        other(noisy, displacement, rotation).force_n + residual_sd * random.normal() - said.force_n;
    sum += off;
    sum_sq += off * off;
  }
  const double mean = sum / draws;
  return said.variance_n2 / (sum_sq / draws - mean * mean);
}

}  // namespace

TEST_CASE("normal force: the variance is that of parameters and measures drawn at random",
          "[normal_force][law]") {
  // A variance from n draws has a relative standard deviation of sqrt(2 / n); the margin is four of
  // it. Terms of higher order are below 0.1 %, because the errors of the parameters are small.
  constexpr int draws = 4000;
  const double margin = 4 * std::sqrt(2.0 / draws);
  const auto agrees = [&](const auto& curve, const auto& spread, const auto& compensation,
                          double measure, double measure_sd) {
    CAPTURE(measure);
    for (const double noise : {0.0, 1.0}) {
      CHECK(said_over_drawn(curve, spread, compensation, 0.02 * noise, measure_sd * noise, measure,
                            {1.5, 2}, -0.1, draws) == Approx(1).epsilon(margin));
    }
  };
  Spread<3> spread;
  spread.factor = {{{0.02, 0, 0}, {-1e-4, 2e-4, 0}, {1e-7, -3e-7, 2e-7}}};
  const auto area = published::force_of_area();
  for (const double measure : {9.0, 40.0, 450.0}) {
    agrees(area, spread, NoCompensation{}, measure, 0.3);
    agrees(area, spread, ScaledCompensation<>{0.05, 3}, measure, 0.3);
  }
  agrees(area, spread, published::compensation_by_area(), 200, 0.3);
  const PowerLawForce<> power{3, 0.4, 0.5, 8};
  Spread<2> of_power;
  of_power.factor = {{{0.004, 0}, {1e-4, 3e-4}}};
  for (const double measure : {0.4, 2.0, 6.0}) {
    agrees(power, of_power, NoCompensation{}, measure, 1e-3 * measure);
    agrees(power, of_power, ScaledCompensation<>{0.05, 3}, measure, 1e-3 * measure);
  }
}

TEST_CASE("normal force: a variance is never negative, and more noise is no less",
          "[normal_force][law]") {
  rc::prop("of any parameters' covariance", [] {
    const auto curve = any_rising<2>();
    Spread<3> spread;
    double unit = 1;
    for (auto& row : spread.factor) {
      for (double& entry : row) {
        entry = test::uniform(-1, 1) * unit;
      }
      unit /= curve.to;
    }
    CurveErrors<3> errors{spread.covariance(), test::uniform(0, 1),
                          test::uniform(0, 0.1) * curve.from};
    const double m = test::uniform(-0.1, 1.5) * curve.to;
    const auto variance = [&] {
      return NormalForce(curve, NoCompensation{}, errors)(m).variance_n2;
    };
    const double before = variance();
    const double floor = errors.residual_sd_n * errors.residual_sd_n;
    RC_ASSERT(before >= floor - 1e-13 * (1 + before));
    RC_ASSERT(m > 0 || before == floor);
    errors.covariance[0][0] += 0.5;
    const double with_covariance = variance();
    RC_ASSERT(with_covariance >= before);
    errors.measure_sd *= 2;
    const double with_noise = variance();
    RC_ASSERT(with_noise >= with_covariance);
    errors.residual_sd_n += 1;
    RC_ASSERT(variance() > with_noise);
  });
}

TEST_CASE("normal force: two forces fused", "[normal_force][law]") {
  using R = NormalForceResult<double>;
  const auto any = [] {
    return R{ForceStatus::measured, test::log_uniform(1e-3, 1e3), test::log_uniform(1e-12, 1e12)};
  };
  rc::prop("lie between them, surer than either, in any order", [&] {
    const R a = any(), b = any();
    const auto f = fused(a, b);
    const double margin = 4 * epsilon_of_double;
    const double low = (std::min)(a.force_n, b.force_n);
    const double high = (std::max)(a.force_n, b.force_n);
    RC_ASSERT(f.sources == 2);
    RC_ASSERT(f.force_n >= low - margin * high);
    RC_ASSERT(f.force_n <= high * (1 + margin));
    // 1/v is the sum of both, so v is between half of the smaller variance and all of it
    const double surer = (std::min)(a.variance_n2, b.variance_n2);
    RC_ASSERT(f.variance_n2 <= surer * (1 + margin));
    RC_ASSERT(f.variance_n2 >= surer / 2 * (1 - margin));
    const double information = 1 / a.variance_n2 + 1 / b.variance_n2;
    RC_ASSERT(std::abs(f.variance_n2 * information - 1) <= 2 * margin);
    // nearer to the more certain one
    const R& sure = a.variance_n2 < b.variance_n2 ? a : b;
    const R& unsure = a.variance_n2 < b.variance_n2 ? b : a;
    RC_ASSERT(std::abs(f.force_n - sure.force_n) <=
              std::abs(f.force_n - unsure.force_n) + 2 * margin * high);
    const auto g = fused(b, a);
    RC_ASSERT(std::abs(g.force_n - f.force_n) <= margin * high);
    RC_ASSERT(std::abs(g.variance_n2 - f.variance_n2) <= margin * f.variance_n2);
    RC_ASSERT(g.disagreement == -f.disagreement);
    const double spread = std::sqrt(a.variance_n2 + b.variance_n2);
    RC_ASSERT(std::abs(f.disagreement * spread - (a.force_n - b.force_n)) <= margin * high);
  });
  rc::prop("that are the same are that force, of half the variance", [&] {
    const R a = any();
    const auto f = fused(a, a);
    RC_ASSERT(f.force_n == a.force_n);
    RC_ASSERT(f.variance_n2 == a.variance_n2 / 2);
    RC_ASSERT(f.disagreement == 0);
  });
  rc::prop("one of which is missing are the other", [&] {
    const R a = any();
    const R lacking = test::whole(0, 1) == 0 ? R{}
                                             : R{ForceStatus::measured, any().force_n,
                                                 test::whole(0, 1) == 0 ? test::nan : infinity};
    for (const auto& f : {fused(a, lacking), fused(lacking, a)}) {
      RC_ASSERT(f.sources == 1);
      RC_ASSERT(f.force_n == a.force_n);
      RC_ASSERT(f.variance_n2 == a.variance_n2);
    }
  });
}

TEST_CASE("normal force: fused forces err as they say", "[normal_force][law]") {
  // Errors of both forces are random: checks the variance of the fused force and the unit variance
  // of the disagreement, to four standard deviations of the samples.
  constexpr int draws = 8000;
  const double margin = 4 * std::sqrt(2.0 / draws);
  for (const double variance_b : {0.01, 0.25, 4.0}) {
    test::Random random(static_cast<std::uint64_t>(100 * variance_b));
    double sum_sq = 0, disagreement_sq = 0, said = 0;
    for (int k = 0; k < draws; ++k) {
      const NormalForceResult<double> a{ForceStatus::measured, 10 + 0.5 * random.normal(), 0.25};
      const NormalForceResult<double> b{ForceStatus::measured,
                                        10 + std::sqrt(variance_b) * random.normal(), variance_b};
      const auto f = fused(a, b);
      sum_sq += (f.force_n - 10) * (f.force_n - 10);
      disagreement_sq += f.disagreement * f.disagreement;
      said = f.variance_n2;
    }
    CAPTURE(variance_b);
    CHECK(sum_sq / draws / said == Approx(1).epsilon(margin));
    CHECK(disagreement_sq / draws == Approx(1).epsilon(margin));
  }
}
