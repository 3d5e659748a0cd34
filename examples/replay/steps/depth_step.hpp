// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What the program does with the library: one frame in, its depth out. The types of the frames and
// the policy of smoothing are known only at run time here; the library has them as types.
#include <functional>
#include <opencv2/core.hpp>
#include <string>

#include "fingerpad/core/grid.hpp"
#include "replay/io/recording.hpp"

namespace replay {

enum class Smoothing { none, box, anchored };

struct FrameDepth {
  fingerpad::Index valid_pixels = 0;
  fingerpad::Index pad_pixels = 0;
  bool pad_has_changed = false;  ///< its light is not that of the reference
};

/// Depth in mm, NaN where there is none, of an 8- or 16-bit colour frame of the reference's size.
using DepthStep = std::function<FrameDepth(const cv::Mat& frame, cv::Mat_<float>& depth_mm)>;

/// Fits the reference and sets up everything that frames need. Throws fingerpad::parameter_error.
DepthStep make_depth_step(const Recording& recording, Smoothing smoothing, int window_px);

}  // namespace replay
