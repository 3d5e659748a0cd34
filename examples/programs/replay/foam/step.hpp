// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Computes features and pre-slip of a foam array with the library's foam_hand.hpp. Only this step
// evaluates the pre-slip rules.
#include <string>
#include <vector>

#include "fingerpad/foam/preslip.hpp"
#include "fingerpad/foam/taxels.hpp"
#include "fingerpad/pipeline/foam_hand.hpp"
#include "replay/foam/recording.hpp"

namespace replay {

/// The rules of which a sample completes a pair.
struct FoamAlarm {
  bool grasp_lift = false;
  bool grasp_optimise = false;

  bool any() const { return grasp_lift || grasp_optimise; }
  /// The names of the rules with "+" between them; empty without alarm.
  std::string names() const;
};

/// One sample of the recording.
struct FoamRow {
  int sample = 0;  ///< counted from 0
  int frame = 0;
  std::string time_s;  ///< empty if unknown
  std::vector<fingerpad::FingerSample<double>> fingers;
  FoamAlarm alarm;

  /// False if the sample was skipped: its time is missing or not later than the previous one.
  bool was_taken() const;
};

/// The noise of the taxels of one finger at rest.
struct FoamNoise {
  std::vector<double> deviations;  ///< row by row; NaN for a dead taxel
  std::string source;              ///< origin of the noise, in words
  bool shakes = false;             ///< the first samples shake, and no noise can be measured
};

/// The noise from sensor.json, else estimated from the quiet part given there. Without either it is
/// estimated from the first four windows, or else from the whole recording, or else set to a
/// thousandth of the largest reading.
/// Throws Failure if the given quiet part does not allow an estimate.
FoamNoise noise_of(const FoamRecording& recording, int finger);

class FoamStep {
 public:
  /// The recording must outlive the step. Throws fingerpad::parameter_error.
  FoamStep(const FoamRecording& recording, const std::vector<FoamNoise>& noise);

  /// Takes the samples in order.
  FoamRow operator()(int sample);
  /// Median time of features and rules over the samples so far.
  double median_us() const;

 private:
  const FoamRecording& recording_;
  fingerpad::FoamHand<> hand_;     // with grasp-lift
  fingerpad::Preslip<> optimise_;  // both rules are applied; sensor.json selects which are reported
  std::vector<double> us_;
};

}  // namespace replay
