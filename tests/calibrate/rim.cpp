// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The membrane's modulus, from apexes of inflated caps whose truth follows from the energy alone
// (tests/support/inflated_rubber.hpp).
#include "fingerpad/calibrate/rim.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/digest.hpp"
#include "support/generators.hpp"
#include "support/inflated_rubber.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"
#include "support/rim_marks.hpp"

using namespace fingerpad;
using test::InflatedRubber;

namespace {

const std::vector<double> four_pressures = {0.008, 0.012, 0.016, 0.020};

std::vector<FreeApex> apexes_of(InflatedRubber pad,
                                const std::vector<double>& pressures,
                                double sd_mm = 1e-3) {
  std::vector<FreeApex> apexes;
  for (const double pressure_mpa : pressures) {
    pad.pressure_mpa = pressure_mpa;
    apexes.push_back({pressure_mpa, pad.profile().front().z, sd_mm});
  }
  return apexes;
}

StressFreeCap<double> cap_of(const InflatedRubber& pad) {
  return {pad.radius_mm, pad.height_mm, pad.mooney_share};
}

}  // namespace

TEST_CASE("rim calibration: modulus and height from the apex at four pressures", "[wrench]") {
  InflatedRubber small{.mooney_share = 0.3, .modulus_n_per_mm = 0.2, .radius_mm = 12};
  small.height_mm = 6;
  for (const InflatedRubber& pad : {InflatedRubber{}, small}) {
    std::vector<double> pressures = four_pressures;
    for (double& mpa : pressures) {
      mpa *= pad.modulus_n_per_mm / 0.5 * 18.735 / pad.radius_mm;
    }
    auto given = cap_of(pad);
    given.height_mm += 0.1;
    const auto fit = fit_rim(given, apexes_of(pad, pressures), {.radius_sd_mm = 0});
    CAPTURE(pad.radius_mm, fit.cause);
    CHECK(fit.ok());
    CHECK(fit.modulus_n_per_mm == Approx(pad.modulus_n_per_mm).epsilon(0.003));
    CHECK(fit.height_mm == Approx(pad.height_mm).margin(0.005));
    CHECK(fit.residual_mm < 1e-3);
  }
}

TEST_CASE("rim calibration: what it costs if the radius or the rubber is not known", "[wrench]") {
  InflatedRubber pad;
  auto cap = cap_of(pad);
  cap.base_radius_mm += 0.05;
  CHECK(fit_rim(cap, apexes_of(pad, four_pressures)).modulus_n_per_mm == Approx(0.5).epsilon(0.01));
  pad.mooney_share = 0.3;
  const auto apexes = apexes_of(pad, four_pressures);
  const auto found = fit_rim(cap_of({}), apexes, {.height_sd_mm = 0.02, .mooney_sd = 0.3});
  CHECK(found.modulus_n_per_mm == Approx(0.5).epsilon(0.02));
  CHECK(found.mooney_share == Approx(0.3).margin(0.1));
  const double neo_hookean = fit_rim(cap_of({}), apexes).modulus_n_per_mm;
  CHECK(neo_hookean > 1.03 * 0.5);
}

TEST_CASE("rim calibration: its standard deviation holds", "[wrench][figures]") {
  const auto exact = apexes_of({}, four_pressures, 0.005);
  test::Random random(5);
  int within = 0;
  for (int draw = 0; draw < 20; ++draw) {
    auto apexes = exact;
    auto cap = cap_of({});
    cap.height_mm += 0.1 * random.normal();
    cap.base_radius_mm += 0.02 * random.normal();
    for (FreeApex& a : apexes) {
      a.apex_mm += a.sd_mm * random.normal();
      a.pressure_mpa *= 1 + 0.002 * random.normal();
    }
    const auto fit = fit_rim(cap, apexes);
    within += std::fabs(fit.modulus_n_per_mm - 0.5) < 2 * fit.modulus_sd_n_per_mm ? 1 : 0;
  }
  CHECK(within >= 17);
}

TEST_CASE("rim calibration: a single pressure is doubtful, and how much", "[wrench]") {
  const auto fit = fit_rim(cap_of({}), apexes_of({}, {0.016}));
  CHECK(fit.cause == cause::one_pressure);
  CHECK(fit.modulus_n_per_mm == Approx(0.5).epsilon(0.01));
  // 0.1 mm of the stress-free height
  CHECK(fit.modulus_sd_n_per_mm > 0.03 * 0.5);
  const auto several = fit_rim(cap_of({}), apexes_of({}, four_pressures));
  CHECK(several.modulus_sd_n_per_mm < 0.01 * 0.5);
}

TEST_CASE("rim calibration: what cannot be is refused or doubted", "[wrench]") {
  const auto said = [](std::vector<FreeApex> apexes, const RimFitOptions& options = {}) {
    return test::refusal([&] { (void)fit_rim({}, apexes, options); });
  };
  CHECK(said({}) == "fit_rim: apexes = 0, must be >= 1");
  CHECK(said({{-0.01, 13}}) == "fit_rim: pressure_mpa = -0.01, must be finite and > 0");
  CHECK(said({{0.01, -13}}) == "fit_rim: apex_mm = -13, must be finite and > 0");
  CHECK(said({{0.01, 13}}, {.height_sd_mm = -1}) ==
        "RimFitOptions: height_sd_mm = -1, must be finite and >= 0");
  auto apexes = apexes_of({}, four_pressures);
  apexes[2].apex_mm += 0.2;
  CHECK(fit_rim(cap_of({}), apexes).cause == cause::no_such_cap);
}

