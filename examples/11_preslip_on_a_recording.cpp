// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// When does a held object begin to slip? Foam fingers tell by vibrations, without a coefficient of
// friction. Prints when each rule first alarms, and what the fingers felt then.
//   11_preslip_on_a_recording [TAXELS.csv [FINGERS]]
// The fingers (1 to 3, 2 when left out) share the rows of the table evenly, one below the other.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "fingerpad/calibrate/taxels.hpp"
#include "fingerpad/foam/preslip.hpp"
#include "fingerpad/foam/taxel_features.hpp"

using namespace fingerpad;

struct Sample {
  double time_s;
  std::vector<double> readings;  // row by row
};

struct Recording {
  Index rows = 0, cols = 0;
  std::vector<Sample> samples;
};

/// frame,time_s,r0_c0,r0_c1,...: columns in this order, all of them there.
Recording read(const char* file) {
  std::ifstream stream(file);
  std::string line, cell;
  Recording recording;
  std::getline(stream, line);
  const auto last = line.rfind(",r");  // of the last taxel
  int row = 0, col = 0;
  if (last == std::string::npos || std::sscanf(line.c_str() + last, ",r%d_c%d", &row, &col) != 2) {
    throw std::runtime_error(std::string(file) + " is no table of taxels");
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

template <class Rule, std::size_t Fingers>
bool find_first_alarm(const Recording& recording) {
  const Index rows = recording.rows / Index(Fingers);
  const auto finger = [&](const Sample& sample, std::size_t k) {  // no copy
    const double* const first = sample.readings.data() + Index(k) * rows * recording.cols;
    return StridedView<const double>(first, rows, recording.cols, recording.cols);
  };

  const TaxelOptions<> options;
  std::vector<TaxelFeatures<>> features;  // once; each finger has its own noise and its own state
  std::vector<TaxelFeatures<>::State> states;
  for (std::size_t k = 0; k < Fingers; ++k) {
    TaxelNoiseCalibration calibration(rows, recording.cols, options);
    for (const Sample& sample : recording.samples) {
      calibration.add(finger(sample, k), sample.time_s);
    }
    features.emplace_back(calibration.fit().view(), options);
    states.push_back(features.back().start());
  }
  const Preslip<Rule, Fingers> preslip;
  auto history = preslip.start();

  for (const Sample& sample : recording.samples) {  // each as it is received
    std::array<FingerSample<>, Fingers> felt;
    for (std::size_t k = 0; k < Fingers; ++k) {
      felt[k] = features[k](finger(sample, k), sample.time_s, states[k]);
    }
    if (preslip(felt, history).alarm) {
      std::printf("%s: first alarm at %.3f s\n", Rule::name, sample.time_s);
      for (const FingerSample<>& f : felt) {
        std::printf("  centroid (%.2f, %.2f) mm, ", f.center_x_mm, f.center_y_mm);
        if (f.is_vibrating()) {
          std::printf("row %td col %td vibrates, waves: %td, %.2f Hz\n",
                      f.location / recording.cols, f.location % recording.cols, f.waves,
                      f.frequency_hz);
        } else {
          std::printf("%s\n", name_of(f.status));
        }
      }
      return true;
    }
  }
  std::printf("%s: no alarm in %zu samples\n", Rule::name, recording.samples.size());
  return false;
}

template <std::size_t Fingers>
bool look(const Recording& recording) {
  const bool in_hold = find_first_alarm<GraspOptimise, Fingers>(recording);
  const bool in_lift = find_first_alarm<GraspLift, Fingers>(recording);
  return in_hold && in_lift;
}

int main(int argc, char** argv) {
  try {
    const Recording recording =
        read(argc > 1 ? argv[1] : FINGERPAD_EXAMPLE_RECORDING "/../foam/taxels.csv");
    const int fingers = argc > 2 ? std::atoi(argv[2]) : 2;
    if (fingers < 1 || fingers > 3 || recording.rows % fingers != 0) {
      throw std::runtime_error("the rows of 1 to 3 fingers must share the array evenly");
    }
    const bool found = fingers == 1   ? look<1>(recording)
                       : fingers == 2 ? look<2>(recording)
                                      : look<3>(recording);
    return found || argc > 1 ? 0 : 1;  // the bundled recording has both
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
