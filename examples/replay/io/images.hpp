// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Reads and writes image files, with one error line for each.
#include <filesystem>
#include <opencv2/core.hpp>

namespace replay {

/// Limits every image that this program decodes to 2^26 px (67 megapixels): a file of 3 MB can
/// claim an image of gigabytes. OpenCV reads its limit from OPENCV_IO_MAX_IMAGE_PIXELS when it is
/// loaded, so the program is started again with that variable set. A value that the user has set
/// stays. Call it first in main(). Where /proc is missing, OpenCV's own limit of 2^30 px stays.
void limit_image_size(char** arguments);

/// Suppresses what codecs print to standard error, for its lifetime.
class QuietCodecs {
 public:
  QuietCodecs();
  ~QuietCodecs();
  QuietCodecs(const QuietCodecs&) = delete;
  QuietCodecs& operator=(const QuietCodecs&) = delete;

 private:
  int saved_stderr_;
};

/// Reads an 8- or 16-bit colour image (BGR or BGRA, OpenCV order); throws Failure.
cv::Mat read_colour_image(const std::filesystem::path& file);

/// Throws Failure if `image` is not an 8- or 16-bit colour image; `file` is for the message.
void expects_colour_image(const cv::Mat& image, const std::filesystem::path& file);

/// Reads a 32-bit float image of one channel, mm; throws Failure.
cv::Mat_<float> read_depth_image(const std::filesystem::path& file);

/// Writes a picture for viewing as PNG; throws Failure. The file is a twentieth larger than that of
/// write_png(), and is written seven times as fast.
void write_picture(const std::filesystem::path& file, const cv::Mat& image);

/// Writes a PNG or a 32-bit float TIFF; throws Failure.
void write_png(const std::filesystem::path& file, const cv::Mat& image);
void write_depth_image(const std::filesystem::path& file, const cv::Mat_<float>& depth_mm);

}  // namespace replay
