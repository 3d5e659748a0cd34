// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Labelled recordings in a folder.
#include <filesystem>
#include <string>
#include <vector>

namespace slip_trials {

struct Trial {
  std::string object;  ///< empty if there is only one
  std::string name;
  bool slips = false;
  std::vector<std::filesystem::path> views;  ///< videos, or folders of frames
  std::filesystem::path free;                ///< frames of the free pad; may be empty
};

/// Finds the trials, sorted by object and name, slips first. Throws replay::Failure if there are
/// none, or for a label that is neither slip nor hold.
std::vector<Trial> trials_of(const std::filesystem::path& folder);

}  // namespace slip_trials
