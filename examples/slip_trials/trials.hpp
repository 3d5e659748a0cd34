// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Labelled recordings in a folder.
#include <filesystem>
#include <string>
#include <vector>

namespace slip_trials {

struct Trial {
  std::string name;
  bool slips = false;
  std::vector<std::filesystem::path> views;  ///< videos, or folders of frames
};

/// Sorted by name; throws replay::Failure where there are none.
std::vector<Trial> trials_of(const std::filesystem::path& folder);

}  // namespace slip_trials
