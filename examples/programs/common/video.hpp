// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A video file, decoded by a process of its own: OpenCV's decoders may crash on a damaged or
// hostile file. Then that process ends, and this one has a Failure to report.
#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>

namespace replay {

/// All functions throw Failure if the decoder crashes, or takes more than a minute for a frame.
class Video {
 public:
  /// Opens a file, as open_video() does.
  explicit Video(const std::filesystem::path& file);
  ~Video();
  Video(Video&&) noexcept;
  Video& operator=(Video&&) noexcept;

  double rate_hz() const { return rate_hz_; }  ///< as the file claims it: any number

  /// Opens the file again, before its first frame.
  void rewind();
  /// Moves to the next frame; false at the end, or where a frame is damaged.
  bool grab();
  /// The frame moved to, or an empty one if it cannot be decoded.
  cv::Mat retrieve();

 private:
  class Decoder;

  std::unique_ptr<Decoder> decoder_;
  double rate_hz_ = 0;
};

}  // namespace replay
