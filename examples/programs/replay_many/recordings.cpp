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
#include "common/sensor.hpp"

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

std::string range_name(int first, int last) {
  return std::to_string(first) + "-" + std::to_string(last);
}

}  // namespace

Recordings::Recordings(Path input, Path out, Settings settings)
    : input_(fs::absolute(input)), out_(fs::absolute(out)), settings_(std::move(settings)) {
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
      ++found.frames;
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
    for (Unit& unit : units_of(found)) {
      units.push_back(std::move(unit));
    }
  }
  return units;
}

/// Only files of single frames are worth splitting: tables need all frames in sequence.
bool Recordings::is_split(const Found& found) const {
  if (found.frames <= settings_.split_frames ||
      !(settings_.replay.pictures || settings_.replay.raw)) {
    return false;
  }
  try {
    const replay::Sensor sensor = replay::read_sensor(found.folder / "sensor.json");
    return !sensor.dots_only && !sensor.video;
  } catch (const replay::Failure&) {
    return false;  // its unit reports the reason
  }
}

std::vector<std::string> Recordings::options() const {
  std::vector<std::string> words;
  if (settings_.replay.raw) {
    words.emplace_back("--raw");
  }
  if (!settings_.replay.pictures) {
    words.emplace_back("--no-pictures");
  }
  return words;
}

std::vector<Unit> Recordings::units_of(const Found& found) {
  const auto unit = [&](const Path& place, int first, int last, double size) {
    Unit made{found.name,
              {"recording", found.folder.string(), out_.string(), place.string(),
               std::to_string(first), std::to_string(last)},
              size};
    for (std::string& word : options()) {
      made.arguments.push_back(std::move(word));
    }
    return made;
  };
  if (!is_split(found)) {
    return {unit(place_of(found.name), 0, -1, found.bytes)};
  }
  std::vector<Unit> units;
  const Path parts = out_ / "parts" / found.name;
  replay::make_folders(parts);
  const auto add = [&](int first, int last, double size) {
    const Path place = parts / range_name(first, last);
    if (std::error_code error; !fs::exists(place, error)) {
      units.push_back(unit(place, first, last, size));
    }
  };
  add(0, 0, found.bytes);
  for (int first = 0; first < found.frames; first += settings_.split_frames) {
    const int last = (std::min)(first + settings_.split_frames, found.frames);
    add(first, last, found.bytes * (last - first) / found.frames);
  }
  parts_left_[found.name] = static_cast<int>(units.size());
  return units.empty() ? std::vector<Unit>{join_of(found)} : units;
}

Unit Recordings::join_of(const Found& found) const {
  Unit unit{found.name, {"join", out_.string(), place_of(found.name).string()}, found.bytes};
  const Path parts = out_ / "parts" / found.name;
  unit.arguments.push_back((parts / range_name(0, 0)).string());
  for (int first = 0; first < found.frames; first += settings_.split_frames) {
    const int last = (std::min)(first + settings_.split_frames, found.frames);
    unit.arguments.push_back((parts / range_name(first, last)).string());
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
  job.done = [this, found_of](const Unit& unit) {
    const auto parts = parts_left_.find(unit.name);
    if (unit.arguments.front() == "join" || parts == parts_left_.end() || --parts->second > 0) {
      return std::vector<Unit>();
    }
    return std::vector<Unit>{join_of(*found_of(unit))};
  };
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
