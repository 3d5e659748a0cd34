// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// An error with a file: one line that names the file and the reason. It may be thrown anywhere and
// is printed once, in main().
#include <filesystem>
#include <stdexcept>
#include <string>

namespace replay {

class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A picture that is damaged: the others may be read without it.
class Unreadable : public Failure {
 public:
  using Failure::Failure;
};

/// Throws Failure("FILE: why") as one line, even if `why` from a library has several.
template <class Error = Failure>
[[noreturn]] inline void fail(const std::filesystem::path& file, const std::string& why) {
  std::string line = file.string() + ": " + why;
  for (char& c : line) {
    c = c == '\n' || c == '\r' ? ' ' : c;
  }
  throw Error(line);
}

}  // namespace replay
