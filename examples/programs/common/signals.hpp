// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// signals.csv of a recording: frame,time_s,pressure_mpa. The last column may be absent or empty.
#include <filesystem>
#include <map>
#include <string>

namespace replay {

/// Times and pressures of the frames in the file.
struct Signals {
  std::map<int, std::string> times_s;  ///< as written in the file
  std::map<int, double> pressures_mpa;

  std::string time_s(int frame) const;   ///< empty if unknown
  double pressure_mpa(int frame) const;  ///< NaN if unknown
};

/// Throws Failure with the line number. A missing file is no error and gives no frames.
Signals read_signals(const std::filesystem::path& file, int frame_count);

}  // namespace replay
