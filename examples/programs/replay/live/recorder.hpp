// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Records live frames as a recording that replay reads with --sensor.
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

namespace replay {

/// Writes DIR/001, DIR/002, ..., each with frames/ as the camera gave them and signals.csv with
/// their times. A recording appears when it is complete; ones that exist are kept. All functions
/// throw Failure.
class Recorder {
 public:
  /// No recording can be begun if `folder` is empty.
  explicit Recorder(const std::filesystem::path& folder) : folder_(folder) {}
  /// Completes a recording that was begun; what then fails is lost.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  bool is_on() const { return !aside_.empty(); }
  int frames() const { return frames_; }  ///< of this recording, so far
  /// Begins a recording, or completes the one that was begun.
  void toggle();
  /// Takes a frame, if a recording was begun.
  void add(const cv::Mat& stored, const std::string& time_s);

 private:
  std::filesystem::path folder_, place_, aside_;  ///< the last is empty between recordings
  std::string signals_;
  int frames_ = 0;
};

}  // namespace replay
