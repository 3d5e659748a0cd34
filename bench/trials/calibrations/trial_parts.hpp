// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Common parts of the trials.
#include <limits>
#include <utility>
#include <vector>

#include "bench/trials/calibrations/trials.hpp"

namespace trials {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint64_t measured_once = 20110801;

/// Makes a trial from two functions: Data measure(Chance&) and std::vector<double> fit(const
/// Data&).
template <class Measure, class Fit>
Trial trial(std::vector<double> truth, const Measure& measure, const Fit& fit) {
  Chance chance(measured_once);
  return {.truth = std::move(truth),
          .again = [fit, data = measure(chance)] { return fit(data); },
          .anew = [=](Chance& next) { return fit(measure(next)); }};
}

/// Trials defined in trials_of_shape.cpp.
Trial camera_plate();
Trial cap();
Trial intensity();

}  // namespace trials
