// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Parts that several pictures share: letters, numbers, captions.
#include <cmath>
#include <cstdio>
#include <opencv2/core.hpp>
#include <string>

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

/// The grey level that only the brightest hundredth of the image's pixels exceed.
double brightest_level(const cv::Mat& image);

/// Whether item `done` of `total` is one of at most `most` evenly spaced ones.
bool is_chosen(int done, int total, int most);

/// Rounds a value for printing; never gives "-0.00".
inline double rounded(double value, double steps_per_unit = 100) {
  return std::round(value * steps_per_unit) / steps_per_unit + 0.0;
}

}  // namespace replay
