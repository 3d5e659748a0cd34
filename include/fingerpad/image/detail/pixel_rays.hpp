// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The points that a camera's pixels see at given depths: point_at() of optics/camera.hpp without
// its square roots and divisions.
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// A pixel's ray is straight and lies in a plane with the optical axis: its point is (column -
/// center, row - center) in pixel widths, times mm_per_px = at_plate + per_mm depth.
template <scalar S>
struct MmPerPx {
  S at_plate;
  S per_mm;
};
template <scalar S>
MmPerPx<S> mm_per_px(const Camera<S>& camera, const S& row, const S& col) {
  const S distorted_sq = squared_norm(distorted_tangents(camera, row, col));
  const S q = undistortion(camera, distorted_sq);
  const S t_sq = distorted_sq * q * q;
  const S in_air = camera.plate_distance_mm - camera.plate_thickness_mm;
  const S in_plate = camera.plate_thickness_mm * tangent_ratio(t_sq, camera.plate_index);
  const S per_px = tangent_per_px(camera) * q;
  return {per_px * (in_air + in_plate), per_px * tangent_ratio(t_sq, camera.refractive_index)};
}
template <scalar S>
MmPerPx<S> mm_per_px(const OrthographicCamera<S>& camera, const S&, const S&) {
  return {camera.pitch_mm, S(0)};
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
