// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "durable.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <system_error>

#include "common/failure.hpp"

namespace replay_many {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const Path& file, int error) {
  replay::fail(file, "cannot be written: " + std::generic_category().message(error));
}

/// Syncs a file's content, or a folder's directory entries.
void sync(const Path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    refuse(path, errno);
  }
  const int error = ::fsync(file) == 0 ? 0 : errno;
  ::close(file);
  if (error != 0 && error != EINVAL) {  // EINVAL: the file system does not support it
    refuse(path, error);
  }
}

}  // namespace

void make_folders(const Path& folder) {
  std::error_code error;
  if (folder.empty() || fs::is_directory(folder, error)) {
    return;
  }
  make_folders(folder.parent_path());
  fs::create_directory(folder, error);
  if (error) {
    refuse(folder, error.value());
  }
  sync(folder.parent_path().empty() ? "." : folder.parent_path());
}

void write_file(const Path& file, const std::string& text) {
  Path aside = file;
  aside += ".part";
  errno = 0;
  std::ofstream stream(aside, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) {
    refuse(aside, errno);
  }
  publish_file(aside, file);
}

void publish_file(const Path& file, const Path& place) {
  sync(file);
  if (std::rename(file.c_str(), place.c_str()) != 0) {
    refuse(place, errno);
  }
  sync(place.parent_path());
}

void publish_folder(const Path& folder, const Path& place) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    sync(entry.path());
  }
  sync(folder);
  if (std::rename(folder.c_str(), place.c_str()) != 0) {
    if (errno != ENOTEMPTY && errno != EEXIST) {
      refuse(place, errno);
    }
    fs::remove_all(folder);
  }
  sync(place.parent_path());
}

}  // namespace replay_many
