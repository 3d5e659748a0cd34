// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/whole_files.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "common/failure.hpp"

namespace replay {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, int error) {
  fail(file, "cannot be written: " + std::generic_category().message(error));
}

/// Syncs a file's content, or a folder's directory entries.
void sync(const fs::path& path) {
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

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : ".";
}

}  // namespace

void make_folders(const fs::path& folder) {
  std::error_code error;
  if (folder.empty() || fs::is_directory(folder, error)) {
    return;
  }
  make_folders(folder.parent_path());
  fs::create_directory(folder, error);
  if (error) {
    refuse(folder, error.value());
  }
  sync(folder_of(folder));
}

void write_file(const fs::path& file, const std::string& text) {
  WholeFile whole(file);
  whole << text;
  whole.publish();
}

WholeFile::WholeFile(const fs::path& place)
    : place_(place), aside_(place.string() + ".part"), stream_(aside_, std::ios::binary) {}

void WholeFile::publish() {
  errno = 0;
  stream_.close();
  if (!stream_) {
    refuse(aside_, errno);
  }
  publish_file(aside_, place_);
}

void publish_file(const fs::path& file, const fs::path& place) {
  sync(file);
  if (std::rename(file.c_str(), place.c_str()) != 0) {
    refuse(place, errno);
  }
  sync(folder_of(place));
}

void publish_folder(const fs::path& folder, const fs::path& place) {
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
  sync(folder_of(place));
}

}  // namespace replay
