// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/stress_free_dots.hpp"

#include <cmath>
#include <limits>
#include <string>

#include "common/failure.hpp"
#include "common/number_table.hpp"

namespace replay {
namespace {

SpaceGrid no_points(cv::Size size) {
  return SpaceGrid(size, cv::Vec3d::all(std::numeric_limits<double>::quiet_NaN()));
}

cv::Vec3d point(const NumberTable::Line& line, std::size_t column) {
  return {line.values[column], line.values[column + 1], line.values[column + 2]};
}

}  // namespace

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
