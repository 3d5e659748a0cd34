// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Labelled recordings in a folder.
#include <filesystem>
#include <string>
#include <vector>

namespace slip_trials {

struct Trial {
  std::string object;  ///< empty where there is one only
  std::string name;
  bool slips = false;
  std::vector<std::filesystem::path> views;  ///< videos, or folders of frames
  std::filesystem::path free;                ///< frames of the free pad; empty: none
};

/// Sorted by object and name, slips first; throws replay::Failure where there are none, and for a
/// label that says neither slip nor hold.
std::vector<Trial> trials_of(const std::filesystem::path& folder);

}  // namespace slip_trials
