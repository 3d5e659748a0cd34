// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Recordings of how the dots of a pad moved under known loads, one file a load.
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace load_trials {

/// The dots of all repeats of a load, in one row.
struct Load {
  std::string name;
  bool single_axis = false;  ///< tilted about one axis at most: its force is exact
  double fx_n = 0;           ///< along the pad
  double fz_n = 0;           ///< along the pad, across
  cv::Mat_<cv::Vec2d> from;  ///< px
  cv::Mat_<cv::Vec2d> to;
};

/// Sorted by name; throws replay::Failure where there are none, or one is not as expected.
std::vector<Load> loads_of(const std::filesystem::path& folder);

}  // namespace load_trials
