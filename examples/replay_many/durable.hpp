// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Files and folders that are there whole or not at all, whenever the power goes: written aside,
// synced, renamed. All throw replay::Failure with the system's reason.
#include <filesystem>
#include <string>

namespace replay_many {

using Path = std::filesystem::path;

/// Makes `folder` and those above it, and syncs what is new.
void make_folders(const Path& folder);

/// Writes a text file; an earlier one is replaced.
void write_file(const Path& file, const std::string& text);

/// Moves `file`, written aside on the same file system, to `place`; an earlier one is replaced.
void publish_file(const Path& file, const Path& place);

/// Moves the folder to `place`, with all that is in it; where `place` is there already, it is the
/// same work done twice, and the folder goes. The folders above `place` must be there.
void publish_folder(const Path& folder, const Path& place);

}  // namespace replay_many
