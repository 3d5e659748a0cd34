// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// dots.csv of a recording: frame,row,col,x_px,y_px. A dot that was not found has no line.
#include <filesystem>
#include <map>
#include <optional>

#include "replay/dots/grid.hpp"

namespace replay {

/// Reads the dots of each frame in the file; throws Failure with the line number. `size` is the
/// size of the print; without it the largest row and column in the file give the size.
std::map<int, DotGrid> read_dots(const std::filesystem::path& file,
                                 int frame_count,
                                 std::optional<cv::Size> size);

}  // namespace replay
