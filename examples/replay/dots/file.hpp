// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// dots.csv of a recording: frame,row,col,x_px,y_px. A dot that was not found has no line.
#include <filesystem>
#include <map>
#include <optional>

#include "replay/dots/grid.hpp"

namespace replay {

/// Dots of each frame that the file names; throws Failure with the line number. `size` is that of
/// the print; without one the grid is as large as the file's largest row and column make it.
std::map<int, DotGrid> read_dots(const std::filesystem::path& file,
                                 int frame_count,
                                 std::optional<cv::Size> size);

}  // namespace replay
