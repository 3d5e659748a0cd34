// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/io/side_dots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "replay/io/failure.hpp"
#include "replay/io/number_table.hpp"

namespace replay {
namespace {

constexpr int max_side_dots = 4096;

SpaceGrid no_points(cv::Size size) {
  return SpaceGrid(size, cv::Vec3d::all(std::numeric_limits<double>::quiet_NaN()));
}

cv::Vec3d point(const NumberTable::Line& line, std::size_t column) {
  return {line.values[column], line.values[column + 1], line.values[column + 2]};
}

}  // namespace

std::optional<SideDots> read_side_dots(const std::filesystem::path& file, int frame_count) {
  if (!std::filesystem::exists(file)) {
    return {};
  }
  const NumberTable table(
      file, {"frame", "index", "border_x", "border_y", "border_z", "dot_x", "dot_y", "dot_z"});
  int count = 0;
  for (const auto& line : table.lines()) {
    count = (std::max)(count, 1 + table.index(line, 1, max_side_dots, "side dots"));
  }
  if (count == 0) {
    fail(file, "lists no side dots");
  }
  SideDots all{SpaceGrid(1, count, cv::Vec3d::all(0)), {}};
  std::vector<int> times(static_cast<std::size_t>(count), 0);
  for (const auto& line : table.lines()) {
    const int frame = table.index(line, 0, frame_count, "frames");
    const int index = table.index(line, 1, count, "side dots");
    SpaceGrid& dots = all.dots_mm[frame];
    if (dots.empty()) {
      dots = no_points({count, 1});
    }
    if (!std::isnan(dots(0, index)[0])) {
      table.refuse(line, "side dot " + std::to_string(index) + " of frame " +
                             std::to_string(frame) + " is given twice");
    }
    dots(0, index) = point(line, 5);
    all.border_mm(0, index) += point(line, 2);
    ++times[static_cast<std::size_t>(index)];
  }
  for (int index = 0; index < count; ++index) {
    if (times[static_cast<std::size_t>(index)] == 0) {
      fail(file, "side dot " + std::to_string(index) + " is in no frame; number them from 0 to " +
                     std::to_string(count - 1));
    }
    all.border_mm(0, index) *= 1.0 / times[static_cast<std::size_t>(index)];
  }
  return all;
}

std::optional<SpaceGrid> read_stress_free_dots(const std::filesystem::path& file, cv::Size size) {
  if (!std::filesystem::exists(file)) {
    return {};
  }
  const NumberTable table(file, {"row", "col", "x_mm", "y_mm", "z_mm"});
  SpaceGrid dots = no_points(size);
  for (const auto& line : table.lines()) {
    const int row = table.index(line, 0, size.height, "rows of dots");
    const int col = table.index(line, 1, size.width, "columns of dots");
    if (!std::isnan(dots(row, col)[0])) {
      table.refuse(
          line, "row " + std::to_string(row) + ", col " + std::to_string(col) + " is given twice");
    }
    dots(row, col) = point(line, 2);
  }
  return dots;
}

}  // namespace replay
