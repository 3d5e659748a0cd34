// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A synthetic recording of two foam fingers that hold an object. The grip is loosened from 3 s on.
// From 6.5 s on the object creeps, first where the pressure is lowest; creeping taxels vibrate.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <string>

namespace foam {

constexpr int fingers = 2;
constexpr int rows = 8;  // of each finger; the fingers lie one below the other in the table
constexpr int cols = 4;
constexpr int samples = 300;
constexpr double rate_hz = 30;
constexpr double loosened_from_s = 3;
constexpr double creeps_from_s = 6.5;
constexpr double slips_from_s = 9.5;  // from here on nothing holds the object
constexpr double noise = 5;           // counts
constexpr double peak = 1800;         // counts, with the firm grip

/// Standard normal noise; the same numbers on every platform.
class Normal {
 public:
  double operator()() {
    double sum = -6;
    for (int k = 0; k < 12; ++k) {
      sum += uniform();
    }
    return sum;
  }
  double uniform() { return static_cast<double>(generator_()) / 4294967296.0; }

 private:
  std::mt19937 generator_{2007};
};

/// Pressure on a taxel as a share of the peak; it differs between the two fingers.
inline double pressure(int finger, int row, int col) {
  const double from_row = row - (finger == 0 ? 3.2 : 4.1);
  const double from_col = col - (finger == 0 ? 1.4 : 1.7);
  return std::exp(-from_row * from_row / 9 - from_col * from_col / 3);
}

/// When a taxel begins to vibrate: the least pressed ones first. Those pressed by less than `least`
/// never vibrate.
inline double starts_s(double pressed) {
  constexpr double least = 0.1;
  return pressed < least
             ? 1e9
             : creeps_from_s + (slips_from_s - creeps_from_s) * (pressed - least) / (1 - least);
}

/// Reading in counts, without noise.
inline double reading(double pressed, double time_s, double turn, double strength) {
  const double grip = 1 - 0.06 * (std::max)(0.0, time_s - loosened_from_s);
  const double since_s = (std::max)(0.0, time_s - creeps_from_s);
  const double waves = 4 * since_s + 0.25 * since_s * since_s;  // from 4 Hz up to 6.5 Hz
  const double reach = std::clamp((time_s - starts_s(pressed)) / 0.4, 0.0, 1.0);
  return peak * grip * pressed +
         60 * strength * reach * std::sin(2 * std::numbers::pi * (waves + turn));
}

/// The content of taxels.csv.
inline std::string recording() {
  Normal normal;
  double turns[fingers * rows][cols];
  double strengths[fingers * rows][cols];
  std::string text = "frame,time_s";
  char cell[48];
  for (int i = 0; i < fingers * rows; ++i) {
    for (int j = 0; j < cols; ++j) {
      std::snprintf(cell, sizeof cell, ",r%d_c%d", i, j);
      text += cell;
      turns[i][j] = normal.uniform();
      strengths[i][j] = 0.6 + 0.8 * normal.uniform();
    }
  }
  text += '\n';
  for (int k = 0; k < samples; ++k) {
    const double time_s = k / rate_hz;
    std::snprintf(cell, sizeof cell, "%d,%.4f", k, time_s + 0.001 * normal.uniform());
    text += cell;
    for (int i = 0; i < fingers * rows; ++i) {
      for (int j = 0; j < cols; ++j) {
        const double pressed = pressure(i / rows, i % rows, j);
        const double counts =
            reading(pressed, time_s, turns[i][j], strengths[i][j]) + noise * normal();
        std::snprintf(cell, sizeof cell, ",%d",
                      static_cast<int>(std::lround(std::clamp(counts, 0.0, 4095.0))));
        text += cell;
      }
    }
    text += '\n';
  }
  return text;
}

}  // namespace foam
