// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// One frame in every kind of grid gives the same depth map to the last bit, and every kind of grid
// receives the depth map.
#include <cstdint>

#include "fingerpad/depth/depth.hpp"
#include "support/catch.hpp"
#include "support/every_grid.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::fill_from;
using test::Frame;
using test::Image;

namespace {

template <class Grid, class T>
bool holds(const Grid& grid, const Image<T>& expected) {
  const auto view = as_view(grid);
  if (view.rows() != expected.rows() || view.cols() != expected.cols()) {
    return false;
  }
  for (Index i = 0; i < expected.rows(); ++i) {
    for (Index j = 0; j < expected.cols(); ++j) {
      if (!test::same_bits(static_cast<T>(view(i, j)), expected(i, j))) {
        return false;
      }
    }
  }
  return true;
}

/// A frame with noise and lost pixels, its estimator, and the result for test::Image.
template <class Pixel>
struct Case {
  test::Pad pad;
  Frame<Pixel> frame;
  DepthEstimator<> estimator;
  test::Estimate<float> expected;

  explicit Case(int window_px = 29)
      : frame(pad.frame<Pixel>(pad.pressed_depths(3), 1, 6)),
        estimator(pad.estimator<float>({.window_px = window_px})),
        expected(0, 0) {
    for (std::size_t k = 0; k < frame.red.cells.size(); k += 11) {
      frame.red.cells[k] = k % 2 == 0 ? Pixel(0) : test::stored<Pixel>(255);
    }
    expected = test::estimate(estimator, frame);
    REQUIRE(expected.result.valid_pixels() > 1000);
  }

  /// Whether any two grids as input give the same result.
  template <class Red, class Green>
  bool reads(const Red& red, const Green& green) {
    test::Estimate<float> e(pad.rows, pad.cols);
    const auto result = estimator(red, green, e.depth_mm, e.status);
    return result.count == expected.result.count &&
           test::same_bits(e.depth_mm, expected.depth_mm) &&
           e.status.cells == expected.status.cells;
  }
  /// Whether any two grids receive the same output.
  template <class Depth, class Status>
  bool writes(Depth&& depth, Status&& status) {
    fill_from(depth, Image<float>(pad.rows, pad.cols, -1));
    const auto result = estimator(frame.red, frame.green, depth, status);
    return result.ok() && holds(depth, expected.depth_mm) && holds(status, expected.status);
  }
};

}  // namespace

TEMPLATE_TEST_CASE(
    "a frame is read from every grid", "[adapt][depth]", std::uint8_t, std::uint16_t, float) {
  using Pixel = TestType;
  for (const int window_px : {1, 29}) {
    Case<Pixel> c(window_px);
    const auto &red = c.frame.red, &green = c.frame.green;
    test::from_every_grid<Pixel>(red, [&](const auto& from) { CHECK(c.reads(from, green)); });
    test::from_every_grid<Pixel>(green, [&](const auto& from) { CHECK(c.reads(red, from)); });
    if constexpr (std::is_same_v<Pixel, float>) {  // an expression without memory
      test::RowMajor<Pixel> half(red.rows(), red.cols());
      fill_from(half, red);
      half /= 2;
      CHECK(c.reads(half + half, green));
    }
  }
}

TEST_CASE("two channels of one image are read in place", "[adapt][depth]") {
  Case<std::uint8_t> c;
  cv::Mat image(static_cast<int>(c.pad.rows), static_cast<int>(c.pad.cols), CV_8UC3);
  image = cv::Scalar(99, 0, 0);
  fill_from(channel<std::uint8_t>(image, 1), c.frame.green);
  fill_from(channel<std::uint8_t>(image, 2), c.frame.red);
  CHECK(c.reads(channel<std::uint8_t>(image, 2), channel<std::uint8_t>(image, 1)));
}

TEST_CASE("depth and status are written into every grid", "[adapt][depth]") {
  Case<std::uint8_t> c;
  const Index rows = c.pad.rows, cols = c.pad.cols;
  test::ForeignImage<PixelStatus> status(rows, cols);
  test::on_every_grid<float>(rows, cols, [&](auto&& depth) { CHECK(c.writes(depth, status)); });
  test::RowMajor<float> depth(rows, cols);
  test::on_every_grid<PixelStatus>(rows, cols, [&](auto&& to) { CHECK(c.writes(depth, to)); });

  // a double grid receives the results of float
  test::RowMajor<double> wider(rows, cols);
  CHECK(c.estimator(c.frame.red, c.frame.green, wider, status).ok());
  const test::RowMajor<float> narrowed = wider.cast<float>();
  CHECK(holds(narrowed, c.expected.depth_mm));
}
