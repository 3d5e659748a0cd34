// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/depth/free_light.hpp"

#include <cmath>
#include <cstdint>

#include "support/catch.hpp"
#include "support/digest.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Image;

namespace {

/// A frame as a lamp or camera with these gains gives it.
test::Frame<double> frame_of(const test::Pad& pad,
                             const Image<double>& depth_mm,
                             const LightGains& gains,
                             std::uint64_t seed) {
  auto frame = pad.frame<double>(depth_mm, 0);
  test::Random random(seed);
  for (std::size_t k = 0; k < frame.red.cells.size(); ++k) {
    if (frame.red.cells[k] > 0) {
      frame.red.cells[k] = std::round(gains.red * frame.red.cells[k] + random.normal());
      frame.green.cells[k] = std::round(gains.green * frame.green.cells[k] + random.normal());
    }
  }
  return frame;
}

double mean_error_mm(const Image<float>& found, const Image<double>& truth) {
  double sum = 0, count = 0;
  for (std::size_t k = 0; k < truth.cells.size(); ++k) {
    const double e = std::abs(static_cast<double>(found.cells[k]) - truth.cells[k]);
    if (truth.cells[k] > 3 && std::isfinite(e)) {
      sum += e;
      count += 1;
    }
  }
  return sum / count;
}

struct Errors {
  double green, balance;  ///< shares
  double in_sd;           ///< of the balance
  double height;          ///< of the pad, found, a share of the reference's
};

Errors errors_of(const FreeLight<float>& light,
                 const test::Frame<double>& frame,
                 const LightGains& truth) {
  const auto found = light(frame.red, frame.green);
  REQUIRE(found.has_value());
  const double off = std::log(found->gains.red / found->gains.green / (truth.red / truth.green));
  return {found->gains.green / truth.green - 1, off, off / found->balance_sd, found->height};
}

constexpr LightGains changes[] = {{1, 1}, {0.97, 0.97}, {0.9, 0.9}, {1, 1.01}, {1, 1.03}, {1.1, 1}};

}  // namespace

TEST_CASE("a free frame tells its light, whatever the height of the pad", "[free light]") {
  const test::Pad pad = test::pad_of(240, 280, 0.16);
  const FreeLight<float> light(pad.camera, pad.fluid, pad.reference<float>());
  for (const double height : {1.0, 0.98, 1.02}) {
    auto depth_mm = pad.free_depths();
    for (double& l : depth_mm.cells) {
      l *= height;
    }
    for (const LightGains& gains : changes) {
      const auto e = errors_of(light, frame_of(pad, depth_mm, gains, 3), gains);
      CAPTURE(height, gains.green, gains.red);
      CHECK(std::abs(e.green) < 0.004);
      CHECK(std::abs(e.balance) < 0.0015);
      CHECK(e.height == Approx(height).margin(0.001));
    }
  }
}

TEST_CASE("the light's standard deviation is that of its errors", "[free light]") {
  const test::Pad pad = test::pad_of(240, 280, 0.16);
  const FreeLight<float> light(pad.camera, pad.fluid, pad.reference<float>());
  double squares = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const LightGains& gains = changes[seed % 6];
    squares += square(errors_of(light, frame_of(pad, pad.free_depths(), gains, seed), gains).in_sd);
  }
  CHECK(squares / 20 > 0.3);
  CHECK(squares / 20 < 3);
}

TEST_CASE("dirt on a tenth of the pad is not its light", "[free light]") {
  const test::Pad pad = test::pad_of(240, 280, 0.16);
  const FreeLight<float> light(pad.camera, pad.fluid, pad.reference<float>());
  auto frame = frame_of(pad, pad.free_depths(), {0.97, 1}, 1);
  for (Index i = 80; i < 160; ++i) {
    for (Index j = 60; j < 100; ++j) {
      frame.red(i, j) *= 0.8;
      frame.green(i, j) *= 0.7;
    }
  }
  const auto e = errors_of(light, frame, {0.97, 1});
  CHECK(std::abs(e.green) < 0.006);
  CHECK(std::abs(e.balance) < 0.003);
}

TEST_CASE("depth under another light is that under the reference's once the light is known",
          "[free light]") {
  const test::Pad pad = test::pad_of(240, 280, 0.16);
  const auto reference = pad.reference<float>();
  const FreeLight<float> light(pad.camera, pad.fluid, reference);
  const auto pressed_mm = pad.pressed_depths(2);
  const auto error_mm = [&](const LightGains& gains, bool known) {
    DepthEstimator<float> estimator(pad.camera, pad.fluid, reference, {.window_px = 15});
    if (known) {
      const auto free = frame_of(pad, pad.free_depths(), gains, 5);
      const auto found = light(free.red, free.green);
      REQUIRE(found.has_value());
      estimator.set_light(found->gains);
    }
    const auto e = test::estimate(estimator, frame_of(pad, pressed_mm, gains, 6));
    CHECK(e.result.ok() == (known || gains.green > 0.95));
    return mean_error_mm(e.depth_mm, pressed_mm);
  };
  const double unchanged = error_mm({1, 1}, false);
  for (const LightGains& gains : {LightGains{0.9, 0.9}, {1, 1.03}, {0.96, 1}}) {
    CAPTURE(gains.green, gains.red);
    CHECK(error_mm(gains, false) > 0.2);
    CHECK(error_mm(gains, true) < 1.3 * unchanged);
  }
}

TEST_CASE("frames that tell no light", "[free light]") {
  const test::Pad pad;
  const auto reference = pad.reference<float>();
  const FreeLight<float> light(pad.camera, pad.fluid, reference);
  const auto frame = pad.frame<double>(pad.free_depths());
  CHECK(light(frame.red, frame.green).has_value());
  CHECK_FALSE(light(Image<double>(3, 3), Image<double>(3, 3)).has_value());
  CHECK_FALSE(light(Image<double>(48, 56), Image<double>(48, 56)).has_value());
  auto unknown = reference;
  unknown.green.clear();
  CHECK_FALSE(FreeLight<float>(pad.camera, pad.fluid, unknown)(frame.red, frame.green).has_value());
}

TEST_CASE("unchanged: light of a noisy free frame with dirt", "[unchanged]") {
  test::Pad pad = test::pad_of(240, 280, 0.16);
  const FreeLight<float> light(pad.camera, pad.fluid, pad.reference<float>());
  test::Digest d;
  for (const LightGains& gains : changes) {
    auto frame = frame_of(pad, pad.free_depths(), gains, 5);
    for (Index i = 60; i < 90; ++i) {
      for (Index j = 100; j < 140; ++j) {
        frame.red(i, j) *= 0.8;
      }
    }
    const auto found = light(frame.red, frame.green);
    REQUIRE(found.has_value());
    d.all(found->gains.green, found->gains.red, found->height, found->green_sd, found->balance_sd);
  }
  CHECK(d.sum() == test::same(885.350));
}
