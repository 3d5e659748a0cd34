// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Reads and checks tables of numbers in .csv files.
#include <filesystem>
#include <string>
#include <vector>

namespace replay {

/// A file with the columns `header`, read line by line. Throws Failure with file and line number.
class NumberTable {
 public:
  NumberTable(const std::filesystem::path& file, const std::vector<std::string>& header);

  struct Line {
    int number;  ///< in the file, from 1
    std::vector<double> values;
  };
  const std::vector<Line>& lines() const { return lines_; }

  /// Value of a column as an index in [0, count); `what` names it in error messages.
  int index(const Line& line, std::size_t column, int count, const std::string& what) const;
  [[noreturn]] void refuse(const Line& line, const std::string& why) const;

 private:
  [[noreturn]] void refuse(int number, const std::string& why) const;

  std::filesystem::path file_;
  std::vector<std::string> header_;
  std::vector<Line> lines_;
};

}  // namespace replay
