// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Cells of .csv files.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
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

/// Why a line of several cells is not separated by commas; "" if it may be.
inline std::string wrong_separator(const std::string& line) {
  if (line.find(',') != std::string::npos && line.find(';') == std::string::npos) {
    return "";
  }
  for (const auto& [separator, name] :
       {std::pair(';', "';'"), {'\t', "tabs"}, {'|', "'|'"}, {' ', "blanks"}}) {
    const std::size_t at = line.find_first_not_of(" \t\r");
    if (at != std::string::npos && line.find(separator, at) < line.find_last_not_of(" \t\r")) {
      return std::string("the values are separated by ") + name +
             ", but must be by ',' (and decimals by '.'); write the table again with these";
    }
  }
  return "";
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
