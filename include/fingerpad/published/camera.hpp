// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Camera equations as printed, where the default differs: one height for both directions of a
// pencil (the slides), and the sine in eq. 13 (Ito, Kim, Nagai, Obinata 2011).
#include <cmath>

#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// The same height in both directions: h2 = n h1 cos^3(phi1) / cos^3(phi2), with phi1 in the fluid
/// and phi2 in air (closed form of the slides' chain of differentials).
struct SingleHeight {
  template <scalar S>
  static PencilHeights<S> heights(const Camera<S>& camera, const Ray<S>& ray) {
    const PencilHeights<S> both = pencil_heights(camera, ray);
    return {both.meridional_mm, both.meridional_mm};
  }
};

/// Eq. 13 with the sine, for a camera without a plate. It is right only if depth_mm is a length
/// along the ray. With a depth along z it is at most 0.026 mm short on a pad 50 mm from the camera,
/// and 0.39 mm at 30 degrees and a depth of 13 mm.
template <scalar S>
Point3<S> point_at(const Camera<S>& camera, const S& row, const S& col, const S& depth_mm) {
  using std::sqrt;
  const Point2<S> t = tangents_of_pixel(camera, row, col);
  const S inverse_cos = sqrt(S(S(1) + squared_norm(t)));
  const S sine_per_t = S(1) / (camera.refractive_index * inverse_cos);
  const S rho_per_t = camera.plate_distance_mm + depth_mm * sine_per_t;
  return {S(t.x * rho_per_t), S(t.y * rho_per_t), depth_mm};
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
