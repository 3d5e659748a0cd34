// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Options and statuses of all calibrations. Samples that do not determine the parameters are
// refused (parameter_error). Samples that determine them but look wrong give parameters and a
// status that names the likely cause.
#include <cstdint>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// Options of the fits, and limits below which samples are refused.
struct FitOptions {
  bool robust = false;             ///< Huber's loss: outliers weigh less
  double threshold = 1.345;        ///< of Huber's loss, in standard deviations of a sample, > 0
  int passes = 100;                ///< steps at most, >= 2
  double min_independence = 1e-5;  ///< refuses parameters with a smaller independent fraction of
                                   ///< information; in (0, 1)
  double min_explained = 0.9;      ///< refuses samples as contradictory if the model explains a
                                   ///< smaller share of the variance about the mean; in [0, 1)
  // only for fit_normal_force
  bool through_zero = true;  ///< no force without contact; the published curves lack this
  bool rising = true;        ///< the force never falls from 0 to the largest measure
  bool displaced = false;    ///< also fits the compensation for displacement
  bool rotated = false;      ///< also fits the compensation for rotation
};

/// Refuses what has no meaning (parameter_error).
inline void expects_valid(const FitOptions& options) {
  const char* const owner = "FitOptions";
  expects(is_finite(options.threshold) && options.threshold > 0, owner, "threshold",
          options.threshold, "finite and > 0");
  expects(options.passes >= 2, owner, "passes", static_cast<long long>(options.passes), ">= 2");
  expects(options.min_independence > 0 && options.min_independence < 1, owner, "min_independence",
          options.min_independence, "in (0, 1)");
  expects(options.min_explained >= 0 && options.min_explained < 1, owner, "min_explained",
          options.min_explained, "in [0, 1)");
}

/// Whether a fit can be trusted and, if not, the likely cause.
enum class FitStatus : std::uint8_t {
  ok,
  not_converged,
  nothing_to_check,
  at_end_of_search,
  measure_not_in_mm,
  displacement_not_in_mm,
  rotation_not_in_rad,
  moment_not_in_n_mm,
  force_not_in_n,
  gauge_not_tared,
  gauge_rotated,
  axes_exchanged,
  sign_reversed,
  has_outlier,
  pressure_not_in_mpa,
  pressure_unbalanced,
  depths_not_in_mm,
  depths_missing,
  colours_unexplained,
  scatters_no_light,
  light_unexplained,
  light_taken_away,
  pad_moved,
  taxels_missing,
  onsets_not_found,
};

/// The cause in words.
constexpr const char* name_of(FitStatus status) {
  switch (status) {
    case FitStatus::ok:
      return "ok";
    case FitStatus::not_converged:
      return "the fit has not converged: use more samples or fewer parameters";
    case FitStatus::nothing_to_check:
      return "there are as many samples as parameters, so the fit cannot be checked";
    case FitStatus::at_end_of_search:
      return "the best value is at an end of the search: use other frames or a wider search";
    case FitStatus::measure_not_in_mm:
      return "no measure reaches 0.05, or one exceeds 10000: give areas in mm^2, depths and radii "
             "in mm";
    case FitStatus::displacement_not_in_mm:
      return "no displacement reaches 0.01, or one exceeds 100: give displacements in mm";
    case FitStatus::rotation_not_in_rad:
      return "a rotation exceeds a right angle: give rotations in rad";
    case FitStatus::moment_not_in_n_mm:
      return "moments are below 0.05 mm or above 100 mm times the normal force: give moments in N "
             "mm";
    case FitStatus::force_not_in_n:
      return "no force reaches 0.05 (along the pad 0.01), or one exceeds 300: give forces in N";
    case FitStatus::gauge_not_tared:
      return "a constant explains most of the residual: tare the gauge";
    case FitStatus::gauge_rotated:
      return "the forces are rotated against the displacements: align the gauge with the image";
    case FitStatus::axes_exchanged:
      return "the forces mirror the displacements: check whether x and y are exchanged or one is "
             "reversed";
    case FitStatus::sign_reversed:
      return "the forces point against the displacements: check the sign of each axis";
    case FitStatus::has_outlier:
      return "a sample is far from the others: check its dots and its gauge reading, or fit "
             "robustly";
    case FitStatus::pressure_not_in_mpa:
      return "a pressure exceeds 0.2: give it in MPa above the pressure around the pad";
    case FitStatus::pressure_unbalanced:
      return "pressure and pull of the rim do not balance: check that the pressures are of the "
             "same frames and tared";
    case FitStatus::depths_not_in_mm:
      return "the depths are too small for a pad: give depths in mm";
    case FitStatus::depths_missing:
      return "fewer than half of the pixels have a depth: check calibration, exposure and frame";
    case FitStatus::colours_unexplained:
      return "the colours do not follow from the depths: check that both have the same order, "
             "place and frame";
    case FitStatus::scatters_no_light:
      return "g is not positive everywhere: check whether red and green are exchanged";
    case FitStatus::light_unexplained:
      return "neighbouring light removes less than a tenth of the error: check frame, order and "
             "unit";
    case FitStatus::light_taken_away:
      return "neighbouring light would darken: measured and true depths may be exchanged";
    case FitStatus::pad_moved:
      return "the dots move slowly, unlike noise: check that the pad is at rest";
    case FitStatus::taxels_missing:
      return "fewer than half of the taxels gave readings in range: check bytes, range and order";
    case FitStatus::onsets_not_found:
      return "no threshold separates the onsets from the rest: check the marks, or use another "
             "rule";
  }
  return "unknown";
}

}  // namespace v0
}  // namespace fingerpad
