// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/calibrate/foam.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "fingerpad/adapt/dual.hpp"
#include "support/catch.hpp"
#include "support/digest.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::Random;
using test::refusal;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double period_s = 1.0 / 30;
using Array = test::Image<double>;
using Options = TaxelOptions;

double gaussian(Random& random) {
  const double length = std::sqrt(-2 * std::log(1 - random.uniform()));
  return length * std::cos(2 * std::numbers::pi * random.uniform());
}

/// A recording whose sample k is reading(k, row, col, noise of deviation 1).
template <class Reading>
TaxelNoiseCalibration<> recorded(Index rows,
                                 Index cols,
                                 Index samples,
                                 std::uint64_t seed,
                                 const Reading& reading,
                                 const Options& options = {}) {
  TaxelNoiseCalibration calibration(rows, cols, options);
  Random random(seed);
  Array taxels(rows, cols);
  Index added = 0;
  for (Index k = 0; k < samples; ++k) {
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        taxels(i, j) = reading(k, i, j, gaussian(random));
      }
    }
    added += calibration.add(taxels, period_s * static_cast<double>(k)) ? 1 : 0;
  }
  CHECK(added == samples);
  return calibration;
}

/// Estimated noise of one taxel, in deviations of its true noise.
template <class Reading>
double found(Index windows, std::uint64_t seed, const Reading& reading, Index window = 16) {
  const Options options{.window = window};
  return recorded(
             1, 1, windows * window, seed,
             [&](Index k, Index, Index, double noise) { return reading(k, noise); }, options)
      .fit()
      .typical;
}

/// Relative standard error of a deviation from the median of this many windows. The median of n
/// samples has pi / (2 n) of the variance of one sample; a variance with f degrees of freedom has
/// the relative deviation sqrt(2 / f), and its root half of that.
double standard_error(Index windows, Index freedoms) {
  return 0.5 * std::sqrt(2 / static_cast<double>(freedoms)) *
         std::sqrt(std::numbers::pi / (2 * static_cast<double>(windows)));
}

/// Mean square about the line, by the textbook.
double mean_square(const std::vector<double>& y) {
  const double n = static_cast<double>(y.size());
  double mean = 0, product = 0, squares = 0;
  for (const double value : y) {
    mean += value / n;
  }
  for (std::size_t u = 0; u < y.size(); ++u) {
    const double from_middle = static_cast<double>(u) - (n - 1) / 2;
    product += from_middle * (y[u] - mean);
    squares += from_middle * from_middle;
  }
  const double slope = product / squares;
  double sum = 0;
  for (std::size_t u = 0; u < y.size(); ++u) {
    sum += square(y[u] - mean - slope * (static_cast<double>(u) - (n - 1) / 2));
  }
  return sum / n;
}

bool same_noise(const TaxelNoise<>& a, const TaxelNoise<>& b) {
  return a.deviations == b.deviations && a.typical == b.typical &&
         a.largest_factor == b.largest_factor && a.windows == b.windows &&
         a.centroid_deviation_mm == b.centroid_deviation_mm;
}

}  // namespace

TEST_CASE("taxel noise: gaussian noise is found within its sampling error", "[taxel_noise]") {
  const Index windows = 101;
  const int seeds = 400;
  const double bound = 2 * standard_error(windows, 14);
  int within = 0;
  double mean = 0, squares = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    const double ratio = found(windows, static_cast<std::uint64_t>(seed) + 1,
                               [](Index, double noise) { return 800 + 7 * noise; }) /
                         7;
    within += std::abs(ratio - 1) <= bound ? 1 : 0;
    mean += ratio / seeds;
    squares += (ratio - 1) * (ratio - 1) / seeds;
  }
  // as much as the calibration reports for nine taxels, each of which is one of these; 400 windows
  // determine it to 3.5 %, and the asymptotic formula of the median is accurate to 2 %
  const TaxelNoise nine = recorded(3, 3, 16 * windows, 1, [](Index, Index, Index, double noise) {
                            return 800 + 7 * noise;
                          }).fit();
  CHECK(3 * nine.typical_error / nine.typical == Approx(std::sqrt(squares)).epsilon(0.09));
  // 95 % of them, plus or minus twice sqrt(0.95 0.05 / 400)
  CHECK(within >= seeds * 0.93);
  CHECK(within <= seeds * 0.975);
  CHECK(std::abs(mean - 1) <= 0.004);
}

