// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/shear.hpp"

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/published/shear.hpp"
#include "support/catch.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::same_bits;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = test::nan;

/// Normalised values of a displacement of 1 mm and a rotation of 1 rad at one contact size.
struct Factors {
  double measure;
  double of_displacement;
  double of_rotation;
};

/// 1 N/mm and 1 N mm/rad: forces equal the normalised displacement.
RadialShear<> ones() {
  return {{{1.0}}, {{1.0}}};
}

void check_factors(const ShearNormalisation<double>& normalisation,
                   std::initializer_list<Factors> table) {
  const Shear shear(normalisation, ones());
  for (const Factors& f : table) {
    CAPTURE(f.measure);
    const auto r = shear(f.measure, {1, -2}, 1);
    CHECK(test::relative_error(r.normalised_displacement_mm.x, f.of_displacement) < 1e-14);
    CHECK(r.normalised_displacement_mm.y == -2 * r.normalised_displacement_mm.x);
    CHECK(test::relative_error(r.normalised_rotation_rad, f.of_rotation) < 1e-14);
    CHECK(r.tangential_force_n.x == r.normalised_displacement_mm.x);
    CHECK(r.tangential_force_n.y == r.normalised_displacement_mm.y);
    CHECK(r.moment_n_mm == r.normalised_rotation_rad);
    const ForceStatus said = f.measure >= 1e6                            ? ForceStatus::implausible
                             : f.measure < normalisation.reference / 100 ? ForceStatus::below_range
                                                                         : ForceStatus::measured;
    CHECK(r.force_status == said);
    CHECK(r.moment_status == said);
    const double alone =
        shear_factor(f.measure, normalisation.reference, normalisation.displacement_exponent);
    CHECK(alone == r.normalised_displacement_mm.x);
  }
}

RadialShear<3> bent() {
  return {{{2, 0.5, -0.25}, 1.5}, {{30, 0, 8}, 0.5}};
}
LinearShear<> slanted() {
  return {.x_by_x = 2,
          .x_by_y = -0.5,
          .y_by_x = 0.25,
          .y_by_y = 3,
          .offset_n = {0.125, -0.25},
          .moment_n_mm_per_rad = 40,
          .moment_offset_n_mm = 0.5};
}

template <class Normalisation, class Map>
std::string refusal_of(const Normalisation& normalisation, const Map& map) {
  return test::refusal([&] { Shear<Map>(normalisation, map); });
}

}  // namespace

TEST_CASE("shear: normalised as published (eqs. 4 and 5)", "[shear]") {
  // 2^20 to the 0.65 is 2^13, to the 1.7 is 2^34; 2^20 to the 0.75 is 2^15, to the 2.2 is 2^44.
  SECTION("by area") {
    check_factors(published::shear_normalisation_by_area(),
                  {{100, 1, 1},
                   {25, 0.40612619817811776130, 0.09473228540689988014},
                   {50, 0.63728031365963107185, 0.30778610333622907112},
                   {200, 1.56916819579350147144, 3.24900958542494209043},
                   {300, 2.04234363194535116445, 6.47300783992377929866},
                   {478, 2.76457344940414283662, 14.2898419122327119320},
                   {104857600, 8192, 17179869184},
                   {100 / 1048576.0, 1 / 8192.0, 1 / 17179869184.0}});
  }
  SECTION("by depth") {
    check_factors(published::shear_normalisation_by_depth(),
                  {{10, 1, 1},
                   {1, 0.17782794100389228012, 0.00630957344480193249},
                   {2, 0.29906975624424410838, 0.02899118654710782125},
                   {2.5, 0.35355339059327376220, 0.04736614270344994007},
                   {3.5, 0.45504152822405842642, 0.09930010267962126659},
                   {5.62, 0.64908599200608596565, 0.28146208095944221636},
                   {10485760, 32768, 17592186044416},
                   {10 / 1048576.0, 1 / 32768.0, 1 / 17592186044416.0}});
  }
  SECTION("the reference size counts as it is") {
    const auto r = Shear(published::shear_normalisation_by_area(), bent())(100.0, {0.3, 0.4}, 0.25);
    CHECK(r.normalised_displacement_mm.x == 0.3);
    CHECK(r.normalised_rotation_rad == 0.25);
  }
}

