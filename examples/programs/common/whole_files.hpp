// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Files and folders that exist completely or not at all, even after a power failure: they are
// written elsewhere, synced and renamed. All functions throw Failure with the system's
// reason.
#include <filesystem>
#include <fstream>
#include <string>

namespace replay {

/// Creates `folder` and its parents, and syncs the new ones.
void make_folders(const std::filesystem::path& folder);

/// Writes a text file; replaces an earlier one.
void write_file(const std::filesystem::path& file, const std::string& text);

/// Moves `file`, which is on the same file system, to `place`; replaces an earlier one.
void publish_file(const std::filesystem::path& file, const std::filesystem::path& place);

/// Moves the folder with its content to `place`. If `place` exists already, the same work was done
/// twice, and `folder` is removed. The parents of `place` must exist.
void publish_folder(const std::filesystem::path& folder, const std::filesystem::path& place);

/// A file that is written bit by bit, under a temporary name beside its place.
class WholeFile {
 public:
  explicit WholeFile(const std::filesystem::path& place);
  template <class Value>
  WholeFile& operator<<(const Value& value) {
    stream_ << value;
    return *this;
  }
  void publish();

 private:
  std::filesystem::path place_, aside_;
  std::ofstream stream_;
};

}  // namespace replay
