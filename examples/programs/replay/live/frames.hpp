// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Live frames from a camera, or from a video in its place.
#include <chrono>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>
#include <optional>

#include "common/images.hpp"
#include "common/video.hpp"

namespace replay {

class LiveFrames {
 public:
  using Clock = std::chrono::steady_clock;

  /// Requests frames of `size` from the camera. Both functions throw Failure.
  static LiveFrames of_camera(int number, cv::Size size, const PictureFormat& format);
  /// With `in_real_time` each frame arrives when it is due, and frames that are not fetched in time
  /// are skipped, as with a camera. Otherwise all frames arrive as fast as they are fetched.
  static LiveFrames of_video(const std::filesystem::path& file,
                             cv::Size size,
                             const PictureFormat& format,
                             bool in_real_time);

  /// Waits for the next frame, of 8 bit, and makes it linear in light; returns false at the end of
  /// a video. Throws Failure for a frame of another size or type, or if a camera gives no frame.
  bool next(cv::Mat& frame);
  /// Skips the next frame without waiting for it.
  void skip();

  double rate_hz() const { return rate_hz_; }  ///< as camera or video report it; 0 if unknown

  // These are for the last frame.
  int number() const { return number_; }
  const cv::Mat& stored() const { return stored_; }  ///< as the camera gave it
  double time_s() const;                             ///< since the first one
  Clock::time_point arrival() const { return arrival_; }

 private:
  bool grab();

  cv::VideoCapture camera_;
  std::optional<Video> video_;  ///< in place of the camera
  std::filesystem::path name_;
  cv::Size size_;
  PictureFormat format_;
  cv::Mat stored_;
  double rate_hz_ = 0;
  Clock::duration period_ = {};  ///< frame period of a video; 0 for a camera
  bool in_real_time_ = true;
  int number_ = -1;
  Clock::time_point start_ = {};  ///< when frame 0 arrived, or would have arrived
  Clock::time_point arrival_ = {};
};

}  // namespace replay
