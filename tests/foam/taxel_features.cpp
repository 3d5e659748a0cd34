// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties of the features of every array.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "fingerpad/foam/taxels.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::Image;

namespace {

constexpr double tau = 2 * std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double period_s = 0.01;

TaxelOptions options() {
  return {
      .pitch_mm = 2, .window = 16, .sample_period_s = period_s, .longest_gap_s = 0.1, .noise = 0.1};
}

/// Array k of a recording whose taxel (row, col) reads `reading(k, row, col)`.
template <class T = double, class Reading>
Image<T> array(Index rows, Index cols, const Reading& reading) {
  Image<T> taxels(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      taxels(i, j) = static_cast<T>(reading(i, j));
    }
  }
  return taxels;
}

/// The features after `count` more samples, evenly timed.
template <class Features, class Reading>
FingerSample<double> go_on(Features& features, int count, const Reading& reading, int first = 0) {
  FingerSample<double> sample;
  for (int k = first; k < first + count; ++k) {
    const auto taxels =
        array(features.rows(), features.cols(), [&](Index i, Index j) { return reading(k, i, j); });
    sample = features(taxels, k * period_s);
  }
  return sample;
}
/// The same from the start on.
template <class Features, class Reading>
FingerSample<double> after(Features features, int count, const Reading& reading) {
  return go_on(features, count, reading);
}

/// A sine with `waves` in a window of 16 at one taxel, and 10 at all others.
struct Sine {
  double waves;
  Index row = 1;
  Index col = 2;
  double amplitude = 3;
  double operator()(int k, Index i, Index j) const {
    return 10 + (i == row && j == col ? amplitude * std::sin(tau * waves * (k + 0.3) / 16) : 0);
  }
};

}  // namespace

TEST_CASE("taxel features: centroid of force in mm, x along columns", "[taxel_features]") {
  const TaxelFeatures features(3, 5, options());
  const auto centroid_of = [&](std::vector<std::array<double, 3>> loads) {
    return after(features, 1, [&](int, Index i, Index j) {
      for (const auto& load : loads) {
        if (load[0] == static_cast<double>(i) && load[1] == static_cast<double>(j)) {
          return load[2];
        }
      }
      return 0.0;
    });
  };
  const auto one = centroid_of({{2, 4, 7}});
  CHECK(one.center_x_mm == 8);
  CHECK(one.center_y_mm == 4);
  CHECK(one.sum == 7);
  const auto two = centroid_of({{0, 0, 1}, {2, 4, 3}});
  CHECK(two.center_x_mm == 6);
  CHECK(two.center_y_mm == 3);
  // negative readings count as no pressure
  const auto three = centroid_of({{0, 0, 1}, {2, 4, 3}, {1, 1, -5}});
  CHECK(three.center_x_mm == 6);
  CHECK(three.sum == 4);
  const auto none = centroid_of({});
  CHECK_FALSE(none.is_pressed());
  CHECK(std::isnan(none.center_x_mm));
  CHECK(none.sum == 0);
}

TEST_CASE("taxel features: touch and release", "[taxel_features]") {
  // from twice 2.5 times the noise of 0.1 on, until below that
  const auto load = [](int k) { return k < 5 ? 0.49 : k < 8 ? 0.51 : k < 12 ? 0.26 : 0.24; };
  TaxelFeatures finger(3, 5, options());
  for (int k = 0; k < 20; ++k) {
    CAPTURE(k);
    const auto sample = go_on(
        finger, 1, [&](int n, Index i, Index) { return i == 1 ? load(n) : 0.24; }, k);
    CHECK(sample.is_pressed() == (k >= 5 && k < 12));
  }
  finger.reset();
  CHECK_FALSE(go_on(finger, 1, [](int, Index, Index) { return 0.26; }).is_pressed());
}

TEST_CASE("taxel features: the taxel that spreads most vibrates, of equals the first",
          "[taxel_features]") {
  const TaxelFeatures features(3, 5, options());
  const auto two = [](double at_7, double at_11) {
    return [=](int k, Index i, Index j) {
      const double a = i * 5 + j == 7 ? at_7 : i * 5 + j == 11 ? at_11 : 0;
      return 10 + a * (k % 4 < 2 ? 1 : -1);
    };
  };
  CHECK(after(features, 16, two(1, 2)).location == 11);
  CHECK(after(features, 16, two(2, 1)).location == 7);
  CHECK(after(features, 16, two(2, 2)).location == 7);
  CHECK(after(features, 16, two(2, 2)).status == TaxelStatus::vibrating);
  // a deviation within the noise is no vibration: 2.5 times 0.1 by default
  CHECK(after(features, 16, two(0.24, 0.24)).status == TaxelStatus::quiet);
  CHECK(after(features, 16, two(0.24, 0.24)).location == FingerSample<double>::no_location);
  CHECK(after(features, 16, two(0.24, 0.27)).location == 11);
}

