// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Arrays on which running sums lose digits, and long recordings.
#include <cmath>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

#include "fingerpad/foam/taxels.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Image;

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

TEMPLATE_TEST_CASE("taxel features: a huge reading is forgotten with its window",
                   "[taxel_features]",
                   float,
                   double) {
  using S = TestType;
  auto o = options(16);
  o.noise = 1;
  TaxelFeatures<S> finger(4, 4, o);
  Index false_alarms_late = 0;
  for (int k = 0; k < 200; ++k) {
    Image<S> taxels(4, 4, S(100));
    taxels(1, 1) = k == 50 ? S(9e8) : S(100);
    const auto sample = finger(taxels, k);
    if (k >= 50 && k < 66) {
      CHECK(sample.location == 5);
    }
    false_alarms_late += k >= 50 + 16 && sample.is_vibrating() ? 1 : 0;
  }
  CHECK(false_alarms_late == 0);
}

TEMPLATE_TEST_CASE("taxel features: readings at the ends of what a number holds",
                   "[taxel_features]",
                   float,
                   double) {
  using S = TestType;
  using Limits = std::numeric_limits<S>;
  const TaxelFeatures<S> features(2, 2, options(8));
  for (const S extreme : {Limits::max(), Limits::lowest(), Limits::denorm_min(), Limits::min()}) {
    CAPTURE(extreme);
    auto finger = features;
    for (int k = 0; k < 60; ++k) {
      Image<S> taxels(2, 2, S(10));
      taxels(0, 1) = k > 20 && k < 40 && k % 3 == 0 ? extreme : S(10);
      taxels(1, 1) = k % 4 < 2 ? S(20) : S(10);
      const auto sample = finger(taxels, k);
      CHECK(sample.waves >= 0);
      CHECK(sample.waves <= 4);
      CHECK_FALSE(std::isnan(sample.frequency_hz));
      if (k >= 8 && (k <= 20 || k >= 40 + 16)) {
        CHECK(sample.location == 3);
        CHECK(sample.waves == 2);
      }
    }
  }
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
