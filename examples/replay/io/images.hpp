// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Image files in and out, each with its own line of complaint.
#include <filesystem>
#include <opencv2/core.hpp>

namespace replay {

/// While it lives, nothing that a codec prints by itself reaches standard error.
class QuietCodecs {
 public:
  QuietCodecs();
  ~QuietCodecs();
  QuietCodecs(const QuietCodecs&) = delete;
  QuietCodecs& operator=(const QuietCodecs&) = delete;

 private:
  int saved_stderr_;
};

/// An 8- or 16-bit colour image (BGR or BGRA, as OpenCV orders them); throws Failure.
cv::Mat read_colour_image(const std::filesystem::path& file);

/// Refuses what is not an 8- or 16-bit colour image; `file` names it in the message.
void expects_colour_image(const cv::Mat& image, const std::filesystem::path& file);

/// A 32-bit float image of one channel, mm; throws Failure.
cv::Mat_<float> read_depth_image(const std::filesystem::path& file);

/// A picture to look at, as PNG; throws Failure. A twentieth larger than write_png() makes it, and
/// written seven times as fast.
void write_picture(const std::filesystem::path& file, const cv::Mat& image);

/// Writes a PNG or a 32-bit float TIFF; throws Failure.
void write_png(const std::filesystem::path& file, const cv::Mat& image);
void write_depth_image(const std::filesystem::path& file, const cv::Mat_<float>& depth_mm);

}  // namespace replay