TEST_CASE("taxel features: every taxel that vibrates is listed", "[taxel_features]") {
  // taxels 3, 7, 11 and 12, with 2, 4, 4 and 8 waves in 16 samples; 12 is the strongest
  const auto reading = [](int k, Index i, Index j) {
    const auto wave = [k](int period) { return k % period < period / 2 ? 1.0 : -1.0; };
    const Index taxel = i * 5 + j;
    const double vibration = taxel == 3 ? wave(8) : taxel == 7 || taxel == 11 ? 2 * wave(4) : 0;
    return 10 + (k < 20 ? 0.01 * (k % 2) : taxel == 12 ? 3 * wave(2) : vibration);
  };
  TaxelFeatures finger(3, 5, options());
  CHECK(go_on(finger, 20, reading).vibration_count == 0);
  const auto sample = go_on(finger, 32, reading, 20);
  CHECK(sample.location == 12);
  CHECK(sample.has_rested);
  CHECK(sample.waves == 8);
  REQUIRE(sample.vibration_count == 3);  // by their waves
  CHECK(sample.vibrations[0].location == 3);
  CHECK(sample.vibrations[0].waves == 2);
  CHECK_FALSE(sample.vibrations[0].is_several);
  CHECK(sample.vibrations[1].location == 7);
  CHECK(sample.vibrations[1].waves == 4);
  CHECK(sample.vibrations[1].is_several);
  CHECK(sample.vibrations[2].location == 12);
  CHECK(sample.vibrations[2].waves == 8);
  CHECK_FALSE(sample.vibrations[2].is_several);
}

TEST_CASE("taxel features: nothing vibrates before the window is full", "[taxel_features]") {
  TaxelFeatures finger(3, 5, options());
  const auto early = go_on(finger, 15, Sine{3});
  CHECK(early.status == TaxelStatus::filling);
  CHECK(early.location == FingerSample<double>::no_location);
  CHECK(early.waves == 0);
  CHECK(early.is_pressed());
  const auto full = go_on(finger, 1, Sine{3}, 15);
  CHECK(full.status == TaxelStatus::vibrating);
  CHECK(full.location == 7);
  finger.reset();
  CHECK(go_on(finger, 1, Sine{3}, 16).status == TaxelStatus::filling);
}

TEST_CASE("taxel features: as many waves as a sine has in the window", "[taxel_features]") {
  const TaxelFeatures features(3, 5, options());
  // a crossing may be missed where waves are shorter than three samples, and one wave minus its
  // line crosses it three times
  for (int waves = 2; waves <= 5; ++waves) {
    CAPTURE(waves);
    const auto sample = after(features, 40, Sine{static_cast<double>(waves)});
    CHECK(sample.waves == waves);
    CHECK(sample.frequency_hz == Approx(waves / 0.16));
    CHECK(sample.location == 7);
  }
}

TEST_CASE("taxel features: a step is one wave that has begun", "[taxel_features]") {
  const TaxelFeatures features(3, 5, options());
  const auto step = [](int at) {
    return [=](int k, Index i, Index j) { return i == 1 && j == 1 && k >= at ? 5.0 : 9.0; };
  };
  CHECK(after(features, 24, step(23)).waves == 1);
  CHECK(after(features, 24, step(22)).waves == 1);
  CHECK(after(features, 24, step(23)).location == 6);
  CHECK(after(features, 24, step(8)).status == TaxelStatus::quiet);  // out of the window
  CHECK(after(features, 24, step(9)).status == TaxelStatus::vibrating);
}

TEST_CASE("taxel features: noise that crosses the mean is not counted within the hysteresis",
          "[taxel_features]") {
  const auto rippled = [](int k, Index, Index) {
    return 10 + std::sin(tau * 4 * (k + 0.3) / 64) + (k % 2 == 0 ? 0.3 : -0.3);
  };
  auto o = options();
  o.window = 64;
  CHECK(after(TaxelFeatures<>(1, 1, o), 64, rippled).waves == 4);
}

TEST_CASE("taxel features: waves of the window, frequency by the clock", "[taxel_features]") {
  // 12.5 Hz sampled at 0.8 to 1.25 times the nominal rate: 10 to 6.4 waves in 64 samples
  for (const double rate : {0.8, 1.0, 1.25}) {
    CAPTURE(rate);
    auto o = options();
    o.window = 64;
    const TaxelFeatures features(1, 1, o);
    auto finger = features;
    FingerSample<double> sample;
    for (int k = 0; k < 200; ++k) {
      const double t = k * period_s / rate;
      sample = finger(array(1, 1, [&](Index, Index) { return 10 + std::sin(tau * 12.5 * t); }), t);
    }
    const double window_s = 64 * period_s / rate;
    CHECK(std::abs(static_cast<double>(sample.waves) - 12.5 * window_s) <= 0.5);
    CHECK(sample.frequency_hz == Approx(static_cast<double>(sample.waves) / window_s));
  }
}

