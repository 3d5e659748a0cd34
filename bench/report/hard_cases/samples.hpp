// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Running sums: windows over an image and over the samples of a taxel.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fingerpad/depth/depth.hpp"
#include "fingerpad/foam/taxels.hpp"
#include "row.hpp"
#include "support/pad.hpp"

namespace hard {

inline Row long_image() {
  return row("window means", "400 dim rows below 40 bright ones (1000 : 1), window of 5; relative",
             "exact sums of whole numbers of 2^-38", []<class S>(S) {
               Forms f;
               const fingerpad::Index rows = 440, cols = 9;
               test::Frame<S> frame(rows, cols);
               for (fingerpad::Index i = 0; i < rows; ++i) {
                 for (fingerpad::Index j = 0; j < cols; ++j) {
                   const double wave = 1 + 0.3 * std::sin(static_cast<double>(3 * i + 5 * j));
                   frame.red(i, j) = S(i < 40 ? 250 * wave / 1.3 : 0.25 * wave);
                   frame.green(i, j) = S(100 * wave);
                 }
               }
               const auto load = [&](fingerpad::Index row, std::uint64_t* red, std::uint64_t* green,
                                     std::uint32_t* counts) {
                 for (fingerpad::Index j = 0; j < cols; ++j) {
                   red[j] = static_cast<std::uint64_t>(frame.red(row, j) * S(0x1p38));
                   green[j] = static_cast<std::uint64_t>(frame.green(row, j) * S(0x1p38));
                   counts[j] = 1;
                 }
               };
               const auto sum_of = [&]<class T>(fingerpad::Index row, T sum) {
                 for (fingerpad::Index j = 2; j <= 6; ++j) {
                   sum = sum + T(frame.red(row, j));
                 }
                 return sum;
               };
               fingerpad::detail::WindowMeans<std::uint64_t, S> sums(rows, cols, {5, 7});
               sums.start(load);
               std::vector<S> red(64), green(64), outer(64);
               S running = S(0);
               for (fingerpad::Index i = 0; i < 5; ++i) {
                 running = sum_of(i, running);
               }
               for (fingerpad::Index i = 0; i + 2 < rows; ++i) {
                 sums.advance(load, red.data(), green.data(), outer.data());
                 if (i > 2) {
                   running = sum_of(i + 2, running) - sum_of(i - 3, S(0));
                 }
                 if (i >= 50) {
                   Digits50 exact(0);
                   for (fingerpad::Index p = i - 2; p <= i + 2; ++p) {
                     exact = sum_of(p, exact);
                   }
                   exact /= 25;
                   f.naive.add_relative(running / S(25), exact);
                   f.stable.add_relative(red[4] / S(0x1p38), exact);
                 }
               }
               return f;
             });
}

inline Row small_vibration() {
  return row("taxel features",
             "vibration of 8 on 4000 counts that wander, 20000 samples, window of 8; of its rms",
             "sums about a recent reading, made anew within each window", []<class S>(S) {
               Forms f;
               fingerpad::TaxelOptions options;
               options.window = 8;
               options.sample_period_s = 1;
               options.longest_gap_s = 10;
               options.noise = 0;
               fingerpad::TaxelFeatures<S> features(1, 1, options);
               test::Random random(5);
               std::vector<S> readings;
               S sum = S(0), squares = S(0);
               double level = 4000;
               for (int k = 0; k < 20000; ++k) {
                 level += 8 * random.uniform(-1, 1);
                 level = level > 4400 || level < 3600 ? 4000 : level;
                 const S reading = S(level + (k % 4 < 2 ? 8 : -8));
                 readings.push_back(reading);
                 sum += reading;
                 squares += reading * reading;
                 if (k >= 8) {
                   const S gone = readings[readings.size() - 9];
                   sum -= gone;
                   squares -= gone * gone;
                 }
                 const auto sample = features(test::Image<S>(1, 1, reading), k);
                 if (k % 7 == 0 && k > 100) {
                   Digits50 mean(0), tilt(0), left(0);
                   const std::size_t first = readings.size() - 8;
                   for (int u = 0; u < 8; ++u) {
                     const Digits50 one(readings[first + static_cast<std::size_t>(u)]);
                     mean += one / 8;
                     tilt += one * (u - 3.5);
                     left += one * one / 8;
                   }
                   // the sum of (u - 3.5)^2 is 42
                   const Digits50 exact = sqrt(Digits50(left - mean * mean - tilt * tilt / 336));
                   S of_moment = S(0);  // recomputed in place of a running sum
                   for (int u = 0; u < 8; ++u) {
                     of_moment += readings[first + static_cast<std::size_t>(u)] * S(u - 3.5);
                   }
                   const S of_sums = squares / S(8) - (sum / S(8)) * (sum / S(8)) -
                                     of_moment * of_moment / S(336);
                   f.naive.add_relative(std::sqrt(of_sums), exact);
                   f.stable.add_relative(sample.deviation, exact);
                 }
               }
               return f;
             });
}

}  // namespace hard
