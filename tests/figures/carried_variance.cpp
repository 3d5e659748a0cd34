// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Dependence of results on their calibration: derivatives by dual numbers against differences, and
// the propagated variance against calibrations repeated with fresh noise.
#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "fingerpad/adapt/dual.hpp"
#include "fingerpad/calibrate/look_up.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/catch.hpp"
#include "support/curves.hpp"
#include "support/pad.hpp"
#include "support/slipping_patch.hpp"

using namespace fingerpad;

namespace {

/// c_R, c_G, kappa, and the camera's distance, index, center (x, y) and pitch.
template <class S>
using Optics = std::array<S, 8>;

template <class S>
S depth_after_fit(const test::Pad& pad,
                  const test::Image<double>& shape,
                  const test::Frame<double>& frame,
                  const Colour<double>& seen,
                  Index row,
                  Index col,
                  const Optics<S>& p) {
  Absorption<S> fluid = cast<S>(pad.fluid);
  fluid.c_red_per_mm = p[0];
  fluid.c_green_per_mm = p[1];
  fluid.kappa = p[2];
  Camera<S> camera = cast<S>(pad.camera);
  camera.plate_distance_mm = p[3];
  camera.refractive_index = p[4];
  camera.center_x_px = p[5];
  camera.center_y_px = p[6];
  camera.pitch_mm = p[7];
  const auto reference = fit_reference<S>(camera, fluid, frame.red, frame.green, shape);
  const auto ray = ray_at_pixel(camera, S(static_cast<double>(row)), S(static_cast<double>(col)));
  return newton_depth(fluid, ray, reference.g(row, col), Colour<S>{S(seen.red), S(seen.green)})
      .depth_mm;
}

constexpr double reference_mm2 = 100;

/// Tangential forces of a pad with 2 N/mm at the reference and the exponent 0.6.
std::vector<ForceSample<double>> dragged(double noise_n, test::Random& random) {
  std::vector<ForceSample<double>> samples;
  for (int k = 0; k < 60; ++k) {
    ForceSample<double> s;
    s.measure = 40 + 4 * k;
    const double angle = 2.4 * k;
    const double length = 0.3 + 0.02 * (k % 20);
    s.displacement_mm = {length * std::cos(angle), length * std::sin(angle)};
    s.rotation_rad = 0;
    const double gain = 2 * std::pow(s.measure / reference_mm2, 0.6);
    s.tangential_force_n = {gain * s.displacement_mm.x + noise_n * random.normal(),
                            gain * s.displacement_mm.y + noise_n * random.normal()};
    samples.push_back(s);
  }
  return samples;
}

template <class S>
Point2<S> force_at(const S& gain, const S& exponent, double measure, const Point2<double>& d) {
  const Shear shear(test::straight_map(S(reference_mm2), exponent, S(1.5), gain, S(30)));
  return shear(S(measure), {S(d.x), S(d.y)}, S(0)).tangential_force_n;
}

/// A camera's distance, index, center (x, y) and pitch.
template <class S>
using Places = std::array<S, 5>;

template <class S>
Camera<S> camera_of(const Places<S>& p) {
  Camera<S> camera = cast<S>(Camera<double>());
  camera.plate_distance_mm = p[0];
  camera.refractive_index = p[1];
  camera.center_x_px = p[2];
  camera.center_y_px = p[3];
  camera.pitch_mm = p[4];
  return camera;
}

/// Slips of four dots of a dragged patch whose edge begins to slip. Pixels and depths are those of
/// the default camera; `p` is the camera that the method assumes.
template <class S>
std::array<Point2<S>, 4> slips_of(const Places<S>& p) {
  constexpr Index n = 21;
  const Camera<double> seen_by;
  const Camera<S> camera = camera_of(p);
  StickRatio<S> ratio(n, n, {.noise = 0.005});
  test::SlippingPatch patch;
  const auto show = [&] {
    const LazyView dots(n, n, [&](Index i, Index j) {
      const auto& at = patch.dots(i, j);
      const auto px = pixel_of(seen_by, at);
      return point_at(camera, S(px.y), S(px.x), S(at.z));
    });
    return ratio(dots, patch.contact);
  };
  (void)show();
  patch.step(test::moved_by({0.002, 0.003, 0.01}, {0, 0, 28}, {0.5, 0.2, 0}), 0.7);
  REQUIRE(show().updated());
  std::array<Point2<S>, 4> slips;
  std::size_t k = 0;
  for (const Index col : {7, 10, 12, 13}) {
    slips[k++] = ratio.slips()(10, col);
  }
  return slips;
}

}  // namespace

