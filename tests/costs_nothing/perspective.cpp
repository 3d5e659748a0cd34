// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The camera's perspective in the curvature of a height map.
#include <limits>

#include "fingerpad/image/curvature_map.hpp"

using namespace fingerpad;
using Units = detail::DepthUnits<OrthographicCamera<double>, float>;

extern "C" void switched_off(const Units& units, const float* depth_mm, float* zeta, float* size) {
  for (int k = 0; k < 640; ++k) {
    zeta[k] = units.flattened(depth_mm[k]);
    size[k] = units.shrink(zeta[k]);
  }
}

extern "C" void without_effect(const Units& units,
                               const float* depth_mm,
                               float* zeta,
                               float* size) {
  for (int k = 0; k < 640; ++k) {
    const float l = depth_mm[k] * units.per_mm;
    zeta[k] = l > units.lowest && l < units.highest ? l : std::numeric_limits<float>::quiet_NaN();
    size[k] = 1;
  }
}
