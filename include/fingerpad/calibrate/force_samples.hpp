// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What a calibration of forces is given: moments in which a force gauge and the camera looked at
// the same contact.
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "fingerpad/calibrate/model_fit.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// One measurement. NaN: not measured; a fit leaves out samples that lack what it needs.
template <scalar S = double>
struct ForceSample {
  S measure = not_a_number<S>();  ///< area in mm^2, depth in mm or radius in mm, > 0
  Point2<S> displacement_mm = {S(0), S(0)};
  S rotation_rad = S(0);
  S normal_force_n = not_a_number<S>();  ///< that presses, >= 0
  Point2<S> tangential_force_n = {not_a_number<S>(), not_a_number<S>()};
  S moment_n_mm = not_a_number<S>();  ///< about the contact's normal, through its middle
  int load = 0;  ///< samples of one load have one number, and are left out together
};

/// For a plot of what the fit says over what was measured.
template <scalar S = double>
struct ForceResidual {
  std::size_t sample;  ///< its place among those given
  S measured;          ///< N, or N mm
  S fitted;
  S weight;  ///< 1; less for what counts as an outlier
};

/// How well forces are predicted that took no part in the calibration.
template <scalar S = double>
struct CrossValidation {
  std::vector<S> errors;  ///< predicted less measured, of each sample; NaN: no prediction
  int loads = 0;          ///< how many times a load was left out
  Index samples = 0;      ///< with a prediction
  S mean_abs = not_a_number<S>();
  S rms = not_a_number<S>();
  S worst = not_a_number<S>();  ///< largest absolute error
};

/// Leaves out one load after the other, calibrates with the rest, and predicts what was left out:
/// model = fit(span of samples); error = error_of(model, sample). O(loads) fits; allocates. What
/// the fit refuses is refused.
template <scalar S, class Fit, class ErrorOf>
CrossValidation<S> leave_one_load_out(std::span<const ForceSample<S>> samples,
                                      const Fit& fit,
                                      const ErrorOf& error_of) {
  using std::sqrt;
  CrossValidation<S> result;
  result.errors.assign(samples.size(), not_a_number<S>());
  std::vector<bool> done(samples.size(), false);
  std::vector<ForceSample<S>> rest;
  for (std::size_t first = 0; first < samples.size(); ++first) {
    if (done[first]) {
      continue;
    }
    rest.clear();
    for (const ForceSample<S>& sample : samples) {
      if (sample.load != samples[first].load) {
        rest.push_back(sample);
      }
    }
    const auto model = fit(std::span<const ForceSample<S>>(rest));
    ++result.loads;
    for (std::size_t i = first; i < samples.size(); ++i) {
      if (samples[i].load == samples[first].load) {
        done[i] = true;
        result.errors[i] = error_of(model, samples[i]);
      }
    }
  }
  S sum = S(0), sum_sq = S(0), worst = S(0);
  for (const S& error : result.errors) {
    if (is_finite(error)) {
      const S size = value(error) < 0 ? S(-error) : error;
      sum = sum + size;
      sum_sq = sum_sq + square(error);
      worst = value(size) > value(worst) ? size : worst;
      ++result.samples;
    }
  }
  if (result.samples > 0) {
    const S count = S(static_cast<double>(result.samples));
    result.mean_abs = sum / count;
    result.rms = sqrt(S(sum_sq / count));
    result.worst = worst;
  }
  return result;
}

namespace detail {

// Between samples and fits: which samples a fit can use, and what it says of them.

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