TEST_CASE("taxel noise: no window is too short or too long", "[taxel_noise]") {
  for (const Index window : {4, 5, 16, 64}) {
    CAPTURE(window);
    const Index windows = 20001 / window;
    const double ratio = found(
        windows, 3, [](Index, double noise) { return 800 + 0.5 * noise; }, window);
    const Index freedoms = window - 2;
    // and the assumed ratio of the median of a chi-square to its mean is accurate to 0.7 %
    CHECK(std::abs(ratio / 0.5 - 1) <= 3 * standard_error(windows, freedoms) + 0.007);
  }
}

TEST_CASE("taxel noise: a drift is not noise", "[taxel_noise]") {
  const double bound = 3 * standard_error(101, 14);
  for (const double drift : {-3.0, 0.4, 20.0}) {  // per sample
    CAPTURE(drift);
    const auto drifting = [&](Index k, double noise) {
      return 5000 + drift * static_cast<double>(k) + 7 * noise;
    };
    const auto resting = [](Index, double noise) { return 5000 + 7 * noise; };
    const double with = found(101, 5, drifting), without = found(101, 5, resting);
    CHECK(std::abs(with / 7 - 1) <= bound);
    CHECK(with == Approx(without).epsilon(1e-9));  // the same noise gives the same result
  }
  // a slow wave is nearly straight within a window
  const auto slow = [](Index k, double noise) {
    return 800 + 100 * std::sin(2 * std::numbers::pi * static_cast<double>(k) / 400) + 7 * noise;
  };
  CHECK(std::abs(found(101, 5, slow) / 7 - 1) <= bound);
}

TEST_CASE("taxel noise: touches in a third of the windows hardly count", "[taxel_noise]") {
  const auto in_touch = [](Index k) { return k / 16 % 3 == 1; };
  const auto touched = [&](Index k, double noise) {
    const bool is_held = in_touch(k) && k % 16 > 4 && k % 16 < 12;
    return 800 + (is_held ? 400 : 0) + 7 * noise;
  };
  const auto shaken = [&](Index k, double noise) {
    return 800 + (in_touch(k) ? 300 * (k % 2 == 0 ? 1 : -1) : 0) + 7 * noise;
  };
  // The median of all windows is then the 3/4 quantile of those at rest: 17.12 for a chi-square
  // with 14 degrees of freedom, whose median is 13.34.
  const double expected = std::sqrt(17.12 / 13.34);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    CHECK(found(201, seed, touched) / 7 == Approx(expected).epsilon(0.06));
    CHECK(found(201, seed, shaken) / 7 == Approx(expected).epsilon(0.06));
  }
  // steps from one load to another, each within a window, with rest between them
  const auto steps = [](Index k, double noise) {
    return 800 + 300 * std::floor(static_cast<double>(k + 8) / 160) + 7 * noise;
  };
  CHECK(std::abs(found(201, 4, steps) / 7 - 1) <= 0.12);
}

TEST_CASE("taxel noise: each taxel has its own, but none less than is typical", "[taxel_noise]") {
  // noise 2 in most taxels, 10 in one, none in a resting one
  const auto deviation = [](Index i, Index j) { return i == 1 && j == 2 ? 10.0 : 2.0; };
  const auto calibration = recorded(3, 4, 16 * 400, 9, [&](Index, Index i, Index j, double noise) {
    return i == 2 && j == 0 ? 3.0 : 500 + deviation(i, j) * noise;
  });
  const TaxelNoise noise = calibration.fit();
  CHECK(noise.windows == 400);
  CHECK(noise.deviations.size() == 12);
  CHECK(noise.typical == Approx(std::sqrt((100 + 10 * 4) / 11.0)).epsilon(0.04));
  const auto view = grid_of(noise.deviations, 3, 4);
  for (Index i = 0; i < 3; ++i) {
    for (Index j = 0; j < 4; ++j) {
      CAPTURE(i, j);
      if (i == 1 && j == 2) {
        CHECK(view(i, j) == Approx(10).epsilon(0.04));
      } else {
        CHECK(view(i, j) == noise.typical);
      }
    }
  }
  // it is accepted by the features
  CHECK(refusal([&] { TaxelFeatures<>(3, 4, {}, noise.deviations); }) == "accepted");
}

