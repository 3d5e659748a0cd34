// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Recordings of the motion of a pad's dots under known loads, one file per load.
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace load_trials {

/// The dots of all repeats of a load, in one row.
struct Load {
  std::string name;
  bool single_axis = false;  ///< tilted about at most one axis, so its force is exact
  double fx_n = 0;           ///< along the pad
  double fz_n = 0;           ///< along the pad, across
  cv::Mat_<cv::Vec2d> from;  ///< px
  cv::Mat_<cv::Vec2d> to;
};

/// Reads the loads, sorted by name. Throws replay::Failure if there are none or one is malformed.
std::vector<Load> loads_of(const std::filesystem::path& folder);

}  // namespace load_trials
