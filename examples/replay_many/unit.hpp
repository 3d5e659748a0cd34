// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Work that a process of its own does, so that whatever it meets ends that process alone.
#include <cstddef>
#include <string>
#include <vector>

namespace replay_many {

struct Unit {
  std::string name;                    ///< for people
  std::vector<std::string> arguments;  ///< behind "--unit", to this program
  double size = 0;                     ///< in whatever grows with time; the largest goes first
};

/// How a unit's process ended, and its exit status.
enum class End {
  done = 0,
  failed = 1,   ///< something in the recording
  no_room = 3,  ///< the output cannot be written
  missing = 4,  ///< the recording is not to be seen from there
  died = 5      ///< by a signal, or for want of memory: it may do better another time
};

struct Report {
  std::size_t unit = 0;
  End end = End::done;
  std::string reason = {};  ///< one line; empty where it is done
  int rank = 0;             ///< where it ran
};

}  // namespace replay_many
