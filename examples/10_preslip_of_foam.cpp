// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Warns before a held object slips: two foam fingers feel its vibration, and no coefficient of
// friction is needed. The fingers' noise is measured while they hold the object still.
#include <array>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "fingerpad/calibrate/foam.hpp"
#include "fingerpad/pipeline/foam_hand.hpp"

using namespace fingerpad;

constexpr Index high = 8, wide = 4;  // of a finger
constexpr double quiet_until_s = 3;

struct Sample {
  double time_s = 0;
  std::vector<double> readings;  // of both fingers, row by row
  StridedView<const double> finger(Index which) const {
    return {readings.data() + which * high * wide, high, wide, wide};
  }
};

/// Reads the columns frame,time_s,r0_c0,r0_c1,...
std::vector<Sample> read(const std::string& file) {
  std::ifstream stream(file);
  std::string line, cell;
  std::getline(stream, line);
  std::vector<Sample> samples;
  while (std::getline(stream, line)) {
    std::istringstream cells(line);
    Sample sample;
    std::getline(cells, cell, ',');
    std::getline(cells, cell, ',');
    sample.time_s = std::stod(cell);
    while (std::getline(cells, cell, ',')) {
      sample.readings.push_back(cell.empty() ? not_a_number<double>() : std::stod(cell));
    }
    sample.readings.resize(2 * high * wide, not_a_number<double>());
    samples.push_back(sample);
  }
  return samples;
}

int main() {
  const auto samples = read(FINGERPAD_EXAMPLE_RECORDING "/../foam/taxels.csv");

  // Once: the fingers, each with its noise.
  std::vector<TaxelFeatures<>> fingers;
  for (Index f = 0; f < 2; ++f) {
    TaxelNoiseCalibration noise(high, wide);
    for (const Sample& sample : samples) {
      if (sample.time_s <= quiet_until_s) {
        noise.add(sample.finger(f), sample.time_s);
      }
    }
    fingers.emplace_back(high, wide, TaxelOptions(), noise.fit().deviations);
  }
  FoamHand<> hand(fingers);

  // Every sample, as it is received.
  for (const Sample& sample : samples) {
    const std::array readings{sample.finger(0), sample.finger(1)};
    if (hand(readings, sample.time_s) == PreslipStatus::preslip) {
      std::printf("about to slip at %.2f s:\n", sample.time_s);
      for (const FingerSample<>& finger : hand.fingers()) {
        std::printf("  centroid (%.2f, %.2f) mm, %.2f Hz\n", finger.center_x_mm, finger.center_y_mm,
                    finger.frequency_hz);
      }
      return sample.time_s > quiet_until_s ? 0 : 1;
    }
  }
  std::printf("no warning in %zu samples\n", samples.size());
  return 1;
}