TEST_CASE("taxel noise: the most that a window spread", "[taxel_noise]") {
  const Index rows = 2, cols = 3, windows = 30, window = 16;
  std::vector<std::vector<double>> of(static_cast<std::size_t>(rows * cols));
  const auto reading = [&](Index, Index i, Index j, double noise) {
    const double now = 700 + static_cast<double>(1 + j) * noise;
    of[static_cast<std::size_t>(i * cols + j)].push_back(now);
    return now;
  };
  const TaxelNoise noise = recorded(rows, cols, windows * window, 21, reading).fit();
  double largest = 0;
  for (std::size_t k = 0; k < of.size(); ++k) {
    for (Index w = 0; w < windows; ++w) {
      const auto begin = of[k].begin() + w * window;
      const std::vector<double> one(begin, begin + window);
      largest = (std::max)(largest, std::sqrt(mean_square(one)) / noise.deviations[k]);
    }
  }
  CHECK(noise.largest_factor == Approx(largest).epsilon(1e-9));
  CHECK(noise.largest_factor > 1);
  CHECK(noise.largest_factor < 3);

  // Slightly above it no window of the recording vibrates at its end; below, one does.
  for (const double share : {1.0001, 0.9999}) {
    Options options;
    options.noise_factor = share * noise.largest_factor;
    TaxelFeatures<> features(rows, cols, options, noise.deviations);
    Array taxels(rows, cols);
    int vibrating = 0;
    for (Index k = 0; k < windows * window; ++k) {
      for (std::size_t i = 0; i < of.size(); ++i) {
        taxels(static_cast<Index>(i) / cols, static_cast<Index>(i) % cols) =
            of[i][static_cast<std::size_t>(k)];
      }
      const auto sample = features(taxels, period_s * static_cast<double>(k));
      vibrating += (k + 1) % window == 0 && sample.is_vibrating() ? 1 : 0;
    }
    CHECK(vibrating == (share > 1 ? 0 : 1));
  }
}

TEST_CASE("taxel noise: what shakes is no noise", "[taxel_noise]") {
  // taxels have the share p of their variance in common, with either sign, at any frequency
  for (const double period : {2.3, 5.0, 0.0}) {
    for (const double p : {0.0, 0.3, 0.7, 0.95}) {
      CAPTURE(period, p);
      Random random(5);
      double common = 0;
      const auto reading = [&](Index k, Index i, Index j, double noise) {
        if (i == 0 && j == 0) {
          common = period > 0 ? std::sqrt(2) * std::sin(2 * std::numbers::pi * double(k) / period)
                              : gaussian(random);
        }
        return 800 +
               7 * (std::sqrt(p) * ((i + j) % 2 == 0 ? 1 : -1) * common + std::sqrt(1 - p) * noise);
      };
      const TaxelNoise noise = recorded(4, 5, 16 * 40, 3, reading).fit();
      CHECK(noise.shared == Approx(p).margin(p > 0 ? 0.1 : 0.16));
      CHECK(noise.ok() == (p < 0.5));
      CHECK((noise.ok() || std::string(noise.cause).find("shakes") != std::string::npos));
    }
  }
  const auto shaken = [](Index k, Index, Index, double noise) {
    return 800 + 50 * std::sin(2 * double(k)) + noise;
  };
  CHECK_FALSE(recorded(1, 3, 16 * 8, 1, shaken).fit().ok());
  CHECK(std::isnan(recorded(1, 2, 16 * 8, 1, shaken).fit().shared));  // two cannot tell
  // an object that shakes in a third of the windows does not count
  CHECK(recorded(4, 5, 16 * 30, 1,
                 [&](Index k, Index i, Index j, double noise) {
                   return k % 48 < 16 ? shaken(k, i, j, noise) : 800 + noise;
                 })
            .fit()
            .ok());
}

