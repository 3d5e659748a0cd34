// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Causes of all calibrations. Samples that do not determine the parameters are refused
// (parameter_error). Samples that determine them but look wrong give parameters and the likely
// cause.
namespace fingerpad {
inline namespace v1 {

/// A fit that is not ok() says in its field `cause` what is likely wrong; nullptr if it is ok.
/// Causes of several fits, each with one address in a program, to compare with ==:
namespace cause {
inline constexpr char not_converged[] =
    "the fit has not converged: use more samples or fewer parameters";
inline constexpr char nothing_to_check[] =
    "there are as many samples as parameters, so the fit cannot be checked";
inline constexpr char at_end_of_search[] =
    "the best value is at an end of the search: use other frames or a wider search";
inline constexpr char gauge_not_tared[] =
    "a constant explains most of the residual: tare the gauge";
inline constexpr char gauge_rotated[] =
    "the forces are rotated against the displacements: align the gauge with the image";
inline constexpr char depths_not_in_mm[] = "the depths are too small for a pad: give depths in mm";
inline constexpr char colours_unexplained[] =
    "the colours do not follow from the depths: check that both have the same order, place and "
    "frame";
}  // namespace cause

/// "ok", or the likely mistake.
template <class Fit>
const char* text_of(const Fit& fit) {
  return fit.ok() ? "ok" : fit.cause;
}

}  // namespace v1
}  // namespace fingerpad
