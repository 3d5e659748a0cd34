// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/adapt/opencv.hpp"

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/weighted_sum.hpp"

using namespace fingerpad;

namespace {

/// Checks that every channel of `image` is viewed in place: its cells are the values of the image.
template <class T>
void check_channels(cv::Mat& image) {
  const cv::Mat& constant = image;
  for (int c = 0; c < image.channels(); ++c) {
    const StridedView<T> view = channel<T>(image, c);
    const StridedView<const T> read_only = channel<T>(constant, c);
    CHECK(view.rows() == image.rows);
    CHECK(view.cols() == image.cols);
    bool same = true;
    for (int i = 0; i < image.rows; ++i) {
      for (int j = 0; j < image.cols; ++j) {
        const T* value = image.ptr<T>(i) + j * image.channels() + c;
        same = same && &view(i, j) == value && &read_only(i, j) == value;
      }
    }
    CHECK(same);
  }
}

template <class Pixel>
cv::Mat_<Pixel> coordinates(int rows, int cols) {
  cv::Mat_<Pixel> image(rows, cols);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < cols; ++j) {
      image(i, j) = Pixel(static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(j), 7);
    }
  }
  return image;
}

}  // namespace

TEST_CASE("cv::Mat_ and its regions are strided grids", "[opencv]") {
  cv::Mat_<double> image(6, 4);
  cv::Mat_<double> frame(20, 30);
  cv::Mat_<double> region = frame(cv::Rect(5, 7, 4, 6));
  for (auto* m : {&image, &region}) {
    STATIC_REQUIRE(std::same_as<decltype(as_view(*m)), StridedView<double>>);
    test::fill_with_pattern(*m);
    CHECK(test::weighted_sum(*m) == test::pattern_sum(6, 4));
    CHECK(&as_view(*m)(5, 3) == &(*m)(5, 3));
  }
  CHECK_FALSE(region.isContinuous());
  CHECK(as_view(region).row_stride() == 30);
  CHECK(as_view(region).data() == &frame(7, 5));

  const cv::Mat_<double>& constant = region;
  STATIC_REQUIRE(std::same_as<decltype(as_view(constant)), StridedView<const double>>);
  STATIC_REQUIRE(!writable_grid<const cv::Mat_<double>>);
  CHECK(test::weighted_sum(constant) == test::pattern_sum(6, 4));
}

TEST_CASE("colour images are grids of pixels", "[opencv]") {
  auto image = coordinates<cv::Vec3b>(5, 7);
  CHECK(as_view(image)(4, 6) == cv::Vec3b(4, 6, 7));
  cv::Mat_<cv::Vec3b> region = image(cv::Rect(2, 1, 4, 3));
  CHECK(as_view(region)(2, 3) == cv::Vec3b(3, 5, 7));

  // Rows that begin at an even number of bytes, as cameras and BMP files pad them: 22 bytes are not
  // a whole number of pixels.
  std::vector<std::uint8_t> memory(5 * 24);
  cv::Mat_<cv::Vec3b> padded(5, 7, reinterpret_cast<cv::Vec3b*>(memory.data()), 22);
  image.copyTo(padded);
  bool same = true;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 7; ++j) {
      same = same && as_view(padded)(i, j) == image(i, j);
    }
  }
  CHECK(same);
  cv::Mat wrapped = padded;
  check_channels<std::uint8_t>(wrapped);
}

TEST_CASE("one channel of an interleaved image is a view without a copy", "[opencv]") {
  cv::Mat bytes(9, 11, CV_8UC3);
  cv::Mat words(9, 11, CV_16UC3);
  cv::Mat floats(9, 11, CV_32FC2);
  cv::Mat grey(9, 11, CV_8UC1);
  check_channels<std::uint8_t>(bytes);
  check_channels<std::uint16_t>(words);
  check_channels<float>(floats);
  check_channels<std::uint8_t>(grey);

  const cv::Rect inside(2, 3, 5, 4);
  cv::Mat byte_region = bytes(inside);
  cv::Mat word_region = words(inside);
  REQUIRE_FALSE(byte_region.isContinuous());
  check_channels<std::uint8_t>(byte_region);
  check_channels<std::uint16_t>(word_region);

  channel<std::uint8_t>(byte_region, 2)(1, 1) = 200;
  CHECK(bytes.at<cv::Vec3b>(4, 3)[2] == 200);
}

TEST_CASE("an empty image, a wrong type and a missing channel are refused by name", "[opencv]") {
  cv::Mat bytes(4, 4, CV_8UC3);
  const cv::Mat& constant = bytes;
  CHECK_THROWS_AS(channel<std::uint16_t>(bytes, 0), parameter_error);
  CHECK_THROWS_AS(channel<std::int8_t>(bytes, 0), parameter_error);
  CHECK_THROWS_AS(channel<float>(constant, 0), parameter_error);
  CHECK_THROWS_AS(channel<std::uint8_t>(bytes, 3), parameter_error);
  CHECK_THROWS_AS(channel<std::uint8_t>(bytes, -1), parameter_error);
  CHECK_NOTHROW(channel<std::uint8_t>(constant, 2));
  const auto refusal = [](cv::Mat image, int c) {
    try {
      channel<std::uint8_t>(image, c);
    } catch (const parameter_error& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK(refusal(bytes, 3) == "channel: c = 3, must be in [0, image.channels())");
  CHECK(refusal({}, 2) == "channel: pixels of the image = 0, must be > 0: was the image read?");
}
