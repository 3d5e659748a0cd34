// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "bench/trials/calibrations/trials.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <opencv2/core.hpp>
#include <span>
#include <utility>

#include "bench/trials/calibrations/trial_parts.hpp"
#include "common/failure.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/calibrate/contact.hpp"
#include "fingerpad/calibrate/depth.hpp"
#include "fingerpad/calibrate/foam.hpp"
#include "fingerpad/calibrate/look_up.hpp"
#include "fingerpad/calibrate/neighbour_light.hpp"
#include "fingerpad/calibrate/rim.hpp"
#include "fingerpad/depth/neighbour_light.hpp"

namespace trials {
namespace {

using Map = cv::Mat_<double>;

// --- light

/// Sixty colours at known depths, each the mean of 16 frames of a block of 16 x 16 pixels with shot
/// noise of a grey level.
Trial absorption() {
  using Samples = std::vector<fingerpad::DepthSample<double>>;
  const fingerpad::Camera<double> camera{};
  const fingerpad::Absorption<double> fluid{};
  constexpr double noise = 1.0 / 64;
  const auto measure = [=](Chance& chance) {
    Samples samples;
    for (int k = 0; k < 60; ++k) {
      const double depth_mm = 0.3 + 0.2 * k;
      auto s = depth_sample(camera, 239.5 + 20 * (k % 5 - 2), 319.5, depth_mm,
                            fingerpad::Colour<double>{});
      s.colour = colour_at_depth(fluid, s.ray, 57.0, 0.0163, depth_mm);
      s.colour.red += noise * chance.normal();
      s.colour.green += noise * chance.normal();
      samples.push_back(s);
    }
    return samples;
  };
  const auto fit = [](const Samples& samples) {
    const auto found = fingerpad::fit_absorption(std::span(samples));
    return std::vector<double>{found.fluid.c_red_per_mm,
                               found.fluid.c_green_per_mm - found.fluid.c_red_per_mm,
                               found.fluid.kappa};
  };
  return trial({fluid.c_red_per_mm, fluid.c_green_per_mm - fluid.c_red_per_mm, fluid.kappa},
               measure, fit);
}

constexpr int light_rows = 20, light_cols = 24;
constexpr double light_pitch_mm = 0.64;

/// Depth of a pad with a plate pressed into it at a shifted position.
Map pressed_pad(double pressed_mm, double shift_mm) {
  Map depth(light_rows, light_cols);
  for (int i = 0; i < light_rows; ++i) {
    for (int j = 0; j < light_cols; ++j) {
      const double x = light_pitch_mm * (j - light_cols / 2);
      const double y = light_pitch_mm * (i - light_rows / 2);
      const double cap = 8 - 0.08 * (x * x + y * y);
      depth(i, j) = cap > 0 ? (std::min)(cap, 8 - pressed_mm + 0.1 * (x - shift_mm)) : none;
    }
  }
  return depth;
}

/// Twelve presses of known depth, with 0.02 mm of noise in the known depths.
Trial neighbour_light() {
  using Press = std::pair<Map, Map>;  ///< measured and true depth
  const fingerpad::NeighbourLight<float> light{3, 0.004F, 0.2F};
  const Map free_mm = pressed_pad(0, 0);
  std::vector<Press> exact;
  fingerpad::NeighbourLightCompensation<> compensation(light, static_cast<float>(light_pitch_mm),
                                                       free_mm);
  for (int k = 0; k < 12; ++k) {
    const Map measured = pressed_pad(0.8 + 0.2 * k, k % 3 - 1);
    cv::Mat_<float> truth(measured.size());
    (void)compensation(measured, truth);
    exact.emplace_back(measured, Map());
    truth.convertTo(exact.back().second, CV_64F);
  }
  const auto measure = [=](Chance& chance) {
    std::vector<Press> presses;
    for (const auto& [measured, truth] : exact) {
      presses.emplace_back(measured, truth.clone());
      for (double& depth : presses.back().second) {
        depth += 0.02 * chance.normal();
      }
    }
    return presses;
  };
  const auto fit = [=](const std::vector<Press>& presses) {
    std::vector<Map> measured, truth;
    for (const auto& [one, other] : presses) {
      measured.push_back(one);
      truth.push_back(other);
    }
    const auto found = fingerpad::fit_neighbour_light(light_pitch_mm, free_mm, measured, truth,
                                                      {light.radius_px, light.radius_px});
    return std::vector<double>{found.light.m0_mm_per_rad, found.light.n_per_mm};
  };
  return trial({0.004, 0.2}, measure, fit);
}

/// Ten frames of a free pad with 0.005 mm of noise. The threshold's true value is not known here.
Trial contact() {
  constexpr int rows = 28, cols = 28;
  constexpr double pitch_mm = 0.4, radius_mm = 20;
  const fingerpad::Camera<double> camera{50, 1.33, 13.5, 13.5, pitch_mm};
  const auto measure = [=](Chance& chance) {
    std::vector<Map> frames;
    for (int k = 0; k < 10; ++k) {
      frames.emplace_back(rows, cols);
      for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < cols; ++j) {
          const double rho = pitch_mm * std::hypot(i - 13.5, j - 13.5);
          frames.back()(i, j) =
              std::sqrt(radius_mm * radius_mm - rho * rho) - 8 + 0.005 * chance.normal();
        }
      }
    }
    return frames;
  };
  const auto fit = [=](const std::vector<Map>& frames) {
    const auto pad = fit_contact_threshold(camera, frames, 6);
    return std::vector<double>{pad.threshold_per_mm, pad.median_per_mm};
  };
  return trial({none, none}, measure, fit);
}

