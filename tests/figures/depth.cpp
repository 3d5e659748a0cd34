// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Depth error on full-size frames of finite-element membranes: refracted rays, printed dots, 8 bit,
// one grey level of noise in each channel. See tests/data/README.md for the shapes.
#include "fingerpad/published/depth.hpp"

#include <cmath>
#include <string>

#include "fingerpad/depth/depth.hpp"
#include "support/catch.hpp"
#include "support/finite_elements.hpp"

using namespace fingerpad;
using test::Frame;
using test::Image;

namespace {

/// Mean absolute error in mm within 14 mm of the axis, and within 17.5 mm.
struct Error {
  double inner_mm;
  double outer_mm;
};

namespace bound_mm {
constexpr Error best = {0.03, 0.04};       // documented
constexpr Error printed = {0.045, 0.065};  // as a guard
}  // namespace bound_mm

Error error_of(const test::Pad& pad, const Image<float>& depth_mm, const Image<double>& truth) {
  double sum[2] = {};
  double count[2] = {};
  for (Index i = 0; i < pad.rows; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      const double l = truth(i, j);
      if (l != l) {
        continue;
      }
      const auto p = point_at(pad.camera, static_cast<double>(i), static_cast<double>(j), l);
      const double r = std::hypot(p.x, p.y);
      for (const int k : {0, 1}) {
        if (r < (k == 0 ? 14 : 17.5)) {
          sum[k] += std::abs(static_cast<double>(depth_mm(i, j)) - l);
          count[k] += 1;
        }
      }
    }
  }
  return {sum[0] / count[0], sum[1] / count[1]};  // NaN if a depth is missing
}

}  // namespace

TEST_CASE("depth of noisy frames of finite-element membranes", "[depth]") {
  const test::Scene scene;
  const auto free = scene.depth("free");
  const test::Pad& pad = scene.pad();
  DepthEstimator<> estimator(pad.camera, pad.fluid, scene.reference(free));
  const auto free_frame = scene.frame(free, 99);
  published::DepthEstimator<> as_printed(pad.published(), free_frame.red, free_frame.green, free);
  Image<float> depth(pad.rows, pad.cols);
  const auto check = [](const Error& error, const Error& bound) {
    INFO("mean absolute error within 14 mm: " << error.inner_mm
                                              << ", within 17.5 mm: " << error.outer_mm);
    CHECK(error.inner_mm <= bound.inner_mm);
    CHECK(error.outer_mm <= bound.outer_mm);
  };
  std::uint64_t seed = 0;
  for (const std::string name : {"free", "press", "cylinder", "roll"}) {
    const auto truth = scene.depth(name);
    for (int noise = 0; noise < 2; ++noise) {
      const auto frame = scene.frame(truth, ++seed);
      INFO(name << ", noise of seed " << seed);
      check(error_of(pad, test::estimate(estimator, frame).depth_mm, truth), bound_mm::best);
      REQUIRE(as_printed(frame.red, frame.green, depth));
      check(error_of(pad, depth, truth), bound_mm::printed);
    }
  }
}
