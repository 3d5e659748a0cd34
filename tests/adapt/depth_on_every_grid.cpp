// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// One frame in every kind of grid gives the same depth map to the last bit, and every kind of grid
// receives the depth map.
#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>
#if __has_include(<xtensor/containers/xtensor.hpp>)
#include <xtensor/containers/xtensor.hpp>
#else
#include <xtensor/xtensor.hpp>
#endif

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/adapt/mdspan.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/adapt/xtensor.hpp"
#include "fingerpad/depth/depth.hpp"
#include "support/catch.hpp"
#include "support/foreign_image.hpp"
#include "support/pad.hpp"
#include "support/test_mdspan.hpp"

using namespace fingerpad;
using test::fill_from;
using test::Frame;
using test::Image;

namespace {

template <class T>
using RowMajor = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
template <class T>
using ColMajor = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

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
  /// The same for two grids of one kind, which are filled first.
  template <class Grid>
  bool reads_filled(Grid red, Grid green) {
    fill_from(red, frame.red);
    fill_from(green, frame.green);
    return reads(red, green);
  }
  /// Whether any two grids receive the same output.
  template <class Depth, class Status>
  bool writes(Depth&& depth, Status&& status) {
    fill_from(depth, Image<float>(pad.rows, pad.cols, -1));
    const auto result = estimator(frame.red, frame.green, depth, status);
    return result.ok() && holds(depth, expected.depth_mm) && holds(status, expected.status);
  }
};

/// Both channels interleaved in one image, among others with different content.
template <class Pixel>
cv::Mat interleaved(const Frame<Pixel>& frame, int channels) {
  const int rows = static_cast<int>(frame.red.rows());
  const int cols = static_cast<int>(frame.red.cols());
  // a region of a wider image, so that rows are not contiguous in memory
  cv::Mat wide(rows, cols + 5, CV_MAKETYPE(cv::DataType<Pixel>::depth, channels));
  cv::Mat image = wide(cv::Rect(3, 0, cols, rows));
  for (int c = 0; c < channels; ++c) {
    const auto view = channel<Pixel>(image, c);
    fill_from(view, c == 1 ? frame.green : frame.red);
    if (c == 0 || c == 3) {
      fill_from(view, Image<Pixel>(rows, cols, Pixel(99)));
    }
  }
  return image;
}

}  // namespace

TEMPLATE_TEST_CASE(
    "a frame is read from every grid", "[adapt][depth]", std::uint8_t, std::uint16_t, float) {
  using Pixel = TestType;
  Case<Pixel> c;
  const Index rows = c.pad.rows;
  const Index cols = c.pad.cols;
  const auto& red = c.frame.red;
  const auto& green = c.frame.green;
  const int r = static_cast<int>(rows);
  const int k = static_cast<int>(cols);

  CHECK(c.reads_filled(RowMajor<Pixel>(rows, cols), RowMajor<Pixel>(rows, cols)));
  CHECK(c.reads_filled(ColMajor<Pixel>(rows, cols), ColMajor<Pixel>(rows, cols)));
  CHECK(c.reads_filled(cv::Mat_<Pixel>(r, k), cv::Mat_<Pixel>(r, k)));
  CHECK(
      c.reads_filled(test::ForeignImage<Pixel>(rows, cols), test::ForeignImage<Pixel>(rows, cols)));
  using Tensor = xt::xtensor<Pixel, 2>;
  const std::array<std::size_t, 2> shape = {static_cast<std::size_t>(rows),
                                            static_cast<std::size_t>(cols)};
  CHECK(c.reads_filled(Tensor(shape), Tensor(shape)));
  using Columns = xt::xtensor<Pixel, 2, xt::layout_type::column_major>;
  CHECK(c.reads_filled(Columns(shape), Columns(shape)));

  for (const int channels : {3, 4}) {
    const cv::Mat image = interleaved(c.frame, channels);
    CHECK(c.reads(channel<Pixel>(image, 2), channel<Pixel>(image, 1)));
  }

  using Span = test::TestMdspan<const Pixel>;
  const auto mapping =
      test::LayoutStride::right(static_cast<test::MdIndex>(rows), static_cast<test::MdIndex>(cols));
  CHECK(c.reads(Span(red.cells.data(), mapping), Span(green.cells.data(), mapping)));

  // stored upside down and back to front, with gaps
  std::vector<Pixel> rotated(static_cast<std::size_t>(2 * 2 * rows * cols));
  const StridedView<Pixel> back(&rotated.back(), rows, cols, -4 * cols, -2);
  fill_from(back, red);
  CHECK(c.reads(back, StridedView<const Pixel>(green.cells.data(), rows, cols, cols)));

  const LazyView lazy(rows, cols, [&](Index i, Index j) { return red(i, j); });
  CHECK(c.reads(lazy, green));  // two kinds at once
  CHECK(c.reads(lazy, LazyView(rows, cols, [&](Index i, Index j) { return green(i, j); })));
  if constexpr (std::is_same_v<Pixel, float>) {  // an expression without memory
    RowMajor<Pixel> half(rows, cols);
    fill_from(half, red);
    half /= 2;
    CHECK(c.reads(half + half, green));
  }
}

