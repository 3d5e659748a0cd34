// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The output folder, written all or nothing: it is built under a temporary name beside its place
// and moved there when it is complete. The folder of an earlier run is replaced; any other is
// refused.
#include <filesystem>
#include <string>
#include <vector>

namespace replay {

class OutputFolder {
 public:
  /// Creates missing parent folders of `place`. Throws Failure if `place` contains anything but the
  /// files of an earlier run, or cannot be written.
  explicit OutputFolder(const std::filesystem::path& place);
  /// Removes the written files unless publish() was called.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Path of PART/NAME in the temporary folder; creates PART.
  std::filesystem::path file(const std::string& part, const std::string& name) const;
  std::filesystem::path file(const std::string& name) const { return growing_ / name; }
  /// Moves the folder to its place; throws Failure.
  void publish();
  const std::filesystem::path& place() const { return place_; }

 private:
  void make_parents(const std::filesystem::path& folder);
  void remove_traces();
  std::filesystem::path place_;
  std::filesystem::path growing_;
  std::vector<std::filesystem::path> made_parents_;  ///< outermost first
};

/// "000012.tiff", or "depth_000012.png" with a stem.
std::string numbered(const std::string& stem, int frame, const std::string& extension);

}  // namespace replay
