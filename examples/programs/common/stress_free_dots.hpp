// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// stress_free_dots.csv: the printed dots on the stress-free membrane.
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>

namespace replay {

/// Points in mm; NaN if missing.
using SpaceGrid = cv::Mat_<cv::Vec3d>;

/// Reads row,col,x_mm,y_mm,z_mm, one line per known dot, of a print of `size`. Returns nullopt if
/// there is no such file; throws Failure.
std::optional<SpaceGrid> read_stress_free_dots(const std::filesystem::path& file, cv::Size size);

}  // namespace replay