TEST_CASE("taxel noise: how still the centroid is", "[taxel_noise]") {
  // A load f_k at x_k, with noise s of each taxel: the centroid with sum F has the variance s^2 sum
  // (x_k - x)^2 / F^2 along x.
  const Index rows = 5, cols = 4;
  const auto load = [](Index i, Index j) {
    return 200 + 100 * static_cast<double>(i) - 40 * static_cast<double>(j);
  };
  const double deviation = 3, pitch_mm = 2.5;
  double sum = 0, x = 0, y = 0, xx = 0, yy = 0;
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      sum += load(i, j);
      x += load(i, j) * pitch_mm * static_cast<double>(j);
      y += load(i, j) * pitch_mm * static_cast<double>(i);
    }
  }
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      xx += square(pitch_mm * static_cast<double>(j) - x / sum);
      yy += square(pitch_mm * static_cast<double>(i) - y / sum);
    }
  }
  const double expected_mm = deviation / sum * std::sqrt((xx + yy) / 2);
  const auto pressed = [&](Index, Index i, Index j, double noise) {
    return load(i, j) + deviation * noise;
  };
  const Options options{.pitch_mm = pitch_mm};
  const auto noise = recorded(rows, cols, 16 * 400, 31, pressed, options).fit();
  // Both axes are judged together: with some 28 degrees of freedom the median is nearer to the mean
  // than assumed, by 2.4 % of the variance.
  CHECK(std::abs(noise.centroid_deviation_mm / expected_mm - 1) <=
        3 * standard_error(400, 28) + 0.013);

  // pressed in some windows only: these are judged
  const auto sometimes = [&](Index k, Index i, Index j, double one) {
    return k / 16 % 4 == 3 ? -1 - std::abs(one) : pressed(k, i, j, one);
  };
  const auto seldom = recorded(rows, cols, 16 * 400, 31, sometimes, options).fit();
  CHECK(seldom.windows == 400);
  CHECK(std::abs(seldom.centroid_deviation_mm / expected_mm - 1) <=
        3 * standard_error(300, 28) + 0.013);
  // released for one sample of each window, or never pressed: no result
  for (const Index every : {16, 1}) {
    const auto let_go = [&](Index k, Index i, Index j, double one) {
      return k % every == every / 2 ? -1 - std::abs(one) : pressed(k, i, j, one);
    };
    CHECK(std::isnan(recorded(rows, cols, 64, 31, let_go, options).fit().centroid_deviation_mm));
  }
}

TEST_CASE("taxel noise: taxels that are bad for a while or always", "[taxel_noise]") {
  const auto good = [](Index, Index, Index, double noise) { return 800 + 7 * noise; };
  const auto reference = recorded(2, 2, 16 * 99, 41, good).fit();
  for (const double bad : {none, infinity, -infinity, 4095.0, 1e300}) {
    CAPTURE(bad);
    const Options options{.saturated_at = 4095};
    // always: the taxel is dead, and the others are unchanged
    const auto always = recorded(
                            2, 2, 16 * 99, 41,
                            [&](Index k, Index i, Index j, double noise) {
                              return i == 0 && j == 1 ? bad : good(k, i, j, noise);
                            },
                            options)
                            .fit();
    CHECK(std::isnan(always.deviations[1]));
    CHECK(always.windows == 99);
    for (const std::size_t k : {0U, 2U, 3U}) {
      CHECK(always.deviations[k] == Approx(reference.deviations[k]).epsilon(0.06));
    }
    // in one sample of every second window: these windows are not judged
    for (const Index at : {0, 5, 15}) {
      CAPTURE(at);
      const auto seldom =
          recorded(
              2, 2, 16 * 99, 41,
              [&](Index k, Index i, Index j, double noise) {
                const bool is_bad = k % 32 == at && i == 0 && j == 1;
                return is_bad ? bad : i == 0 && j == 1 ? 800 + 20 * noise : good(k, i, j, noise);
              },
              options)
              .fit();
      CHECK(seldom.deviations[1] == Approx(20).epsilon(4 * standard_error(49, 14)));
      CHECK(seldom.largest_factor < 2.5);
      CHECK(seldom.typical == Approx(std::sqrt((400 + 3 * 49) / 4.0)).epsilon(0.1));
    }
    // in every window: the taxel is never judged
    const auto often = recorded(
                           2, 2, 16 * 99, 41,
                           [&](Index k, Index i, Index j, double noise) {
                             return k % 16 == 7 && i == 0 && j == 1 ? bad : good(k, i, j, noise);
                           },
                           options)
                           .fit();
    CHECK(std::isnan(often.deviations[1]));
  }
  // just below saturation counts
  const auto high =
      recorded(1, 1, 64, 1,
               [](Index k, Index, Index, double) { return k % 2 == 0 ? 4094.0 : 4093.0; },
               {.saturated_at = 4095})
          .fit();
  CHECK(high.deviations[0] > 0.4);
}