TEST_CASE("shear: elastic pads, by the radius of the contact", "[shear]") {
  // Tangential stiffness is proportional to the radius, torsional stiffness to its cube.
  check_factors(shear_by_radius(5.0), {{5, 1, 1}, {10, 2, 8}, {2.5, 0.5, 0.125}, {15, 3, 27}});
  // The same by the area of the contact.
  const double pi = 3.14159265358979323846;
  const ShearNormalisation<double> by_area{25 * pi, 0.5, 1.5};
  for (const double radius : {0.1, 1.0, 4.0, 9.0}) {
    const auto a = Shear(by_area, ones())(radius * radius * pi, {1, 0}, 1);
    const auto b = Shear(shear_by_radius(5.0), ones())(radius, {1, 0}, 1);
    CHECK(a.tangential_force_n.x == Approx(b.tangential_force_n.x).epsilon(1e-14));
    CHECK(a.moment_n_mm == Approx(b.moment_n_mm).epsilon(1e-14));
  }
}

TEST_CASE("shear: without a measure of size nothing is changed", "[shear]") {
  const Shear shear(shear_without_measure(), ones());
  for (const double any : {1e-300, 0.01, 1.0, 17.0, 1e300}) {
    const auto r = shear(any, {0.7, -0.2}, 0.1);
    CHECK(r.tangential_force_n.x == 0.7);
    CHECK(r.tangential_force_n.y == -0.2);
    CHECK(r.moment_n_mm == 0.1);
  }
  CHECK(shear(0.0, {0.7, -0.2}, 0.1).tangential_force_n.x == 0);
}

TEST_CASE("shear: a factor exists only in contact", "[shear]") {
  for (const double measure : {0.0, -0.0, -1.0, -infinity, none}) {
    for (const double exponent : {0.65, 0.0, -1.0}) {
      CHECK(shear_factor(measure, 100.0, exponent) == 0);
    }
  }
  CHECK(shear_factor(400.0, 100.0, 0.0) == 1);
  CHECK(shear_factor(400.0, 100.0, -0.5) == Approx(0.5));
}

TEST_CASE("shear: a polynomial along the displacement, and its tangent beyond", "[shear]") {
  const Shear shear(shear_without_measure(), bent());
  // |d| = 1: 2 + 0.5 - 0.25
  auto r = shear(1.0, {0.6, -0.8}, -0.25);
  CHECK(r.tangential_force_n.x == Approx(2.25 * 0.6).epsilon(1e-15));
  CHECK(r.tangential_force_n.y == Approx(-2.25 * 0.8).epsilon(1e-15));
  CHECK(r.moment_n_mm == Approx(-(30 * 0.25 + 8 * 0.015625)).epsilon(1e-15));
  CHECK(r.force_status == ForceStatus::measured);
  CHECK(r.moment_status == ForceStatus::measured);
  // |d| = 2.5, identified up to 1.5: 3.28125 there, with the slope 2 + 1.5 - 0.75 * 2.25
  r = shear(1.0, {-1.5, 2}, 0.75);
  CHECK(std::hypot(r.tangential_force_n.x, r.tangential_force_n.y) ==
        Approx(3.28125 + 1.8125).epsilon(1e-15));
  CHECK(r.tangential_force_n.x < 0);
  CHECK(r.tangential_force_n.y > 0);
  CHECK(r.force_status == ForceStatus::beyond_range);
  // 0.5: 15 + 1, slope 30 + 6
  CHECK(r.moment_n_mm == Approx(16 + 0.25 * 36).epsilon(1e-15));
  CHECK(r.moment_status == ForceStatus::beyond_range);
  // the end itself is within the range
  r = shear(1.0, {0, 1.5}, -0.5);
  CHECK(r.force_status == ForceStatus::measured);
  CHECK(r.tangential_force_n.y == Approx(3.28125).epsilon(1e-15));
  CHECK(r.moment_status == ForceStatus::measured);
  CHECK(r.moment_n_mm == Approx(-16).epsilon(1e-15));
  // no displacement, no force
  r = shear(1.0, {0, 0}, 0);
  CHECK(r.tangential_force_n.x == 0);
  CHECK(r.moment_n_mm == 0);
  CHECK(r.force_status == ForceStatus::measured);
}

