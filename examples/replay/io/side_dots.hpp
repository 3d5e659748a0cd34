// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Files of dots in space: side_dots.csv, the side dots at the rim, found in the frames by another
// program, and stress_free_dots.csv, the printed dots on the stress-free membrane.
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <optional>

namespace replay {

/// Points in mm; NaN if missing.
using SpaceGrid = cv::Mat_<cv::Vec3d>;

struct SideDots {
  SpaceGrid border_mm;               ///< one row: the rim point of each dot
  std::map<int, SpaceGrid> dots_mm;  ///< by frame, one row each
};

/// Reads frame,index,border_x,border_y,border_z,dot_x,dot_y,dot_z in mm, one line per found dot.
/// Returns nullopt if there is no such file; throws Failure.
std::optional<SideDots> read_side_dots(const std::filesystem::path& file, int frame_count);

/// Reads row,col,x_mm,y_mm,z_mm, one line per known dot, of a print of `size`. Returns nullopt if
/// there is no such file; throws Failure.
std::optional<SpaceGrid> read_stress_free_dots(const std::filesystem::path& file, cv::Size size);

}  // namespace replay
