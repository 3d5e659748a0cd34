// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/calibrate/depth.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/digest.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::refusal;

namespace {

/// A sensor whose fluid and light are known.
struct Sensor {
  Camera<double> camera;
  Absorption<double> fluid;
  double brightness = 57;
  std::vector<double> g = {0.0163};  // of 1, and if there, of (x, y, x^2, x y, y^2) / 20 mm
  double ramp = 0;                   // of kappa over x / 20 mm

  double g_at(const Point2<double>& at) const {
    const double x = at.x / 20, y = at.y / 20;
    const double m[] = {1, x, y, x * x, x * y, y * y};
    return std::inner_product(g.begin(), g.end(), m, 0.0);
  }
  DepthSample<double> sample(double row, double col, double depth_mm) const {
    auto s = depth_sample(camera, row, col, depth_mm, Colour<double>{});
    Absorption<double> here = fluid;
    here.kappa *= 1 + ramp * s.plate_mm.x / 20;
    s.colour = colour_at_depth(here, s.ray, brightness, g_at(s.plate_mm), depth_mm);
    return s;
  }
};

Sensor random_sensor() {
  Sensor sensor;
  sensor.camera.plate_distance_mm = test::uniform(30, 80);
  sensor.fluid.c_red_per_mm = test::log_uniform(0.015, 0.06);
  sensor.fluid.c_green_per_mm = sensor.fluid.c_red_per_mm + test::uniform(0, 0.02);
  sensor.fluid.kappa = test::log_uniform(0.5, 2);
  sensor.brightness = test::uniform(40, 200);
  sensor.g = {test::log_uniform(0.3, 3) * 3 * sensor.brightness /
              (sensor.camera.plate_distance_mm * sensor.camera.plate_distance_mm)};
  return sensor;
}

using Samples = std::vector<DepthSample<double>>;

Samples samples_on_axis(const Sensor& sensor, int count) {
  Samples samples;
  for (int i = 0; i < count; ++i) {
    samples.push_back(sensor.sample(239.5, 319.5, 0.3 + 12.0 * i / (count - 1)));
  }
  return samples;
}

void add_noise(Samples& samples, double sd, std::mt19937& random) {
  std::normal_distribution<double> noise(0, sd);
  for (auto& s : samples) {
    s.colour.red += noise(random);
    s.colour.green += noise(random);
  }
}

/// Depth of these colours by a fitted model, by bisection on F.
template <class Fit>
double depth_of(const Fit& fit, const DepthSample<double>& s) {
  double low = -1, high = 20;
  for (int k = 0; k < 60; ++k) {
    const double l = (low + high) / 2;
    const double g = fit.light.scattering.at(s.plate_mm);
    (l > 0 && depth_equation(fit.fluid, s.ray, g, s.colour, l).first > 0 ? high : low) = l;
  }
  return low;
}

}  // namespace

TEST_CASE("dW/dc is the derivative of W") {
  using test::Digits50;
  rc::prop("against differences in fifty digits", [] {
    const double l = test::log_uniform(1e-4, 15), c = test::log_uniform(1e-6, 1);
    const double k = test::uniform(2, 2.5), h = test::uniform(20, 100);
    const Ray<Digits50> wide{
        .path_factor = Digits50(k), .meridional_mm = Digits50(h), .sagittal_mm = Digits50(h - 3)};
    const auto w = [&](const Digits50& x) { return scattered_light(Digits50(l), x, wide); };
    const Digits50 truth = test::slope_by_difference(w, Digits50(c), Digits50(c * 1e-15));
    const double slope = detail::scattered_light_per_absorption(
        l, c, Ray<double>{.path_factor = k, .meridional_mm = h, .sagittal_mm = h - 3});
    const double scale = static_cast<double>(w(Digits50(c))) / c;
    RC_ASSERT(std::abs(slope - static_cast<double>(truth)) < 1e-14 * scale * (1 + c * k * l));
  });
}

