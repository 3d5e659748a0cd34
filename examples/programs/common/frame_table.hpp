// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// frames.csv: every number of a frame beside its doubt. One list of columns makes the header, the
// lines and the summary of what was doubted.
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "replay/steps/frame.hpp"

namespace replay {

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

class FramesCsv {
 public:
  explicit FramesCsv(const std::filesystem::path& file);
  void write(const FrameRow& row);
  void close();  ///< throws Failure where anything could not be written
  const Doubts& doubts() const { return doubts_; }

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
  Doubts doubts_;
};

}  // namespace replay
