// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What goes wrong with a file: one line that says which file and why. Thrown anywhere, shown once,
// in main.
#include <filesystem>
#include <stdexcept>
#include <string>

namespace replay {

class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws "FILE: why" as one line, whatever a library put into `why`.
[[noreturn]] inline void fail(const std::filesystem::path& file, const std::string& why) {
  std::string line = file.string() + ": " + why;
  for (char& c : line) {
    c = c == '\n' || c == '\r' ? ' ' : c;
  }
  throw Failure(line);
}

}  // namespace replay
