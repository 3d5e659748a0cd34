// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What is wrong with a recording, before anything is computed from it: units, signs and order of
// numbers, light, clock, calibration. Each check looks for one likely mistake, with a threshold far
// from what a good recording shows; a recording that passes may still be wrong in other ways.
#include <filesystem>
#include <string>
#include <vector>

namespace replay {

struct Finding {
  std::string place;     ///< file, and what in it
  std::string what;      ///< what is seen
  std::string remedy;    ///< what to do about it
  bool is_wrong = true;  ///< false: only something that cannot be computed without more
};
using Findings = std::vector<Finding>;

/// All that is found; empty: nothing. What cannot be read at all is a finding, too.
Findings check_recording(const std::filesystem::path& folder);

/// Prints a line for each finding. The exit status: 0 nothing is wrong, 1 something is.
int print_check(const std::filesystem::path& folder);

}  // namespace replay