TEST_CASE("also without smoothing", "[adapt][depth]") {
  Case<std::uint8_t> c(1);
  const cv::Mat image = interleaved(c.frame, 3);
  CHECK(c.reads(channel<std::uint8_t>(image, 2), channel<std::uint8_t>(image, 1)));
  CHECK(c.reads_filled(ColMajor<std::uint8_t>(c.pad.rows, c.pad.cols),
                       ColMajor<std::uint8_t>(c.pad.rows, c.pad.cols)));
  CHECK(c.reads_filled(test::ForeignImage<std::uint8_t>(c.pad.rows, c.pad.cols),
                       test::ForeignImage<std::uint8_t>(c.pad.rows, c.pad.cols)));
}

TEST_CASE("depth and status are written into every grid", "[adapt][depth]") {
  Case<std::uint8_t> c;
  const Index rows = c.pad.rows;
  const Index cols = c.pad.cols;
  const int r = static_cast<int>(rows);
  const int k = static_cast<int>(cols);
  using Status = test::ForeignImage<PixelStatus>;
  Status status(rows, cols);

  CHECK(c.writes(RowMajor<float>(rows, cols), status));
  CHECK(c.writes(ColMajor<float>(rows, cols), Status(rows, cols)));
  CHECK(c.writes(cv::Mat_<float>(r, k), status));
  CHECK(c.writes(test::ForeignImage<float>(rows, cols), Status(rows, cols)));
  const std::array<std::size_t, 2> shape = {static_cast<std::size_t>(rows),
                                            static_cast<std::size_t>(cols)};
  CHECK(c.writes(xt::xtensor<float, 2>(shape), xt::xtensor<PixelStatus, 2>(shape)));
  cv::Mat pairs(r, k, CV_32FC2);
  CHECK(c.writes(channel<float>(pairs, 1), status));
  std::vector<float> memory(static_cast<std::size_t>(rows * cols));
  std::vector<PixelStatus> states(memory.size());
  const auto mapping =
      test::LayoutStride::left(static_cast<test::MdIndex>(rows), static_cast<test::MdIndex>(cols));
  CHECK(c.writes(test::TestMdspan<float>(memory.data(), mapping),
                 test::TestMdspan<PixelStatus>(states.data(), mapping)));
  CHECK(c.writes(StridedView<float>(&memory.back(), rows, cols, -cols, -1), status));
  CHECK(c.writes(LazyView(rows, cols,
                          [&](Index i, Index j) -> float& {
                            return memory[static_cast<std::size_t>(i * cols + j)];
                          }),
                 status));
  ColMajor<float> wide(rows + 4, cols + 6);
  CHECK(c.writes(wide.block(1, 2, rows, cols), status));

  // a double grid receives the results of float
  RowMajor<double> wider(rows, cols);
  CHECK(c.estimator(c.frame.red, c.frame.green, wider, status).ok());
  const RowMajor<float> narrowed = wider.cast<float>();
  CHECK(holds(narrowed, c.expected.depth_mm));
}
