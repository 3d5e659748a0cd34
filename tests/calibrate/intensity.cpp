// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/calibrate/intensity.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "support/catch.hpp"
#include "support/digest.hpp"
#include "support/generators.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::begins_with;
using test::Image;
using test::Random;
using test::refusal;

namespace {

constexpr Index height = 110;
constexpr Index width = 130;

/// A ball in a gel of known law: a frame of the free pad and one with the ball.
struct Gel {
  IntensityLaw<> law{4, 0, 0};
  double ball_mm = 4;
  double depth_mm = 1.5;
  Point2<double> axis_mm = {6.4, 5.3};
  double mm_per_px = 0.1;
  double noise = 0;

  Image<double> free() const { return {height, width, 150.0}; }
  Image<double> pressed(Random& random) const {
    Image<double> frame = free();
    for (Index i = 0; i < height; ++i) {
      for (Index j = 0; j < width; ++j) {
        const double x = mm_per_px * static_cast<double>(j) - axis_mm.x;
        const double y = mm_per_px * static_cast<double>(i) - axis_mm.y;
        const double root_sq = ball_mm * ball_mm - x * x - y * y;
        const double depth =
            root_sq > 0 ? std::max(0.0, depth_mm - ball_mm + std::sqrt(root_sq)) : 0.0;
        frame(i, j) = 150 * std::exp(-log_of(depth)) + noise * random.normal();
      }
    }
    return frame;
  }

 private:
  double log_of(double depth) const {
    double low = 0;
    double high = 2;
    for (int k = 0; k < 60; ++k) {
      const double middle = (low + high) / 2;
      (pressed_depth_mm(law, middle) < depth ? low : high) = middle;
    }
    return low;
  }
};

const IntensityOptions as_it_is{.smoothing_px = 0};

template <class Frames>
IntensityFit<> fit(const Gel& gel, const Frames& pressed, const IntensityOptions& options = {}) {
  return fit_intensity(gel.free(), pressed, gel.ball_mm, gel.mm_per_px, options);
}

}  // namespace

TEST_CASE("intensity calibration: the law comes back from presses without noise",
          "[intensity_depth]") {
  rc::prop("for every ball and place", [] {
    Gel gel;
    gel.law = {test::uniform(2, 6), 0, 0};
    gel.ball_mm = test::uniform(2.5, 6);
    gel.depth_mm = test::uniform(0.6, 1.6);
    gel.axis_mm = {test::uniform(5.5, 7.5), test::uniform(4.5, 6.5)};
    Random random(1);
    const IntensityFit<> one = fit(gel, std::array{gel.pressed(random)}, as_it_is);
    RC_ASSERT(one.ok());
    RC_ASSERT(std::abs(one.law.linear_mm - gel.law.linear_mm) < 1e-10);
    RC_ASSERT(std::abs(one.max_depth_mm - gel.depth_mm) < 1e-10);
    RC_ASSERT(one.mean_error_mm < 1e-10);
    RC_ASSERT(one.law.square_mm == 0.0);
  });
}

TEST_CASE("intensity calibration: two presses count by what they tell", "[intensity_depth]") {
  // a shallow press tells less of the constant than a deep one
  Gel gel;
  gel.noise = 1;
  Random random(3);
  std::vector<Image<double>> pressed;
  for (const double depth : {0.3, 1.7}) {
    gel.depth_mm = depth;
    gel.axis_mm.x += 0.7;
    pressed.push_back(gel.pressed(random));
  }
  const IntensityFit<> shallow = fit(gel, std::array{pressed[0]});
  const IntensityFit<> deep = fit(gel, std::array{pressed[1]}), both = fit(gel, pressed);
  REQUIRE((shallow.ok() && deep.ok() && both.ok()));
  CHECK(both.variance_mm2 < shallow.variance_mm2);
  const double off_deep = std::abs(both.law.linear_mm - deep.law.linear_mm);
  CHECK(off_deep < 0.1 * std::abs(both.law.linear_mm - shallow.law.linear_mm));
  CHECK(both.max_depth_mm == Approx(deep.max_depth_mm).epsilon(0.01));
}

TEST_CASE("intensity calibration: the variance is that of the constant", "[intensity_depth]") {
  Gel gel;
  gel.noise = 1;
  Random random(5);
  double square_sum = 0;
  double variance = 0;
  constexpr int trials = 60;
  for (int k = 0; k < trials; ++k) {
    // noise that is not averaged flattens the law
    const IntensityFit<> one = fit(gel, std::array{gel.pressed(random)});
    REQUIRE(one.ok());
    square_sum += square(one.law.linear_mm - 4);
    variance += one.variance_mm2 / trials;
  }
  const double ratio = std::sqrt(square_sum / trials / variance);
  CHECK(ratio > 0.6);
  CHECK(ratio < 1.6);
}

TEST_CASE("intensity calibration: what tells nothing is refused", "[intensity_depth]") {
  const Gel gel;
  Random random(1);
  const Image<double> good = gel.pressed(random);
  const auto refused = [&](const std::vector<Image<double>>& pressed) {
    return refusal([&] { (void)fit(gel, pressed, as_it_is); });
  };
  CHECK(refused({good}) == "accepted");
  CHECK(begins_with(refused({}), "fit_intensity: number of presses = 0"));
  // brighter in the middle: not a ball in a darkening gel
  auto bright = good;
  for (double& level : bright.cells) {
    level = 150 * 60 / level;
  }
  const Image<double> nothing(height, width, std::numeric_limits<double>::quiet_NaN());
  for (const Image<double>& bad :
       {gel.free(), Image<double>(height, width + 1, 100.0), nothing, bright}) {
    CHECK(begins_with(refused({good, bad}), "fit_intensity: press = 1"));
  }
  const auto refused_ball = [&](double ball_mm, double mm_per_px) {
    return refusal([&] { (void)fit_intensity(gel.free(), std::array{good}, ball_mm, mm_per_px); });
  };
  CHECK(begins_with(refused_ball(0, 0.1), "fit_intensity: ball_mm = 0"));
  CHECK(begins_with(refused_ball(4, -1), "fit_intensity: mm_per_px = -1"));
}

TEST_CASE("unchanged: the law of noisy presses", "[unchanged]") {
  Gel gel{.law = {4, 0.5, -0.2}, .noise = 1};
  Random random(6);
  std::vector<Image<double>> pressed;
  for (const double depth : {0.5, 1.1, 1.7}) {
    gel.depth_mm = depth;
    gel.axis_mm.x += 0.4;
    pressed.push_back(gel.pressed(random));
  }
  test::Digest d;
  for (const IntensityFit<>& found : {fit(gel, pressed), fit(gel, pressed, as_it_is)}) {
    d.all(found.law.linear_mm, found.variance_mm2, found.mean_error_mm, found.max_depth_mm,
          found.ok());
  }
  CHECK(d.sum() == test::same(276.052));
}