TEST_CASE("shear: a straight line needs no range, but reports the one it has", "[shear]") {
  const Shear open(shear_without_measure(), RadialShear<>{{{2.0}}, {{3.0}}});
  const Shear closed(shear_without_measure(), RadialShear<>{{{2.0}, 1.0}, {{3.0}, 0.5}});
  for (const double size : {0.5, 5.0, 5e5}) {
    const auto a = open(1.0, {size, 0}, size), b = closed(1.0, {size, 0}, size);
    // neither 100 mm nor half a turn is plausible for a fingertip
    const bool far = size > 100, turned = size > 3.2;
    CHECK(a.force_status == (far ? ForceStatus::implausible : ForceStatus::measured));
    CHECK(a.moment_status == (turned ? ForceStatus::implausible : ForceStatus::measured));
    const auto expected = size > 1 ? ForceStatus::beyond_range : ForceStatus::measured;
    CHECK(b.force_status == (far ? ForceStatus::implausible : expected));
    CHECK(b.moment_status == (turned ? ForceStatus::implausible : expected));
    CHECK(a.tangential_force_n.x == 2 * size);
    CHECK(b.tangential_force_n.x == 2 * size);
    CHECK(a.moment_n_mm == 3 * size);
    CHECK(b.moment_n_mm == 3 * size);
  }
}

TEST_CASE("shear: any linear map", "[shear]") {
  const Shear shear(shear_without_measure(), slanted());
  auto r = shear(1.0, {1, 2}, 0.25);
  CHECK(r.tangential_force_n.x == 2 - 1 + 0.125);
  CHECK(r.tangential_force_n.y == 0.25 + 6 - 0.25);
  CHECK(r.moment_n_mm == 10.5);
  // offsets are the force of a contact that is not displaced, not of a missing contact
  r = shear(1.0, {0, 0}, 0);
  CHECK(r.tangential_force_n.x == 0.125);
  CHECK(r.tangential_force_n.y == -0.25);
  CHECK(r.moment_n_mm == 0.5);
  r = shear(0.0, {1, 2}, 0.25);
  CHECK(r.tangential_force_n.x == 0);
  CHECK(r.tangential_force_n.y == 0);
  CHECK(r.moment_n_mm == 0);
  // with its own axes
  const Shear sized(published::shear_normalisation_by_area(), slanted());
  r = sized(200.0, {1, 2}, 0.25);
  CHECK(r.tangential_force_n.x == Approx(1.56916819579350147 + 0.125).epsilon(1e-14));
  CHECK(r.tangential_force_n.y == Approx(6.25 * 1.56916819579350147 - 0.25).epsilon(1e-14));
  CHECK(r.moment_n_mm == Approx(10 * 3.24900958542494209 + 0.5).epsilon(1e-14));
  // no displacement of a fingertip is beyond the range of this map
  CHECK(shear(1.0, {60, 80}, -3.1).ok());  // 100 mm
  CHECK(shear(1.0, {101, 0}, 0.1).force_status == ForceStatus::implausible);
  CHECK(shear(1.0, {101, 0}, 0.1).moment_status == ForceStatus::measured);
  CHECK(shear(1.0, {1, 0}, -15).moment_status == ForceStatus::implausible);
}

TEST_CASE("shear: without contact there is no force, whatever is displaced", "[shear]") {
  const Shear shear(published::shear_normalisation_by_area(), bent());
  for (const double measure : {0.0, -0.0, -1e-300, -7.0, -1e300}) {
    for (const double size : {0.0, 0.1, 1.0, 1e6}) {
      const auto r = shear(measure, {size, -size}, size);
      CHECK(r.force_status == ForceStatus::no_contact);
      CHECK(r.moment_status == ForceStatus::no_contact);
      CHECK(r.has_force());
      CHECK(r.has_moment());
      CHECK(r.tangential_force_n.x == 0);
      CHECK(r.tangential_force_n.y == 0);
      CHECK(r.moment_n_mm == 0);
      CHECK(r.normalised_displacement_mm.x == 0);
      CHECK(r.normalised_rotation_rad == 0);
    }
  }
}

