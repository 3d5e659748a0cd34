// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/calibrate/neighbour_light.hpp"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "fingerpad/adapt/eigen.hpp"
#include "support/catch.hpp"
#include "support/digest.hpp"
#include "support/generators.hpp"

using namespace fingerpad;

namespace {

using Map = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Frames = std::vector<Map>;
constexpr double pitch_mm = 0.2;

Map membrane(double pressed_mm, double shift_mm) {
  Map l(64, 80);
  for (Index i = 0; i < 64; ++i) {
    for (Index j = 0; j < 80; ++j) {
      const double x = pitch_mm * (static_cast<double>(j) - 40),
                   y = pitch_mm * (static_cast<double>(i) - 32);
      const double cap = 8 - 0.08 * (x * x + y * y);
      const double plate = 8 - pressed_mm + 0.1 * (x - shift_mm);
      l(i, j) = cap > 0 ? (std::min)(cap, plate) : std::nan("");
    }
  }
  return l;
}

/// True depths for this neighbouring light: l_true = l - m psi_sum by the sums of the compensation.
Frames truths(const NeighbourLight<double>& light, const Map& reference, const Frames& measured) {
  Frames truth;
  NeighbourLightCompensation<double> sums(light, pitch_mm, reference);
  Map psi_sum_rad(reference.rows(), reference.cols());
  for (const Map& l : measured) {
    truth.push_back(l);
    REQUIRE(sums.inclination_sums(l, psi_sum_rad) == FrameStatus::ok);
    for (Index i = 0; i < l.rows(); ++i) {
      for (Index j = 0; j < l.cols(); ++j) {
        const double m =
            light.m0_mm_per_rad * std::exp(light.n_per_mm * (l(i, j) - reference(i, j)));
        truth.back()(i, j) -= m * psi_sum_rad(i, j);
      }
    }
  }
  return truth;
}

NeighbourLightFit<> fit_of(const Map& reference,
                           const Frames& measured,
                           const Frames& truth,
                           const std::array<Index, 2>& radii_px,
                           double pixel_aspect = 1) {
  return fit_neighbour_light(pitch_mm, reference, measured, truth, radii_px, pixel_aspect);
}

std::string refusal(const Map& reference, const Frames& measured, const Frames& truth) {
  try {
    (void)fit_of(reference, measured, truth, {3, 4});
  } catch (const parameter_error& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("calibration of neighbour light: noise-free frames give it back") {
  rc::prop("random light", [] {
    const NeighbourLight<double> light{test::whole(3, 9), test::uniform(0.0005, 0.002),
                                       test::uniform(-0.5, 0.5), *rc::gen::element(1.0, 1.25)};
    const Map reference = membrane(0, 0);
    const Frames measured = {membrane(1, 1), membrane(2.5, -2)};
    const auto fit = fit_of(reference, measured, truths(light, reference, measured), {1, 12},
                            light.pixel_aspect);
    RC_ASSERT(fit.light.radius_px == light.radius_px);
    RC_ASSERT(std::abs(fit.light.m0_mm_per_rad / light.m0_mm_per_rad - 1) < 1e-9);
    RC_ASSERT(std::abs(fit.light.n_per_mm - light.n_per_mm) < 1e-9);
    RC_ASSERT(fit.light.pixel_aspect == light.pixel_aspect);
    RC_ASSERT(fit.rms_after_mm < 1e-6 * fit.rms_before_mm);
    RC_ASSERT(fit.rms_of_radius_mm.size() == 12u);
    RC_ASSERT(fit.ok());
  });
}

TEST_CASE("calibration of neighbour light: the stated deviations are those of many fits") {
  const NeighbourLight<double> light{6, 0.001, 0.2};
  const Map reference = membrane(0, 0);
  const Frames measured = {membrane(1, 1), membrane(2.5, -2)};
  const Frames exact = truths(light, reference, measured);
  std::mt19937 random(9);
  std::normal_distribution<double> noise(0, 0.02);
  double m0_sq = 0, n_sq = 0;
  NeighbourLightFit<> fit{};
  constexpr int trials = 100;
  for (int t = 0; t < trials; ++t) {
    Frames truth = exact;
    for (Map& l : truth) {
      l = l.unaryExpr([&](double v) { return v + noise(random); });
    }
    fit = fit_of(reference, measured, truth, {6, 6});
    m0_sq += square(fit.light.m0_mm_per_rad - light.m0_mm_per_rad) / trials;
    n_sq += square(fit.light.n_per_mm - light.n_per_mm) / trials;
  }
  CHECK(std::sqrt(m0_sq) == Approx(fit.m0_sd).epsilon(0.25));
  CHECK(std::sqrt(n_sq) == Approx(fit.n_sd).epsilon(0.25));
  CHECK(fit.rms_after_mm == Approx(0.02).epsilon(0.05));
  CHECK(fit.rms_before_mm > fit.rms_after_mm);
}

TEST_CASE("calibration of neighbour light: degenerate frames are refused") {
  const Map reference = membrane(0, 0);
  const Frames pressed = {membrane(2, 0)};
  CHECK(refusal(reference, {reference}, {reference}).find("inclination change") !=
        std::string::npos);
  CHECK(refusal(reference, {}, {}).find("number of frames = 0") != std::string::npos);
  CHECK(refusal(reference, pressed, {}).find("number of frames") != std::string::npos);
  CHECK(refusal(reference, {Map::Ones(3, 3)}, {reference}).find("same size") != std::string::npos);
  CHECK(refusal(reference, {Map::Constant(64, 80, std::nan(""))}, {reference})
            .find("pixels with a reference") != std::string::npos);
  CHECK(refusal(reference, pressed, pressed).find("independent share of n") != std::string::npos);
  CHECK_THROWS_AS(fit_neighbour_light(0.0, reference, pressed, pressed), parameter_error);
  CHECK_THROWS_AS(fit_of(reference, pressed, pressed, {0, 5}), parameter_error);
  CHECK_THROWS_AS(fit_of(reference, pressed, pressed, {5, 4}), parameter_error);
  CHECK_THROWS_AS(fit_of(reference, pressed, pressed, {1, 5}, 20), parameter_error);
}

TEST_CASE("unchanged: neighbouring light of noisy depths", "[unchanged]") {
  const Map reference = membrane(0, 0);
  const Frames measured = {membrane(1, 1), membrane(2.5, -2)};
  Frames truth = truths({6, 0.001, 0.2}, reference, measured);
  std::mt19937 random(9);
  std::normal_distribution<double> noise(0, 0.02);
  for (Map& l : truth) {
    l = l.unaryExpr([&](double v) { return v + noise(random); });
  }
  const auto fit = fit_of(reference, measured, truth, {3, 9});
  test::Digest d;
  d.all(fit.light.radius_px, fit.light.m0_mm_per_rad, fit.light.n_per_mm, fit.rms_before_mm,
        fit.rms_after_mm, fit.m0_sd, fit.n_sd, fit.ok());
  for (const double rms : fit.rms_of_radius_mm) {
    d.add(rms);
  }
  CHECK(d.sum() == test::same(387.837));
}
