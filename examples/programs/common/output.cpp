// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/output.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <regex>
#include <system_error>
#include <vector>

#include "common/failure.hpp"
#include "common/whole_files.hpp"

namespace replay {
namespace {

namespace fs = std::filesystem;

/// Whether replay or plot.py writes a file of this path, relative to the output folder.
bool is_ours(const std::string& relative) {
  static const std::regex ours(
      R"(frames\.csv|dots\.csv|slide\.csv|depth|depth/\d{6}\.tiff|contact|contact/\d{6}\.png|pictures|)"
      R"(pictures/(depth|side|contact|stick|traction|slide|live)_\d{6}\.png|)"
      R"(pictures/(montage|motion|stick_ratio|forces|wrench|array|preslip|slide)\.png)");
  return std::regex_match(relative, ours);
}

void refuse_foreign(const fs::path& place) {
  const std::string kept = ": nothing was changed; choose another folder";
  if (!fs::exists(fs::symlink_status(place))) {
    return;
  }
  if (!fs::is_directory(place)) {
    fail(place, "is not a folder" + kept);
  }
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(place)) {
    const std::string relative = entry.path().lexically_relative(place).generic_string();
    if (entry.is_symlink() || !is_ours(relative)) {
      fail(place, "contains " + relative + ", which replay did not write" + kept);
    }
  }
  if (!fs::is_empty(place)) {
    std::ifstream table(place / "frames.csv");
    std::string header;
    if (!std::getline(table, header) || header.rfind("frame,time_s", 0) != 0) {
      fail(place, "is not empty and has no frames.csv of an earlier run" + kept);
    }
  }
}

/// The folder's path without "." and trailing slash, with symbolic links resolved.
fs::path resolved(const fs::path& given) {
  fs::path place = fs::weakly_canonical(fs::absolute(given));
  return place.has_filename() ? place : place.parent_path();
}

fs::path make_sibling(const fs::path& place) {
  std::string hidden = ".";
  hidden += place.filename().string() + ".XXXXXX";
  const std::string name = (place.parent_path() / hidden).string();
  std::vector<char> pattern(name.begin(), name.end());
  pattern.push_back('\0');
  if (::mkdtemp(pattern.data()) == nullptr) {
    fail(place.parent_path(),
         "cannot be written: " + std::error_code(errno, std::generic_category()).message());
  }
  const fs::path sibling(pattern.data());
  fs::permissions(sibling,
                  fs::perms::group_read | fs::perms::group_exec | fs::perms::others_read |
                      fs::perms::others_exec,
                  fs::perm_options::add);
  return sibling;
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& place) {
  try {
    place_ = resolved(place);
    refuse_foreign(place_);
  } catch (const fs::filesystem_error& error) {
    fail(place, error.code().message());
  }
  make_parents(place_.parent_path());
  try {
    growing_ = make_sibling(place_);
  } catch (const Failure&) {
    remove_traces();
    throw;
  }
}

OutputFolder::~OutputFolder() {
  if (!growing_.empty()) {
    remove_traces();
  }
}

void OutputFolder::make_parents(const fs::path& folder) {
  if (fs::exists(folder)) {
    return;
  }
  make_parents(folder.parent_path());
  std::error_code error;
  fs::create_directory(folder, error);
  if (error) {
    remove_traces();
    fail(folder, "cannot be created: " + error.message());
  }
  made_parents_.push_back(folder);
}

void OutputFolder::remove_traces() {
  std::error_code ignored;
  if (!growing_.empty()) {
    fs::remove_all(growing_, ignored);
  }
  for (; !made_parents_.empty(); made_parents_.pop_back()) {
    fs::remove(made_parents_.back(), ignored);  // fails unless it is empty
  }
}

fs::path OutputFolder::file(const std::string& part, const std::string& name) const {
  std::error_code error;
  fs::create_directories(growing_ / part, error);
  if (error) {
    fail(growing_ / part, "cannot be written: " + error.message());
  }
  return growing_ / part / name;
}

void OutputFolder::publish() {
  try {
    refuse_foreign(place_);  // again: another program may have used it meanwhile
    const fs::path earlier = fs::exists(place_) ? make_sibling(place_) : "";
    if (!earlier.empty()) {
      fs::rename(place_, earlier);
    }
    try {
      publish_folder(growing_, place_);
    } catch (...) {
      if (!earlier.empty()) {
        fs::rename(earlier, place_);
      }
      throw;
    }
    fs::remove_all(earlier);
    growing_.clear();
  } catch (const fs::filesystem_error& error) {
    fail(place_, "cannot be written: " + error.code().message());
  }
}

std::string numbered(const std::string& stem, int frame, const std::string& extension) {
  char digits[16];
  std::snprintf(digits, sizeof digits, "%06d", frame);
  return stem + digits + extension;
}

}  // namespace replay
