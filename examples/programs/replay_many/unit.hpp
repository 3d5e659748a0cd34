// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Units of work. Each runs in its own process, so that a crash ends only that process.
#include <cstddef>
#include <string>
#include <vector>

namespace replay_many {

struct Unit {
  std::string name;                    ///< for messages
  std::vector<std::string> arguments;  ///< of this program, after "--unit"
  double size = 0;                     ///< any measure of the run time; the largest unit runs first
};

/// How a unit's process ended; the values are its exit status.
enum class End {
  done = 0,
  failed = 1,   ///< the recording is at fault
  no_room = 3,  ///< the output cannot be written
  missing = 4,  ///< the recording is not visible from the unit's machine
  died = 5      ///< by a signal or lack of memory; a retry may succeed
};

struct Report {
  std::size_t unit = 0;
  End end = End::done;
  std::string reason = {};  ///< one line; empty if done
  int rank = 0;             ///< the rank that ran it
};

}  // namespace replay_many
