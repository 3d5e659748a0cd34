// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/published/depth.hpp"

#include <opencv2/core.hpp>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/depth/depth.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Pad;

namespace {

/// Allocations of three frames.
template <class S, class Estimator, class Red, class Green, class Workspace>
long taken(const Estimator& estimator, const Red& red, const Green& green, Workspace& workspace) {
  test::Estimate<S> e(rows(red), cols(red));
  const long before = test::allocations();
  for (int again = 0; again < 3; ++again) {
    (void)estimator(red, green, e.depth_mm, e.status, workspace);
    (void)estimator(red, green, e.depth_mm, workspace);
    (void)estimator.band(5, 9, red, green, e.depth_mm, e.status, workspace);
  }
  return test::allocations() - before;
}

template <class Smoothing, class Inverse, class Pixel, class S>
struct Step {
  using smoothing = Smoothing;
  using inverse = Inverse;
  using pixel = Pixel;
  using scalar = S;
};

}  // namespace

TEMPLATE_TEST_CASE("no frame takes memory",
                   "[depth]",
                   (Step<NoSmoothing, published::Bisection, std::uint8_t, float>),
                   (Step<published::BoxMean, ExponentialFree<>, std::uint8_t, float>),
                   (Step<BiasFreeMean, ExponentialFree<>, std::uint16_t, float>),
                   (Step<AnchoredMean, Newton, std::uint8_t, float>),
                   (Step<BiasFreeMean, ExponentialFree<>, std::uint8_t, float>),
                   (Step<BiasFreeMean, ExponentialFree<>, float, float>),
                   (Step<BiasFreeMean, Newton, double, double>),
                   (Step<published::BoxMean, ExponentialFree<9, 12, 8>, std::uint8_t, double>)) {
  using S = typename TestType::scalar;
  using Pixel = typename TestType::pixel;
  const Pad pad;
  auto frame = pad.frame<Pixel>(pad.pressed_depths(3));
  for (std::size_t k = 0; k < frame.red.cells.size(); k += 5) {
    frame.red.cells[k] = test::stored<Pixel>(k % 2 == 0 ? 0 : 255);
  }
  const auto estimator =
      pad.estimator<typename TestType::smoothing, typename TestType::inverse, S>();
  const long before = test::allocations();
  auto workspace = estimator.template workspace<Pixel>();
  CHECK(test::allocations() > before);  // the counter works
  CHECK(taken<S>(estimator, frame.red, frame.green, workspace) == 0);
  if constexpr (std::is_same_v<Pixel, std::uint8_t>) {
    cv::Mat image(static_cast<int>(pad.rows), static_cast<int>(pad.cols), CV_8UC3);
    image = cv::Scalar(10, 50, 60);
    CHECK(taken<S>(estimator, channel<const Pixel>(image, 2), channel<const Pixel>(image, 1),
                   workspace) == 0);
  }
}
