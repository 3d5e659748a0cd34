// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Turns a folder of recordings into units of work. The output consists of:
//   DIR/recordings/NAME/  the output of replay; a recording is done if this exists
//   DIR/failed/NAME.txt   the reason of a failure
//   DIR/aside/            temporary files
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/whole_files.hpp"
#include "engine.hpp"

namespace replay_many {

using Path = std::filesystem::path;

class Recordings {
 public:
  /// Finds the recordings in `input`; throws replay::Failure if there are none.
  /// `raw` and `pictures` are those of replay.
  Recordings(Path input, Path out, bool raw, bool pictures);

  struct Found {
    std::string name;  ///< path relative to the input
    Path folder;
    double bytes = 0;
    std::string refused = {};  ///< why it cannot be read
  };
  const std::vector<Found>& all() const { return all_; }  ///< sorted by name

  /// The remaining units. With `retry`, recordings that failed before are tried again.
  std::vector<Unit> left(bool retry);
  Job job();

  Path place_of(const std::string& name) const { return out_ / "recordings" / name; }
  /// Why a recording failed; empty if it did not.
  std::optional<std::string> failure_of(const std::string& name) const;

 private:
  void look_into(const Path& folder, const std::string& name);
  Unit unit_of(const Found& found) const;
  Path failure_file(const std::string& name) const { return out_ / "failed" / (name + ".txt"); }
  void expects_input() const;

  Path input_, out_;
  bool raw_, pictures_;
  std::vector<Found> all_;
  unsigned long long device_ = 0;  ///< device of the input's file system
};

/// Runs a unit with these arguments in its own process. Returns the exit status, a value of End,
/// and prints the reason of a failure on standard error.
int run_unit(const std::vector<std::string>& arguments);

}  // namespace replay_many
