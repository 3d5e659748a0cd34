// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Options and statuses of all calibrations. Samples that do not determine the parameters are
// refused (parameter_error). Samples that determine them but look wrong give parameters and a
// status that names the likely cause.
#include <cstdint>

#include "fingerpad/core/expects.hpp"
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
      return "not converged: more samples, or fewer parameters";
    case FitStatus::nothing_to_check:
      return "as many samples as parameters: nothing is left to check them by";
    case FitStatus::at_end_of_search:
      return "the best lies at an end of the search: other frames, or a wider search";
    case FitStatus::measure_not_in_mm:
      return "no measure reaches 0.05, or one exceeds 10000: areas in mm^2, depths and radii in "
             "mm?";
    case FitStatus::displacement_not_in_mm:
      return "no displacement reaches 0.01, or one exceeds 100: in mm?";
    case FitStatus::rotation_not_in_rad:
      return "a rotation beyond a right angle: in rad?";
    case FitStatus::moment_not_in_n_mm:
      return "moments of less than 0.05 mm or more than 100 mm times the normal force: in N mm?";
    case FitStatus::force_not_in_n:
      return "no force reaches 0.05 (along the pad 0.01), or one exceeds 300: in N?";
    case FitStatus::gauge_not_tared:
      return "a constant would explain most of what is left: was the gauge tared?";
    case FitStatus::gauge_rotated:
      return "forces stand askew to the displacements: is the gauge rotated against the image?";
    case FitStatus::axes_exchanged:
      return "forces mirror the displacements: are x and y exchanged, or one of them reversed?";
    case FitStatus::sign_reversed:
      return "forces point against the displacements: is the sign of an axis reversed?";
    case FitStatus::has_outlier:
      return "a sample lies far off the others: a dot mistaken, a gauge bumped? Fit robustly";
    case FitStatus::pressure_not_in_mpa:
      return "a pressure above 0.2: in MPa, above that around the pad?";
    case FitStatus::pressure_unbalanced:
      return "pressure and pull of the rim do not balance: pressures of the same frames, tared?";
    case FitStatus::depths_not_in_mm:
      return "depths too small for a pad: in mm?";
    case FitStatus::depths_missing:
      return "fewer than half of the pixels have a depth: calibration, exposure, frame?";
    case FitStatus::colours_unexplained:
      return "the colours do not follow from the depths: other order, other place, other frame?";
    case FitStatus::scatters_no_light:
      return "g is not positive everywhere: are red and green exchanged?";
    case FitStatus::light_unexplained:
      return "neighbouring light takes off less than a tenth of the error: other frame, order, "
             "unit?";
    case FitStatus::light_taken_away:
      return "neighbouring light would darken: are measured and true depths exchanged?";
    case FitStatus::pad_moved:
      return "dots move slowly, not as noise does: did the pad stand still?";
    case FitStatus::taxels_missing:
      return "fewer than half of the taxels gave readings in range: bytes, range, order?";
    case FitStatus::onsets_not_found:
      return "no threshold tells the onsets from the rest: marks late or early, or another rule?";
  }
  return "unknown";
}

}  // namespace v0
}  // namespace fingerpad
