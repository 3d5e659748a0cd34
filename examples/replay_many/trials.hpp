// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibrations of a sensor that exists only as numbers, to be done again and again: with fresh
// noise (Monte Carlo), or with what was measured once, drawn with replacement (bootstrap).
#include <functional>
#include <string>
#include <vector>

#include "chance.hpp"

namespace replay_many {

/// What a calibration says of its parameters.
struct Estimate {
  std::vector<double> values;
  std::vector<std::vector<double>> covariance;  ///< analytic; NaN: it says nothing
};

struct Trial {
  std::string name;
  std::vector<std::string> parameters;
  std::vector<double> truth;
  Estimate once;  ///< of what the bootstrap draws from
  /// One more calibration; throws fingerpad::parameter_error where it is refused.
  std::function<Estimate(Chance&)> bootstrap, monte_carlo;
  double weight = 1;  ///< time of one, in ms about
};

/// All of them; each makes its measurements when it is asked for.
const std::vector<std::string>& trial_names();
/// Throws replay::Failure for a name that there is not.
Trial trial_of(const std::string& name);

}  // namespace replay_many
