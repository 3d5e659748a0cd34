// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Every calibration from any recording: it is refused by name, or, where it says ok, all that it
// found is finite and fit for the method that it is for.
#include <cstdint>
#include <numbers>
#include <vector>

#include "fingerpad/calibrate/contact.hpp"
#include "fingerpad/calibrate/depth.hpp"
#include "fingerpad/calibrate/foam.hpp"
#include "fingerpad/calibrate/intensity.hpp"
#include "fingerpad/calibrate/look_up.hpp"
#include "fingerpad/calibrate/neighbour_light.hpp"
#include "fingerpad/calibrate/rim.hpp"
#include "fuzz/input.hpp"

using namespace fingerpad;
using fuzz::Grid;
using fuzz::Input;
using fuzz::require;

namespace {

std::vector<ForceSample<double>> any_samples(Input& in) {
  std::vector<ForceSample<double>> samples(static_cast<std::size_t>(in.whole(0, 40)));
  const double slope = in.number(0.01, 0.1), noise = in.number(0, 0.2);
  for (ForceSample<double>& s : samples) {
    s.measure = in.number(10, 400);
    s.displacement_mm = {in.number(-2, 2), in.number(-2, 2)};
    s.rotation_rad = in.number(-0.3, 0.3);
    s.normal_force_n = slope * s.measure + noise * in.number(-1, 1);
    s.tangential_force_n = {2 * s.displacement_mm.x + noise * in.number(-1, 1),
                            2 * s.displacement_mm.y};
    s.moment_n_mm = 30 * s.rotation_rad;
  }
  return samples;
}

void try_forces(Input& in) {
  const auto given = any_samples(in);
  const std::span<const ForceSample<double>> samples(given);
  const bool through_zero = in.flag();
  const auto degree = static_cast<int>(in.whole(1, 3));
  const auto require_law = [](const ShearFit<>& fit) {
    require(!fit.ok() || (is_finite(fit.law.slope) && is_finite(fit.law.exponent)),
            "a law is finite");
  };
  switch (in.whole(0, 2)) {
    case 0: {
      const auto fit = fit_normal_force(samples, degree, through_zero);
      require(!fit.ok() || is_finite(fit.curve.force_n(fit.curve.to)), "a curve is finite");
      return;
    }
    case 1:
      return require_law(fit_tangential_force(samples, 100.0));
    default:
      return require_law(fit_moment(samples, 100.0, 1.7));
  }
}

void try_absorption(Input& in) {
  Camera<double> camera;
  const Absorption<double> fluid{.c_red_per_mm = 0.02, .c_green_per_mm = 0.03, .kappa = 1.1};
  std::vector<DepthSample<double>> samples;
  for (Index k = in.whole(0, 24); k > 0; --k) {
    const double depth_mm = in.number(0, 12), level = in.number(50, 200);
    auto sample = depth_sample(camera, in.number(0, 480), in.number(0, 640), depth_mm,
                               Colour<double>{level * std::exp(-2 * fluid.c_red_per_mm * depth_mm),
                                              level * in.number(0.2, 1)});
    samples.push_back(sample);
  }
  const auto fit = fit_absorption(std::span<const DepthSample<double>>(samples));
  require(!fit.ok() || is_finite(fit.fluid.kappa), "a fluid is finite");
  require(!fit.ok() || check(fit.fluid).empty(), "a fluid is accepted");
}

void try_taxels(Input& in) {
  const Index rows = in.whole(0, 4), cols = in.whole(0, 4);
  TaxelOptions options;
  options.window = in.whole(2, 20);
  TaxelNoiseCalibration calibration(rows, cols, options);
  double time_s = 0;
  for (Index k = in.whole(1, 150); k > 0; --k) {
    const Grid<double> taxels(in, rows, cols, 0, 1000);
    (void)calibration.add(taxels.view(), time_s);
    time_s += in.number(0.02, 0.04);
  }
  const TaxelNoise noise = calibration.fit();
  require(is_finite(noise.typical) && noise.typical > 0, "noise is above 0");
}

void try_intensity(Input& in) {
  const Index rows = in.side(1, 40), cols = in.side(1, 40);
  Grid<std::uint8_t> free(rows, cols), pressed(rows, cols);
  const double x = in.number(0, 40), y = in.number(0, 40), r = in.number(2, 20);
  expects(std::abs(x) < 100 && std::abs(y) < 100 && r > 1 && r < 100, "fuzz", "r", r,
          "in (1, 100)");
  std::vector<Grid<std::uint8_t>> presses;
  for (int press = 0; press < 2; ++press) {
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const double off = std::hypot(static_cast<double>(i) - y, static_cast<double>(j) - x);
        free.view()(i, j) = 200;
        pressed.view()(i, j) =
            static_cast<std::uint8_t>(200 - (off < r ? 80 * (1 - off * off / (r * r)) : 0.0));
      }
    }
    for (Index k = in.whole(0, 10); k > 0; --k) {
      pressed.view()(in.whole(0, rows - 1), in.whole(0, cols - 1)) = in.byte();
    }
    presses.push_back(pressed);
  }
  const double ball_mm = in.number(1, 8), mm_per_px = in.number(0.02, 0.2);
  const std::array pressed_views = {presses[0].view(), presses[1].view()};
  const IntensityFit<> fit = fit_intensity(free.view(), pressed_views, ball_mm, mm_per_px);
  if (fit.ok()) {
    fingerpad::require(fit.law);
    require(is_finite(fit.mean_error_mm), "a mean error is a number");
  }
}

