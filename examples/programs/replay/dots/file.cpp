// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/dots/file.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "common/failure.hpp"
#include "common/table.hpp"

namespace replay {
namespace {

constexpr int largest_print = 100;  // rows or columns of a print whose size only the file gives

}  // namespace

std::map<int, DotGrid> read_dots(const std::filesystem::path& file,
                                 int frame_count,
                                 std::optional<cv::Size> size) {
  Table table(file, {"frame", "row", "col", "x_px", "y_px"});
  std::map<std::array<int, 3>, cv::Vec2d> found;
  cv::Size largest(0, 0);
  while (table.next()) {
    const int frame = table.index(0, frame_count, "frames");
    const int row = table.index(1, size ? size->height : largest_print, "rows of dots");
    const int col = table.index(2, size ? size->width : largest_print, "columns of dots");
    const cv::Vec2d pixel(table.number(3), table.number(4));
    if (!found.emplace(std::array<int, 3>{frame, row, col}, pixel).second) {
      table.refuse("row " + std::to_string(row) + ", col " + std::to_string(col) + " of frame " +
                   std::to_string(frame) + " is given twice");
    }
    largest = {(std::max)(largest.width, col + 1), (std::max)(largest.height, row + 1)};
  }
  if (found.empty()) {
    fail(file, "lists no dots");
  }
  std::map<int, DotGrid> dots;
  for (const auto& [where, pixel] : found) {
    DotGrid& grid = dots[where[0]];
    if (grid.empty()) {
      grid = no_dots(size.value_or(largest));
    }
    grid(where[1], where[2]) = pixel;
  }
  return dots;
}

}  // namespace replay
