// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibrations of a simulated sensor that can be repeated: with new noise (Monte Carlo), or with
// samples drawn with replacement from one measurement (bootstrap).
#include <functional>
#include <string>
#include <vector>

#include "bench/trials/calibrations/chance.hpp"

namespace trials {

/// The parameters that a calibration estimates.
struct Estimate {
  std::vector<double> values;
  std::vector<std::vector<double>> covariance;  ///< analytic; NaN where the fit reports none
};

struct Trial {
  std::string name;
  std::vector<std::string> parameters;
  std::vector<double> truth;
  Estimate once;  ///< from the measurement that the bootstrap draws from
  /// Repeats the calibration; throws fingerpad::parameter_error if the data are refused.
  std::function<Estimate(Chance&)> bootstrap, monte_carlo;
  double weight = 1;  ///< approximate time of one calibration, ms
};

/// Names of all trials. A trial makes its measurements in trial_of().
const std::vector<std::string>& trial_names();
/// Throws replay::Failure for an unknown name.
Trial trial_of(const std::string& name);

}  // namespace trials
