// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The rubber's second constant, from inflated caps whose truth follows from the energy alone.
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "fingerpad/calibrate/rim.hpp"
#include "fingerpad/force/wrench.hpp"
#include "support/catch.hpp"
#include "support/inflated_rubber.hpp"
#include "support/numbers.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::InflatedRubber;

namespace {

using Point = Point3<double>;
constexpr int columns = 36;
constexpr double arc_mm = 0.8;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

double angle(int k) {
  return 2 * std::numbers::pi * k / columns;
}

auto grid_of(const std::vector<Point>& points) {
  return StridedView<const Point>(points.data(), 1, columns, columns);
}

std::vector<Point> border_of(const InflatedRubber& pad) {
  std::vector<Point> border;
  for (int k = 0; k < columns; ++k) {
    border.push_back({pad.radius_mm * std::cos(angle(k)), pad.radius_mm * std::sin(angle(k)), 0});
  }
  return border;
}

/// Side dots of a pad with a small shear along its rim, shear(angle).
template <class Shear>
std::vector<Point> dots_of(const InflatedRubber& pad,
                           const std::vector<InflatedRubber::Place>& profile,
                           const Shear& shear) {
  const auto at = InflatedRubber::near_rim(profile, arc_mm);
  const double turn = pad.turn(profile, 1e-3, arc_mm) / 1e-3;
  std::vector<Point> dots;
  for (int k = 0; k < columns; ++k) {
    const double to = angle(k) + turn * shear(angle(k));
    dots.push_back({at.r * std::cos(to), at.r * std::sin(to), at.z});
  }
  return dots;
}

struct Found {
  RimFit<double> fit;
  double moment_error = 0;       ///< of M_z
  double neo_hookean_error = 0;  ///< of M_z, for the neo-Hookean assumption
};

double inclination_of(const InflatedRubber& pad) {
  return 2 * std::atan(pad.height_mm / pad.radius_mm);
}

/// Calibrates by four pressures, then twists the rim. A drag has no closed form, because load that
/// varies along the rim is partly carried there (tests/accuracy/wrench_of_another_rubber.cpp).
Found found_of(InflatedRubber pad, double pressure_scale = 1) {
  const auto border = border_of(pad);
  RimCalibration<> calibration(grid_of(border), pad.radius_mm, inclination_of(pad));
  std::size_t level = 0;
  std::vector<InflatedRubber::Place> profile;
  for (const double kpa : {8.0, 12.0, 16.0, 20.0}) {
    pad.pressure_mpa = kpa / 1000 * pressure_scale;
    profile = pad.profile();
    const auto dots = dots_of(pad, profile, [](double) { return 0.0; });
    REQUIRE(calibration.add(level++, grid_of(dots), pad.pressure_mpa, profile.front().z));
  }
  Found found;
  found.fit = calibration.fit({.stress_free_height_mm = pad.height_mm});

  WrenchOptions<double> options{.base_radius_mm = pad.radius_mm,
                                .stress_free_inclination_rad = inclination_of(pad),
                                .mooney_share = found.fit.mooney_share,
                                .modulus_n_per_mm = found.fit.modulus_n_per_mm};
  const auto& rim = profile.back();
  const double shear = 0.03;
  const double pull = pad.modulus_n_per_mm * pad.shear_pull(rim.stretch, 1, shear);
  const auto turned = dots_of(pad, profile, [&](double) { return shear; });
  const auto felt = [&] {
    Wrench<> wrench(grid_of(border), found.fit, options);
    return wrench.by_modulus(grid_of(turned), pad.pressure_mpa);
  };
  const auto twist = felt();
  options.mooney_share = 0;
  const auto other = felt();
  REQUIRE(other.ok());
  REQUIRE(twist.ok());
  const double radius = pad.radius_mm;
  const double moment = pull * 2 * std::numbers::pi * radius * radius;
  found.moment_error = twist.moment_n_mm.z / moment - 1;
  found.neo_hookean_error = other.moment_n_mm.z / moment - 1;
  return found;
}

}  // namespace

