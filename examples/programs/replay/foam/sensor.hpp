// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The section "foam" of sensor.json, which describes a foam array. All keys are optional.
#include <filesystem>
#include <optional>
#include <vector>

#include "fingerpad/foam/preslip.hpp"
#include "fingerpad/foam/taxels.hpp"

namespace replay {

/// The rectangle of the array that belongs to one finger.
struct FingerPlace {
  int first_row = 0;
  int rows = 0;
  int first_col = 0;
  int cols = 0;
};

constexpr int max_fingers = 5;

struct FoamSensor {
  std::vector<FingerPlace> fingers;       ///< empty: the whole array is one finger
  fingerpad::TaxelOptions taxels;         ///< except for the members below
  std::optional<double> noise;            ///< empty: from the quiet part of the recording
  std::optional<double> free_until_s;     ///< empty: found, if the first samples are free
  std::optional<double> quiet_until_s;    ///< empty: the first windows are assumed quiet
  std::optional<double> sample_period_s;  ///< empty: from the recording
  std::optional<double> longest_gap_s;    ///< empty: library default, at least four periods
  std::vector<double> newton_per_unit;    ///< of all taxels, or of each; empty: not known
  std::vector<fingerpad::Point2<double>> places_mm;  ///< of each; empty: a regular array
  fingerpad::PreslipOptions rules;
  bool grasp_lift = true;
  bool grasp_optimise = false;
};

/// Reads and checks `file`, which may be absent; throws Failure.
FoamSensor read_foam_sensor(const std::filesystem::path& file);

}  // namespace replay