TEST_CASE("shear: force and moment fail each by itself", "[shear]") {
  const Shear shear(published::shear_normalisation_by_area(), bent());
  const auto good = shear(80.0, {0.2, -0.1}, 0.05);
  const auto no_force = [](const ShearResult<double>& r) {
    return r.force_status == ForceStatus::not_finite && !r.has_force() &&
           std::isnan(r.tangential_force_n.x) && std::isnan(r.tangential_force_n.y) &&
           std::isnan(r.normalised_displacement_mm.x) && std::isnan(r.normalised_displacement_mm.y);
  };
  const auto no_moment = [](const ShearResult<double>& r) {
    return r.moment_status == ForceStatus::not_finite && !r.has_moment() &&
           std::isnan(r.moment_n_mm) && std::isnan(r.normalised_rotation_rad);
  };
  for (const double bad : {none, infinity, -infinity}) {
    CAPTURE(bad);
    for (const double measure : {80.0, 0.0}) {
      for (const auto& d : {Point2<double>{bad, 0.1}, {0.1, bad}, {bad, bad}, {bad, -bad}}) {
        const auto r = shear(measure, d, 0.05);
        CHECK(no_force(r));
        CHECK(r.has_moment());
        CHECK(r.moment_n_mm == (measure > 0 ? good.moment_n_mm : 0));
      }
      const auto r = shear(measure, {0.2, -0.1}, bad);
      CHECK(no_moment(r));
      CHECK(r.has_force());
      CHECK(r.tangential_force_n.x == (measure > 0 ? good.tangential_force_n.x : 0));
    }
    const auto r = shear(bad, {0.2, -0.1}, 0.05);
    CHECK(no_force(r));
    CHECK(no_moment(r));
  }
  CHECK(no_force(ShearResult<double>()));
  CHECK(no_moment(ShearResult<double>()));
}

TEST_CASE("shear: the moment about the origin", "[shear]") {
  // a force along y at x = 3 mm rotates from x toward y
  CHECK(moment_about_origin(0.0, {0.0, 2.0}, {3.0, 0.0}) == 6);
  CHECK(moment_about_origin(0.0, {2.0, 0.0}, {0.0, 3.0}) == -6);
  CHECK(moment_about_origin(5.0, {2.0, 1.0}, {4.0, 2.0}) == 5);  // in line with the origin
  CHECK(moment_about_origin(5.0, {2.0, 1.0}, {0.0, 0.0}) == 5);
  CHECK(moment_about_origin(1.0, {0.5, -1.5}, {2.0, -3.0}) == 1 - 3 + 1.5);
}