TEST_CASE("calibration of depth: noise-free colours give the fluid back") {
  rc::prop("random sensors", [] {
    const Sensor sensor = random_sensor();
    const Samples samples = samples_on_axis(sensor, 5 + static_cast<int>(test::whole(0, 11)));
    const auto fit = fit_absorption<0, double>(samples);
    const double roundoff = 100 * fit.condition * epsilon<double>();
    RC_ASSERT(fit.ok());
    RC_ASSERT(test::relative_error(fit.fluid.c_red_per_mm, sensor.fluid.c_red_per_mm) < roundoff);
    RC_ASSERT(test::relative_error(fit.fluid.kappa, sensor.fluid.kappa) < roundoff);
    RC_ASSERT(test::relative_error(fit.light.scattering.coefficient[0], sensor.g[0]) < roundoff);
    RC_ASSERT(std::abs(fit.fluid.c_green_per_mm - sensor.fluid.c_green_per_mm) <
              roundoff * sensor.fluid.c_green_per_mm);
    RC_ASSERT(fit.residual_rms < 1e-12 * sensor.brightness);
  });
}

TEST_CASE("calibration of depth: light that varies over the plate") {
  Sensor sensor;
  sensor.g = {0.0163, 0.002, -0.001, -0.004, 0.001, 0.0005};
  sensor.ramp = 0.03;
  Samples samples;
  for (int k = 0; k < 175; ++k) {  // three of the depths at each place
    samples.push_back(
        sensor.sample(90 + 12 * (k / 7 % 25), 170 + 50 * (k % 7), 0.5 + 2.3 * (k % 6)));
  }
  for (std::size_t k = 0; k < samples.size(); ++k) {  // red is blurred more than green
    samples[k].green_laplacian = 9 * std::sin(double(k));
    samples[k].colour.green -= 0.125 * samples[k].green_laplacian;
  }
  const auto fit = fit_absorption<2, double>(samples);
  CHECK(fit.ok());
  CHECK(fit.red_blur == Approx(0.125).epsilon(1e-6));
  CHECK(fit.fluid.c_red_per_mm == Approx(0.029).epsilon(1e-8));
  for (const auto& s : samples) {
    CHECK(fit.light.scattering.at(s.plate_mm) == Approx(sensor.g_at(s.plate_mm)).epsilon(1e-8));
    CHECK(fit.light.kappa.at(s.plate_mm) ==
          Approx(sensor.fluid.kappa * (1 + 0.03 * s.plate_mm.x / 20)).epsilon(1e-8));
    CHECK(std::abs(fit.error_mm(s)) < 1e-8);
  }
  auto misplaced = samples[3];
  misplaced.depth_mm += 0.01;
  CHECK(fit.error_mm(misplaced) == Approx(-0.01).epsilon(0.01));
}

TEST_CASE("calibration of depth: brighter light and longer numbers change only what they must") {
  std::mt19937 random(7);
  const Sensor sensor;
  Samples samples = samples_on_axis(sensor, 20);
  add_noise(samples, 0.02, random);
  const auto fit = fit_absorption<0, double>(samples);
  Samples brighter = samples;
  for (auto& s : brighter) {
    s.colour = {2 * s.colour.red, 2 * s.colour.green};
  }
  const auto twice = fit_absorption<0, double>(brighter);
  CHECK(twice.fluid.c_red_per_mm == fit.fluid.c_red_per_mm);
  CHECK(twice.fluid.c_green_per_mm == fit.fluid.c_green_per_mm);
  CHECK(twice.fluid.kappa == fit.fluid.kappa);
  CHECK(twice.light.scattering.coefficient[0] == 2 * fit.light.scattering.coefficient[0]);
  CHECK(twice.covariance[0][0] == fit.covariance[0][0]);
  CHECK(twice.residual_rms == 2 * fit.residual_rms);

  std::vector<DepthSample<long double>> wide;
  for (const auto& s : samples) {
    using L = long double;
    wide.push_back({{.path_factor = L(s.ray.path_factor),
                     .meridional_mm = L(s.ray.meridional_mm),
                     .sagittal_mm = L(s.ray.sagittal_mm)},
                    {L(s.plate_mm.x), L(s.plate_mm.y)},
                    L(s.depth_mm),
                    {L(s.colour.red), L(s.colour.green)}});
  }
  const auto longer = fit_absorption<0, long double>(wide);
  CHECK(static_cast<double>(longer.fluid.c_red_per_mm) ==
        Approx(fit.fluid.c_red_per_mm).epsilon(1e-6));
}

