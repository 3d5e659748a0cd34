// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Files and folders that exist completely or not at all, even after a power failure: they are
// written elsewhere, synced and renamed. All functions throw replay::Failure with the system's
// reason.
#include <filesystem>
#include <string>

namespace replay_many {

using Path = std::filesystem::path;

/// Creates `folder` and its parents, and syncs the new ones.
void make_folders(const Path& folder);

/// Writes a text file; replaces an earlier one.
void write_file(const Path& file, const std::string& text);

/// Moves `file`, which is on the same file system, to `place`; replaces an earlier one.
void publish_file(const Path& file, const Path& place);

/// Moves the folder with its content to `place`. If `place` exists already, the same work was done
/// twice, and `folder` is removed. The parents of `place` must exist.
void publish_folder(const Path& folder, const Path& place);

}  // namespace replay_many
