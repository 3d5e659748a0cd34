// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What a calibration of forces is given: moments in which a force gauge and the camera looked at
// the same contact.
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

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

}  // namespace v0
}  // namespace fingerpad
