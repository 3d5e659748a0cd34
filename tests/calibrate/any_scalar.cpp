// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Every calibration that does not solve for the fluid (whose own tests do the same), in float and
// in dual numbers: the same result, and the derivatives of finite differences.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "fingerpad/adapt/dual.hpp"
#include "fingerpad/calibrate/contact.hpp"
#include "fingerpad/calibrate/foam.hpp"
#include "fingerpad/calibrate/intensity.hpp"
#include "fingerpad/calibrate/look_up.hpp"
#include "fingerpad/calibrate/neighbour_light.hpp"
#include "fingerpad/optics/orthographic_camera.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Image;
using test::Random;

namespace {

template <class S>
using Results = std::vector<S>;

/// Height of a bulging membrane, pressed or free.
double membrane_mm(Index i, Index j, double pressed_mm) {
  const double x = 0.2 * (static_cast<double>(j) - 24), y = 0.2 * (static_cast<double>(i) - 20);
  const double cap = 8 - 0.08 * (x * x + y * y);
  return std::fmin(cap, 8 - pressed_mm + 0.1 * x);
}

template <class S, class Cell>
Image<S> map_of(Index rows, Index cols, const Cell& cell) {
  Image<S> map(rows, cols, S(0));
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      map(i, j) = cell(i, j);
    }
  }
  return map;
}

/// m0 and n by the pitch between pixels: the excess of depth grows with the square of the press.
struct LightByPitch {
  template <class S>
  Results<S> operator()(const S& p) const {
    using Maps = std::vector<Image<double>>;
    const auto free = map_of<double>(40, 48, [](Index i, Index j) { return membrane_mm(i, j, 0); });
    Maps measured, truth;
    for (const double pressed_mm : {0.8, 1.6}) {
      measured.push_back(
          map_of<double>(40, 48, [&](Index i, Index j) { return membrane_mm(i, j, pressed_mm); }));
      truth.push_back(measured.back());
      for (Index k = 0; k < 40 * 48; ++k) {
        double& l = truth.back().cells[static_cast<std::size_t>(k)];
        const double off = free.cells[static_cast<std::size_t>(k)] - l;
        l += 0.02 * off * off;
      }
    }
    const auto fit = fit_neighbour_light<S>(S(0.2) * p, free, measured, truth, {3, 3});
    return {fit.light.m0_mm_per_rad, fit.light.n_per_mm, fit.rms_after_mm, fit.m0_sd};
  }
};

/// The law of a dark gel by the radius of the ball.
struct IntensityByBall {
  template <class S>
  Results<S> operator()(const S& p) const {
    const auto free = map_of<double>(70, 80, [](Index, Index) { return 150.0; });
    const auto pressed = map_of<double>(70, 80, [](Index i, Index j) {
      const double x = 0.1 * static_cast<double>(j) - 4.1, y = 0.1 * static_cast<double>(i) - 3.4;
      const double root_sq = 16 - x * x - y * y;
      const double depth = root_sq > 0 ? std::fmax(0.0, 1.2 - 4 + std::sqrt(root_sq)) : 0.0;
      return 150 * std::exp(-depth / 3);
    });
    const IntensityFit<S> fit =
        fit_intensity<S>(free, std::array{pressed}, S(4) * p, S(0.1), {.smoothing_px = 0});
    REQUIRE(fit.ok());
    return {fit.law.linear_mm, fit.max_depth_mm};
  }
};

/// Noise of an array with another gain of one taxel.
struct TaxelsByGain {
  template <class S>
  Results<S> operator()(const S& p) const {
    Random random(5);
    TaxelNoiseCalibration<S> calibration(3, 3);
    for (int t = 0; t < 160; ++t) {
      const auto readings = map_of<S>(3, 3, [&](Index i, Index j) {
        const S plain = S(50 + 2 * random.normal());
        return i == 1 && j == 1 ? S(p * plain) : plain;
      });
      REQUIRE(calibration.add(readings, t / 30.0));
    }
    const TaxelNoise<S> noise = calibration.fit();
    return {noise.typical, noise.deviations[4], noise.largest_factor, noise.centroid_deviation_mm};
  }
};

