// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Tables in .csv files: cells separated by commas, decimals by dots, no quotes.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace replay {

/// Reads a table line by line. Every function throws Failure with file and number of the line
/// for what it refuses.
class Table {
 public:
  enum class Lines { complete, may_end_early };  ///< the latter: missing cells are empty

  /// Takes any header.
  explicit Table(const std::filesystem::path& file, Lines lines = Lines::complete);
  /// Refuses another header.
  Table(const std::filesystem::path& file, const std::vector<std::string>& header);

  const std::vector<std::string>& header() const { return header_; }

  /// Reads the next line that is not empty; false at the end of the file.
  bool next();
  int line() const { return line_; }  ///< in the file, from 1
  const std::vector<std::string>& cells() const { return cells_; }

  /// A cell that must be a finite number.
  double number(std::size_t column) const;
  /// The same, but NaN if it is empty, "nan" or infinite.
  double number_or_nan(std::size_t column) const;
  /// A cell that must be a whole number in [0, count); `what` names it in the message.
  int index(std::size_t column, int count, const std::string& what) const;
  [[noreturn]] void refuse(const std::string& why) const;

 private:
  std::filesystem::path file_;
  std::ifstream stream_;
  Lines lines_;
  int line_ = 1;
  std::vector<std::string> header_, cells_;
};

/// Whether the whole text is a number, which is NaN if the text is empty, "nan" or infinite.
bool read_number(const std::string& text, double& number);

/// Six decimals; empty if `value` is not finite.
std::string cell_of(double value);

}  // namespace replay