TEST_CASE("taxel features: a gap counts as at most two periods", "[taxel_features]") {
  auto o = options();
  o.longest_gap_s = 2;
  const TaxelFeatures features(3, 5, o);
  for (const double gap_s : {0.021, 0.3, 1.99}) {
    CAPTURE(gap_s);
    auto finger = features, without = features;
    double time_s = 0;
    for (int k = 0; k < 40; ++k) {
      time_s += k == 20 ? gap_s : period_s;
      const auto taxels = array(3, 5, [&](Index i, Index j) { return Sine{4}(k, i, j); });
      const auto sample = finger(taxels, time_s);
      const auto even = without(taxels, k * period_s);
      CHECK(sample.status == even.status);
      CHECK(sample.waves == even.waves);
      CHECK(sample.location == even.location);
      // as if the window were a period longer
      CHECK(sample.frequency_hz ==
            Approx(k >= 20 && k < 35 ? even.frequency_hz * 15 / 16 : even.frequency_hz));
    }
  }
}

TEST_CASE("taxel features: times that do not grow are refused, jumps begin a new window",
          "[taxel_features]") {
  TaxelFeatures finger(3, 5, options());
  const auto taxels = array(3, 5, [](Index, Index) { return 10.0; });
  const auto status_at = [&](double t) { return finger(taxels, t).status; };
  CHECK(status_at(test::nan) == TaxelStatus::refused);
  CHECK(status_at(infinity) == TaxelStatus::refused);
  CHECK(finger.samples() == 0);
  go_on(finger, 16, Sine{3});
  CHECK(finger.samples() == 16);
  CHECK(status_at(0.15) == TaxelStatus::refused);  // the last time again
  CHECK(status_at(0.10) == TaxelStatus::refused);
  CHECK(status_at(test::nan) == TaxelStatus::refused);
  CHECK(finger.samples() == 16);
  CHECK(go_on(finger, 1, Sine{3}, 16).status == TaxelStatus::vibrating);
  CHECK(status_at(0.26) == TaxelStatus::vibrating);  // 0.1 s later is no jump
  CHECK(status_at(0.361) == TaxelStatus::filling);
  CHECK(finger.samples() == 1);
  CHECK(status_at(0.37) == TaxelStatus::filling);
  CHECK(status_at(0.1) == TaxelStatus::filling);  // a clock that was set back
  CHECK(finger.samples() == 1);
}

TEST_CASE("taxel features: bad taxels are left out and the others stay right", "[taxel_features]") {
  auto o = options();
  o.saturated_at = 4095;
  const TaxelFeatures features(3, 5, o);
  double bad = 0;
  // taxel 7 vibrates by 3, taxel 11 by 1; taxel 7 is invalid once, at sample 20
  const auto reading = [&](int k, Index i, Index j) {
    const Index taxel = i * 5 + j;
    const double turn = k % 4 < 2 ? 1 : -1;
    return taxel == 7 ? (k == 20 ? bad : 10 + 3 * turn) : 10 + (taxel == 11 ? turn : 0);
  };
  for (const double one : {test::nan, infinity, -infinity, 4095.0, 1e300}) {
    CAPTURE(one);
    bad = one;
    auto finger = features;
    CHECK(go_on(finger, 20, reading).location == 7);
    const auto there = go_on(finger, 1, reading, 20);
    CHECK(there.left_out == 1);
    CHECK(there.location == 11);
    // the centroid without taxel 7, by hand: all read 10 except taxel 11, which reads 11
    CHECK(there.sum == 141);
    CHECK(there.center_x_mm == Approx(2 * (10.0 * (30 - 2) + 1 * 1) / 141));
    const auto next = go_on(finger, 1, reading, 21);
    CHECK(next.left_out == 0);
    CHECK(next.location == 11);
    CHECK(go_on(finger, 14, reading, 22).location == 11);
    CHECK(go_on(finger, 1, reading, 36).location == 7);  // a window later
  }
}

TEST_CASE("taxel features: a taxel that stays while the others change does not count",
          "[taxel_features]") {
  auto o = options();
  o.stuck_after = 5;
  // of 9 taxels one reads 50 and one 0 all the time; the others rise after sample 20
  const auto reading = [](int k, Index, Index j) {
    return j == 0 ? 0.0 : j == 1 ? 50.0 : 10 + 0.01 * (k % 2) + (k >= 20 ? 10 : 0);
  };
  TaxelFeatures finger(1, 9, o);
  const auto held = go_on(finger, 20, reading);
  CHECK(held.left_out == 0);  // nothing asks it to change
  CHECK(held.sum >= 120);
  CHECK(go_on(finger, 5, reading, 20).left_out == 0);
  const auto later = go_on(finger, 1, reading, 25);
  CHECK(later.left_out == 1);  // zero is not stuck: no pressure there
  CHECK(later.sum < 141);
  CHECK(later.center_x_mm == Approx(2 * 5));
  const auto again = go_on(
      finger, 1, [&](int k, Index i, Index j) { return reading(k, i, j) + 1; }, 26);
  CHECK(again.left_out == 0);
}

TEST_CASE("taxel features: what one taxel does stops no others", "[taxel_features]") {
  // a steady hold of whole counts, in which one taxel is lost, loose, or spikes
  auto o = options();
  o.stuck_after = 5;
  const auto left_out = [&](auto lone) {
    return after(TaxelFeatures(3, 5, o), 60,
                 [&](int k, Index i, Index j) {
                   return i == 1 && j == 1 ? lone(k) : 100.0 + double(i * j) + (j == 3 ? k % 2 : 0);
                 })
        .left_out;
  };
  CHECK(left_out([](int k) { return k < 20 ? 3000.0 : test::nan; }) == 1);
  CHECK(left_out([](int k) { return k < 20 ? 3000.0 : 0.0; }) == 0);
  CHECK(left_out([](int k) { return k == 20 ? 9e8 : 100.0; }) == 0);
  CHECK(left_out([](int k) { return k < 20 ? 0.0 : 3000.0; }) == 0);
}

