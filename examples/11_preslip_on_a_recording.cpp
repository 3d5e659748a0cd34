// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Detects when a held object begins to slip. Foam fingers detect it by vibrations, without a
// coefficient of friction. Prints the first alarm of each rule and the state of the fingers then.
// Usage: 11_preslip_on_a_recording [TAXELS.csv [FINGERS [QUIET_UNTIL_S]]]
// The fingers (default 2) share the rows of the table evenly, one below the other. The
// noise is estimated from the part until QUIET_UNTIL_S (default 3), in which nothing may be
// touched.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "fingerpad/calibrate/foam.hpp"
#include "fingerpad/pipeline/foam_hand.hpp"

#ifndef FINGERPAD_EXAMPLE_RECORDING
#define FINGERPAD_EXAMPLE_RECORDING "examples/data/press"
#endif

using namespace fingerpad;

struct Sample {
  double time_s;
  std::vector<double> readings;  // row by row
};

struct Recording {
  Index rows = 0, cols = 0;
  std::vector<Sample> samples;
};

/// Reads the columns frame,time_s,r0_c0,r0_c1,...; all are required, in this order.
Recording read(const char* file) {
  std::ifstream stream(file);
  std::string line, cell;
  Recording recording;
  std::getline(stream, line);
  const auto last = line.rfind(",r");  // of the last taxel
  int row = 0, col = 0;
  if (last == std::string::npos || std::sscanf(line.c_str() + last, ",r%d_c%d", &row, &col) != 2) {
    throw std::runtime_error(std::string(file) + " is not a table of taxels");
  }
  recording.rows = row + 1;
  recording.cols = col + 1;
  while (std::getline(stream, line)) {
    std::istringstream cells(line);
    Sample sample{};
    for (int k = 0; std::getline(cells, cell, ','); ++k) {
      const double number = cell.empty() ? std::nan("") : std::strtod(cell.c_str(), nullptr);
      if (k == 1) {
        sample.time_s = number;
      } else if (k > 1) {
        sample.readings.push_back(number);
      }
    }
    sample.readings.resize(static_cast<std::size_t>(recording.rows * recording.cols), std::nan(""));
    recording.samples.push_back(sample);
  }
  return recording;
}

void print_alarm(PreslipRule rule,
                 double time_s,
                 std::span<const FingerSample<>> fingers,
                 Index cols) {
  std::printf("%s: first alarm at %.3f s\n", name_of(rule), time_s);
  for (const FingerSample<>& f : fingers) {
    std::printf("  centroid (%.2f, %.2f) mm, ", f.center_x_mm, f.center_y_mm);
    if (f.is_vibrating()) {
      std::printf("taxel at row %td, col %td vibrates: %td waves, %.2f Hz\n", f.location / cols,
                  f.location % cols, f.waves, f.frequency_hz);
    } else {
      std::printf("%s\n", name_of(f.status));
    }
  }
}

/// Returns whether both rules raise an alarm.
bool look(const Recording& recording, int fingers, double quiet_until_s) {
  const Index rows = recording.rows / fingers, cols = recording.cols;
  const auto finger_of = [&](const Sample& sample, int f) {  // no copy
    return StridedView<const double>(sample.readings.data() + f * rows * cols, rows, cols, cols);
  };

  // Once: the fingers, each with its noise.
  std::vector<TaxelFeatures<>> features;
  for (int f = 0; f < fingers; ++f) {
    TaxelNoiseCalibration calibration(rows, cols);
    for (const Sample& sample : recording.samples) {
      if (sample.time_s <= quiet_until_s) {
        calibration.add(finger_of(sample, f), sample.time_s);
      }
    }
    features.emplace_back(rows, cols, TaxelOptions(), calibration.fit().deviations);
  }
  // One rule is enough for a hand; here both are compared.
  FoamHand<> hand(features);
  Preslip<> optimise(fingers, {.rule = PreslipRule::grasp_optimise});

  bool in_hold = false, in_lift = false;
  for (const Sample& sample : recording.samples) {  // each as it is received
    std::vector<StridedView<const double>> readings;
    for (int f = 0; f < fingers; ++f) {
      readings.push_back(finger_of(sample, f));
    }
    const PreslipStatus lift = hand(readings, sample.time_s);
    if (lift == PreslipStatus::preslip && !in_lift) {
      print_alarm(PreslipRule::grasp_lift, sample.time_s, hand.fingers(), cols);
      in_lift = true;
    }
    if (optimise(hand.fingers()) == PreslipStatus::preslip && !in_hold) {
      print_alarm(PreslipRule::grasp_optimise, sample.time_s, hand.fingers(), cols);
      in_hold = true;
    }
  }
  if (!in_lift || !in_hold) {
    const PreslipRule silent = in_lift ? PreslipRule::grasp_optimise : PreslipRule::grasp_lift;
    std::printf("%s: no alarm in %zu samples\n", name_of(silent), recording.samples.size());
  }
  return in_lift && in_hold;
}

int main(int argc, char** argv) {
  try {
    const Recording recording =
        read(argc > 1 ? argv[1] : FINGERPAD_EXAMPLE_RECORDING "/../foam/taxels.csv");
    const int fingers = argc > 2 ? std::atoi(argv[2]) : 2;
    if (fingers < 1 || fingers > 100 || recording.rows % fingers != 0) {
      throw std::runtime_error("the rows of the array must be divisible among the fingers");
    }
    const double quiet_until_s = argc > 3 ? std::atof(argv[3]) : 3;
    const bool found = look(recording, fingers, quiet_until_s);
    return found || argc > 1 ? 0 : 1;  // the bundled recording must raise both alarms
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
