// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Images of a grid of printed dots at known positions.
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "fingerpad/core/dots.hpp"

namespace test {

using DotPlaces = cv::Mat_<cv::Vec2d>;

struct Print {
  cv::Size frame = {320, 240};
  int rows = 8;
  int cols = 11;
  double pitch_px = 24;
  double radius_px = 5;
  double rotation_rad = 0;
  double ink = 60;      ///< grey level of a dot
  double ground = 150;  ///< grey level of the background
  double fall = 0.3;    ///< relative loss of light from the left to the right border
  double noise = 0;     ///< standard deviation, grey levels
};

/// Dots of a print centered in the frame.
inline DotPlaces places_of(const Print& print) {
  DotPlaces dots(print.rows, print.cols);
  const cv::Vec2d middle(0.5 * print.frame.width, 0.5 * print.frame.height);
  const double c = std::cos(print.rotation_rad);
  const double s = std::sin(print.rotation_rad);
  for (int i = 0; i < print.rows; ++i) {
    for (int j = 0; j < print.cols; ++j) {
      const double u = print.pitch_px * (j - (print.cols - 1) / 2.0);
      const double v = print.pitch_px * (i - (print.rows - 1) / 2.0);
      dots(i, j) = middle + cv::Vec2d(c * u - s * v, s * u + c * v);
    }
  }
  return dots;
}

inline DotPlaces moved(const DotPlaces& dots, const cv::Vec2d& by) {
  DotPlaces all = dots.clone();
  for (cv::Vec2d& dot : all) {
    dot += by;
  }
  return all;
}

/// Draws a disc of `value` in `light`; each pixel is weighted by its covered share.
inline void draw_disc(cv::Mat_<double>& light,
                      const cv::Vec2d& center,
                      double radius_px,
                      double value) {
  constexpr int fine = 8;
  const int reach = static_cast<int>(std::ceil(radius_px)) + 1;
  const cv::Point at(static_cast<int>(std::lround(center[0])),
                     static_cast<int>(std::lround(center[1])));
  const cv::Rect box = cv::Rect(at.x - reach, at.y - reach, 2 * reach + 1, 2 * reach + 1) &
                       cv::Rect({0, 0}, light.size());
  for (int i = box.y; i < box.y + box.height; ++i) {
    for (int j = box.x; j < box.x + box.width; ++j) {
      int covered = 0;
      for (int k = 0; k < fine * fine; ++k) {
        const cv::Vec2d point(j + (k % fine + 0.5) / fine - 0.5, i + (k / fine + 0.5) / fine - 0.5);
        covered += cv::norm(point - center) <= radius_px ? 1 : 0;
      }
      light(i, j) += (value - light(i, j)) * covered / (fine * fine);
    }
  }
}

/// Image of `dots`, 8 bit in three equal channels; NaN: no dot there. `specks` are discs of a third
/// of a dot's radius.
inline cv::Mat picture_of(const Print& print,
                          const DotPlaces& dots,
                          const std::vector<cv::Vec2d>& specks = {},
                          unsigned long long seed = 1) {
  cv::Mat_<double> light(print.frame, print.ground);
  for (const cv::Vec2d& dot : dots) {
    if (fingerpad::is_present(dot)) {
      draw_disc(light, dot, print.radius_px, print.ink);
    }
  }
  for (const cv::Vec2d& speck : specks) {
    draw_disc(light, speck, print.radius_px / 3, print.ink);
  }
  cv::RNG random(seed);
  cv::Mat frame(print.frame, CV_8UC3);
  for (int i = 0; i < frame.rows; ++i) {
    for (int j = 0; j < frame.cols; ++j) {
      const double lit = light(i, j) * (1 - print.fall * j / frame.cols);
      for (int c = 0; c < 3; ++c) {
        frame.at<cv::Vec3b>(i, j)[c] =
            cv::saturate_cast<unsigned char>(lit + random.gaussian(print.noise));
      }
    }
  }
  return frame;
}

/// Root mean square and largest distance of dots of the same name that exist in both, px.
struct DotErrors {
  double rms_px = 0;
  double worst_px = 0;
  int count = 0;
};
inline DotErrors errors_of(const DotPlaces& found, const DotPlaces& truth) {
  DotErrors errors;
  for (int i = 0; i < truth.rows; ++i) {
    for (int j = 0; j < truth.cols; ++j) {
      const double off = cv::norm(found(i, j) - truth(i, j));
      if (std::isfinite(off)) {
        errors.rms_px += off * off;
        errors.worst_px = std::fmax(errors.worst_px, off);
        ++errors.count;
      }
    }
  }
  errors.rms_px = std::sqrt(errors.rms_px / errors.count);
  return errors;
}

}  // namespace test
