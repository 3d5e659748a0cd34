// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Frames as they come: of a camera, or of a video in its place.
#include <chrono>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

namespace replay {

class LiveFrames {
 public:
  using Clock = std::chrono::steady_clock;

  /// A camera is asked for frames of `size`. Both throw Failure.
  static LiveFrames of_camera(int number, cv::Size size);
  /// `in_real_time`: each frame comes when it is due, and those that were not fetched in time are
  /// left out, as a camera's are; else all come, as fast as they are fetched.
  static LiveFrames of_video(const std::filesystem::path& file, cv::Size size, bool in_real_time);

  /// Waits for the next frame, 8-bit colour; false at the end of a video. Throws Failure for a
  /// frame of another size, or where a camera gives none.
  bool next(cv::Mat& frame);
  /// Leaves out the next frame, without waiting for it.
  void skip();

  double rate_hz() const { return rate_hz_; }  ///< as camera or video say it; 0: they do not

  // Of the last frame.
  int number() const { return number_; }
  double time_s() const;  ///< since the first one
  Clock::time_point arrival() const { return arrival_; }

 private:
  bool grab();

  cv::VideoCapture source_;
  std::filesystem::path name_;
  cv::Size size_;
  double rate_hz_ = 0;
  Clock::duration period_ = {};  ///< of a video; 0 for a camera
  bool in_real_time_ = true;
  int number_ = -1;
  Clock::time_point start_ = {};  ///< when frame 0 came, or would have come
  Clock::time_point arrival_ = {};
};

}  // namespace replay
