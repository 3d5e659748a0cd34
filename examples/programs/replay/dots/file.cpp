// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/dots/file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <string>
#include <tuple>
#include <vector>

#include "common/csv_cells.hpp"
#include "common/failure.hpp"

namespace replay {
namespace {

const std::vector<std::string> header = {"frame", "row", "col", "x_px", "y_px"};
constexpr int largest_print = 100;  // rows or columns of a print whose size only the file gives

struct Line {
  int frame = 0;
  int row = 0;
  int col = 0;
  cv::Vec2d pixel;
};

/// Reads the lines of one file and checks each line alone.
class LineReader {
 public:
  LineReader(const std::filesystem::path& file, int frame_count, std::optional<cv::Size> size)
      : file_(file), frame_count_(frame_count), size_(size), stream_(file) {
    std::string line;
    if (!std::getline(stream_, line)) {
      fail(file, "is empty or cannot be read");
    }
    if (cells_of(line) != header) {
      refuse("must be frame,row,col,x_px,y_px");
    }
  }

  /// Returns false at the end of the file.
  bool next(Line& line) {
    std::string text;
    while (std::getline(stream_, text)) {
      ++number_;
      cells_ = cells_of(text);
      if (cells_.size() == 1 && cells_[0].empty()) {
        continue;
      }
      if (cells_.size() != header.size()) {
        refuse("has " + std::to_string(cells_.size()) + " values, must have " +
               std::to_string(header.size()));
      }
      line.frame = index(0, frame_count_, "frames");
      line.row = index(1, size_ ? size_->height : largest_print, "rows of dots");
      line.col = index(2, size_ ? size_->width : largest_print, "columns of dots");
      line.pixel = {coordinate(3), coordinate(4)};
      return true;
    }
    return false;
  }

  [[noreturn]] void refuse(const std::string& why) const {
    fail(file_, "line " + std::to_string(number_) + ": " + why);
  }

 private:
  int index(std::size_t cell, int count, const std::string& what) const {
    double number = 0;
    if (!is_number(cells_[cell], number) || number != std::floor(number) || number < 0 ||
        number >= count) {
      refuse(header[cell] + " '" + cells_[cell] + "' is not one of the " + what + " 0 to " +
             std::to_string(count - 1));
    }
    return static_cast<int>(number);
  }

  double coordinate(std::size_t cell) const {
    double number = 0;
    if (!is_number(cells_[cell], number)) {
      refuse(header[cell] + " '" + cells_[cell] + "' is not a number");
    }
    return number;
  }

  const std::filesystem::path& file_;
  int frame_count_;
  std::optional<cv::Size> size_;
  std::ifstream stream_;
  int number_ = 1;
  std::vector<std::string> cells_;
};

}  // namespace

std::map<int, DotGrid> read_dots(const std::filesystem::path& file,
                                 int frame_count,
                                 std::optional<cv::Size> size) {
  LineReader reader(file, frame_count, size);
  std::map<std::array<int, 3>, cv::Vec2d> found;
  cv::Size largest(0, 0);
  for (Line line; reader.next(line);) {
    if (!found.emplace(std::array<int, 3>{line.frame, line.row, line.col}, line.pixel).second) {
      reader.refuse("row " + std::to_string(line.row) + ", col " + std::to_string(line.col) +
                    " of frame " + std::to_string(line.frame) + " is given twice");
    }
    largest.height = (std::max)(largest.height, line.row + 1);
    largest.width = (std::max)(largest.width, line.col + 1);
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
