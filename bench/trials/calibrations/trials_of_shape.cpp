// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Trials of the calibrations of geometry: camera, free pad, and gel intensity.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "bench/trials/calibrations/trial_parts.hpp"
#include "calibrate/geometry.hpp"
#include "calibrate/shape.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/calibrate/intensity.hpp"

namespace trials {

/// A plate of 9 x 9 dots, and the same raised by 10 mm, with 0.05 px of noise.
Trial camera_plate() {
  using Dots = std::vector<calibrate::PlateDot>;
  using Pair = std::pair<Dots, Dots>;
  constexpr double distance_mm = 50, raised_mm = 10, pitch_mm = 0.08;
  const auto picture = [](double pitch, Chance& chance) {
    Dots dots;
    for (int k = 0; k < 81; ++k) {
      const double x = 3.0 * (k % 9 - 4), y = 3.0 * (k / 9 - 4);
      dots.push_back({{x, y},
                      {319.5 + x / pitch + 0.05 * chance.normal(),
                       239.5 + y / pitch + 0.05 * chance.normal()}});
    }
    return dots;
  };
  const auto measure = [=](Chance& chance) {
    const Dots low = picture(pitch_mm, chance);
    return Pair(low, picture(pitch_mm * (distance_mm + raised_mm) / distance_mm, chance));
  };
  const auto fit = [](const Pair& pair) {
    const auto found = calibrate::fit_camera(pair.first, pair.second, raised_mm, distance_mm);
    return std::vector<double>{found.camera.pitch_mm, found.camera.center_x_px,
                               found.camera.plate_distance_mm};
  };
  return trial({pitch_mm, 319.5, distance_mm}, measure, fit);
}

/// Thirty touches of a cap by a ball, with 0.02 mm of noise along each axis.
Trial cap() {
  using Touches = std::vector<fingerpad::Point3<double>>;
  constexpr double base_mm = 18.735, apex_mm = 13.03, ball_mm = 3;
  const auto measure = [](Chance& chance) {
    constexpr double radius = (base_mm * base_mm / apex_mm + apex_mm) / 2;
    Touches touches;
    for (int k = 0; k < 30; ++k) {
      const double around = 2.4 * k, off_axis = 0.03 * k;  // rad
      const double rho = (radius + ball_mm) * std::sin(off_axis);
      const double z = (radius + ball_mm) * std::cos(off_axis) - radius + apex_mm - ball_mm;
      touches.push_back({rho * std::cos(around) + 0.02 * chance.normal(),
                         rho * std::sin(around) + 0.02 * chance.normal(),
                         z + 0.02 * chance.normal()});
    }
    return touches;
  };
  const auto fit = [](const Touches& touches) {
    const auto found = calibrate::fit_shape(touches, {ball_mm, base_mm, 0, false});
    return std::vector<double>{found.apex_height_mm};
  };
  return trial({apex_mm}, measure, fit);
}

/// Eight presses of a ball into a gel seen in one channel, with one grey level of noise.
Trial intensity() {
  using Picture = cv::Mat_<double>;
  constexpr double law_mm = 4, bright = 150, ball_mm = 4, mm_per_px = 0.1;
  const Picture free(64, 64, bright);
  const auto measure = [=](Chance& chance) {
    std::vector<Picture> presses;
    for (int k = 0; k < 8; ++k) {
      presses.emplace_back(free.size());
      const double depth = 0.4 + 0.07 * k, x = 3.1 + 0.1 * (k % 3), y = 3.0 + 0.1 * (k % 4);
      for (int i = 0; i < free.rows; ++i) {
        for (int j = 0; j < free.cols; ++j) {
          const double rho = std::hypot(mm_per_px * j - x, mm_per_px * i - y);
          const double root = std::sqrt(std::fmax(ball_mm * ball_mm - rho * rho, 0));
          const double dent = std::fmax(depth - ball_mm + root, 0);
          presses.back()(i, j) = bright * std::exp(-dent / law_mm) + chance.normal();
        }
      }
    }
    return presses;
  };
  const auto fit = [=](const std::vector<Picture>& presses) {
    const auto found = fingerpad::fit_intensity(free, presses, ball_mm, mm_per_px);
    return std::vector<double>{found.law.linear_mm};
  };
  return trial({law_mm}, measure, fit);
}

}  // namespace trials
