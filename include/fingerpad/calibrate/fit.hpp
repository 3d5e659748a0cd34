// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Options and causes of all calibrations. Samples that do not determine the parameters are refused
// (parameter_error). Samples that determine them but look wrong give parameters and the likely
// cause.
#include <string>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// Options of the fits of forces.
struct FitOptions {
  bool robust = false;         ///< Huber's loss: outliers weigh less
  double min_explained = 0.9;  ///< refuses samples as contradictory if the model explains a smaller
                               ///< share of the variance about the mean; in [0, 1)
};

/// Says which option has no meaning; "" if all have one.
inline std::string check(const FitOptions& o) {
  return check("FitOptions",
               {{"min_explained", o.min_explained, {.min = 0, .max = 1, .below_max = true}}});
}

/// A fit that is not ok() says in its field `cause` what is likely wrong; nullptr if it is ok.
/// Causes of several fits:
namespace cause {
inline constexpr const char* not_converged =
    "the fit has not converged: use more samples or fewer parameters";
inline constexpr const char* nothing_to_check =
    "there are as many samples as parameters, so the fit cannot be checked";
inline constexpr const char* at_end_of_search =
    "the best value is at an end of the search: use other frames or a wider search";
inline constexpr const char* gauge_not_tared =
    "a constant explains most of the residual: tare the gauge";
inline constexpr const char* gauge_rotated =
    "the forces are rotated against the displacements: align the gauge with the image";
inline constexpr const char* depths_not_in_mm =
    "the depths are too small for a pad: give depths in mm";
inline constexpr const char* colours_unexplained =
    "the colours do not follow from the depths: check that both have the same order, place and "
    "frame";
}  // namespace cause

/// "ok", or the likely mistake.
template <class Fit>
const char* text_of(const Fit& fit) {
  return fit.ok() ? "ok" : fit.cause;
}

}  // namespace v0
}  // namespace fingerpad
