// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Which projection of the curvature map belongs to a camera.
#include "fingerpad/image/curvature_projection.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

template <scalar S>
PitchAtDepth projection_for(const Camera<S>& camera) {
  return PitchAtDepth(camera);
}
template <scalar S>
PlatePitch projection_for(const OrthographicCamera<S>& camera) {
  return {static_cast<double>(value(camera.pitch_mm))};
}

template <class CameraType>
using projection_of = decltype(projection_for(CameraType{}));

/// Distance in mm of the points that neighbouring pixels see at a depth.
inline double pixel_size_mm(const PlatePitch& plate, double) {
  return plate.pitch_mm;
}
inline double pixel_size_mm(const PitchAtDepth& camera, double depth_mm) {
  return camera.pitch_mm * (1 + camera.growth_per_mm * depth_mm);
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