TEST_CASE("taxel features: the first full window has no other vibration than later ones",
          "[taxel_features]") {
  auto o = options();
  o.window = 4;
  o.noise = 0.01;
  const TaxelFeatures features(3, 5, o);  // more taxels than samples of the window
  const auto reading = [](int k, Index, Index) { return k % 4 < 2 ? 10.0 : 11.0; };
  auto finger = features;
  const auto first = go_on(finger, 4, reading);
  CHECK(first.is_vibrating());
  REQUIRE(first.vibration_count == 1);
  CHECK(first.vibrations[0].is_several);
  CHECK(first.deviation == Approx(go_on(finger, 4, reading, 4).deviation));
}

TEST_CASE("taxel features: with stuck_after 0 no reading is ever stuck", "[taxel_features]") {
  auto o = options();
  o.stuck_after = 0;
  const TaxelFeatures features(2, 3, o);
  const auto sample = after(features, 50, [](int, Index, Index j) { return 10.0 * double(j); });
  CHECK(sample.status == TaxelStatus::quiet);
  CHECK(sample.left_out == 0);
  CHECK(sample.sum == 60);
}

TEST_CASE("taxel features: two windows of new clocks may pass, then they are told",
          "[taxel_features]") {
  TaxelFeatures finger(1, 2, options());  // a window of 16
  for (int run = 0; run < 2; ++run) {
    for (int k = 1; k <= 34; ++k) {
      CAPTURE(run, k);
      const auto status = finger(Image<double>(1, 2, 10.0), 1.0 * k).status;
      CHECK(status == (k <= 2 * 16 ? TaxelStatus::filling : TaxelStatus::clock_jumps));
    }
    finger.reset();
  }
}

TEST_CASE("taxel features: the edge of a contact may let go and come back", "[taxel_features]") {
  // all read about 100; taxel 2 alternates between 0 and another reading
  const TaxelFeatures features(1, 4, options());
  const auto vibrates = [&](double comes_back_to) {
    return after(features, 60,
                 [&](int k, Index, Index j) {
                   const double load = 100 + 0.01 * (k % 3);
                   return k < 30 || j != 2 ? load : k % 2 == 0 ? 0 : comes_back_to;
                 })
        .is_vibrating();
  };
  CHECK(vibrates(40));
  CHECK_FALSE(vibrates(130));  // higher than the others: a loose contact
}

TEST_CASE("taxel features: noise taxel by taxel, and dead ones", "[taxel_features]") {
  const auto all_vibrate = [](int k, Index, Index) { return 10 + (k % 4 < 2 ? 1.0 : -1.0); };
  std::vector<double> noise = {test::nan, 1, 0.1, 1};
  const auto with_noise = [&] { return TaxelFeatures<>(2, 2, options(), noise); };
  const auto sample = after(with_noise(), 16, all_vibrate);
  CHECK(sample.location == 2);
  CHECK(sample.left_out == 1);
  CHECK(sample.sum < 34);
  noise[2] = -1;
  CHECK(after(with_noise(), 16, all_vibrate).status == TaxelStatus::quiet);
  noise.assign(4, test::nan);
  CHECK(after(with_noise(), 16, all_vibrate).status == TaxelStatus::no_taxels);
}

TEST_CASE("taxel features: a finger of several arrays is a list of taxels with places",
          "[taxel_features]") {
  // an array of 2 x 2 and, beside it, one of 3 taxels
  const std::vector<Point2<double>> places = {{0, 0},  {2, 0},  {0, 2}, {2, 2},
                                              {10, 0}, {10, 3}, {10, 6}};
  TaxelFeatures<> finger(7, 1, options(), {}, places);
  const auto sample = go_on(finger, 16, [](int k, Index i, Index) {
    return i == 0 ? 30.0 : i == 6 ? (k % 4 < 2 ? 11.0 : 9.0) : 0.0;
  });
  CHECK(sample.status == TaxelStatus::vibrating);
  CHECK(sample.location == 6);
  CHECK(sample.sum == 39);
  CHECK(sample.center_x_mm == Approx(9 * 10 / 39.0));
  CHECK(sample.center_y_mm == Approx(9 * 6 / 39.0));
  CHECK(sample.left_out == 0);
  std::vector<Point2<double>> bad = places;
  bad[3].y = test::nan;
  CHECK(test::refusal([&] { TaxelFeatures<>(7, 1, options(), {}, bad); }) ==
        "TaxelFeatures: places_mm.y = nan, must be finite");
  const std::vector<double> noise(4, 1);
  CHECK(test::refusal([&] { TaxelFeatures<>(7, 1, options(), noise, places); }) ==
        "TaxelFeatures: size of noise or places_mm = 4, must be 0 or rows * cols");
  CHECK(test::refusal([&] { TaxelFeatures<>(2, 2, options(), noise, places); }) ==
        "TaxelFeatures: size of noise or places_mm = 7, must be 0 or rows * cols");
}

