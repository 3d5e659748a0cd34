// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The fuzzer's bytes as a file.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "fuzz/input.hpp"

namespace fuzz {

/// A file in a folder of its own for each process, in memory where the system has such a folder.
/// Its name is the same in each process: a decoder may look at the name.
class File {
 public:
  File() {
    const std::filesystem::path memory = "/dev/shm";
    std::string folder =
        ((exists(memory) ? memory : std::filesystem::temp_directory_path()) / "fingerpad_XXXXXX")
            .string();
    require(mkdtemp(folder.data()) != nullptr, "a folder can be created");
    path_ = std::filesystem::path(folder) / "file";
  }
  ~File() { remove_all(folder()); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  std::filesystem::path folder() const { return path_.parent_path(); }
  const std::filesystem::path& with(const std::string& content) const {
    std::ofstream(path_, std::ios::binary) << content;
    return path_;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace fuzz
