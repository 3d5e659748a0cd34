// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "common/images.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "common/failure.hpp"
#include "common/median.hpp"

namespace replay {
namespace {

namespace fs = std::filesystem;

/// The 16-bit number at `at`, high byte first; 0 beyond the end.
std::size_t word_at(const std::string& bytes, std::size_t at) {
  const auto byte = [&](std::size_t k) {
    return k < bytes.size() ? static_cast<std::size_t>(static_cast<uchar>(bytes[k])) : 0;
  };
  return 256 * byte(at) + byte(at + 1);
}

/// Whether a JPEG file ends before its end marker: the decoder fills the rest with grey.
bool is_cut_jpeg(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), {});
  if (word_at(bytes, 0) != 0xFFD8) {
    return false;
  }
  constexpr std::size_t scan = 0xFFDA, end = 0xFFD9;
  bool in_scan = false;
  for (std::size_t at = 2; at + 1 < bytes.size();) {
    const std::size_t marker = word_at(bytes, at);
    if (marker == end) {
      return false;
    }
    const bool is_data = marker <= 0xFF00 || (marker >= 0xFFD0 && marker < 0xFFD8);
    if (is_data || marker == 0xFFFF) {
      if (!in_scan && marker != 0xFFFF) {
        return false;  // damaged in another way, of which the decoder has its own opinion
      }
      ++at;
    } else {
      in_scan = in_scan || marker == scan;
      at += 2 + word_at(bytes, at + 2);
    }
  }
  return true;
}

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
    fail<Unreadable>(
        file,
        "cannot be read as an image (damaged, cut short, of an unknown format, or too large)");
  }
  if (is_cut_jpeg(file)) {
    fail<Unreadable>(file, "is cut short: a part of the picture is missing");
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

std::vector<double> srgb_response() {
  std::vector<double> light;
  for (int k = 0; k < 256; ++k) {
    const double y = k / 255.0;
    light.push_back(255 * (y <= 0.04045 ? y / 12.92 : std::pow((y + 0.055) / 1.055, 2.4)));
  }
  return light;
}

cv::Mat read_stored_image(const fs::path& file) {
  cv::Mat image = read_image(file);
  if (image.depth() != CV_8U && image.depth() != CV_16U) {
    fail(file, "must have 8 or 16 bits per channel");
  }
  const int colours = image.channels() - 1 + image.channels() % 2;  // without transparency
  if (colours < image.channels()) {
    cv::Mat opaque(image.size(), CV_MAKETYPE(image.depth(), colours));
    cv::mixChannels({image}, {opaque},
                    colours == 1 ? std::vector<int>{0, 0} : std::vector<int>{0, 0, 1, 1, 2, 2});
    image = opaque;
  }
  return image;
}

namespace {

/// 16 bit, 256 units per grey level.
cv::Mat in_16_bit(const cv::Mat& image) {
  cv::Mat wide;
  image.convertTo(wide, CV_16U, image.depth() == CV_16U ? 1 : 256);
  return wide;
}

/// `image` has 16 bit; between the values of 8 bit, the response is straight.
cv::Mat without_response(cv::Mat image, const std::vector<double>& response) {
  for (int i = 0; i < image.rows; ++i) {
    auto* row = image.ptr<ushort>(i);
    for (int j = 0; j < image.cols * image.channels(); ++j) {
      const std::size_t low = row[j] / 256U, high = (std::min)(low + 1, std::size_t(255));
      const double between = row[j] % 256U / 256.0;
      const double light = response[low] + between * (response[high] - response[low]);
      row[j] = cv::saturate_cast<ushort>(256 * light);
    }
  }
  return image;
}

/// Each pixel's own colour, and the means of its neighbours for the other two.
cv::Mat without_mosaic(const cv::Mat& image, const std::string& mosaic) {
  // OpenCV names a mosaic by the second and third pixel of the second row
  const int code = mosaic == "rggb"   ? cv::COLOR_BayerBG2BGR
                   : mosaic == "bggr" ? cv::COLOR_BayerRG2BGR
                   : mosaic == "grbg" ? cv::COLOR_BayerGB2BGR
                                      : cv::COLOR_BayerGR2BGR;
  cv::Mat colours;
  cv::cvtColor(image, colours, code);
  return colours;
}

}  // namespace

cv::Mat linear_colours(const cv::Mat& stored, const PictureFormat& format, const fs::path& file) {
  const bool is_raw = !format.mosaic.empty();
  if (stored.depth() != CV_8U && stored.depth() != CV_16U) {
    fail(file, "must have 8 or 16 bits per channel");
  }
  cv::Mat image = stored;
  if (format.may_be_grey && stored.channels() == 1) {
    cv::cvtColor(stored, image, cv::COLOR_GRAY2BGR);
  }
  if (is_raw ? image.channels() != 1 : image.channels() < 3) {
    fail(file, "has " + std::to_string(stored.channels()) +
                   (stored.channels() == 1 ? " channel" : " channels") +
                   (is_raw ? ", but camera.mosaic says that pictures are raw, of one channel"
                           : ", but must be a colour image (red and green are used)"));
  }
  if (!format.response.empty()) {
    image = without_response(in_16_bit(image), format.response);
  }
  return is_raw ? without_mosaic(in_16_bit(image), format.mosaic) : image;
}

cv::Mat read_colour_image(const fs::path& file, const PictureFormat& format) {
  return linear_colours(read_stored_image(file), format, file);
}

std::vector<bool> usually_exposed(const std::vector<cv::Mat>& frames) {
  constexpr double most = 1.25;  // times as light or as dark
  std::vector<double> levels;    // 0: empty
  for (const cv::Mat& frame : frames) {
    const double unit = frame.depth() == CV_16U ? 1.0 / 256 : 1;
    levels.push_back(frame.empty() ? 0 : 1 + unit * cv::sum(cv::mean(frame))[0]);
  }
  std::vector<double> whole = levels;
  whole.erase(std::remove(whole.begin(), whole.end(), 0.0), whole.end());
  const double usual = median_of(whole);
  std::vector<bool> alike;
  for (const double level : levels) {
    alike.push_back(level < most * usual && level * most > usual);
  }
  return alike;
}

double saturated_share(const cv::Mat& frame, const cv::Mat_<uchar>& pad) {
  cv::Mat red, green;
  cv::extractChannel(frame, red, 2);
  cv::extractChannel(frame, green, 1);
  const cv::Mat high = cv::max(red, green) >= (frame.depth() == CV_16U ? 254 * 256 : 254);
  return cv::countNonZero(high & pad) / static_cast<double>(cv::countNonZero(pad));
}

double step_between_blocks(const cv::Mat& frame, const cv::Mat_<uchar>& pad) {
  cv::Mat red, green;
  cv::Mat_<float> colour;
  cv::extractChannel(frame, red, 2);
  cv::extractChannel(frame, green, 1);
  cv::subtract(red, green, colour, cv::noArray(), CV_32F);
  double sum[2] = {0, 0}, count[2] = {0, 0};
  for (int i = 0; i < frame.rows; ++i) {
    for (int j = 1; j < frame.cols; ++j) {
      if (pad(i, j - 1) != 0 && pad(i, j) != 0) {
        const int at_border = j % 16 == 0 ? 1 : 0;
        sum[at_border] += static_cast<double>(std::abs(colour(i, j) - colour(i, j - 1)));
        count[at_border] += 1;
      }
    }
  }
  return sum[1] / count[1] / (sum[0] / count[0]);
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
