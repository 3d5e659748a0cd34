// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The section "foam" of sensor.json: what is known of a foam array. All of it is optional.
#include <filesystem>
#include <optional>
#include <vector>

#include "fingerpad/foam/preslip.hpp"
#include "fingerpad/foam/taxel_features.hpp"

namespace replay {

/// The rectangle of the array that one finger has.
struct FingerPlace {
  int first_row = 0;
  int rows = 0;
  int first_col = 0;
  int cols = 0;
};

constexpr int max_fingers = 5;

struct FoamSensor {
  std::vector<FingerPlace> fingers;        ///< none: the whole array is one
  fingerpad::TaxelOptions<double> taxels;  ///< but for what follows
  std::optional<double> noise;             ///< none: from the quiet part of the recording
  std::optional<double> quiet_until_s;     ///< none: its first windows are taken to be quiet
  std::optional<double> sample_period_s;   ///< none: from the recording
  std::optional<double> longest_gap_s;     ///< none: the library's, at least four periods
  fingerpad::PreslipOptions<double> rules;
  bool grasp_lift = true;
  bool grasp_optimise = false;
};

/// Reads and checks `file`, which may be absent; throws Failure.
FoamSensor read_foam_sensor(const std::filesystem::path& file);

}  // namespace replay
