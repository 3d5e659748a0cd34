// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties of tangential forces and moments for every pad, contact and shift.
#include "fingerpad/force/shear.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "fingerpad/published/shear.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/pad.hpp"

using namespace fingerpad;

namespace {

constexpr double ulp = std::numeric_limits<double>::epsilon();

template <int Degree, class S = double>
detail::OddPolynomial<Degree, S> any_rising() {
  detail::OddPolynomial<Degree, S> p;
  for (S& c : p.coefficients) {
    c = static_cast<S>(test::log_uniform(0.1, 100));
  }
  p.to = static_cast<S>(test::log_uniform(0.05, 5));
  return p;
}
template <int Degree, class S = double>
RadialShear<Degree, S> any_radial() {
  RadialShear<Degree, S> map{any_rising<Degree, S>(), any_rising<Degree, S>()};
  // for a contact between 0.6 and 60 mm
  map.moment.coefficients[0] =
      map.force.coefficients[0] * static_cast<S>(square(test::log_uniform(0.6, 60)));
  return map;
}
LinearShear<> any_linear() {
  LinearShear<> map;
  for (double* k : {&map.x_by_x, &map.x_by_y, &map.y_by_x, &map.y_by_y, &map.moment_n_mm_per_rad}) {
    *k = test::uniform(-10, 10);
  }
  return map;
}

template <class S = double>
ShearNormalisation<S> any_normalisation() {
  return {static_cast<S>(test::log_uniform(1, 1000)), static_cast<S>(test::uniform(0.2, 2)),
          static_cast<S>(test::uniform(0.2, 3))};
}
double any_measure() {
  return test::log_uniform(0.1, 1000);
}
Point2<double> any_displacement() {
  const double angle = test::uniform(-std::numbers::pi, std::numbers::pi);
  const double length = test::log_uniform(1e-4, 10);
  return {length * std::cos(angle), length * std::sin(angle)};
}
double any_rotation() {
  return test::log_uniform(1e-4, 2) * (test::whole(0, 1) == 0 ? 1 : -1);
}

double length(const Point2<double>& p) {
  return std::hypot(p.x, p.y);
}
bool near(double a, double b, double scale, double epsilons) {
  return std::abs(a - b) <= epsilons * ulp * std::abs(scale);
}
Point2<double> rotated(const Point2<double>& p, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * p.x - s * p.y, s * p.x + c * p.y};
}

template <int N>
struct Degree {
  static constexpr int value = N;
};

}  // namespace

TEMPLATE_TEST_CASE("shear: a round pad looks the same from every side",
                   "[shear][law]",
                   Degree<1>,
                   Degree<2>,
                   Degree<4>) {
  rc::prop("the force turns with the displacement, the moment does not", [] {
    const Shear shear(any_normalisation(), any_radial<TestType::value>());
    const double measure = any_measure(), theta = any_rotation();
    const auto d = any_displacement();
    const double angle = test::uniform(-std::numbers::pi, std::numbers::pi);
    const auto r = shear(measure, d, theta), t = shear(measure, rotated(d, angle), theta);
    const auto expected = rotated(r.tangential_force_n, angle);
    const double size = length(expected);
    RC_ASSERT(near(t.tangential_force_n.x, expected.x, size, 20));
    RC_ASSERT(near(t.tangential_force_n.y, expected.y, size, 20));
    RC_ASSERT(t.moment_n_mm == r.moment_n_mm);
  });
  rc::prop("to the bit by quarter turns, mirrors and half turns", [] {
    const Shear shear(any_normalisation(), any_radial<TestType::value>());
    const double measure = any_measure(), theta = any_rotation();
    const auto d = any_displacement();
    const auto r = shear(measure, d, theta);
    const auto& f = r.tangential_force_n;
    const auto quarter = shear(measure, {-d.y, d.x}, theta);
    RC_ASSERT(quarter.tangential_force_n.x == -f.y && quarter.tangential_force_n.y == f.x);
    const auto mirror = shear(measure, {d.x, -d.y}, -theta);
    RC_ASSERT(mirror.tangential_force_n.x == f.x && mirror.tangential_force_n.y == -f.y);
    RC_ASSERT(mirror.moment_n_mm == -r.moment_n_mm);
    const auto back = shear(measure, {-d.x, -d.y}, -theta);
    RC_ASSERT(back.tangential_force_n.x == -f.x && back.tangential_force_n.y == -f.y);
    RC_ASSERT(back.moment_n_mm == -r.moment_n_mm);
    RC_ASSERT(back.force_status == r.force_status && back.moment_status == r.moment_status);
  });
  rc::prop("the force points where the pad is carried", [] {
    const Shear shear(any_normalisation(), any_radial<TestType::value>());
    const auto d = any_displacement();
    const double theta = any_rotation();
    const auto r = shear(any_measure(), d, theta);
    const auto& f = r.tangential_force_n;
    RC_ASSERT(near(d.x * f.y, d.y * f.x, length(d) * length(f), 10));
    RC_ASSERT(d.x * f.x + d.y * f.y > 0);
    RC_ASSERT(theta * r.moment_n_mm > 0);
  });
}

