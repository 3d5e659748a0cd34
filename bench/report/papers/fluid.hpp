// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Identification of the fluid from colours at known depths, by the printed three equations and by
// the default, with the noise that remains after a mean over 29 x 29 px.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

#include "fingerpad/calibrate/depth.hpp"
#include "fingerpad/published/depth.hpp"
#include "support/pad.hpp"
#include "table.hpp"

namespace bench::papers {

constexpr double colour_noise = 1.0 / 29;

inline fingerpad::Colour<double> noisy_colour(const test::Pad& pad,
                                              double depth_mm,
                                              test::Random& random) {
  auto c = pad.colour(24, 28, depth_mm, 57);
  c.red += colour_noise * random.normal();
  c.green += colour_noise * random.normal();
  return c;
}

struct Fluids {
  std::vector<double> c_red, c_green, kappa;
  int no_answer = 0;

  void add(bool ok, double c_red_per_mm, double c_green_per_mm, double of_light) {
    if (!ok) {
      ++no_answer;
      return;
    }
    c_red.push_back(c_red_per_mm);
    c_green.push_back(c_green_per_mm);
    kappa.push_back(of_light);
  }
  /// The quartiles, which enclose half of all answers.
  static std::string quartiles(std::vector<double> x) {
    std::sort(x.begin(), x.end());
    char text[64];
    std::snprintf(text, sizeof text, "%.4f to %.4f", x[x.size() / 4], x[3 * x.size() / 4]);
    return text;
  }
};

inline Section fluid_section() {
  using namespace fingerpad;
  test::Pad pad;
  pad.one_height = true;
  const auto pencil = pad.pencil(24, 28);
  test::Random random(3);
  Fluids printed, ours;
  for (int k = 0; k < 200; ++k) {
    const auto at = [&](double depth_mm) {
      const auto c = noisy_colour(pad, depth_mm, random);
      return published::KnownPixel<double>{pencil.path_factor, pencil.meridional_mm, depth_mm,
                                           c.red, c.green};
    };
    const auto found = published::identify_fluid(at(12), std::array{at(1), at(4), at(8)});
    const auto fluid = found.value_or(published::Fluid<double>());
    printed.add(found.has_value(), fluid.c_R, fluid.c_G, fluid.kappa);
    std::vector<DepthSample<double>> samples;
    for (int n = 0; n < 60; ++n) {
      const double depth_mm = 0.5 + 11.5 * n / 59;
      samples.push_back({pencil, {0, 0}, depth_mm, noisy_colour(pad, depth_mm, random)});
    }
    const auto fit = fit_absorption(std::span<const DepthSample<double>>(samples));
    ours.add(fit.ok(), fit.fluid.c_red_per_mm, fit.fluid.c_green_per_mm, fit.fluid.kappa);
  }
  const std::string nearest =
      "200 draws of 0.034 grey levels at 4 depths, default 60 depths; true: ";
  const auto row = [&](const std::string& experiment, const std::string& name,
                       const std::string& truth, const auto member) {
    return Row{experiment,
               name + ", quartiles",
               truth,
               Fluids::quartiles(printed.*member),
               Fluids::quartiles(ours.*member),
               nearest + truth};
  };
  return {"Fluid [S]",
          {row("identification from three known depths", "c_R per mm", "0.0290", &Fluids::c_red),
           row("", "c_G per mm", "0.0336", &Fluids::c_green),
           row("", "kappa", "0.9924", &Fluids::kappa),
           {"", "draws without an answer", "", std::to_string(printed.no_answer) + " of 200",
            std::to_string(ours.no_answer) + " of 200", "the same"}}};
}

}  // namespace bench::papers
