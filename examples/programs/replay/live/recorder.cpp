// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/live/recorder.hpp"

#include <cstdio>
#include <exception>

#include "common/failure.hpp"
#include "common/images.hpp"
#include "common/output.hpp"
#include "common/whole_files.hpp"

namespace replay {

Recorder::~Recorder() {
  try {
    if (is_on()) {
      toggle();
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "replay: %s\n", error.what());
  }
}

void Recorder::toggle() {
  if (is_on()) {
    if (frames_ > 0) {
      write_file(aside_ / "signals.csv", signals_);
      publish_folder(aside_, place_);
      std::printf("recorded     %s, %d frames\n", place_.c_str(), frames_);
    } else {
      std::filesystem::remove_all(aside_);
    }
    aside_.clear();
    return;
  }
  if (folder_.empty()) {
    fail("recording", "has no place; say with --record DIR where recordings go");
  }
  int number = 1;
  do {
    char name[16];
    std::snprintf(name, sizeof name, "%03d", number++);
    place_ = folder_ / name;
    aside_ = place_.string() + ".part";
  } while (std::filesystem::exists(place_) || std::filesystem::exists(aside_));
  make_folders(aside_ / "frames");
  signals_ = "frame,time_s\n";
  frames_ = 0;
}

void Recorder::add(const cv::Mat& stored, const std::string& time_s) {
  if (is_on()) {
    write_picture(aside_ / "frames" / numbered("", frames_, ".png"), stored);
    signals_ += std::to_string(frames_++) + "," + time_s + "\n";
  }
}

}  // namespace replay
