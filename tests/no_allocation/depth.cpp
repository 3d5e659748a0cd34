// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/depth/depth.hpp"

#include <opencv2/core.hpp>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/published/depth.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Pad;

namespace {

/// Allocations of three frames.
template <class S, class Red, class Green>
long taken(DepthEstimator<S>& estimator, const Red& red, const Green& green) {
  test::Estimate<S> e(rows(red), cols(red));
  const long before = test::allocations();
  for (int again = 0; again < 3; ++again) {
    (void)estimator(red, green, e.depth_mm, e.status);
    (void)estimator(red, green, e.depth_mm);
    (void)estimator.band(5, 9, red, green, e.depth_mm, e.status);
  }
  return test::allocations() - before;
}

template <class P, class S>
struct Kind {
  using Pixel = P;
  using Scalar = S;
};

}  // namespace

TEMPLATE_TEST_CASE("no frame takes memory",
                   "[depth]",
                   (Kind<std::uint8_t, float>),
                   (Kind<std::uint16_t, float>),
                   (Kind<float, float>),
                   (Kind<std::uint8_t, double>),
                   (Kind<double, double>)) {
  using S = typename TestType::Scalar;
  using Pixel = typename TestType::Pixel;
  const Pad pad;
  auto frame = pad.frame<Pixel>(pad.pressed_depths(3));
  for (std::size_t k = 0; k < frame.red.cells.size(); k += 5) {
    frame.red.cells[k] = test::stored<Pixel>(k % 2 == 0 ? 0 : 255);
  }
  for (const int window_px : {1, 29}) {
    const auto first = pad.estimator<S>({.window_px = window_px});
    const long before = test::allocations();
    DepthEstimator<S> estimator = first;
    CHECK(test::allocations() > before);  // the counter works
    CHECK(taken(estimator, frame.red, frame.green) == 0);
    if constexpr (std::is_same_v<Pixel, std::uint8_t>) {
      cv::Mat image(static_cast<int>(pad.rows), static_cast<int>(pad.cols), CV_8UC3);
      image = cv::Scalar(10, 50, 60);
      CHECK(taken(estimator, channel<const Pixel>(image, 2), channel<const Pixel>(image, 1)) == 0);
    }
  }
}

TEST_CASE("no frame takes memory as printed", "[depth]") {
  const Pad pad;
  const auto free = pad.free_depths();
  const auto frame = pad.frame<std::uint8_t>(free);
  published::DepthEstimator<double> estimator(pad.published(), frame.red, frame.green, free);
  test::Image<double> depth(pad.rows, pad.cols);
  const long before = test::allocations();
  for (int again = 0; again < 3; ++again) {
    (void)estimator(frame.red, frame.green, depth);
  }
  CHECK(test::allocations() == before);
}