TEST_CASE("depth follows fluid and camera, through the reference as well") {
  const test::Pad pad;
  const auto shape = pad.free_depths();
  const auto frame = pad.frame<double>(shape);
  const Optics<double> at = {
      pad.fluid.c_red_per_mm,       pad.fluid.c_green_per_mm,    pad.fluid.kappa,
      pad.camera.plate_distance_mm, pad.camera.refractive_index, pad.camera.center_x_px,
      pad.camera.center_y_px,       pad.camera.pitch_mm};
  for (const auto& pixel : {std::array<Index, 2>{24, 28}, {30, 20}, {12, 40}}) {
    const Index row = pixel[0];
    const Index col = pixel[1];
    CAPTURE(row, col);
    const auto seen = pad.colour(row, col, 0.8 * pad.free_depth(row, col), 50);
    const auto depth = depth_after_fit(pad, shape, frame, seen, row, col, seeded(at));
    CHECK(depth.value == Approx(0.8 * pad.free_depth(row, col)).epsilon(2e-3));
    for (std::size_t k = 0; k < at.size(); ++k) {
      CAPTURE(k);
      const double step = 1e-5 * at[k];
      const auto moved = [&](double by) {
        auto p = at;
        p[k] += by;
        return depth_after_fit(pad, shape, frame, seen, row, col, p);
      };
      const double slope = (moved(step) - moved(-step)) / (2 * step);
      CHECK(depth.slopes[k] == Approx(slope).epsilon(1e-5).margin(1e-6 / at[k]));
      CHECK(std::abs(slope) > 1e-6);
    }
  }
}

TEST_CASE("variance of a force by look-up is what repeated calibrations scatter by") {
  test::Random random(7);
  constexpr double noise_n = 0.1;
  constexpr int trials = 400;
  const Point2<double> d = {0.5, -0.2};
  const double measure = GENERATE(60.0, 250.0);
  const auto fit_of = [](const std::vector<ForceSample<double>>& samples) {
    return fit_tangential_force(std::span<const ForceSample<double>>(samples), reference_mm2);
  };
  double variance = 0;
  double scatter = 0;
  const auto truth = force_at(2.0, 0.6, measure, d);
  for (int t = 0; t < trials; ++t) {
    const auto fit = fit_of(dragged(noise_n, random));
    const auto p = seeded(std::array{fit.law.slope, fit.law.exponent});
    const auto force = force_at(p[0], p[1], measure, d);
    const Eigen::Matrix2d covariance{{fit.covariance[0][0], fit.covariance[0][1]},
                                     {fit.covariance[1][0], fit.covariance[1][1]}};
    variance += carried_variance(force.x, covariance) / trials;
    scatter += square(force.x.value - truth.x) / trials;
  }
  // 400 trials determine a variance to 7 %
  CHECK(scatter / variance == Approx(1).margin(0.25));
}

TEST_CASE("slips of dots follow the camera") {
  const Camera<double> camera;
  const Places<double> at = {camera.plate_distance_mm, camera.refractive_index, camera.center_x_px,
                             camera.center_y_px, camera.pitch_mm};
  const auto plain = slips_of(at);
  const auto dual = slips_of(seeded(at));
  for (std::size_t k = 0; k < at.size(); ++k) {
    const double step = 1e-6 * at[k];
    const auto moved = [&](double by) {
      auto p = at;
      p[k] += by;
      return slips_of(p);
    };
    const auto more = moved(step);
    const auto less = moved(-step);
    double largest = 0;
    for (std::size_t dot = 0; dot < plain.size(); ++dot) {
      CAPTURE(k, dot);
      CHECK(dual[dot].x.value == Approx(plain[dot].x).margin(1e-12));
      const Point2<double> slope = 1 / (2 * step) * (more[dot] - less[dot]);
      for (const auto& [found, wanted] :
           {std::pair{dual[dot].x.slopes[k], slope.x}, {dual[dot].y.slopes[k], slope.y}}) {
        CHECK(found == Approx(wanted).epsilon(1e-5).margin(1e-7 / at[k]));
        largest = std::fmax(largest, std::abs(wanted));
      }
    }
    CHECK(largest > 1e-6 / at[k]);
  }
}