TEMPLATE_TEST_CASE(
    "shear: a pad that stiffens", "[shear][law]", Degree<1>, Degree<2>, Degree<3>, Degree<4>) {
  rc::prop("pulls harder the further it is carried, and within the range and beyond", [] {
    const Shear shear(any_normalisation(), any_radial<TestType::value>());
    const double measure = any_measure(), theta = any_rotation();
    const auto d = any_displacement();
    const double more = 1 + test::log_uniform(1e-9, 10);
    const auto near_by = shear(measure, d, theta);
    const auto further = shear(measure, {more * d.x, more * d.y}, more * theta);
    RC_ASSERT(length(further.tangential_force_n) > length(near_by.tangential_force_n));
    RC_ASSERT(std::abs(further.moment_n_mm) > std::abs(near_by.moment_n_mm));
  });
  rc::prop("and by a larger contact", [] {
    const Shear shear(any_normalisation(), any_radial<TestType::value>());
    const double measure = any_measure(), theta = any_rotation();
    const auto d = any_displacement();
    const double more = 1 + test::log_uniform(1e-9, 10);
    const auto small = shear(measure, d, theta), large = shear(more * measure, d, theta);
    RC_ASSERT(length(large.tangential_force_n) > length(small.tangential_force_n));
    RC_ASSERT(std::abs(large.moment_n_mm) > std::abs(small.moment_n_mm));
  });
  rc::prop("goes on without a jump or a kink at the end of the range", [] {
    const auto map = any_radial<TestType::value>();
    const Shear shear(shear_without_measure(), map);
    const double angle = test::uniform(-std::numbers::pi, std::numbers::pi);
    const auto force = [&](double size) {
      return length(shear(1.0, rotated({size, 0}, angle), 0).tangential_force_n);
    };
    const auto moment = [&](double size) { return shear(1.0, {0, 0}, size).moment_n_mm; };
    const auto smooth = [](const auto& f, double to) {
      const double h = 1e-5 * to;
      const double below = (f(to) - f(to - h)) / h, above = (f(to + h) - f(to)) / h;
      const double step = (f(to * (1 + 4 * ulp)) - f(to * (1 - 4 * ulp)));
      return std::abs(above - below) < 2e-4 * above && std::abs(step) < 100 * ulp * f(to);
    };
    RC_ASSERT(smooth(force, map.force.to));
    RC_ASSERT(smooth(moment, map.moment.to));
  });
  rc::prop("beyond it the slope is the same everywhere", [] {
    const auto map = any_radial<TestType::value>();
    const Shear shear(shear_without_measure(), map);
    const auto slope = [&](double share) {
      const double a = share * map.force.to, b = 1.5 * a;
      const auto at = [&](double x) { return shear(1.0, {x, 0}, 0).tangential_force_n.x; };
      return (at(b) - at(a)) / (b - a);
    };
    const double first = slope(1.001);
    RC_ASSERT(near(slope(test::uniform(1.01, 100)), first, first, 2e4));
  });
}

