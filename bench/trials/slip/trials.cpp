// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "trials.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <set>
#include <sstream>
#include <tuple>

#include "common/failure.hpp"

namespace slip_trials {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> sorted_entries(const fs::path& folder) {
  std::vector<fs::path> entries;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().filename().string().front() != '.') {
      entries.push_back(entry.path());
    }
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

bool has_extension(const fs::path& file, const std::set<std::string>& extensions) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return fs::is_regular_file(file) && extensions.count(extension) > 0;
}

/// The videos in a folder, or the folder itself if it contains pictures.
std::vector<fs::path> views_in(const fs::path& folder) {
  std::vector<fs::path> videos;
  bool pictures = false;
  for (const fs::path& file : sorted_entries(folder)) {
    if (has_extension(file, {".avi", ".mp4", ".mkv", ".mov"})) {
      videos.push_back(file);
    }
    pictures = pictures || has_extension(file, {".jpg", ".jpeg", ".png", ".bmp"});
  }
  return videos.empty() && pictures ? std::vector<fs::path>{folder} : videos;
}

/// A public data set labels clips that shake and hold as `wiggle`.
bool says_slip(const fs::path& file, const std::string& label) {
  static const std::set<std::string> slip = {"fail", "slip"};
  static const std::set<std::string> hold = {"ok", "success", "hold", "wiggle"};
  if (slip.count(label) == 0 && hold.count(label) == 0) {
    replay::fail(file,
                 "unknown label \"" + label + "\" (known: fail, slip; ok, success, hold, wiggle)");
  }
  return slip.count(label) > 0;
}

/// The trials listed in `file`; their folders are in `folder`.
std::vector<Trial> by_labels(const fs::path& file,
                             const fs::path& folder,
                             const std::string& object) {
  std::ifstream labels(file);
  std::vector<Trial> trials;
  for (std::string line; std::getline(labels, line);) {
    std::istringstream words(line);
    std::string height;
    std::string outcome;
    std::string number;
    std::string start;
    std::string end;
    std::string event;
    std::string name;
    if (!(words >> height)) {
      continue;
    }
    words >> outcome >> number >> start >> end >> event >> name;
    const bool slips = says_slip(file, outcome);
    if (name.empty()) {
      replay::fail(file, "line \"" + line + "\" names no trial");
    }
    for (const fs::path& entry : sorted_entries(folder)) {
      if (fs::is_directory(entry) && entry.filename().string().rfind(name, 0) == 0) {
        trials.push_back({object, entry.filename().string(), slips, views_in(entry), {}});
      }
    }
  }
  return trials;
}

/// The trials of each object, from OBJECT_result.dat beside the folder OBJECT.
std::vector<Trial> by_objects(const fs::path& folder) {
  const std::string ending = "_result.dat";
  std::vector<Trial> trials;
  for (const fs::path& file : sorted_entries(folder)) {
    const std::string name = file.filename().string();
    if (name.size() <= ending.size() ||
        name.compare(name.size() - ending.size(), ending.size(), ending) != 0) {
      continue;
    }
    const std::string object = name.substr(0, name.size() - ending.size());
    if (fs::is_directory(folder / object)) {
      const auto of_object = by_labels(file, folder / object, object);
      trials.insert(trials.end(), of_object.begin(), of_object.end());
    }
  }
  return trials;
}

std::vector<Trial> by_folders(const fs::path& folder) {
  std::vector<Trial> trials;
  for (const fs::path& label : sorted_entries(folder)) {
    if (!fs::is_directory(label) || label.filename() == "free") {
      continue;
    }
    std::vector<fs::path> places = {label};
    for (const auto& entry : fs::recursive_directory_iterator(label)) {
      if (entry.is_directory()) {
        places.push_back(entry.path());
      }
    }
    for (const fs::path& place : places) {
      const std::string name = place.lexically_relative(label).generic_string();
      const auto views = views_in(place);
      if (!views.empty()) {
        trials.push_back({"", name, says_slip(folder, label.filename().string()), views, {}});
      }
    }
  }
  return trials;
}

}  // namespace

std::vector<Trial> trials_of(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    replay::fail(folder, "there is no such folder");
  }
  const fs::path labels = folder / "labels.dat";
  std::vector<Trial> trials =
      fs::exists(labels) ? by_labels(labels, folder, "") : by_objects(folder);
  if (trials.empty()) {
    trials = by_folders(folder);
  }
  for (Trial& trial : trials) {
    trial.free = fs::is_directory(folder / "free") ? folder / "free" : fs::path();
  }
  trials.erase(std::remove_if(trials.begin(), trials.end(),
                              [](const Trial& trial) { return trial.views.empty(); }),
               trials.end());
  std::sort(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) {
    return a.slips != b.slips ? a.slips : std::tie(a.object, a.name) < std::tie(b.object, b.name);
  });
  if (trials.empty()) {
    replay::fail(folder,
                 "contains no trials: neither labels.dat nor OBJECT_result.dat nor folders LABEL/");
  }
  return trials;
}

}  // namespace slip_trials