namespace {

/// What the free pictures of a scene say, by the first `pressures` of them, with this noise of the
/// mean of their frames, seen by a camera whose axis is off the pad's.
UnevenFit uneven_fit(const test::UnevenScene& s,
                     double noise_px,
                     std::size_t pressures,
                     std::uint64_t seed,
                     const Point2<double>& axis_px = {0, 0}) {
  test::Random random(seed);
  std::vector<std::vector<Point2<double>>> px(pressures);
  std::vector<FreeDots> pictures;
  for (std::size_t k = 0; k < pressures; ++k) {
    for (const auto& dot : s.scene.frames[k].dots_mm) {
      px[k].push_back(pixel_of(s.scene.camera(), dot) + axis_px +
                      noise_px * Point2<double>{random.normal(), random.normal()});
    }
    pictures.push_back({s.scene.frames[k].pressure_mpa, px[k]});
  }
  WrenchOptions options;
  options.cap = s.scene.cap;
  options.modulus_n_per_mm = s.scene.modulus_n_per_mm;
  return fit_uneven(s.scene.camera(), options, pictures);
}

/// How far off the truth along and across the direction in which it is thicker.
Point2<double> along_and_across(const Point2<double>& share) {
  const double c = std::cos(0.6), s = std::sin(0.6);
  return {c * share.x + s * share.y, c * share.y - s * share.x};
}

}  // namespace

TEST_CASE("rim calibration: free pictures show where the membrane is thicker", "[wrench]") {
  for (const test::UnevenScene& s : test::uneven_scenes()) {
    const auto found = [&](const UnevenFit& fit) {
      REQUIRE(fit.ok());
      return along_and_across(fit.share);
    };
    const UnevenFit without_noise = uneven_fit(s, 0, 4, 1);
    const auto exact = found(without_noise);
    CAPTURE(s.scene.name, exact.x, exact.y);
    // what grows is told to 3 %; what stays is taken for more that grows
    CHECK(std::fabs(exact.x - s.share) < (s.grows ? 0.03 * s.share + 1e-4 : 0.15 * s.share));
    CHECK(std::fabs(exact.y) < 5e-4);
    if (&s != &test::uneven_scenes()[1]) {
      continue;
    }
    const auto beside = uneven_fit(s, 0, 4, 1, {2, -1});
    CHECK(norm(found(beside) - exact) < 2e-3);
    CHECK(norm(beside.axis_px - without_noise.axis_px - Point2<double>{2, -1}) < 0.05);
    double sum_sq = 0, sd = 0;
    constexpr int draws = 4;
    for (int draw = 0; draw < draws; ++draw) {  // 16 frames with .06 px at each pressure
      const auto fit = uneven_fit(s, 0.015, 4, static_cast<std::uint64_t>(draw));
      sum_sq += squared_norm(found(fit) - exact) / (2 * draws);
      sd += fit.share_sd / draws;
    }
    CAPTURE(std::sqrt(sum_sq), sd);
    CHECK(sd < 0.002);
    CHECK(std::sqrt(sum_sq) < 2 * sd);
  }
}

TEST_CASE("rim calibration: what no free pictures can show is refused or doubted", "[wrench]") {
  test::UnevenScene s = test::uneven_scenes()[1];
  s.scene.frames[1] = s.scene.frames[0];
  CHECK(uneven_fit(s, 0.015, 2, 1).cause == cause::one_pressure);
  for (auto& frame : s.scene.frames) {
    frame.dots_mm.resize(15);
  }
  CHECK_FALSE(uneven_fit(s, 0.015, 4, 1).ok());
  CHECK(test::refusal([&] { (void)uneven_fit(s, 0, 1, 1); }) ==
        "fit_uneven: pictures = 1, must be >= 2");
  s.scene.frames[1].dots_mm.resize(10);
  CHECK(test::refusal([&] { (void)uneven_fit(s, 0, 4, 1); }) ==
        "fit_uneven: dots of a picture = 10, must be of all");
}

TEST_CASE("unchanged: the membrane of noisy apexes", "[unchanged]") {
  test::Digest d;
  test::Random random(8);
  for (const double mooney_sd : {0.0, 0.3}) {
    auto apexes = apexes_of({}, four_pressures, 0.005);
    for (FreeApex& a : apexes) {
      a.apex_mm += a.sd_mm * random.normal();
    }
    const auto fit = fit_rim(cap_of({}), apexes, {.height_sd_mm = 0.05, .mooney_sd = mooney_sd});
    d.all(fit.modulus_n_per_mm, fit.modulus_sd_n_per_mm, fit.height_mm, fit.height_sd_mm,
          fit.mooney_share, fit.mooney_sd, fit.residual_mm);
  }
  CHECK(d.sum() == test::same(313.230));
}
