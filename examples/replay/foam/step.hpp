// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// From the samples of a foam array to features and pre-slip, with the library's taxel_features.hpp
// and preslip.hpp; the only place of the program that knows the rules.
#include <functional>
#include <string>
#include <vector>

#include "fingerpad/foam/preslip.hpp"
#include "fingerpad/foam/taxel_features.hpp"
#include "replay/foam/recording.hpp"

namespace replay {

/// Which rules a sample completes a pair of.
struct FoamAlarm {
  bool grasp_lift = false;
  bool grasp_optimise = false;

  bool any() const { return grasp_lift || grasp_optimise; }
  /// The names of the rules, with "+" between them; empty: none.
  std::string names() const;
};

/// One sample of the recording.
struct FoamRow {
  int sample = 0;  ///< counted from 0
  int frame = 0;
  std::string time_s;  ///< empty where unknown
  std::vector<fingerpad::FingerSample<double>> fingers;
  FoamAlarm alarm;

  /// False: its time is missing or not later than the last; then nothing is known of it.
  bool was_taken() const;
};

/// The noise of the taxels of one finger at rest.
struct FoamNoise {
  std::vector<double> deviations;  ///< row by row; NaN: dead
  bool is_known = true;  ///< false: the recording does not tell, a thousandth of the largest
                         ///< reading is taken
};

/// As sensor.json says, or from the whole recording.
FoamNoise noise_of(const FoamRecording& recording, int finger);

class FoamStep {
 public:
  /// The recording must outlive the step. Throws fingerpad::parameter_error.
  FoamStep(const FoamRecording& recording, const std::vector<FoamNoise>& noise);

  /// Samples in their order.
  FoamRow operator()(int sample);
  /// Of the features and the rules, over the samples so far.
  double median_us() const;

 private:
  using Features = fingerpad::TaxelFeatures<>;
  using Rules = std::function<FoamAlarm(const std::vector<fingerpad::FingerSample<double>>&)>;

  template <std::size_t Fingers>
  static Rules rules_of(const FoamSensor& sensor);
  static Rules make_rules(const FoamSensor& sensor);

  const FoamRecording& recording_;
  std::vector<Features> features_;  ///< one a finger
  std::vector<Features::State> states_;
  Rules rules_;
  std::vector<double> us_;
};

}  // namespace replay
