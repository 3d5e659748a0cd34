// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "recordings.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include "common/failure.hpp"

namespace replay_many {
namespace {

namespace fs = std::filesystem;

/// The device of a folder's file system; 0 if there is no folder.
unsigned long long device_of(const Path& folder) {
  struct stat about {};
  return ::stat(folder.c_str(), &about) == 0 && S_ISDIR(about.st_mode) ? about.st_dev : 0;
}

bool is_recording(const Path& folder) {
  std::error_code ignored;
  return fs::exists(folder / "sensor.json", ignored) ||
         fs::exists(folder / "taxels.csv", ignored) || fs::exists(folder / "frames", ignored);
}

}  // namespace

Recordings::Recordings(Path input, Path out, bool raw, bool pictures)
    : input_(fs::absolute(input)), out_(fs::absolute(out)), raw_(raw), pictures_(pictures) {
  device_ = device_of(input_);
  if (device_ == 0) {
    replay::fail(input_, "there is no such folder; check that it is mounted");
  }
  const Path relative = fs::weakly_canonical(out_).lexically_relative(fs::canonical(input_));
  if (!relative.empty() && *relative.begin() != "..") {
    replay::fail(out_, "is inside the folder of the recordings; choose another output folder");
  }
  if (is_recording(input_)) {
    look_into(input_, fs::canonical(input_).filename().string());
  } else {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(input_, error)) {
      if (entry.is_directory() && entry.path().filename().string().front() != '.') {
        look_into(entry.path(), entry.path().filename().string());
      }
    }
    if (error) {
      replay::fail(input_, "cannot be read: " + error.message());
    }
  }
  if (all_.empty()) {
    replay::fail(input_, "contains no recordings; check that it is mounted");
  }
  std::sort(all_.begin(), all_.end(),
            [](const Found& a, const Found& b) { return a.name < b.name; });
}

/// Adds the recordings in a folder. A folder that is no recording is searched if it has subfolders;
/// otherwise it counts as a broken recording, so that it is reported.
void Recordings::look_into(const Path& folder, const std::string& name) {
  Found found{name, folder};
  std::vector<Path> folders;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    std::error_code ignored;
    if (entry.is_regular_file(ignored)) {
      found.bytes += static_cast<double>(entry.file_size(ignored));
    } else if (entry.is_directory(ignored) && !entry.is_symlink(ignored) &&
               entry.path().filename().string().front() != '.') {
      folders.push_back(entry.path());
    }
  }
  if (error) {
    found.refused = folder.string() + ": cannot be read: " + error.message();
  } else if (!is_recording(folder) && !folders.empty()) {
    for (const Path& below : folders) {
      look_into(below, name + "/" + below.filename().string());
    }
    return;
  }
  for (const auto& frame : fs::directory_iterator(folder / "frames", error)) {
    std::error_code ignored;
    if (frame.is_regular_file(ignored) && frame.path().filename().string().front() != '.') {
      found.bytes += static_cast<double>(frame.file_size(ignored));
    }
  }
  all_.push_back(std::move(found));
}

std::optional<std::string> Recordings::failure_of(const std::string& name) const {
  std::ifstream file(failure_file(name));
  std::string reason;
  return std::getline(file, reason) ? std::optional(reason) : std::nullopt;
}

std::vector<Unit> Recordings::left(bool retry) {
  std::vector<Unit> units;
  for (const Found& found : all_) {
    std::error_code error;
    if (retry) {
      fs::remove(failure_file(found.name), error);
    }
    if (fs::exists(place_of(found.name), error) || failure_of(found.name)) {
      continue;
    }
    replay::make_folders(place_of(found.name).parent_path());
    if (!found.refused.empty()) {
      job().failed({found.name, {}, 0}, found.refused);
      continue;
    }
    units.push_back(unit_of(found));
  }
  return units;
}

Unit Recordings::unit_of(const Found& found) const {
  Unit unit{found.name,
            {found.folder.string(), out_.string(), place_of(found.name).string()},
            found.bytes};
  if (raw_) {
    unit.arguments.emplace_back("--raw");
  }
  if (!pictures_) {
    unit.arguments.emplace_back("--no-pictures");
  }
  return unit;
}

/// Throws Failure unless the input folder is still on the same file system.
void Recordings::expects_input() const {
  if (device_of(input_) != device_) {
    replay::fail(input_, "has disappeared; check that it is mounted");
  }
}

Job Recordings::job() {
  const auto found_of = [this](const Unit& unit) {
    return std::lower_bound(
        all_.begin(), all_.end(), unit.name,
        [](const Found& found, const std::string& name) { return found.name < name; });
  };
  Job job;
  job.failed = [this](const Unit& unit, const std::string& reason) {
    replay::make_folders(failure_file(unit.name).parent_path());
    replay::write_file(failure_file(unit.name), reason + "\n");
  };
  job.is_there = [this, found_of](const Unit& unit) {
    expects_input();
    std::error_code error;
    return fs::is_directory(found_of(unit)->folder, error);
  };
  return job;
}

}  // namespace replay_many
