// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Runs units on this machine, each in a process that dies with this one.
#include <sys/types.h>

#include <cstdio>
#include <memory>
#include <vector>

#include "unit.hpp"

namespace replay_many {

class Children {
 public:
  /// Runs up to `jobs` processes at a time, > 0.
  explicit Children(int jobs) : jobs_(jobs) {}

  bool is_full() const { return static_cast<int>(running_.size()) >= jobs_; }
  /// Requires !is_full(). Throws replay::Failure if no process can be created.
  void start(std::size_t unit, const std::vector<std::string>& arguments);
  /// Reports of the units that have ended since the last call.
  std::vector<Report> ended();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  struct Child {
    std::size_t unit;
    pid_t process;
    std::unique_ptr<std::FILE, Close> words;  ///< its standard error
  };
  static Report report_of(const Child& child, int status);

  int jobs_;
  std::vector<Child> running_;
};

}  // namespace replay_many
