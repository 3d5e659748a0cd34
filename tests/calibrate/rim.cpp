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
