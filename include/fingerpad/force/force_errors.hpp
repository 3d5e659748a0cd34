// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How uncertain a force is that a curve gives: by the curve's parameters, by what the calibration
// could not explain, and by noise of the measure beyond that in the calibration.
#include <array>
#include <cstddef>

#include "fingerpad/force/detail/zeros.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// No variance is computed; it is NaN in the result.
struct NoErrors {
  static constexpr bool known = false;
};

/// Of a curve with this many parameters, as the fits of calibrate/force.hpp fill it in.
template <std::size_t Parameters, scalar S = double>
struct CurveErrors {
  static constexpr bool known = true;
  static constexpr std::size_t size = Parameters;

  std::array<std::array<S, size>, size> covariance =
      detail::zero_matrix<S, size>();  ///< of the parameters: symmetric and not indefinite
  S residual_sd_n = S(0);              ///< standard deviation of a sample about the curve, N, >= 0
  S measure_sd = S(0);                 ///< noise of the measure that the samples did not have, >= 0

  /// Variance in N^2 of the force at a measure where the curve has this gradient and slope.
  S variance_n2(const std::array<S, size>& gradient, const S& slope) const {
    S sum = square(residual_sd_n) + square(S(slope * measure_sd));
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = 0; j < size; ++j) {
        sum = sum + S(S(gradient[i] * covariance[i][j]) * gradient[j]);
      }
    }
    return sum;
  }
};

/// Refuses what has no meaning (parameter_error).
inline void expects_valid(const NoErrors&) {}
template <std::size_t Parameters, scalar S>
void expects_valid(const CurveErrors<Parameters, S>& errors) {
  const char* const owner = "CurveErrors";
  for (std::size_t i = 0; i < errors.size; ++i) {
    for (const S& entry : errors.covariance[i]) {
      expects(is_finite(entry), owner, "covariance", entry, "finite");
    }
    expects(value(errors.covariance[i][i]) >= 0, owner, "variance of a parameter",
            errors.covariance[i][i], ">= 0");
  }
  expects(is_finite(errors.residual_sd_n) && value(errors.residual_sd_n) >= 0, owner,
          "residual_sd_n", errors.residual_sd_n, "finite and >= 0");
  expects(is_finite(errors.measure_sd) && value(errors.measure_sd) >= 0, owner, "measure_sd",
          errors.measure_sd, "finite and >= 0");
}

}  // namespace v0
}  // namespace fingerpad
