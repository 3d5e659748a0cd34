// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// From the samples of a foam array to features and pre-slip, by the library's foam_hand.hpp; the
// only place of the program that knows the rules.
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
  std::string source;              ///< where it is from, in words
};

/// As sensor.json says; else of the part that it states to be quiet, or of the first four windows;
/// where these do not tell a thousandth of the largest reading. Throws Failure where the stated
/// part does not tell.
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
  /// Fills fingers and alarm of a row.
  using Hand = std::function<void(int sample, FoamRow& row)>;

  template <std::size_t Fingers>
  static Hand hand_of(const FoamRecording& recording, const std::vector<FoamNoise>& noise);
  static Hand make_hand(const FoamRecording& recording, const std::vector<FoamNoise>& noise);

  const FoamRecording& recording_;
  Hand hand_;
  std::vector<double> us_;
};

}  // namespace replay
