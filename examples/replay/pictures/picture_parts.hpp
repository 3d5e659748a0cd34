// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Parts that several pictures share: captions, the scale bar, the camera's image.
#include <cstdio>
#include <opencv2/core.hpp>
#include <string>

#include "replay/pictures/canvas.hpp"

namespace replay {

constexpr double letter = 9;  ///< height of a capital in the large pictures

template <class... Values>
std::string format(const char* pattern, Values... values) {
  char text[160];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

/// "frame 5,  t = 0.2 s", without the time if it is unknown.
std::string caption(int frame, const std::string& time_s);

/// A round number of mm that is a fifth of the image or a little less.
double scale_bar_mm(double image_width_mm);

void paint_scale_bar(Canvas& canvas, Spot left, double length, double mm, double text_height);

/// The grey level that only the brightest hundredth of the image's pixels exceed.
double brightest_level(const cv::Mat& image);

/// The camera's image as 8 bit, scaled so that `brightest` is nearly white.
cv::Mat displayed(const cv::Mat& image, double brightest, cv::Size size);

}  // namespace replay