TEST_CASE("rim calibration: the rubber is found from the apex at several pressures", "[wrench]") {
  InflatedRubber small;
  small.radius_mm = 12;
  small.height_mm = 6;
  small.modulus_n_per_mm = 0.2;
  const auto check = [](InflatedRubber pad, double per_first, double pressure_scale) {
    pad.mooney_share = per_first / (1 + per_first);
    const Found found = found_of(pad, pressure_scale);
    CAPTURE(pad.radius_mm, pad.mooney_share, found.fit.mooney_share, found.fit.modulus_n_per_mm,
            found.fit.length_mm, found.fit.apex_residual_mm, found.moment_error,
            found.neo_hookean_error);
    CHECK(found.fit.modulus_n_per_mm == Approx(pad.modulus_n_per_mm).epsilon(0.003));
    CHECK(found.fit.mooney_share == Approx(pad.mooney_share).margin(0.05));
    CHECK(std::abs(found.moment_error) < 0.01);
    CHECK(found.neo_hookean_error > 0.12 * pad.mooney_share - 0.003);
  };
  check({}, 0, 1);  // C2 / C1
  check({}, 0.5, 1);
  check({}, 1, 1);
  check(small, 1, 0.5);
}

TEST_CASE("rim calibration: what the apex says of the rubber, and what it does not", "[wrench]") {
  InflatedRubber pad;
  pad.mooney_share = 0.3;
  const auto profile = pad.profile();
  const auto border = border_of(pad);
  const auto dots = dots_of(pad, profile, [](double) { return 0.0; });
  const auto share_of = [&](double apex_mm, const RimFitOptions& options) {
    RimCalibration<> calibration(grid_of(border), pad.radius_mm, inclination_of(pad));
    REQUIRE(calibration.add(0, grid_of(dots), pad.pressure_mpa, apex_mm));
    return calibration.fit_modulus(0.7997, options);
  };
  const double apex = profile.front().z;
  const auto fit = share_of(apex, {.apex_noise_mm = 0.01, .stress_free_height_mm = 11});
  CHECK(fit.mooney_share == Approx(0.3).margin(0.02));
  // 0.19 mm for the whole range of m
  CHECK(fit.mooney_share_sd == Approx(0.01 / 0.188).epsilon(0.1));
  const auto higher = share_of(apex + 0.01, {.stress_free_height_mm = 11});
  CHECK(fit.mooney_share - higher.mooney_share == Approx(fit.mooney_share_sd).epsilon(0.1));
  // out of range: on its border, with a residual
  CHECK(share_of(apex + 0.3, {.stress_free_height_mm = 11}).mooney_share == 0);
  CHECK(share_of(apex + 0.3, {.stress_free_height_mm = 11}).apex_residual_mm > 0.2);
  CHECK(share_of(apex, {}).mooney_share == 0);  // not requested
  CHECK(test::refusal([&] { (void)share_of(none, {.stress_free_height_mm = 11}); }) ==
        "RimCalibration: levels with an apex height = 0, must be >= 1 if m is fitted");
  CHECK(
      test::begins_with(test::refusal([&] { (void)share_of(apex, {.stress_free_height_mm = -1}); }),
                        "RimFitOptions: stress_free_height_mm = -1"));
}

TEST_CASE("rim calibration: the rubber does not depend on the unit of length", "[wrench]") {
  InflatedRubber pad;
  pad.mooney_share = 0.3;
  const auto profile = pad.profile();
  // the height without pressure: 11, 1.1 and 0.55
  const auto fit_in = [&](double unit) {
    const auto scaled = [&](std::vector<Point> points) {
      for (Point& p : points) {
        p = unit * p;
      }
      return points;
    };
    const auto border = scaled(border_of(pad));
    const auto dots = scaled(dots_of(pad, profile, [](double) { return 0.0; }));
    RimCalibration<> calibration(grid_of(border), unit * pad.radius_mm, inclination_of(pad));
    REQUIRE(calibration.add(0, grid_of(dots), pad.pressure_mpa, unit * profile.front().z));
    return calibration.fit_modulus(unit * 0.7997, {.stress_free_height_mm = unit * pad.height_mm});
  };
  const auto fit = fit_in(1);
  for (const double unit : {0.1, 0.05}) {
    CAPTURE(unit);
    const auto other = fit_in(unit);
    CHECK(other.mooney_share == Approx(fit.mooney_share).epsilon(1e-6));
    CHECK(other.modulus_n_per_mm == Approx(unit * fit.modulus_n_per_mm).epsilon(1e-6));
  }
}