TEST_CASE("taxel features: arrays that say nothing", "[taxel_features]") {
  auto o = options();
  o.saturated_at = 4095;
  const TaxelFeatures features(3, 5, o);
  const auto all = [&](double reading) {
    return after(features, 20, [=](int, Index, Index) { return reading; });
  };
  CHECK(all(0).status == TaxelStatus::frozen);
  CHECK_FALSE(all(0).is_pressed());
  CHECK(all(4095).status == TaxelStatus::no_taxels);
  CHECK(all(4095).left_out == 15);
  CHECK(all(test::nan).status == TaxelStatus::no_taxels);
  CHECK_FALSE(all(test::nan).is_pressed());
  CHECK(all(7).status == TaxelStatus::frozen);
  // a single live taxel
  const auto one = after(features, 20, [](int k, Index i, Index j) {
    return i == 2 && j == 3 ? 10 + (k % 4 < 2 ? 1.0 : -1.0) : test::nan;
  });
  CHECK(one.status == TaxelStatus::vibrating);
  CHECK(one.location == 13);
  CHECK(one.left_out == 14);
  CHECK(one.center_x_mm == 6);
  CHECK(one.center_y_mm == 4);
}

TEST_CASE("taxel features: an array of another size is refused and nothing changes",
          "[taxel_features]") {
  TaxelFeatures finger(3, 5, options());
  go_on(finger, 16, Sine{3});
  const auto other = finger(Image<double>(5, 3, 9.0), 0.16);
  CHECK(other.status == TaxelStatus::refused);
  CHECK(std::isnan(other.center_x_mm));
  CHECK(finger(Image<double>(0, 0), 0.16).status == TaxelStatus::refused);
  CHECK(go_on(finger, 1, Sine{3}, 16).status == TaxelStatus::vibrating);
}

TEST_CASE("taxel features: readings in any number", "[taxel_features]") {
  const auto reading = [](int k, Index i, Index j) {
    return 100 + static_cast<double>(i * 10 + j) + (i == 1 && j == 3 && k % 4 < 2 ? 7.0 : 0.0);
  };
  const TaxelFeatures features(3, 5, options());
  const auto expected = after(features, 20, reading);
  REQUIRE(expected.location == 8);
  const auto same = [&](auto cell) {
    auto finger = features;
    FingerSample<double> sample;
    for (int k = 0; k < 20; ++k) {
      sample =
          finger(array<decltype(cell)>(3, 5, [&](Index i, Index j) { return reading(k, i, j); }),
                 k * period_s);
    }
    CHECK(sample.location == expected.location);
    CHECK(sample.waves == expected.waves);
    CHECK(sample.center_x_mm == expected.center_x_mm);
    CHECK(sample.center_y_mm == expected.center_y_mm);
    CHECK(sample.deviation == expected.deviation);
  };
  same(std::uint8_t());
  same(std::uint16_t());
  same(int());
  same(float());
}

TEST_CASE("taxel features: derivative of the centroid", "[taxel_features]") {
  using S = test::Tangent<double>;
  TaxelFeatures<S> finger(1, 2, {.noise = 0.1});
  Image<S> taxels(1, 2, S(3.0));
  taxels(0, 1) = S(1.0, 1.0);
  const auto sample = finger(taxels, 0.0);
  // x = pitch b / (a + b), dx/db = pitch a / (a + b)^2
  CHECK(value(sample.center_x_mm) == Approx(3.4 / 4));
  CHECK(sample.center_x_mm.d == Approx(3.4 * 3 / 16));
}

TEST_CASE("taxel features: bad parameters are refused by name", "[taxel_features]") {
  const auto message = [](auto change) {
    auto o = options();
    change(o);
    return test::refusal([&] { TaxelFeatures<>(3, 5, o); });
  };
  CHECK(message([](auto&) {}) == "accepted");
  CHECK(message([](auto& o) { o.pitch_mm = 0; }) ==
        "TaxelOptions: pitch_mm = 0, must be finite and > 0");
  CHECK(message([](auto& o) { o.window = 3; }) == "TaxelOptions: window = 3, must be in [4, 4096]");
  CHECK(message([](auto& o) { o.window = 4097; }) ==
        "TaxelOptions: window = 4097, must be in [4, 4096]");
  CHECK(message([](auto& o) { o.sample_period_s = -1; }) ==
        "TaxelOptions: sample_period_s = -1, must be finite and > 0");
  CHECK(message([](auto& o) { o.longest_gap_s = infinity; }) ==
        "TaxelOptions: longest_gap_s = inf, must be finite and > 0");
  CHECK(message([](auto& o) { o.noise = -1; }) ==
        "TaxelOptions: noise = -1, must be finite and >= 0");
  CHECK(message([](auto& o) { o.noise_factor = test::nan; }) ==
        "TaxelOptions: noise_factor = nan, must be finite and >= 0");
  CHECK(message([](auto& o) { o.saturated_at = 0; }) ==
        "TaxelOptions: saturated_at = 0, must be in (0, 1e+09]");
  CHECK(message([](auto& o) { o.stuck_after = -1; }) ==
        "TaxelOptions: stuck_after = -1, must be >= 0");
  CHECK(test::refusal([] { TaxelFeatures<>(0, 5); }) ==
        "TaxelFeatures: rows = 0, must be in [1, 1000000]");
  CHECK(test::refusal([] { TaxelFeatures<>(5, 1000001); }) ==
        "TaxelFeatures: cols = 1000001, must be in [1, 1000000]");
}