TEST_CASE("shear: bad parameters are refused by name", "[shear]") {
  const auto normalised = [](const ShearNormalisation<double>& n) { return refusal_of(n, ones()); };
  CHECK(normalised({}) == "ShearNormalisation: reference = nan, must be finite and > 0");
  CHECK(normalised({0}) == "ShearNormalisation: reference = 0, must be finite and > 0");
  CHECK(normalised({-100}) == "ShearNormalisation: reference = -100, must be finite and > 0");
  CHECK(normalised({infinity}) == "ShearNormalisation: reference = inf, must be finite and > 0");
  CHECK(normalised({100, infinity}) ==
        "ShearNormalisation: displacement_exponent = inf, must be finite");
  CHECK(test::begins_with(normalised({100, none}), "ShearNormalisation: displacement_exponent = "));
  CHECK(normalised({100, 0.65, -infinity}) ==
        "ShearNormalisation: rotation_exponent = -inf, must be finite");
  CHECK(test::begins_with(normalised({100, 1, none}), "ShearNormalisation: rotation_exponent = "));

  const auto mapped = [](const auto& map) {
    return refusal_of(published::shear_normalisation_by_area(), map);
  };
  CHECK(mapped(ones()) == "accepted");
  CHECK(mapped(bent()) == "accepted");
  CHECK(mapped(slanted()) == "accepted");
  CHECK(mapped(RadialShear<>()) == "RadialShear: force: coefficients = nan, must be finite");
  for (const bool of_force : {true, false}) {
    const std::string owner = of_force ? "RadialShear: force" : "RadialShear: moment";
    const auto refused = [&](const auto& change) {
      RadialShear<3> map = bent();
      change(of_force ? map.force : map.moment);
      return mapped(map);
    };
    const auto straight = [&](double to) {
      RadialShear<1> map = ones();
      (of_force ? map.force : map.moment).to = to;
      return mapped(map);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK(refused([&](auto& p) { p.coefficients[k] = infinity; }) ==
            owner + ": coefficients = inf, must be finite");
      CHECK(refused([&](auto& p) { p.coefficients[k] = none; }) ==
            owner + ": coefficients = nan, must be finite");
    }
    CHECK(refused([](auto& p) { p.coefficients[0] = 0; }) ==
          owner + ": first of the coefficients = 0, must be > 0");
    CHECK(refused([](auto& p) { p.coefficients[0] = -2.5; }) ==
          owner + ": first of the coefficients = -2.5, must be > 0");
    const std::string range = ", must be finite and > 0, or NaN for degree 1";
    CHECK(refused([](auto& p) { p.to = none; }) == owner + ": to = nan" + range);
    CHECK(refused([](auto& p) { p.to = 0; }) == owner + ": to = 0" + range);
    CHECK(refused([](auto& p) { p.to = -1; }) == owner + ": to = -1" + range);
    CHECK(refused([](auto& p) { p.to = infinity; }) == owner + ": to = inf" + range);
    CHECK(straight(none) == "accepted");
    CHECK(straight(2) == "accepted");
    CHECK(straight(0) == owner + ": to = 0" + range);
    CHECK(straight(infinity) == owner + ": to = inf" + range);
  }

  const auto linear = [&](double LinearShear<>::*field, double given) {
    LinearShear<> map = slanted();
    map.*field = given;
    return mapped(map);
  };
  const auto check_linear = [&](double LinearShear<>::*field, const std::string& name) {
    CHECK(linear(field, infinity) == "LinearShear: " + name + " = inf, must be finite");
    CHECK(linear(field, none) == "LinearShear: " + name + " = nan, must be finite");
    CHECK(linear(field, -3) == "accepted");
  };
  check_linear(&LinearShear<>::x_by_x, "x_by_x");
  check_linear(&LinearShear<>::x_by_y, "x_by_y");
  check_linear(&LinearShear<>::y_by_x, "y_by_x");
  check_linear(&LinearShear<>::y_by_y, "y_by_y");
  check_linear(&LinearShear<>::moment_n_mm_per_rad, "moment_n_mm_per_rad");
  check_linear(&LinearShear<>::moment_offset_n_mm, "moment_offset_n_mm");
  LinearShear<> map = slanted();
  map.offset_n.x = none;
  CHECK(mapped(map) == "LinearShear: offset_n.x = nan, must be finite");
  map.offset_n = {0, infinity};
  CHECK(mapped(map) == "LinearShear: offset_n.y = inf, must be finite");
}

TEST_CASE("shear: the estimator is a value of some numbers", "[shear]") {
  static_assert(std::is_trivially_copyable_v<Shear<RadialShear<3, float>>>);
  static_assert(std::is_trivially_copyable_v<Shear<LinearShear<double>>>);
  static_assert(
      std::is_same_v<decltype(Shear(published::shear_normalisation_by_area(), ones())), Shear<>>);
  const Shear<RadialShear<1, float>> shear(published::shear_normalisation_by_area<float>(),
                                           {{{2.0F}}, {{3.0F}}});
  const auto r = shear(200.0F, {1.0F, 0.0F}, 1.0F);
  CHECK(r.tangential_force_n.x == Approx(2 * 1.56916819579350147).epsilon(1e-6));
  CHECK(r.moment_n_mm == Approx(3 * 3.24900958542494209).epsilon(1e-6));
}
