// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Calls the loops over pixels that must work on vectors; count_vectors finds them by their names.
#include <cstdint>

#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/sampling.hpp"
#include "fingerpad/image/curvature.hpp"

using namespace fingerpad;

DepthResult depth_of(DepthEstimator<>& estimate,
                     const StridedView<const std::uint8_t>& red,
                     const StridedView<const std::uint8_t>& green,
                     const StridedView<float>& depth_mm) {
  return estimate(red, green, depth_mm);
}

bool curvature_of(CurvatureMap<>& map,
                  const StridedView<const float>& depth_mm,
                  const StridedView<float>& clamped,
                  const StridedView<float>& plain) {
  return map(depth_mm, clamped).has_value() && map(depth_mm, clamped, plain).has_value();
}

bool samples_of(const StridedView<const std::uint8_t>& red,
                const StridedView<const std::uint8_t>& green,
                const StridedView<std::uint16_t>& to_red,
                const StridedView<std::uint16_t>& to_green) {
  return sample_frame(red, green, 3, to_red, to_green);
}
