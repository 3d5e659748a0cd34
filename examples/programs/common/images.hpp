// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Reads and writes image files, with one error line for each.
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

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

/// How a camera writes light into its pictures.
struct PictureFormat {
  std::vector<double>
      response;        ///< light of each value of 8 bit, 0 to 255; empty: the value itself
  std::string mosaic;  ///< colours of the first two pixels of the first two rows, "rggb", of raw
                       ///< pictures of one channel; empty: colour pictures
  bool may_be_grey = false;  ///< pictures of one channel are read as grey colours
};
/// The response of sRGB.
std::vector<double> srgb_response();

/// Reads an image of 8 or 16 bit as it is stored, without transparency; throws Failure, and
/// Unreadable for a damaged file.
cv::Mat read_stored_image(const std::filesystem::path& file);

/// An 8- or 16-bit colour image (BGR, OpenCV order), linear in light, of a stored image:
/// the one place where a response curve or a mosaic is undone. Throws Failure, with `file` in its
/// message, if the image has not this format.
cv::Mat linear_colours(const cv::Mat& stored,
                       const PictureFormat& format,
                       const std::filesystem::path& file);

/// Reads such an image; throws Failure.
cv::Mat read_colour_image(const std::filesystem::path& file, const PictureFormat& format = {});

/// Whether each frame is as light as most of them, within a quarter: a camera may begin dark or
/// overexposed. False for one that is empty.
std::vector<bool> usually_exposed(const std::vector<cv::Mat>& frames);

/// Share of the pixels of `pad` in which red or green is saturated, and what is too much.
double saturated_share(const cv::Mat& frame, const cv::Mat_<uchar>& pad);
constexpr double most_saturated = 0.01;

/// Mean step of red - green across the borders of blocks of 16 columns in `pad`, over that
/// elsewhere. About 1 in raw pictures and up to 1.26 after a mosaic; JPEG and video keep colours in
/// such blocks.
double step_between_blocks(const cv::Mat& frame, const cv::Mat_<uchar>& pad);
/// More than in pictures that were never compressed, and more than where depth errs by its noise
/// alone if the reference is compressed alike: JPEG of quality 85 at 180 grey levels, 98 at 57.
constexpr double compressed_step = 1.35, worst_compressed_step = 1.9;

/// Reads a 32-bit float image of one channel, mm; throws Failure.
cv::Mat_<float> read_depth_image(const std::filesystem::path& file);

/// Writes a picture for viewing as PNG; throws Failure. The file is a twentieth larger than that of
/// write_png(), and is written seven times as fast.
void write_picture(const std::filesystem::path& file, const cv::Mat& image);

/// Writes a PNG or a 32-bit float TIFF; throws Failure.
void write_png(const std::filesystem::path& file, const cv::Mat& image);
void write_depth_image(const std::filesystem::path& file, const cv::Mat_<float>& depth_mm);

}  // namespace replay
