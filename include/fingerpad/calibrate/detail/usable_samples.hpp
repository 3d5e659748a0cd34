// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Between samples and fits: which samples a fit can use, and what it says of them.
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "fingerpad/calibrate/force_samples.hpp"
#include "fingerpad/calibrate/model_fit.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// The samples that a fit can use, and which they were.
template <scalar S>
struct UsableSamples {
  std::vector<ForceSample<S>> samples;
  std::vector<std::size_t> places;
};

template <scalar S, class Usable>
UsableSamples<S> usable_samples(std::span<const ForceSample<S>> samples, const Usable& usable) {
  UsableSamples<S> result;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const ForceSample<S>& s = samples[i];
    if (is_finite(s.measure) && value(s.measure) > 0 && usable(s)) {
      result.samples.push_back(s);
      result.places.push_back(i);
    }
  }
  return result;
}

template <scalar S>
bool has_finite_motion(const ForceSample<S>& s) {
  return is_finite(s.displacement_mm.x) && is_finite(s.displacement_mm.y) &&
         is_finite(s.rotation_rad);
}

template <scalar S>
void add_residuals(const ModelFit<S>& fit,
                   const typename ModelFit<S>::Vector& measured,
                   const std::vector<std::size_t>& places,
                   std::vector<ForceResidual<S>>& residuals) {
  for (Index i = 0; i < measured.size(); ++i) {
    residuals.push_back({places[static_cast<std::size_t>(i)], measured(i),
                         S(measured(i) - fit.residuals(i)), fit.weights(i)});
  }
}

template <scalar S, std::size_t N>
std::array<S, N> standard_errors_of(const ModelFit<S>& fit) {
  using std::sqrt;
  std::array<S, N> errors;
  for (std::size_t k = 0; k < N; ++k) {
    const Index i = static_cast<Index>(k);
    errors[k] = value(fit.covariance(i, i)) > 0 ? S(sqrt(fit.covariance(i, i))) : S(0);
  }
  return errors;
}

/// The covariance of the first parameters; 0 for what was not fitted.
template <scalar S, std::size_t N>
std::array<std::array<S, N>, N> covariance_of(const ModelFit<S>& fit) {
  std::array<std::array<S, N>, N> covariance;
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < N; ++j) {
      const Index row = static_cast<Index>(i), col = static_cast<Index>(j);
      const bool fitted = row < fit.covariance.rows() && col < fit.covariance.cols();
      covariance[i][j] = fitted ? S(fit.covariance(row, col)) : S(0);
    }
  }
  return covariance;
}

/// y = a p with given columns.
template <scalar S>
struct LinearModel {
  typename ModelFit<S>::Matrix columns;
  void fill(const typename ModelFit<S>::Vector& parameters,
            typename ModelFit<S>::Vector& values,
            typename ModelFit<S>::Matrix& jacobian) const {
    values = columns * parameters;
    jacobian = columns;
  }
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