void try_rim(Input& in) {
  std::vector<FreeApex> apexes;
  for (Index k = in.whole(1, 3); k > 0; --k) {
    apexes.push_back({in.number(0.005, 0.03), in.number(9, 16), in.number(0.001, 0.1)});
  }
  const auto fit = fit_rim({18.735, in.number(9, 12)}, apexes);
  require(!fit.ok() || (is_finite(fit.modulus_n_per_mm) && fit.modulus_n_per_mm > 0),
          "a modulus is above 0");
}

void try_free_pad(Input& in) {
  const Index rows = in.side(0, 40), cols = in.side(0, 40);
  Camera<double> camera;
  camera.center_x_px = camera.center_y_px = 20;
  camera.pitch_mm = in.number(0.1, 1);
  const double ring = in.number(1, 8);
  std::vector<Grid<float>> depths;
  const double bend = in.number(0, 0.02);
  for (Index frames = in.whole(0, 4); frames > 0; --frames) {
    Grid<float>& depth = depths.emplace_back(rows, cols);
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const double x = static_cast<double>(j - 20), y = static_cast<double>(i - 20);
        depth.view()(i, j) = static_cast<float>(12 - bend * (x * x + y * y));
      }
    }
    for (Index k = in.whole(0, 8); k > 0 && rows > 0 && cols > 0; --k) {
      depth.view()(in.whole(0, rows - 1), in.whole(0, cols - 1)) = in.cell<float>(0, 15);
    }
  }
  std::vector<StridedView<const float>> views;
  for (const Grid<float>& depth : depths) {
    views.push_back(depth.view());
  }
  const ThresholdFit pad = fit_contact_threshold(camera, views, ring);
  require(!pad.ok() || (is_finite(pad.threshold_per_mm) && pad.threshold_per_mm > 0),
          "a threshold is above 0");
}

void try_neighbour_light(Input& in) {
  const Index rows = in.whole(0, 20), cols = in.whole(0, 20);
  const Grid<float> reference(in, rows, cols, 5, 6), measured(in, rows, cols, 5, 9),
      truth(in, rows, cols, 5, 9);
  const std::vector of = {measured.view()}, with = {truth.view()};
  const auto fit =
      fit_neighbour_light(in.number(0.05, 0.5), reference.view(), of, with, {1, in.whole(1, 3)});
  require(!fit.ok() || (is_finite(fit.rms_after_mm) && fit.rms_after_mm >= 0),
          "the residual is finite");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, [](Input& in) {
    constexpr void (*targets[])(Input&) = {try_forces,         try_absorption, try_taxels,
                                           try_intensity,      try_rim,        try_free_pad,
                                           try_neighbour_light};
    targets[in.whole(0, 6)](in);
  });
}
