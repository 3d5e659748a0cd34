// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/io/images.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "replay/io/failure.hpp"

namespace replay {
namespace {

namespace fs = std::filesystem;

cv::Mat read_image(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) {
    fail(file, fs::exists(file, error) ? "is not a file" : "there is no such file");
  }
  cv::Mat image;
  try {
    const QuietCodecs quiet;
    image = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) {
    fail(file,
         "cannot be read as an image (damaged, cut short, of an unknown format, or too large)");
  }
  return image;
}

/// Encodes in memory and writes the bytes itself, because codecs do not report a full disk.
void write_image(const fs::path& file,
                 const char* format,
                 const cv::Mat& image,
                 const std::vector<int>& settings) {
  std::vector<uchar> bytes;
  try {
    const QuietCodecs quiet;
    if (!cv::imencode(format, image, bytes, settings)) {
      bytes.clear();
    }
  } catch (const cv::Exception&) {
    bytes.clear();
  }
  std::ofstream stream(file, std::ios::binary);
  for (const uchar byte : bytes) {
    stream.put(static_cast<char>(byte));
  }
  stream.close();
  if (bytes.empty() || !stream) {
    fail(file, "cannot be written");
  }
}

}  // namespace

void limit_image_size(char** arguments) {
  const char* const limit = "OPENCV_IO_MAX_IMAGE_PIXELS";
  if (std::getenv(limit) == nullptr && ::setenv(limit, "67108864", 0) == 0) {
    ::execv("/proc/self/exe", arguments);
  }
}

QuietCodecs::QuietCodecs() {
  // libpng and video decoders print to the file descriptor, past OpenCV's own logger.
  std::fflush(stderr);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  saved_stderr_ = ::dup(STDERR_FILENO);
  const int nowhere = ::open("/dev/null", O_WRONLY);
  if (nowhere >= 0) {
    ::dup2(nowhere, STDERR_FILENO);
    ::close(nowhere);
  }
}

QuietCodecs::~QuietCodecs() {
  if (saved_stderr_ >= 0) {
    ::dup2(saved_stderr_, STDERR_FILENO);
    ::close(saved_stderr_);
  }
}

void expects_colour_image(const cv::Mat& image, const fs::path& file) {
  if (image.depth() != CV_8U && image.depth() != CV_16U) {
    fail(file, "must have 8 or 16 bits per channel");
  }
  if (image.channels() < 3) {
    fail(file, "has " + std::to_string(image.channels()) +
                   (image.channels() == 1 ? " channel" : " channels") +
                   ", but must be a colour image (red and green are used)");
  }
}

cv::Mat read_colour_image(const fs::path& file) {
  cv::Mat image = read_image(file);
  expects_colour_image(image, file);
  return image;
}

cv::Mat_<float> read_depth_image(const fs::path& file) {
  const cv::Mat image = read_image(file);
  if (image.type() != CV_32FC1) {
    fail(file, "must be a 32-bit float image of one channel (depth in mm, NaN outside the pad)");
  }
  return image;
}

void write_picture(const fs::path& file, const cv::Mat& image) {
  write_image(file, ".png", image, {cv::IMWRITE_PNG_COMPRESSION, 6});
}

void write_png(const fs::path& file, const cv::Mat& image) {
  write_image(file, ".png", image,
              {cv::IMWRITE_PNG_COMPRESSION, 9, cv::IMWRITE_PNG_STRATEGY,
               cv::IMWRITE_PNG_STRATEGY_FILTERED});
}

void write_depth_image(const fs::path& file, const cv::Mat_<float>& depth_mm) {
  write_image(file, ".tiff", depth_mm, {});
}

}  // namespace replay