/// Curvature of a free pad by the pitch of its height map.
struct FreePadByPitch {
  template <class S>
  Results<S> operator()(const S& p) const {
    OrthographicCamera<S> plan;
    plan.pitch_mm = S(0.16) * p;
    std::vector<Image<S>> frames;
    Random random(7);
    for (int k = 0; k < 3; ++k) {
      frames.push_back(map_of<S>(40, 44, [&](Index i, Index j) {
        const double x = 0.16 * (static_cast<double>(j) - 22),
                     y = 0.16 * (static_cast<double>(i) - 20);
        return S(9 - 0.025 * (x * x + y * y) + 2e-4 * random.normal());
      }));
    }
    const auto pad = fit_contact_threshold<S>(plan, frames, 6);
    return {S(pad.threshold_per_mm), S(pad.median_per_mm), S(pad.noise_per_mm),
            S(pad.median_error_per_mm)};
  }
};

/// Largest relative difference of two lists.
template <class A, class B>
double furthest(const Results<A>& a, const Results<B>& b) {
  REQUIRE(a.size() == b.size());
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const auto x = static_cast<double>(value(a[k])), y = static_cast<double>(value(b[k]));
    most = std::fmax(most, std::abs(x - y) / std::fmax(1e-9, std::abs(y)));
    most = std::isfinite(x) ? most : 1e9;
  }
  return most;
}

template <class Calibration>
void check(const char* name, const Calibration& run, double float_error, bool moves = true) {
  CAPTURE(std::string(name));
  const Results<double> plain = run(1.0);
  CHECK(furthest(run(1.0F), plain) < float_error);
  const auto dual = run(seeded(std::array{1.0})[0]);
  CHECK(furthest(dual, plain) < 1e-9);
  constexpr double step = 1e-5;
  const Results<double> more = run(1 + step), less = run(1 - step);
  double largest = 0;
  for (std::size_t k = 0; k < plain.size(); ++k) {
    CAPTURE(k);
    const double slope = (more[k] - less[k]) / (2 * step);
    CHECK(dual[k].slopes[0] == Approx(slope).epsilon(1e-4).margin(1e-6 * std::abs(plain[k])));
    largest = std::fmax(largest, std::abs(slope) / std::abs(plain[k]));
  }
  CHECK((largest > 1e-3) == moves);
}

}  // namespace

TEST_CASE("calibrations: in float, and with derivatives") {
  check("neighbouring light", LightByPitch(), 2e-3);
  check("intensity", IntensityByBall(), 2e-2);
  check("noise of taxels", TaxelsByGain(), 1e-3);
  check("free pad", FreePadByPitch(), 2e-2);
}

TEST_CASE("a look-up's covariance is that which the forces' errors carry into its parameters",
          "[calibrate][force]") {
  constexpr int count = 10;
  using S = Dual<count>;
  std::vector<ForceSample<double>> plain(count);
  std::vector<ForceSample<S>> samples(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double m = 0.3 + 0.5 * static_cast<double>(k);
    plain[k].measure = m;
    plain[k].normal_force_n = m * (2 + 0.3 * m) + 0.05 * std::cos(5 * m);
    samples[k].measure = S(m);
    samples[k].normal_force_n = S::parameter(plain[k].normal_force_n, k);
  }
  const auto dual = fit_normal_force(std::span<const ForceSample<S>>(samples), 2, false);
  const auto fit = fit_normal_force(std::span<const ForceSample<double>>(plain), 2, false);
  for (std::size_t i = 0; i <= 2; ++i) {
    const auto& by_i = dual.curve.coefficients[i];
    CHECK(by_i.value == Approx(fit.curve.coefficients[i]).epsilon(1e-12));
    for (std::size_t j = 0; j <= 2; ++j) {
      const auto& by_j = dual.curve.coefficients[j];
      const double carried =
          std::inner_product(by_i.slopes.begin(), by_i.slopes.end(), by_j.slopes.begin(), 0.0);
      CHECK(fit.curve.covariance[i][j] ==
            Approx(square(fit.curve.residual_sd_n) * carried).epsilon(1e-9));
    }
  }
}
