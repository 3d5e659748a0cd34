// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// signals.csv of a recording: frame,time_s,pressure_mpa. The last column may be absent or empty.
#include <filesystem>
#include <map>
#include <string>

namespace replay {

/// Time of each frame that the file names, as written there; throws Failure with the line number.
/// An absent file is no fault and names no frame.
std::map<int, std::string> read_times(const std::filesystem::path& file, int frame_count);

}  // namespace replay
