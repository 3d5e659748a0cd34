// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/depth/intensity_depth.hpp"

#include <cmath>
#include <limits>

#include "support/allocations.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::begins_with;
using test::Image;
using test::refusal;

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Grey level of an uneven lamp.
double free_level(Index i, Index j) {
  return 150 + 0.3 * static_cast<double>(i) - 0.2 * static_cast<double>(j);
}

}  // namespace

TEST_CASE("intensity depth: the law holds pixel by pixel, whatever the lamp", "[intensity_depth]") {
  rc::prop("for every lamp and law", [] {
    const IntensityLaw<> law{test::uniform(1, 6), test::uniform(-1, 1), test::uniform(-0.5, 0.5)};
    const double lamp = test::log_uniform(0.2, 1.5);
    const double l = test::uniform(-0.2, 0.6);
    Image<double> free(20, 30);
    Image<double> now(20, 30);
    for (Index i = 0; i < 20; ++i) {
      for (Index j = 0; j < 30; ++j) {
        free(i, j) = lamp * free_level(i, j);
        now(i, j) = free(i, j) * std::exp(-l);
      }
    }
    IntensityDepth<double> depth(free, law, {.saturated = 1000});
    Image<double> out(20, 30);
    (void)depth(now, out);
    const double expected = l * (law.linear_mm + l * (law.square_mm + l * law.cube_mm));
    for (const double found : out.cells) {
      RC_ASSERT(std::abs(found - expected) < 1e-12 * (1 + std::abs(expected)));
    }
  });
}

TEST_CASE("intensity depth: bytes and numbers, one answer", "[intensity_depth]") {
  Image<std::uint8_t> free(20, 30);
  Image<std::uint8_t> now(20, 30);
  Image<float> now_float(20, 30);
  test::Random random(3);
  for (Index i = 0; i < 20; ++i) {
    for (Index j = 0; j < 30; ++j) {
      free(i, j) = static_cast<std::uint8_t>(free_level(i, j));
      now(i, j) = static_cast<std::uint8_t>(random.whole(20, 200));
      now_float(i, j) = now(i, j);
    }
  }
  IntensityDepth<> depth(free, {});
  Image<float> a(20, 30);
  Image<float> b(20, 30);
  CHECK(depth(now, a) != FrameStatus::refused);
  CHECK(depth(now_float, b) != FrameStatus::refused);
  for (std::size_t k = 0; k < a.cells.size(); ++k) {
    CHECK(std::abs(a.cells[k] - b.cells[k]) < 1e-5F);
  }
}

TEST_CASE("intensity depth: bad pixels have no depth and change no other", "[intensity_depth]") {
  const Image<double> free(40, 40, 100.0);
  IntensityDepth<double> depth(free, {});
  Image<double> now(40, 40, 100 * std::exp(-0.25));
  now(7, 8) = none;
  now(20, 20) = 255;
  now(21, 20) = 0;
  now(30, 1) = std::numeric_limits<double>::infinity();
  Image<double> out(40, 40);
  (void)depth(now, out);
  Index missing = 0;
  for (const double found : out.cells) {
    missing += found != found;
    CHECK((found != found || std::abs(found - 0.75) < 1e-12));
  }
  CHECK(missing == 4);
}

TEST_CASE("intensity depth: no depth where the law overflows", "[intensity_depth]") {
  const Image<double> free(8, 8, 200.0);
  IntensityDepth<float> depth(free, {1, 1e30, 1e38});
  Image<double> now(8, 8, 200.0);
  now(2, 3) = 2;
  Image<float> out(8, 8);
  (void)depth(now, out);
  CHECK(out(2, 3) != out(2, 3));
  CHECK(out(2, 4) == 0);
}

TEST_CASE("intensity depth: smoothing averages the noise", "[intensity_depth]") {
  const Image<double> free(60, 60, 140.0);
  Image<double> now(60, 60);
  test::Random random(9);
  for (double& level : now.cells) {
    level = 120 + random.normal();
  }
  const auto spread = [&](double smoothing_px) {
    IntensityDepth<double> depth(free, {}, {.smoothing_px = smoothing_px});
    Image<double> out(60, 60);
    CHECK(depth(now, out) != FrameStatus::refused);
    double sum = 0;
    for (const double found : out.cells) {
      sum += square(found - 3 * std::log(140.0 / 120));
    }
    return std::sqrt(sum / 3600);
  };
  CHECK(spread(0) == Approx(3.0 / 120).epsilon(0.1));
  // the mean of a Gaussian with the sd s has the noise of 4 pi s^2 pixels
  CHECK(spread(2) == Approx(spread(0) / std::sqrt(4 * 3.14159 * 4)).epsilon(0.2));
}

TEST_CASE("intensity depth: fifty digits and duals", "[intensity_depth]") {
  const IntensityLaw<> law{3, -0.5, 0.25};
  using test::Digits50;
  const Digits50 fine = pressed_depth_mm(law, Digits50(0.3));
  CHECK(pressed_depth_mm(law, 0.3) == Approx(static_cast<double>(fine)).epsilon(1e-15));
  const double slope =
      test::slope_by_tangent<double>([&](const auto& l) { return pressed_depth_mm(law, l); }, 0.3);
  CHECK(slope == Approx(3 - 0.3 + 3 * 0.25 * 0.09));
}

TEST_CASE("intensity depth: what does not fit is refused", "[intensity_depth]") {
  const Image<double> free(20, 30, 100.0);
  IntensityDepth<double> depth(free, {});
  Image<double> out(20, 30, 7.0);
  CHECK(depth(Image<double>(20, 29), out) == FrameStatus::refused);
  CHECK(out(3, 3) == 7);

  const auto law = [&](const IntensityLaw<>& given) {
    return refusal([&] { IntensityDepth<>{free, given}; });
  };
  CHECK(begins_with(law({0, 0, 0}), "IntensityLaw: linear_mm = 0"));
  CHECK(begins_with(law({1, none, 0}), "IntensityLaw: square_mm = nan"));
  CHECK(begins_with(law({1, 0, none}), "IntensityLaw: cube_mm = nan"));
  const auto options = [&](const IntensityOptions& given) {
    return refusal([&] { IntensityDepth<>{free, {}, given}; });
  };
  CHECK(begins_with(options({.smoothing_px = 21}), "IntensityOptions: smoothing_px = 21"));
  CHECK(begins_with(options({.dark = -1}), "IntensityOptions: dark = -1"));
  CHECK(begins_with(options({.saturated = 5}), "IntensityOptions: saturated = 5"));
  CHECK(begins_with(options({.saturated = none}), "IntensityOptions: saturated = nan"));
  CHECK(options({.saturated = std::numeric_limits<double>::infinity()}) == "accepted");
}

TEST_CASE("intensity depth: a frame allocates nothing", "[intensity_depth]") {
  const test::Image<std::uint8_t> free(40, 50, 140);
  const test::Image<std::uint8_t> now(40, 50, 120);
  test::Image<float> depth(40, 50);
  IntensityDepth<> pressed(free, {});
  const long before = test::allocations();
  const auto result = pressed(now, depth);
  const long after = test::allocations();
  CHECK(result == FrameStatus::not_of_this_pad);
  CHECK(after == before);
}