TEST_CASE("shear: a contact that vanishes lets go without a jump", "[shear][law]") {
  rc::prop("of any force and any moment", [] {
    const Shear shear(any_normalisation(), any_radial<2>());
    const auto d = any_displacement();
    const double theta = any_rotation();
    const auto gone = shear(0.0, d, theta);
    RC_ASSERT(length(gone.tangential_force_n) == 0 && gone.moment_n_mm == 0);
    double force = length(shear(1.0, d, theta).tangential_force_n);
    double moment = std::abs(shear(1.0, d, theta).moment_n_mm);
    for (double measure = 0.1; measure > 1e-60; measure *= 0.1) {
      const auto r = shear(measure, d, theta);
      // the exponents are at least 0.2, and the odd polynomials at least linear
      RC_ASSERT(length(r.tangential_force_n) < 0.64 * force);
      RC_ASSERT(std::abs(r.moment_n_mm) < 0.64 * moment);
      force = length(r.tangential_force_n);
      moment = std::abs(r.moment_n_mm);
    }
    RC_ASSERT(force < 1e-6 && moment < 1e-6);
  });
}

TEST_CASE("shear: linear maps", "[shear][law]") {
  rc::prop("twice the shift, twice the force, of a straight radial map", [] {
    const Shear shear(any_normalisation(), any_radial<1>());
    const double measure = any_measure(), theta = any_rotation(), s = test::uniform(-5, 5);
    const auto d = any_displacement();
    const auto r = shear(measure, d, theta), t = shear(measure, {s * d.x, s * d.y}, s * theta);
    RC_ASSERT(near(t.tangential_force_n.x, s * r.tangential_force_n.x, t.tangential_force_n.x, 4));
    RC_ASSERT(near(t.tangential_force_n.y, s * r.tangential_force_n.y, t.tangential_force_n.y, 4));
    RC_ASSERT(near(t.moment_n_mm, s * r.moment_n_mm, t.moment_n_mm, 4));
  });
  rc::prop("forces of two shifts add, of any linear map without offsets", [] {
    const Shear shear(any_normalisation(), any_linear());
    const double measure = any_measure(), s = test::uniform(-5, 5);
    const double theta = any_rotation(), eta = any_rotation();
    const auto d = any_displacement(), e = any_displacement();
    const auto a = shear(measure, d, theta), b = shear(measure, e, eta);
    const auto both = shear(measure, {d.x + s * e.x, d.y + s * e.y}, theta + s * eta);
    const double factor = length(a.normalised_displacement_mm) / length(d);
    const double scale = 20 * factor * (length(d) + std::abs(s) * length(e));
    const auto &fa = a.tangential_force_n, &fb = b.tangential_force_n;
    RC_ASSERT(near(both.tangential_force_n.x, fa.x + s * fb.x, scale, 10));
    RC_ASSERT(near(both.tangential_force_n.y, fa.y + s * fb.y, scale, 10));
    RC_ASSERT(near(both.moment_n_mm, a.moment_n_mm + s * b.moment_n_mm,
                   std::abs(a.moment_n_mm) + std::abs(s * b.moment_n_mm), 10));
  });
  rc::prop("a straight radial map is a linear one", [] {
    const auto radial = any_radial<1>();
    const double k = radial.force.coefficients[0], c = radial.moment.coefficients[0];
    LinearShear<> linear{.x_by_x = k, .x_by_y = 0, .y_by_x = 0, .y_by_y = k};
    linear.moment_n_mm_per_rad = c;
    const auto normalisation = any_normalisation();
    const double measure = any_measure(), theta = any_rotation();
    const auto d = any_displacement();
    const auto a = Shear(normalisation, radial)(measure, d, theta);
    const auto b = Shear(normalisation, linear)(measure, d, theta);
    RC_ASSERT(a.tangential_force_n.x == b.tangential_force_n.x);
    RC_ASSERT(a.tangential_force_n.y == b.tangential_force_n.y);
    RC_ASSERT(a.moment_n_mm == b.moment_n_mm);
  });
  rc::prop("offsets add to it", [] {
    const auto normalisation = any_normalisation();
    LinearShear<> map = any_linear();
    const Shear without(normalisation, map);
    map.offset_n = {test::uniform(-3, 3), test::uniform(-3, 3)};
    map.moment_offset_n_mm = test::uniform(-3, 3);
    const Shear with(normalisation, map);
    const double measure = any_measure(), theta = any_rotation();
    const auto d = any_displacement();
    const auto a = with(measure, d, theta), b = without(measure, d, theta);
    RC_ASSERT(a.tangential_force_n.x == b.tangential_force_n.x + map.offset_n.x);
    RC_ASSERT(a.tangential_force_n.y == b.tangential_force_n.y + map.offset_n.y);
    RC_ASSERT(a.moment_n_mm == b.moment_n_mm + map.moment_offset_n_mm);
  });
}