namespace {

using Array = Image<double>;
using Recording = std::vector<Array>;

/// Integer readings from 1 to 4000 of a few taxels that vibrate, jump, drift or rest: sums of
/// integers are exact. No reading is 0, which means no pressure.
Recording any_recording(Index rows, Index cols, Index samples) {
  struct Taxel {
    double level, amplitude, period, phase, drift;
    Index jump_at;
  };
  std::vector<Taxel> taxels;
  for (Index k = 0; k < rows * cols; ++k) {
    taxels.push_back({test::uniform(0, 2000), test::whole(0, 1) == 0 ? 0 : test::uniform(0, 500),
                      test::uniform(2, 20), test::uniform(0, 1), test::uniform(-5, 5),
                      test::whole(0, 3 * samples)});
  }
  Recording recording;
  for (Index n = 0; n < samples; ++n) {
    Array array(rows, cols);
    for (std::size_t k = 0; k < taxels.size(); ++k) {
      const Taxel& t = taxels[k];
      const double time = static_cast<double>(n);
      const double wave = t.amplitude * std::sin(6.283 * (time / t.period + t.phase));
      array.cells[k] = std::clamp(
          std::round(t.level + wave + t.drift * time + (n > t.jump_at ? 300 : 0)), 1.0, 4000.0);
    }
    recording.push_back(array);
  }
  return recording;
}

TaxelOptions any_options() {
  TaxelOptions o;
  o.window = Index(1) << test::whole(2, 5);  // a power of two: means of integers are exact
  o.sample_period_s = 1;
  o.longest_gap_s = 10;
  o.noise = test::uniform(0, 50);
  return o;
}

std::vector<FingerSample<double>> features_of(TaxelFeatures<> features,
                                              const Recording& recording) {
  std::vector<FingerSample<double>> samples;
  for (std::size_t n = 0; n < recording.size(); ++n) {
    samples.push_back(features(recording[n], static_cast<double>(n)));
  }
  return samples;
}

template <class Change>
Recording changed(Recording recording, const Change& change) {
  for (Array& array : recording) {
    for (double& reading : array.cells) {
      reading = change(reading);
    }
  }
  return recording;
}

void same_vibration(const FingerSample<double>& a, const FingerSample<double>& b) {
  RC_ASSERT(a.status == b.status);
  RC_ASSERT(a.location == b.location);
  RC_ASSERT(a.waves == b.waves);
  RC_ASSERT(a.left_out == b.left_out);
}

double variance_by_hand(const Recording& recording, std::size_t last, std::size_t taxel, Index n) {
  const double length = static_cast<double>(n);
  double mean = 0, middle = (length - 1) / 2, tilt = 0, spread = 0, squares = 0;
  const auto reading = [&](Index u) {
    return recording[last + 1 - static_cast<std::size_t>(n - u)].cells[taxel];
  };
  for (Index u = 0; u < n; ++u) {
    mean += reading(u) / length;
    tilt += (static_cast<double>(u) - middle) * reading(u);
    spread += (static_cast<double>(u) - middle) * (static_cast<double>(u) - middle);
  }
  for (Index u = 0; u < n; ++u) {
    const double left = reading(u) - mean - tilt / spread * (static_cast<double>(u) - middle);
    squares += left * left;
  }
  return squares / length;
}

}  // namespace