// --- rim

/// Mean apexes of a free pad at four pressures, 0.005 mm of noise each.
Trial rim() {
  constexpr double base_mm = 18.735, height_mm = 11, modulus = 0.5;
  using Apexes = std::vector<fingerpad::FreeApex>;
  const auto measure = [=](Chance& chance) {
    const fingerpad::FreePad<double> pad({base_mm, height_mm});
    Apexes apexes;
    for (const double mpa : {0.008, 0.012, 0.016, 0.020}) {
      for (int k = 0; k < 5; ++k) {
        apexes.push_back({mpa, pad.rim(mpa / modulus)->apex_mm + 0.005 * chance.normal(), 0.005});
      }
    }
    return apexes;
  };
  const auto fit = [=](const Apexes& seen) {
    Apexes means;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      if (k % 5 == 0) {
        means.push_back({seen[k].pressure_mpa, 0, 0.005 / std::sqrt(5.0)});
      }
      means.back().apex_mm += seen[k].apex_mm / 5;
    }
    const auto found = fit_rim({base_mm, height_mm}, means,
                               {.pressure_sd_share = 0, .height_sd_mm = 1, .radius_sd_mm = 0});
    return std::vector<double>{found.modulus_n_per_mm, found.height_mm};
  };
  return trial({modulus, height_mm}, measure, fit);
}

// --- forces

using Sample = fingerpad::ForceSample<double>;
using Samples = std::vector<Sample>;

constexpr double force_noise_n = 0.05;
constexpr double reference_mm = 2;

/// Forty contacts of various sizes, displaced and rotated, with noise of 0.05 N and 0.05 N mm.
Samples contacts(Chance& chance) {
  Samples samples;
  for (int k = 0; k < 40; ++k) {
    Sample s;
    s.measure = chance.uniform(0.4, 5);
    s.displacement_mm = {chance.uniform(-1, 1), chance.uniform(-1, 1)};
    s.rotation_rad = chance.uniform(-0.15, 0.15);
    s.normal_force_n =
        0.5 * s.measure + 0.3 * s.measure * s.measure + force_noise_n * chance.normal();
    const double gain = 2 * std::pow(s.measure / reference_mm, 0.7);
    s.tangential_force_n = {gain * s.displacement_mm.x + force_noise_n * chance.normal(),
                            gain * s.displacement_mm.y + force_noise_n * chance.normal()};
    s.moment_n_mm = 40 * std::pow(s.measure / reference_mm, 1.6) * s.rotation_rad +
                    force_noise_n * chance.normal();
    s.load = k;
    samples.push_back(s);
  }
  return samples;
}

Trial normal_force() {
  const auto fit = [](const Samples& samples) {
    const auto found = fingerpad::fit_normal_force(std::span(samples));
    return std::vector<double>{found.curve.coefficients[1], found.curve.coefficients[2]};
  };
  return trial({0.5, 0.3}, contacts, fit);
}

template <class Fit>
std::vector<double> of_shear(const Fit& found) {
  return {found.law.slope, found.law.exponent};
}

Trial tangential_force() {
  const auto fit = [](const Samples& samples) {
    return of_shear(fingerpad::fit_tangential_force(std::span(samples), reference_mm));
  };
  return trial({2, 0.7}, contacts, fit);
}

Trial moment() {
  const auto fit = [](const Samples& samples) {
    return of_shear(fingerpad::fit_moment(std::span(samples), reference_mm));
  };
  return trial({40, 1.6}, contacts, fit);
}

// --- foam

/// Sixty windows of 3 x 3 taxels at rest, 3 counts of noise.
Trial taxels() {
  constexpr int rows = 3, cols = 3, windows = 60;
  constexpr double noise = 3, period_s = 1.0 / 30;
  using Window = std::vector<Map>;
  const fingerpad::TaxelOptions options{};
  const auto length = static_cast<int>(options.window);
  const auto measure = [=](Chance& chance) {
    std::vector<Window> all(windows);
    for (Window& window : all) {
      for (int k = 0; k < length; ++k) {
        window.emplace_back(rows, cols);
        for (double& reading : window.back()) {
          reading = 800 + noise * chance.normal();
        }
      }
    }
    return all;
  };
  const auto fit = [=](const std::vector<Window>& all) {
    fingerpad::TaxelNoiseCalibration calibration(rows, cols, options);
    int sample = 0;
    for (const Window& window : all) {
      for (const Map& readings : window) {
        (void)calibration.add(readings, period_s * sample++);
      }
    }
    const auto found = calibration.fit();
    return std::vector<double>{found.typical};
  };
  return trial({noise}, measure, fit);
}

const std::map<std::string, Trial (*)()>& makers() {
  static const std::map<std::string, Trial (*)()> all = {{"absorption", absorption},
                                                         {"neighbour_light", neighbour_light},
                                                         {"contact", contact},
                                                         {"camera_plate", camera_plate},
                                                         {"cap", cap},
                                                         {"intensity", intensity},
                                                         {"rim", rim},
                                                         {"normal_force", normal_force},
                                                         {"tangential_force", tangential_force},
                                                         {"moment", moment},
                                                         {"taxels", taxels}};
  return all;
}

}  // namespace

const std::vector<std::string>& trial_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, make] : makers()) {
      all.push_back(name);
    }
    return all;
  }();
  return names;
}

Trial trial_of(const std::string& name) {
  const auto found = makers().find(name);
  if (found == makers().end()) {
    replay::fail(name, "there is no such calibration");
  }
  return found->second();
}

}  // namespace trials