TEST_CASE("shear: the normalisation", "[shear][law]") {
  rc::prop("does not depend on the unit of the measure", [] {
    auto normalisation = any_normalisation();
    const auto map = any_radial<2>();
    const double measure = any_measure(), theta = any_rotation();
    const auto d = any_displacement();
    const auto a = Shear(normalisation, map)(measure, d, theta);
    const double unit = std::ldexp(1.0, static_cast<int>(test::whole(-40, 40)));
    normalisation.reference *= unit;
    const auto b = Shear(normalisation, map)(unit * measure, d, theta);
    RC_ASSERT(a.tangential_force_n.x == b.tangential_force_n.x);
    RC_ASSERT(a.moment_n_mm == b.moment_n_mm);
  });
  rc::prop("is a power: a size so many times as large counts so many times more, anywhere", [] {
    const auto map = any_radial<3>();
    const double theta = any_rotation(), reference = any_measure();
    const auto d = any_displacement();
    // half and whole exponents, whose powers of 4 are exact
    const double half_d = static_cast<double>(test::whole(0, 6)) / 2;
    const double half_t = static_cast<double>(test::whole(0, 6)) / 2;
    const Shear shear(ShearNormalisation<double>{reference, half_d, half_t}, map);
    const auto at = [&](double measure) { return shear(measure, d, theta); };
    // at the reference size nothing changes
    RC_ASSERT(at(reference).normalised_displacement_mm.x == d.x);
    RC_ASSERT(at(reference).normalised_displacement_mm.y == d.y);
    RC_ASSERT(at(reference).normalised_rotation_rad == theta);
    // 4 times the size gives a factor of 2 to twice the exponent
    const double measure = any_measure();
    const auto small = at(measure), large = at(4 * measure);
    const double by_d = std::ldexp(1.0, static_cast<int>(2 * half_d));
    const double by_t = std::ldexp(1.0, static_cast<int>(2 * half_t));
    const auto &a = small.normalised_displacement_mm, &b = large.normalised_displacement_mm;
    RC_ASSERT(near(b.x, by_d * a.x, by_d * a.x, 100));
    RC_ASSERT(near(b.y, by_d * a.y, by_d * a.y, 100));
    RC_ASSERT(near(large.normalised_rotation_rad, by_t * small.normalised_rotation_rad,
                   by_t * small.normalised_rotation_rad, 100));
  });
  rc::prop("is all that a map sees of the size", [] {
    const auto map = any_radial<3>();
    const auto r =
        Shear(any_normalisation(), map)(any_measure(), any_displacement(), any_rotation());
    const auto alone = Shear(shear_without_measure(), map)(1.0, r.normalised_displacement_mm,
                                                           r.normalised_rotation_rad);
    RC_ASSERT(alone.tangential_force_n.x == r.tangential_force_n.x);
    RC_ASSERT(alone.tangential_force_n.y == r.tangential_force_n.y);
    RC_ASSERT(alone.moment_n_mm == r.moment_n_mm);
    const bool wild = alone.force_status == ForceStatus::implausible;
    const bool tiny = r.force_status == ForceStatus::below_range;
    RC_ASSERT(wild || tiny || alone.force_status == r.force_status);
  });
}

