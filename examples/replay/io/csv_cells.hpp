// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Cells of .csv files.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace replay {

/// Splits a line, without quoting; blanks and a carriage return are dropped.
inline std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else if (c != ' ' && c != '\t' && c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

/// Whether the whole cell is a finite number.
inline bool is_number(const std::string& text, double& number) {
  char* end = nullptr;
  number = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0' && std::isfinite(number);
}

/// Empty if `value` is not finite.
inline std::string cell_of(double value) {
  char text[320] = "";  // holds the largest double
  if (std::isfinite(value)) {
    std::snprintf(text, sizeof text, "%.6f", value);
  }
  return text;
}

}  // namespace replay
