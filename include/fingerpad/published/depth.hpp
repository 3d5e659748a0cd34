// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The RGB depth model as printed: Ito, Kim, Nagai, Obinata, "Acquisition of tactile information by
// vision-based tactile sensor for dexterous handling of robot hands", III.A. A quotient of the
// scattering for each pixel, the mean over 29 x 29 px, one height for all rays, bisection. What is
// wrong with it, and what the default does instead: docs/errata.md and docs/depth/depth.md.
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/published/camera.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// Depth as printed, in the scalar S.
template <scalar S = float>
using DepthEstimator =
    fingerpad::DepthEstimator<BoxMean, Bisection, SingleHeight, S, PixelScattering<S>>;

/// The free pad as printed: see fit_reference, which this calls.
template <scalar S = float, grid Red, grid Green, grid Depth>
auto depth_reference(const Camera<double>& camera,
                     const Absorption<double>& fluid,
                     const Red& red,
                     const Green& green,
                     const Depth& depth_mm) {
  return fit_reference<PixelQuotient, SingleHeight, S>(camera, fluid, red, green, depth_mm);
}

/// `reference` from depth_reference(). Refuses bad parameters (parameter_error).
template <scalar S>
DepthEstimator<S> depth_estimator(
    const Camera<double>& camera,
    const Absorption<double>& fluid,
    const DepthReference<S, PixelScattering<S>, SingleHeight>& reference,
    int window_px = 29) {
  return DepthEstimator<S>(camera, fluid, reference, BoxMean{window_px});
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
