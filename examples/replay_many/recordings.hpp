// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A folder of recordings as units of work, and what is there of the output:
//   DIR/recordings/NAME/  what replay writes, and small.png; it is done when it is there
//   DIR/failed/NAME.txt   why there is none
//   DIR/parts/NAME/PART/  of a long recording, until all parts are there
//   DIR/aside/            what grows; of no use to anybody else
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "durable.hpp"
#include "engine.hpp"
#include "replay/replay.hpp"

namespace replay_many {

/// How recordings are processed; `recording`, `out` and the frames belong to each unit.
struct Settings {
  replay::Options replay;
  int split_frames =
      2000;  ///< longer recordings with files for each frame are split into such parts
};

class Recordings {
 public:
  /// Finds the recordings in `input`; throws replay::Failure where there are none.
  Recordings(Path input, Path out, Settings settings);

  struct Found {
    std::string name;  ///< its path within the input
    Path folder;
    double bytes = 0;
    int frames = 0;            ///< 0: not a folder of frames
    std::string refused = {};  ///< why it cannot be looked into
  };
  const std::vector<Found>& all() const { return all_; }  ///< by name

  /// What is left to do. Recordings that have failed before are tried again if `retry`.
  std::vector<Unit> left(bool retry);
  Job job();

  Path place_of(const std::string& name) const { return out_ / "recordings" / name; }
  /// Why it has failed; none: it has not.
  std::optional<std::string> failure_of(const std::string& name) const;

 private:
  void look_into(const Path& folder, const std::string& name);
  bool is_split(const Found& found) const;
  std::vector<Unit> units_of(const Found& found);
  Unit join_of(const Found& found) const;
  std::vector<std::string> options() const;
  Path failure_file(const std::string& name) const { return out_ / "failed" / (name + ".txt"); }
  void expects_input() const;

  Path input_, out_;
  Settings settings_;
  std::vector<Found> all_;
  std::map<std::string, int> parts_left_;  ///< of split recordings at work
  unsigned long long device_ = 0;          ///< that the input is on
};

/// What a process of its own does with a unit's arguments: the exit status, as End has it; says why
/// on standard error.
int run_unit(const std::vector<std::string>& arguments);

}  // namespace replay_many