TEST_CASE("shear: moments about other points", "[shear][law]") {
  const auto any_point = [] {
    return Point2<double>{test::uniform(-20, 20), test::uniform(-20, 20)};
  };
  rc::prop("the force adds its cross product", [=] {
    const auto force = any_point(), center = any_point();
    const double moment = test::uniform(-100, 100);
    const Eigen::Vector3d f(force.x, force.y, test::uniform(-9, 0)), c(center.x, center.y, 0);
    const double expected = moment + c.cross(f).z();
    RC_ASSERT(near(moment_about_origin(moment, force, center), expected, 1000, 2));
  });
  rc::prop("it does not matter over which points one goes", [=] {
    const auto force = any_point(), center = any_point(), stop = any_point();
    const double moment = test::uniform(-100, 100);
    const double there =
        moment_about_origin(moment, force, Point2<double>{center.x - stop.x, center.y - stop.y});
    const double on = moment_about_origin(there, force, stop);
    RC_ASSERT(near(on, moment_about_origin(moment, force, center), 1000, 8));
    // and back again
    const double back = moment_about_origin(on, force, Point2<double>{-center.x, -center.y});
    RC_ASSERT(near(back, moment, 1000, 8));
  });
  rc::prop("turning everything changes nothing", [=] {
    const auto force = any_point(), center = any_point();
    const double moment = test::uniform(-100, 100), angle = test::uniform(-4, 4);
    RC_ASSERT(near(moment_about_origin(moment, rotated(force, angle), rotated(center, angle)),
                   moment_about_origin(moment, force, center), 1000, 8));
  });
}

namespace {

/// A number that is missing now and then.
template <class S>
S sometimes(double number) {
  const auto what = test::whole(0, 39);
  const double gaps[] = {test::nan, std::numeric_limits<double>::infinity(),
                         -std::numeric_limits<double>::infinity(), 0.0, -0.0};
  return static_cast<S>(what < 5 ? gaps[what] : number);
}

/// Whether both are NaN or agree within `epsilons`.
template <class S>
bool agree(S a, S b, double scale, double epsilons) {
  if (a != a || b != b) {
    return a != a && b != b;
  }
  const double off = std::abs(static_cast<double>(a) - static_cast<double>(b));
  return off <= epsilons * static_cast<double>(std::numeric_limits<S>::epsilon()) * scale;
}

}  // namespace

TEMPLATE_TEST_CASE("shear: whatever is measured, the answer says what it is worth",
                   "[shear][law]",
                   double,
                   float) {
  using S = TestType;
  const auto any_number = [] {
    const S odd[] = {S(0),
                     S(-0.0),
                     std::numeric_limits<S>::denorm_min(),
                     -std::numeric_limits<S>::denorm_min(),
                     std::numeric_limits<S>::infinity(),
                     -std::numeric_limits<S>::infinity(),
                     std::numeric_limits<S>::quiet_NaN(),
                     S(1e6),
                     S(-1e6),
                     S(1),
                     S(-1)};
    const auto k = test::whole(0, 19);
    return k < 11 ? odd[k] : static_cast<S>(test::uniform(-10, 10));
  };
  rc::prop("finite where there is one, 0 without contact, else NaN", [=] {
    const Shear shear(published::shear_normalisation_by_area<S>(), any_radial<3, S>());
    const S measure = any_number(), theta = any_number();
    const Point2<S> d{any_number(), any_number()};
    const auto r = shear(measure, d, theta);
    const auto& f = r.tangential_force_n;
    const bool known = is_finite(measure);
    RC_ASSERT(r.has_force() == (known && is_finite(d.x) && is_finite(d.y)));
    RC_ASSERT(r.has_moment() == (known && is_finite(theta)));
    RC_ASSERT((r.has_force() ? is_finite(f.x) && is_finite(f.y) : f.x != f.x && f.y != f.y));
    RC_ASSERT((r.has_moment() ? is_finite(r.moment_n_mm) : r.moment_n_mm != r.moment_n_mm));
    const bool gone = known && !(measure > 0);
    RC_ASSERT((r.force_status == ForceStatus::no_contact) == (gone && r.has_force()));
    RC_ASSERT((r.moment_status == ForceStatus::no_contact) == (gone && r.has_moment()));
    RC_ASSERT(!gone || !r.has_force() || (f.x == 0 && f.y == 0));
    RC_ASSERT(!gone || !r.has_moment() || r.moment_n_mm == 0);
  });
}
