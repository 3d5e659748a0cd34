// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/table.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string_view>
#include <utility>

namespace replay {
namespace {

/// Blanks, quotes and a carriage return are dropped.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else if (c != ' ' && c != '\t' && c != '\r' && c != '"') {
      cells.back() += c;
    }
  }
  return cells;
}

/// Why a line of several cells is not separated by commas; "" if it may be.
std::string wrong_separator(const std::string& line) {
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

}  // namespace

Table::Table(const std::filesystem::path& file, Lines lines)
    : file_(file), stream_(file), lines_(lines) {
  std::string text;
  if (!std::getline(stream_, text)) {
    fail(file, "is empty or cannot be read");
  }
  if (text.rfind("\xEF\xBB\xBF", 0) == 0) {  // byte order mark, as spreadsheets write it
    text.erase(0, 3);
  }
  while (text.starts_with('#')) {  // a comment, or the header as NumPy writes it
    text.erase(0, 1);
    if (text.find(',') == std::string::npos) {
      ++line_;
      text.clear();
      std::getline(stream_, text);
    }
  }
  if (const std::string why = wrong_separator(text); !why.empty()) {
    refuse(why);
  }
  header_ = cells_of(text);
}

Table::Table(const std::filesystem::path& file, const std::vector<std::string>& header)
    : Table(file) {
  if (header_ != header) {
    std::string names;
    for (const std::string& name : header) {
      names += (names.empty() ? "" : ",") + name;
    }
    refuse("must be " + names);
  }
}

bool Table::next() {
  std::string text;
  do {
    if (!std::getline(stream_, text)) {
      return false;
    }
    ++line_;
    cells_ = cells_of(text);
  } while (cells_.size() == 1 && cells_[0].empty());
  if (const std::string why = wrong_separator(text); !why.empty()) {
    refuse(why);
  }
  const std::size_t given = cells_.size(), wanted = header_.size();
  if (given > wanted || (given < wanted && lines_ == Lines::complete)) {
    refuse("has " + std::to_string(given) + " values, must have " + std::to_string(wanted) +
           (given > wanted ? " (decimals must be separated by '.')" : ""));
  }
  cells_.resize(wanted);
  return true;
}

double Table::number(std::size_t column) const {
  const double number = number_or_nan(column);
  if (!std::isfinite(number)) {
    refuse(header_[column] + " '" + cells_[column] + "' is not a number");
  }
  return number;
}

double Table::number_or_nan(std::size_t column) const {
  double number = 0;
  if (!read_number(cells_[column], number)) {
    refuse(header_[column] + " '" + cells_[column] + "' is not a number");
  }
  return number;
}

int Table::index(std::size_t column, int count, const std::string& what) const {
  double number = 0;
  if (!read_number(cells_[column], number) || number != std::floor(number) || number < 0 ||
      number >= count) {
    refuse(header_[column] + " '" + cells_[column] + "' is not one of the " + what + " 0 to " +
           std::to_string(count - 1));
  }
  return static_cast<int>(number);
}

void Table::refuse(const std::string& why) const {
  fail(file_, "line " + std::to_string(line_) + ": " + why);
}

bool read_number(const std::string& text, double& number) {
  char* end = nullptr;
  number = std::strtod(text.c_str(), &end);
  if (*end != '\0') {
    return false;
  }
  if (text.empty() || !std::isfinite(number)) {
    number = std::numeric_limits<double>::quiet_NaN();
  }
  return true;
}

std::string cell_of(double value) {
  char text[320] = "";  // holds the largest double
  if (std::isfinite(value)) {
    std::snprintf(text, sizeof text, "%.6f", value);
  }
  return text;
}

void Doubts::see(const std::string& name, const std::string& cell) {
  constexpr std::string_view status = "_status";
  if (name.ends_with(status) && !cell.empty() && cell != "ok" && cell != "no contact") {
    ++counts_[name.substr(0, name.size() - status.size())][cell];
  }
}

std::map<std::string, std::string> Doubts::in_words() const {
  std::map<std::string, std::string> all;
  for (const auto& [name, words] : counts_) {
    int sum = 0;
    std::string parts;
    for (const auto& [word, count] : words) {
      sum += count;
      parts += (parts.empty() ? "" : ", ") + word + " " + std::to_string(count);
    }
    all[name] = std::to_string(sum) + " frames (" + parts + ")";
  }
  return all;
}

}  // namespace replay