TEST_CASE("taxel noise: a clock that jumps begins a new window", "[taxel_noise]") {
  const auto run = [](Index samples, Index between_jumps, double jump_s) {
    TaxelNoiseCalibration calibration(1, 2);
    Random random(61);
    double time_s = 5;
    for (Index k = 0; k < samples; ++k) {
      const bool jumps = k > 0 && k % between_jumps == 0;
      time_s += jumps ? jump_s : period_s;
      // after a jump the load differs
      const double load = 1000 * static_cast<double>(1 + k / between_jumps);
      Array taxels(1, 2);
      taxels(0, 0) = load + 7 * gaussian(random);
      taxels(0, 1) = load + 7 * gaussian(random);
      CHECK(calibration.add(taxels, time_s));
    }
    return calibration;
  };
  for (const double jump_s : {2.1, 1000.0, -1000.0, -0.6}) {
    CAPTURE(jump_s);
    CHECK(refusal([&] { (void)run(800, 15, jump_s).fit(); }) ==
          "TaxelNoiseCalibration: windows = 0, must be >= 4");
    const auto whole = run(16 * 100, 16, jump_s).fit();
    CHECK(whole.windows == 100);
    CHECK(whole.typical == Approx(7).epsilon(0.1));
    CHECK(whole.largest_factor < 2.5);
    const auto cut = run(16 * 100, 25, jump_s).fit();  // one window of each 25 samples
    CHECK(cut.windows == 64);
    CHECK(cut.typical == Approx(7).epsilon(0.1));
    CHECK(cut.largest_factor < 2.5);
  }
  // smaller gaps do not restart
  CHECK(run(160, 10, 0.25).fit().windows == 10);
  CHECK(run(160, 10, 1.9).fit().windows == 10);
}

TEST_CASE("taxel noise: what is refused changes nothing", "[taxel_noise]") {
  const Index samples = 16 * 6;
  TaxelNoiseCalibration plain(2, 3), disturbed(2, 3);
  Random random(71);
  for (Index k = 0; k < samples; ++k) {
    Array taxels(2, 3), wild(2, 3, 1e6), rotated(3, 2, 1e6), empty(0, 0);
    for (auto& reading : taxels.cells) {
      reading = 800 + 7 * gaussian(random);
    }
    const double time_s = period_s * static_cast<double>(k);
    CHECK(plain.add(taxels, time_s));
    CHECK(disturbed.add(taxels, time_s));
    CHECK_FALSE(disturbed.add(rotated, time_s + 0.01));
    CHECK_FALSE(disturbed.add(empty, time_s + 0.01));
    CHECK_FALSE(disturbed.add(wild, time_s));
    CHECK_FALSE(disturbed.add(wild, time_s - 0.01));
    CHECK_FALSE(disturbed.add(wild, none));
    CHECK_FALSE(disturbed.add(wild, infinity));
  }
  CHECK(same_noise(plain.fit(), disturbed.fit()));
}

