// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The printed dots of one frame in the library's form: a grid of positions in print order.
#include <limits>
#include <opencv2/core.hpp>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/core/dots.hpp"

namespace replay {

/// rows x cols of [x_px, y_px], NaN where a dot was not found.
using DotGrid = cv::Mat_<cv::Vec2d>;
using fingerpad::is_present;

inline cv::Vec2d no_dot() {
  return cv::Vec2d::all(std::numeric_limits<double>::quiet_NaN());
}
inline DotGrid no_dots(cv::Size size) {
  return DotGrid(size, no_dot());
}

}  // namespace replay
