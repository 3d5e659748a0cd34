// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Fits the fluid's absorption to colours at known depths: a ball is pressed to four depths, each
// seen at 49 pixels. `calibrate absorption` does the same with images.
#include <cmath>
#include <cstdio>
#include <random>
#include <span>
#include <vector>

#include "fingerpad/calibrate/depth.hpp"

int main() {
  const fingerpad::Camera<double> camera{.center_x_px = 239.5, .center_y_px = 239.5};

  // What a recording would give. The fluid is what we want to find out.
  const fingerpad::Absorption<double> truth{0.029, 0.0336, 0.9924, 18};
  constexpr double light = 140, scattering = 0.044, noise = 0.03;  // grey levels; mean of 1000 px
  std::mt19937 bits(1);
  std::normal_distribution<double> error(0, noise);
  std::vector<fingerpad::DepthSample<double>> samples;
  for (const double lowest_mm : {1.0, 4.0, 7.0, 10.0}) {
    for (int k = 0; k < 49; ++k) {
      const double row = 239.5 + 15 * (k / 7 - 3), col = 239.5 + 15 * (k % 7 - 3);
      const auto ray = ray_at_pixel(camera, row, col);
      const double depth_mm = lowest_mm + ray.plate_rho_mm * ray.plate_rho_mm / 2 / 15;
      auto seen = colour_at_depth(truth, ray, light, scattering, depth_mm);
      seen.red += error(bits);
      seen.green += error(bits);
      samples.push_back(fingerpad::depth_sample(camera, row, col, depth_mm, seen));
    }
  }

  const auto fit =
      fingerpad::fit_absorption(std::span<const fingerpad::DepthSample<double>>(samples));

  const auto sd = [&](std::size_t k) { return std::sqrt(fit.covariance[k][k]); };
  const auto& fluid = fit.fluid;
  std::printf("%s, residual %.3f grey levels\n", text_of(fit), fit.residual_rms);
  std::printf("c_red            %.5f +- %.5f per mm, true %.5f\n", fluid.c_red_per_mm, sd(0),
              truth.c_red_per_mm);
  std::printf("c_green - c_red  %.5f +- %.5f per mm, true %.5f\n",
              fluid.c_green_per_mm - fluid.c_red_per_mm, sd(1),
              truth.c_green_per_mm - truth.c_red_per_mm);
  std::printf("kappa            %.5f +- %.5f, true %.5f\n", fluid.kappa, sd(2), truth.kappa);
  const double depth_sd = predicted_depth_sd(fit, samples.back());
  std::printf("standard error of a depth of %.1f mm: %.4f mm\n", samples.back().depth_mm, depth_sd);
  const bool within = std::abs(fluid.c_red_per_mm - truth.c_red_per_mm) < 4 * sd(0);
  return fit.ok() && within && depth_sd < 0.05 ? 0 : 1;
}