TEST_CASE("calibration of depth: errors compensate to microns of depth, as predicted",
          "[figures]") {
  const Sensor sensor;
  constexpr int trials = 200;
  std::mt19937 random(11);
  const std::array<double, 3> depths = {2, 6, 11};
  std::array<double, 3> error_sq = {}, predicted_sq = {};
  double kappa_sq = 0, kappa_predicted_sq = 0;
  for (int t = 0; t < trials; ++t) {
    Samples samples = samples_on_axis(sensor, 60);
    add_noise(samples, 0.034, random);
    const auto fit = fit_absorption<0, double>(samples);
    for (std::size_t k = 0; k < depths.size(); ++k) {
      const auto s = sensor.sample(239.5, 319.5, depths[k]);
      error_sq[k] += square(depth_of(fit, s) - depths[k]);
      predicted_sq[k] += square(predicted_depth_sd(fit, s));
    }
    kappa_sq += square(fit.fluid.kappa - sensor.fluid.kappa);
    kappa_predicted_sq += fit.covariance[2][2];
  }
  for (std::size_t k = 0; k < depths.size(); ++k) {
    const double error = std::sqrt(error_sq[k] / trials);
    const double predicted = std::sqrt(predicted_sq[k] / trials);
    CAPTURE(depths[k], error, predicted);
    CHECK(error < 0.010);
    CHECK(error / predicted > 0.7);
    CHECK(error / predicted < 1.4);
  }
  CAPTURE(kappa_sq, kappa_predicted_sq);
  CHECK(std::sqrt(kappa_sq / kappa_predicted_sq) == Approx(1).margin(0.3));
}

TEST_CASE("calibration of depth: covariance against Monte Carlo where the noise is small") {
  const Sensor sensor;
  constexpr int trials = 300;
  constexpr double noise = 1e-4;
  std::mt19937 random(5);
  const Samples exact = samples_on_axis(sensor, 12);
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero(), stated = scatter;
  for (int t = 0; t < trials; ++t) {
    Samples samples = exact;
    add_noise(samples, noise, random);
    const auto fit = fit_absorption<0, double>(samples);
    for (Index i = 0; i < 16; ++i) {
      stated(i / 4, i % 4) += fit.covariance[std::size_t(i / 4)][std::size_t(i % 4)] / trials;
    }
    Eigen::Vector4d off(fit.fluid.c_red_per_mm, 0, fit.fluid.kappa,
                        fit.light.scattering.coefficient[0]);
    off(1) = fit.fluid.c_green_per_mm - fit.fluid.c_red_per_mm;
    off -= Eigen::Vector4d(0.029, 0.0046, sensor.fluid.kappa, 0.0163);
    scatter += off * off.transpose() / trials;
  }
  for (Index i = 0; i < 4; ++i) {
    CAPTURE(i);
    CHECK(std::sqrt(scatter(i, i) / stated(i, i)) == Approx(1).margin(0.15));
  }
  const double correlation = stated(0, 1) / std::sqrt(stated(0, 0) * stated(1, 1));
  const double seen = scatter(0, 1) / std::sqrt(scatter(0, 0) * scatter(1, 1));
  CHECK(seen == Approx(correlation).margin(0.02));
}

TEST_CASE("calibration of depth: a difference of absorption below 0 is held at 0") {
  Sensor sensor;
  sensor.fluid.c_green_per_mm = 0.0285;  // such a fluid is refused, but colours can look like it
  const auto fit = fit_absorption<0, double>(samples_on_axis(sensor, 12));
  CHECK(fit.delta_at_limit);
  CHECK(fit.fluid.c_green_per_mm == fit.fluid.c_red_per_mm);
  CHECK(fit.ok());
  CHECK(fit.residual_rms > 0);
}

