// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Computes the depth of one frame from four image types; the results are identical to the last bit.
#include <cstdint>
#include <cstdio>
#include <cstring>

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/adapt/xtensor.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#if __has_include(<xtensor/containers/xtensor.hpp>)
#include <xtensor/containers/xtensor.hpp>
#else
#include <xtensor/xtensor.hpp>
#endif

using fingerpad::Index;

int main() {
  constexpr Index rows = 120, cols = 160;
  const fingerpad::Camera<double> camera{
      .center_x_px = 79.5, .center_y_px = 59.5, .pitch_mm = 0.32};
  const fingerpad::Absorption<double> fluid;

  // The free pad and its colours as functions of the pixel.
  const fingerpad::LazyView shape(rows, cols, [](Index i, Index j) {
    const double x = (double(j) - 79.5) * 0.32, y = (double(i) - 59.5) * 0.32;
    return std::sqrt(400 - x * x - y * y) - 7;  // NaN or negative outside
  });
  const auto level = [&](Index i, Index j, auto member) {
    const auto ray = fingerpad::ray_at_pixel(camera, double(i), double(j));
    const double depth = (std::max)(0.0, shape(i, j));  // 0 for NaN
    return std::uint8_t(fingerpad::colour_at_depth(fluid, ray, 57.0, 0.0163, depth).*member);
  };
  using Colour = fingerpad::Colour<double>;
  const fingerpad::LazyView red(rows, cols,
                                [&](Index i, Index j) { return level(i, j, &Colour::red); });
  const fingerpad::LazyView green(rows, cols,
                                  [&](Index i, Index j) { return level(i, j, &Colour::green); });

  const auto reference = fingerpad::fit_reference(camera, fluid, red, green, shape);
  fingerpad::DepthEstimator estimate(camera, fluid, reference, {.window_px = 5});

  // The same frame in three libraries: column-major, row-major, and with interleaved channels.
  Eigen::Array<std::uint8_t, -1, -1> eigen_red(rows, cols), eigen_green(rows, cols);
  xt::xtensor<std::uint8_t, 2> xt_red({rows, cols}), xt_green({rows, cols});
  cv::Mat3b image(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      eigen_red(i, j) = xt_red(i, j) = red(i, j);
      eigen_green(i, j) = xt_green(i, j) = green(i, j);
      image(int(i), int(j)) = {0, green(i, j), red(i, j)};
    }
  }

  Eigen::Array<float, -1, -1, Eigen::RowMajor> lazy(rows, cols), eigen(rows, cols);
  xt::xtensor<float, 2> xtensor({rows, cols});
  cv::Mat1f opencv(rows, cols);
  const auto result = estimate(red, green, lazy);
  (void)estimate(eigen_red, eigen_green, eigen);
  (void)estimate(xt_red, xt_green, xtensor);
  (void)estimate(fingerpad::channel<std::uint8_t>(image, 2),
                 fingerpad::channel<std::uint8_t>(image, 1), opencv);

  const auto same = [&](const float* other) {
    return std::memcmp(lazy.data(), other, sizeof(float) * std::size_t(rows * cols)) == 0;
  };
  const bool all = same(eigen.data()) && same(xtensor.data()) && same(opencv.ptr<float>());
  std::printf("%td depths, %s on all four\n", result.valid_pixels(),
              all ? "the same" : "NOT the same");
  return all && result.valid_pixels() > 10000 ? 0 : 1;
}
