// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Files of tests: folders that are removed at the end, the bundled recordings, texts and tables.
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "support/catch.hpp"

namespace test {

inline const std::filesystem::path bundled_recordings =
    (std::filesystem::path(__FILE__).parent_path() / "../../examples/data").lexically_normal();

/// An empty folder of its own, removed with all that is in it.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "fingerpad.XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~ScratchFolder() { std::filesystem::remove_all(path_); }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Replaces the first `old` of a file, which must be there.
inline void replace_in(const std::filesystem::path& file,
                       const std::string& old,
                       const std::string& with) {
  std::string text = text_of(file);
  REQUIRE(text.find(old) != std::string::npos);
  std::ofstream(file) << text.replace(text.find(old), old.size(), with);
}

inline std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

/// A line of a table: its cells by the names of their columns.
using Line = std::map<std::string, std::string>;

inline std::vector<Line> table_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string text;
  REQUIRE(std::getline(stream, text));
  const auto header = cells_of(text);
  std::vector<Line> lines;
  while (std::getline(stream, text)) {
    const auto cells = cells_of(text);
    REQUIRE(cells.size() == header.size());
    Line line;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      line[header[k]] = cells[k];
    }
    lines.push_back(line);
  }
  return lines;
}

}  // namespace test
