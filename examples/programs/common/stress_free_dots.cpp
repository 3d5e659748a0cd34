// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/stress_free_dots.hpp"

#include <cmath>
#include <limits>
#include <string>

#include "common/failure.hpp"
#include "common/table.hpp"

namespace replay {
namespace {

SpaceGrid no_points(cv::Size size) {
  return SpaceGrid(size, cv::Vec3d::all(std::numeric_limits<double>::quiet_NaN()));
}

}  // namespace

std::optional<SpaceGrid> read_stress_free_dots(const std::filesystem::path& file, cv::Size size) {
  if (!std::filesystem::exists(file)) {
    return {};
  }
  Table table(file, {"row", "col", "x_mm", "y_mm", "z_mm"});
  SpaceGrid dots = no_points(size);
  while (table.next()) {
    const int row = table.index(0, size.height, "rows of dots");
    const int col = table.index(1, size.width, "columns of dots");
    if (!std::isnan(dots(row, col)[0])) {
      table.refuse("row " + std::to_string(row) + ", col " + std::to_string(col) +
                   " is given twice");
    }
    dots(row, col) = {table.number(2), table.number(3), table.number(4)};
  }
  return dots;
}

}  // namespace replay