TEST_CASE("calibration of depth: degenerate samples are refused, saying what is lacking") {
  const Sensor sensor;
  const auto fit = [](const Samples& samples) {
    return refusal([&] { (void)fit_absorption<0, double>(samples); });
  };
  const auto at = [&](const std::vector<double>& depths) {
    Samples samples;
    for (const double l : depths) {
      samples.push_back(sensor.sample(239.5, 319.5, l));
    }
    return samples;
  };
  CHECK(fit({}).find("number of samples = 0, must be at least") != std::string::npos);
  CHECK(fit(at({1, 5, 9})).find("number of samples = 3, must be at least") != std::string::npos);
  CHECK(fit(at({4, 4, 4, 4, 4})).find("distinct depths = 1, must be >= 3") != std::string::npos);
  CHECK(fit(at({4, 4, 8, 8, 4})).find("distinct depths = 2, must be >= 3") != std::string::npos);
  CHECK(fit(at({0, 0, 0, 0})).find("distinct depths = 1, must be >= 3") != std::string::npos);
  CHECK(fit(at({4, 8, 12, 12})).find("condition number = ") != std::string::npos);
  CHECK(fit(at({0, 1e-5, 2e-5, 3e-5})) != "accepted");
  CHECK(fit(at({0, 4, 8, 12})) == "accepted");
  for (const double bad : {std::nan(""), -1.0, HUGE_VAL}) {
    Samples samples = at({0.5, 4, 8, 12});
    samples[1].depth_mm = bad;
    CHECK(fit(samples).find("depth_mm = ") != std::string::npos);
    samples = at({0.5, 4, 8, 12});
    samples[2].colour.red = bad;
    CHECK(fit(samples).find("colour.red = ") != std::string::npos);
    samples = at({0.5, 4, 8, 12});
    samples[2].colour.green = bad;
    CHECK(fit(samples).find("colour.green = ") != std::string::npos);
  }
  for (double Colour<double>::*channel : {&Colour<double>::red, &Colour<double>::green}) {
    Samples samples = at({0.5, 4, 8, 12});
    samples[2].colour.*channel = 0;
    CHECK(fit(samples).find("= 0, must be finite and > 0") != std::string::npos);
  }
  Samples swapped = at({0.5, 4, 8, 12});
  for (auto& s : swapped) {
    std::swap(s.colour.red, s.colour.green);
  }
  CHECK(fit(swapped) != "accepted");
  const auto at_one_place = at({0.5, 2, 3, 4, 5, 6, 7, 8, 10});
  CHECK(refusal([&] {
          (void)fit_absorption<1, double>(at_one_place);
        }).find("differ at every place") != std::string::npos);
  const auto unknown = fit_absorption<0, double>(at({0.5, 4, 8, 12}));
  CHECK(std::isnan(unknown.covariance[0][0]));  // no residual to estimate the noise from
}

TEST_CASE("calibration of depth: errors of g's coefficients count by the place") {
  const Sensor sensor;
  const auto at = sensor.sample(100, 150, 5);
  const auto sd_from = [&](std::size_t coefficient) {
    AbsorptionFit<double, 2> fit;
    fit.fluid = sensor.fluid;
    fit.light.kappa.coefficient[0] = sensor.fluid.kappa;
    fit.light.scattering.coefficient = {sensor.g[0], 0.001, 0.0005, 0, 0.001, 0};
    fit.light.scattering.scale_mm = fit.light.kappa.scale_mm = 20;
    fit.covariance[5 + coefficient][5 + coefficient] = 1e-8;
    return predicted_depth_sd(fit, at);
  };
  const double x = at.plate_mm.x / 20, y = at.plate_mm.y / 20;
  REQUIRE((x < -0.1 && y < -0.1 && x != y));
  CHECK(sd_from(1) == Approx(-x * sd_from(0)).epsilon(1e-12));
  CHECK(sd_from(4) == Approx(x * y * sd_from(0)).epsilon(1e-12));
}

TEST_CASE("unchanged: fluid and light of noisy colours", "[unchanged]") {
  Sensor sensor;
  sensor.g = {0.0163, 0.002, -0.001, -0.004, 0.001, 0.0005};
  sensor.ramp = 0.03;
  Samples samples;
  for (int k = 0; k < 175; ++k) {
    samples.push_back(
        sensor.sample(90 + 12 * (k / 7 % 25), 170 + 50 * (k % 7), 0.5 + 2.3 * (k % 6)));
    samples.back().green_laplacian = 9 * std::sin(k);
  }
  std::mt19937 random(4);
  add_noise(samples, 0.1, random);
  samples[20].colour.red += 5;
  test::Digest d;
  const auto add = [&](const auto& fit, const Samples& of) {
    d.all(fit.fluid.c_red_per_mm, fit.fluid.c_green_per_mm, fit.fluid.kappa, fit.red_blur,
          fit.condition, fit.residual_rms, fit.explained, fit.delta_at_limit);
    for (std::size_t k = 0; k < fit.covariance.size(); ++k) {
      d.all(fit.covariance[k][k], fit.covariance[k][0]);
    }
    for (const auto& s : of) {
      d.all(fit.error_mm(s), fit.light.scattering.at(s.plate_mm), fit.light.kappa.at(s.plate_mm));
    }
  };
  add(fit_absorption<2, double>(samples), samples);
  Samples on_axis = samples_on_axis({}, 15);
  add_noise(on_axis, 0.1, random);
  add(fit_absorption<0, double>(on_axis), on_axis);
  CHECK(d.sum() == test::same(13010.856));
}
