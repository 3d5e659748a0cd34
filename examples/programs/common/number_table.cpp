// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/number_table.hpp"

#include <cmath>
#include <fstream>

#include "common/csv_cells.hpp"
#include "common/failure.hpp"

namespace replay {

NumberTable::NumberTable(const std::filesystem::path& file, const std::vector<std::string>& header)
    : file_(file), header_(header) {
  std::ifstream stream(file);
  std::string text;
  if (!std::getline(stream, text)) {
    fail(file, "is empty or cannot be read");
  }
  if (const std::string why = wrong_separator(text); !why.empty()) {
    refuse(1, why);
  }
  if (cells_of(text) != header) {
    std::string names;
    for (const std::string& name : header) {
      names += (names.empty() ? "" : ",") + name;
    }
    refuse(1, "must be " + names);
  }
  for (int number = 2; std::getline(stream, text); ++number) {
    const std::vector<std::string> cells = cells_of(text);
    if (cells.size() == 1 && cells[0].empty()) {
      continue;
    }
    if (cells.size() != header.size()) {
      const std::string why = wrong_separator(text);
      refuse(number, !why.empty() ? why
                                  : "has " + std::to_string(cells.size()) + " values, must have " +
                                        std::to_string(header.size()) +
                                        (cells.size() > header.size()
                                             ? " (decimals must be separated by '.')"
                                             : ""));
    }
    Line line{number, std::vector<double>(cells.size())};
    for (std::size_t k = 0; k < cells.size(); ++k) {
      if (!is_number(cells[k], line.values[k])) {
        refuse(number, header[k] + " '" + cells[k] + "' is not a number");
      }
    }
    lines_.push_back(line);
  }
}

int NumberTable::index(const Line& line,
                       std::size_t column,
                       int count,
                       const std::string& what) const {
  const double value = line.values[column];
  if (value != std::floor(value) || value < 0 || value >= count) {
    char number[32];
    std::snprintf(number, sizeof number, "%g", value);
    refuse(line.number, header_[column] + " '" + number + "' is not one of the " + what + " 0 to " +
                            std::to_string(count - 1));
  }
  return static_cast<int>(value);
}

void NumberTable::refuse(const Line& line, const std::string& why) const {
  refuse(line.number, why);
}

void NumberTable::refuse(int number, const std::string& why) const {
  fail(file_, "line " + std::to_string(number) + ": " + why);
}

}  // namespace replay
