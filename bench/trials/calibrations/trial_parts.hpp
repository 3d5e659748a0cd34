// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Common parts of the trials.
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "bench/trials/calibrations/trials.hpp"

namespace trials {

using Matrix = std::vector<std::vector<double>>;
constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint64_t measured_once = 20110801;

/// Covariance from standard errors only; the other elements are NaN.
inline Matrix diagonal(const std::vector<double>& sds) {
  Matrix matrix(sds.size(), std::vector<double>(sds.size(), none));
  for (std::size_t k = 0; k < sds.size(); ++k) {
    matrix[k][k] = sds[k] * sds[k];
  }
  return matrix;
}

template <class Covariance>
Matrix block(const Covariance& covariance, const std::vector<std::size_t>& places) {
  Matrix matrix;
  for (const std::size_t i : places) {
    matrix.emplace_back();
    for (const std::size_t j : places) {
      matrix.back().push_back(covariance(i, j));
    }
  }
  return matrix;
}

/// Makes a trial from three functions: Data measure(Chance&), Data draw(const Data&, Chance&) and
/// Estimate fit(const Data&).
template <class Measure, class Draw, class Fit>
Trial trial(std::vector<std::string> parameters,
            std::vector<double> truth,
            double weight,
            const Measure& measure,
            const Draw& draw,
            const Fit& fit) {
  Chance chance(measured_once);
  const auto data = measure(chance);
  return {.name = {},
          .parameters = std::move(parameters),
          .truth = std::move(truth),
          .once = fit(data),
          .bootstrap = [=](Chance& next) { return fit(draw(data, next)); },
          .monte_carlo = [=](Chance& next) { return fit(measure(next)); },
          .weight = weight};
}

/// Bootstrap for independent samples: draws them one by one.
inline const auto draw_samples = [](const auto& data, Chance& chance) {
  return chance.drawn_from(data);
};

/// Trials defined in trials_of_shape.cpp.
Trial camera_plate();
Trial cap();
Trial intensity();

}  // namespace trials