TEST_CASE("taxel features: laws", "[taxel_features]") {
  using Features = TaxelFeatures<>;

  rc::prop("a load that is added to all of them vibrates no taxel and stops none", [] {
    const auto recording = any_recording(3, 4, 70);
    auto o = any_options();
    o.stuck_after = 0;  // a taxel is stuck by its share of the load
    const Features features(3, 4, o);
    const double load = static_cast<double>(test::whole(0, 5000));
    const auto plain = features_of(features, recording);
    const auto loaded =
        features_of(features, changed(recording, [=](double x) { return x + load; }));
    for (std::size_t n = 0; n < plain.size(); ++n) {
      same_vibration(plain[n], loaded[n]);
      RC_ASSERT(std::fabs(plain[n].deviation - loaded[n].deviation) <= 1e-9 * plain[n].deviation);
    }
  });

  rc::prop("in another unit all is the same, and sums and deviations are in that unit", [] {
    const auto recording = any_recording(3, 4, 70);
    const auto o = any_options();
    const double unit = std::ldexp(1.0, static_cast<int>(test::whole(-30, 12)));
    auto in_unit = o;
    in_unit.noise *= unit;
    const auto plain = features_of(Features(3, 4, o), recording);
    const auto scaled = features_of(Features(3, 4, in_unit),
                                    changed(recording, [=](double x) { return x * unit; }));
    for (std::size_t n = 0; n < plain.size(); ++n) {
      same_vibration(plain[n], scaled[n]);
      RC_ASSERT(plain[n].deviation * unit == scaled[n].deviation);
      RC_ASSERT(plain[n].sum * unit == scaled[n].sum);
      RC_ASSERT(plain[n].is_pressed() == scaled[n].is_pressed());
      RC_ASSERT(!plain[n].is_pressed() || plain[n].center_x_mm == scaled[n].center_x_mm);
      RC_ASSERT(!plain[n].is_pressed() || plain[n].center_y_mm == scaled[n].center_y_mm);
    }
  });

  rc::prop("a taxel that cannot be read changes nothing in what the others say", [] {
    const auto recording = any_recording(3, 3, 60);
    const auto o = any_options();
    const std::size_t broken = static_cast<std::size_t>(test::whole(0, 8));
    Recording with_gap = recording;
    for (Array& array : with_gap) {
      array.cells[broken] = test::nan;
    }
    std::vector<double> noise(9, o.noise);
    noise[broken] = test::nan;  // known to be dead
    const auto told = features_of(Features(3, 3, o, noise), recording);
    const auto found = features_of(Features(3, 3, o), with_gap);
    for (std::size_t n = 0; n < told.size(); ++n) {
      same_vibration(told[n], found[n]);
      RC_ASSERT(told[n].sum == found[n].sum);
      RC_ASSERT(told[n].location != static_cast<Index>(broken));
    }
  });
}

TEST_CASE("taxel features: what is reported is what two passes over the window give",
          "[taxel_features]") {
  rc::prop("any recording", [] {
    const auto recording = any_recording(3, 4, 90);
    const TaxelFeatures<> features(3, 4, any_options());
    const auto samples = features_of(features, recording);
    const double floor = std::pow(2.5 * features.options().noise, 2);
    const Index window = features.options().window;
    for (std::size_t n = static_cast<std::size_t>(window) - 1; n < samples.size(); n += 3) {
      double largest = 0;
      for (std::size_t k = 0; k < 12; ++k) {
        largest = (std::max)(largest, variance_by_hand(recording, n, k, window));
      }
      const auto& sample = samples[n];
      if (largest > floor * (1 + 1e-9) && largest > 1e-9) {
        RC_ASSERT(sample.is_vibrating());
        const std::size_t at = static_cast<std::size_t>(sample.location);
        RC_ASSERT(variance_by_hand(recording, n, at, window) >= largest * (1 - 1e-9));
        RC_ASSERT(std::fabs(sample.deviation * sample.deviation - largest) <= 1e-9 * largest);
      } else if (largest < floor * (1 - 1e-9)) {
        RC_ASSERT(!sample.is_vibrating());
      }
    }
  });
}

TEST_CASE("taxel features: whatever is read, what is said is in range", "[taxel_features]") {
  rc::prop("odd readings at odd times", [] {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    constexpr double odd[] = {test::nan, infinite, -infinite, 0, -0.0, 1e308, -1e308, 5e-324, 4095};
    auto o = any_options();
    o.stuck_after = test::whole(0, 8);
    o.saturated_at = test::whole(0, 1) == 0 ? 1e9 : 4000;
    const TaxelFeatures features(2, 3, o);
    auto finger = features;
    double time = 0;
    for (int n = 0; n < 60; ++n) {
      Array array(2, 3);
      for (double& reading : array.cells) {
        const auto kind = test::whole(0, 24);
        reading = kind < 9 ? odd[kind] : test::uniform(0, 1000);
      }
      const auto kind = test::whole(0, 30);
      time = kind == 0 ? time - 100 : kind == 1 ? time + 50 : time + test::uniform(0.01, 2);
      const auto sample = finger(array, kind == 2 ? odd[test::whole(0, 2)] : time);
      RC_ASSERT(sample.location >= -1 && sample.location < 6);
      RC_ASSERT(sample.waves >= 0 && sample.waves <= o.window / 2);
      RC_ASSERT(sample.left_out >= 0 && sample.left_out <= 6);
      RC_ASSERT((sample.location >= 0) == (sample.status == TaxelStatus::vibrating));
      RC_ASSERT(is_finite(sample.frequency_hz));
      if (sample.is_pressed()) {  // sums of huge readings may overflow
        RC_ASSERT(sample.center_x_mm >= 0 && sample.center_x_mm <= 2 * o.pitch_mm * (1 + 1e-12));
        RC_ASSERT(sample.center_y_mm >= 0 && sample.center_y_mm <= o.pitch_mm * (1 + 1e-12));
      }
    }
  });
}

