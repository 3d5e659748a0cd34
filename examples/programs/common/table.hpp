// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Tables in .csv files: cells separated by commas, decimals by dots, no quotes.
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/failure.hpp"

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

/// How often each word of doubt stands in a table, by the name of its column.
class Doubts {
 public:
  /// Counts a cell of the column `name`, if that is one of a status. "ok" and "no contact" are no
  /// doubt.
  void see(const std::string& name, const std::string& cell);
  /// One entry a column with doubt: "depth", "3 frames (not of this pad 2, refused 1)".
  std::map<std::string, std::string> in_words() const;

 private:
  std::map<std::string, std::map<std::string, int>> counts_;
};

/// A column of a table that is written: its name, and its cell in a row.
template <class Row>
struct Column {
  std::string name;
  std::function<std::string(const Row&)> cell;
};

/// Writes a table. One list of columns makes the header, the lines and the count of doubts.
template <class Row>
class TableWriter {
 public:
  TableWriter(const std::filesystem::path& file, std::vector<Column<Row>> columns)
      : file_(file), stream_(file), columns_(std::move(columns)) {
    const char* comma = "";
    for (const Column<Row>& column : columns_) {
      stream_ << std::exchange(comma, ",") << column.name;
    }
    stream_ << '\n';
  }
  void write(const Row& row) {
    const char* comma = "";
    for (const Column<Row>& column : columns_) {
      const std::string cell = column.cell(row);
      stream_ << std::exchange(comma, ",") << cell;
      doubts_.see(column.name, cell);
    }
    stream_ << '\n';
  }
  /// Throws Failure where anything could not be written.
  void close() {
    stream_.close();
    if (!stream_) {
      fail(file_, "cannot be written");
    }
  }
  const Doubts& doubts() const { return doubts_; }

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
  std::vector<Column<Row>> columns_;
  Doubts doubts_;
};

}  // namespace replay