TEST_CASE("taxel noise: recordings that do not tell are refused", "[taxel_noise]") {
  const auto noisy = [](Index, Index, Index, double noise) { return 800 + noise; };
  const auto said = [](const auto& calibration) {
    return refusal([&] { (void)(void)calibration.fit(); });
  };
  CHECK(said(TaxelNoiseCalibration(2, 2)) == "TaxelNoiseCalibration: windows = 0, must be >= 4");
  CHECK(said(recorded(2, 2, 63, 1, noisy)) == "TaxelNoiseCalibration: windows = 3, must be >= 4");
  CHECK(said(recorded(2, 2, 64, 1, noisy)) == "accepted");
  CHECK(recorded(2, 2, 16 * 8 + 7, 1, noisy).fit().windows == 8);
  const std::string unchanged =
      "TaxelNoiseCalibration: taxels whose readings change = 0, must be >= 1";
  CHECK(said(recorded(2, 2, 640, 1, [](Index, Index, Index, double) { return 0.1; })) == unchanged);
  CHECK(said(recorded(2, 2, 640, 1, [](Index, Index, Index, double) { return none; })) ==
        unchanged);
  CHECK(said(recorded(2, 2, 640, 1, [](Index, Index, Index, double) { return 4095.0; },
                      {.saturated_at = 4095})) == unchanged);
  // and invalid options
  CHECK(refusal([] { TaxelNoiseCalibration<>(0, 3); }) ==
        "TaxelFeatures: rows = 0, must be in [1, 1000000]");
  CHECK(refusal([] { TaxelNoiseCalibration<>(3, -1); }) ==
        "TaxelFeatures: cols = -1, must be in [1, 1000000]");
  CHECK(refusal([] { TaxelNoiseCalibration<>(3, 3, {.window = 3}); }) ==
        "TaxelOptions: window = 3, must be in [4, 4096]");
  CHECK(test::begins_with(refusal([] { TaxelNoiseCalibration<>(3, 3, {.pitch_mm = none}); }),
                          "TaxelOptions: pitch_mm = "));
}

TEST_CASE("taxel noise: what the options say of noise does not matter", "[taxel_noise]") {
  const auto noisy = [](Index, Index, Index, double noise) { return 800 + 7 * noise; };
  const auto plain = recorded(2, 2, 640, 5, noisy).fit();
  for (const double factor : {0.0, 1000.0}) {
    CHECK(same_noise(plain,
                     recorded(2, 2, 640, 5, noisy, {.noise = 100, .noise_factor = factor}).fit()));
  }
  CHECK(same_noise(plain, recorded(2, 2, 640, 5, noisy).fit()));
}

TEST_CASE("taxel noise: whole counts of an integer array", "[taxel_noise]") {
  for (const double deviation : {1.0, 3.0, 6.0}) {
    CAPTURE(deviation);
    TaxelNoiseCalibration calibration(6, 6);
    Random random(81);
    test::Image<std::uint16_t> counts(6, 6);
    for (Index k = 0; k < 16 * 200; ++k) {
      for (auto& reading : counts.cells) {
        reading = static_cast<std::uint16_t>(std::lround(900.3 + deviation * gaussian(random)));
      }
      CHECK(calibration.add(counts, period_s * static_cast<double>(k)));
    }
    // rounding adds 1/12 to the variance
    const double expected = std::sqrt(deviation * deviation + 1.0 / 12);
    CHECK(calibration.fit().typical == Approx(expected).epsilon(0.015));
  }
}

TEST_CASE("taxel noise: a centroid that cannot move has no deviation, also in derivatives",
          "[taxel_noise]") {
  // of a single taxel; the root of 0 has an infinite slope
  using Dual = decltype(seeded(std::array{1.0}))::value_type;
  const Dual gain = seeded(std::array{1.0})[0];
  TaxelNoiseCalibration<Dual> calibration(1, 1);
  Random random(3);
  for (int k = 0; k < 64; ++k) {
    const test::Image<Dual> reading(1, 1, Dual(gain * (800 + 7 * gaussian(random))));
    REQUIRE(calibration.add(reading, period_s * k));
  }
  const TaxelNoise<Dual> noise = calibration.fit();
  CHECK(noise.typical.slopes[0] == Approx(noise.typical.value).epsilon(1e-9));
  CHECK(noise.centroid_deviation_mm.value == 0);
  CHECK(noise.centroid_deviation_mm.slopes[0] == 0);
}

TEST_CASE("unchanged: noise of an array that is touched for a while", "[unchanged]") {
  const auto fit = recorded(4, 5, 600, 3, [](Index k, Index i, Index j, double noise) {
                     const double load =
                         k > 200 && k < 260 ? 400 + 9 * std::sin(0.7 * double(k)) : 5;
                     return i == 3 && j == 3 ? 77 : load + (3 + 0.2 * double(i + j)) * noise;
                   }).fit();
  test::Digest d;
  for (const double deviation : fit.deviations) {
    d.add(deviation);
  }
  d.all(fit.typical, fit.typical_error, fit.largest_factor, fit.centroid_deviation_mm, fit.shared,
        fit.windows, fit.ok());
  CHECK(d.sum() == test::same(1095.968));
}