namespace {

/// Deviation of taxel 0 of two, without a line, by two passes in double over the last window.
double deviation_by_hand(const std::vector<double>& readings, std::size_t n) {
  const double length = static_cast<double>(n), middle = (length - 1) / 2;
  const double* const first = readings.data() + readings.size() - n;
  double mean = 0, tilt = 0, spread = 0, squares = 0;
  for (std::size_t u = 0; u < n; ++u) {
    mean += first[u] / length;
  }
  for (std::size_t u = 0; u < n; ++u) {
    tilt += (static_cast<double>(u) - middle) * (first[u] - mean);
    spread += (static_cast<double>(u) - middle) * (static_cast<double>(u) - middle);
  }
  for (std::size_t u = 0; u < n; ++u) {
    const double left = first[u] - mean - tilt / spread * (static_cast<double>(u) - middle);
    squares += left * left;
  }
  return std::sqrt(squares / length);
}

TaxelOptions options(Index window) {
  TaxelOptions o;
  o.window = window;
  o.sample_period_s = 1;
  o.longest_gap_s = 10;
  o.noise = 0;
  return o;
}

}  // namespace

TEMPLATE_TEST_CASE("taxel features: a small vibration on a large load that wanders, for long",
                   "[taxel_features]",
                   float,
                   double) {
  // 4000 counts with a random walk over hundreds of them and a vibration of 8, for 20000 samples.
  // The bound is that of one window at any length.
  using S = TestType;
  const Index window = GENERATE(8, 64);
  TaxelFeatures<S> finger(1, 1, options(window));
  std::mt19937 random(5);
  std::uniform_int_distribution<int> step(-8, 8);
  std::vector<double> readings;
  double level = 4000, worst = 0;
  for (int k = 0; k < 20000; ++k) {
    level += step(random);
    level = level > 4400 || level < 3600 ? 4000 : level;
    const double reading = level + (k % 4 < 2 ? 8 : -8);
    readings.push_back(reading);
    const auto sample = finger(Image<S>(1, 1, static_cast<S>(reading)), k);
    if (k % 7 == 0 && k > 100) {
      const double exact = deviation_by_hand(readings, static_cast<std::size_t>(window));
      worst = std::max(worst, std::fabs(static_cast<double>(sample.deviation) / exact - 1));
    }
  }
  INFO("worst relative error " << worst << ", window " << window);
  CHECK(worst < (std::is_same_v<S, float> ? 2e-6 : 1e-14));
}

TEST_CASE("taxel features: bursts of late samples keep the clock of the vibration",
          "[taxel_features]") {
  // a sensor that samples evenly, but whose samples arrive late by up to two periods, in order
  TaxelOptions o;
  o.window = 32;
  o.sample_period_s = 0.032;
  o.noise = 1;
  TaxelFeatures<> finger(1, 1, o);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> late(0, 0.064);
  double received = 0;
  Index right = 0, near = 0, all = 0;
  for (int k = 0; k < 2000; ++k) {
    const double taken = k * 0.032;
    received = std::max(received + 0.0002, taken + late(random));
    const double reading = 500 + 40 * std::sin(2 * 3.14159265358979 * 6.0 / (32 * 0.032) * taken);
    const auto sample = finger(Image<double>(1, 1, reading), received);
    REQUIRE(sample.status != TaxelStatus::refused);
    if (sample.is_vibrating()) {
      ++all;
      right += sample.waves == 6 ? 1 : 0;
      near += sample.waves >= 5 && sample.waves <= 7 ? 1 : 0;
    }
  }
  CHECK(all > 1900);
  CHECK(near == all);
  CHECK(right > all * 9 / 10);
}

TEST_CASE("taxel features: times of a long run, in float", "[taxel_features]") {
  // a float resolves 1e6 s to 0.06 s, two periods, so the time is always a double
  TaxelOptions o;
  o.noise = 1;
  const TaxelFeatures<float> features(1, 1, o);
  for (const double begin_s : {0.0, 1e6, 1.8e9}) {
    CAPTURE(begin_s);
    auto finger = features;
    for (int k = 0; k < 64; ++k) {
      const float reading = 500 + (k < 32      ? 0.1F * static_cast<float>(k % 3)
                                   : k % 4 < 2 ? 40
                                               : -40);
      const auto sample = finger(Image<float>(1, 1, reading), begin_s + k / 30.0);
      CHECK(sample.status == (k < 15   ? TaxelStatus::filling
                              : k < 32 ? TaxelStatus::quiet
                                       : TaxelStatus::vibrating));
      if (k == 63) {
        CHECK(sample.waves == 4);
        CHECK(sample.frequency_hz == Approx(7.5).epsilon(1e-5));
      }
    }
  }
}

TEMPLATE_TEST_CASE("taxel features: after large readings, ones that stay the same do not vibrate",
                   "[taxel_features]",
                   float,
                   double) {
  // the running sum of squares keeps roundoff of the large ones until it is taken anew
  using S = TestType;
  auto o = options(8);
  o.stuck_after = 0;
  const TaxelFeatures<S> features(2, 4, o);
  const int most = std::is_same_v<S, float> ? 100000 : 1000000000;
  std::mt19937 random(5);
  std::uniform_int_distribution<int> any(1, most);
  for (int k = 0; k < 100; ++k) {
    auto finger = features;
    Image<S> readings(2, 4);
    for (int sample = 0; sample < 30; ++sample) {
      for (S& reading : readings.cells) {
        reading = sample < 12 ? static_cast<S>(any(random)) : reading;
      }
      const auto seen = finger(readings, sample);
      CHECK((seen.status == TaxelStatus::quiet || sample < 19));
    }
  }
}
