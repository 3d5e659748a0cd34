// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Files of dots in space: side_dots.csv, the dots beside the rim, which an earlier program has
// found in the frames, and stress_free_dots.csv, the printed dots of a membrane without stress.
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <optional>

namespace replay {

/// Points in mm; NaN: not there.
using SpaceGrid = cv::Mat_<cv::Vec3d>;

struct SideDots {
  SpaceGrid border_mm;               ///< one row: the rim point of each dot
  std::map<int, SpaceGrid> dots_mm;  ///< by frame, one row each
};

/// frame,index,border_x,border_y,border_z,dot_x,dot_y,dot_z in mm, a line for each dot that was
/// found. Nothing where there is no such file; throws Failure.
std::optional<SideDots> read_side_dots(const std::filesystem::path& file, int frame_count);

/// row,col,x_mm,y_mm,z_mm, a line for each dot that is known, of a print of `size`. Nothing where
/// there is no such file; throws Failure.
std::optional<SpaceGrid> read_stress_free_dots(const std::filesystem::path& file, cv::Size size);

}  // namespace replay
