// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// signals.csv of a recording: frame,time_s,pressure_mpa. The last column may be absent or empty.
#include <filesystem>
#include <map>
#include <string>

namespace replay {

/// What is known of the frames that the file names.
struct Signals {
  std::map<int, std::string> times_s;  ///< as written there
  std::map<int, double> pressures_mpa;

  std::string time_s(int frame) const;   ///< empty where unknown
  double pressure_mpa(int frame) const;  ///< NaN where unknown
};

/// Throws Failure with the line number. An absent file is no fault and names no frame.
Signals read_signals(const std::filesystem::path& file, int frame_count);

}  // namespace replay
