// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibrations of a simulated sensor that can be repeated, with new noise or without.
#include <functional>
#include <string>
#include <vector>

#include "bench/trials/calibrations/chance.hpp"

namespace trials {

struct Trial {
  std::vector<double> truth;
  /// Repeats the calibration of one measurement. Gives the parameters; throws
  /// fingerpad::parameter_error if the data are refused, as does the next.
  std::function<std::vector<double>()> again;
  std::function<std::vector<double>(Chance&)> anew;  ///< measures anew
};

/// Names of all trials. A trial makes its measurements in trial_of().
const std::vector<std::string>& trial_names();
/// Throws replay::Failure for an unknown name.
Trial trial_of(const std::string& name);

}  // namespace trials
