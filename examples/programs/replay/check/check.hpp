// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Checks a recording before anything is computed from it: units, signs and order of numbers, light,
// clock, calibration. Each check looks for one likely mistake, with a threshold far from the values
// of good recordings; a recording that passes may still be wrong in other ways.
#include <filesystem>
#include <string>
#include <vector>

namespace replay {

struct Finding {
  std::string place;     ///< file, and the part of it
  std::string what;      ///< the symptom, without a full stop
  std::string remedy;    ///< how to repair it, in whole sentences
  bool is_wrong = true;  ///< false: no mistake, only missing data
};
using Findings = std::vector<Finding>;

/// Returns all findings. A recording that cannot be read gives a finding, too.
Findings check_recording(const std::filesystem::path& folder,
                         const std::filesystem::path& sensor = {});

/// Prints a line for each finding. Returns the exit status: 1 if any finding is wrong, else 0.
int print_check(const std::filesystem::path& folder, const std::filesystem::path& sensor = {});

}  // namespace replay
