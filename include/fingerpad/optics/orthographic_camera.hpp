// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A camera without perspective, for height maps from other sensors or simulations. Methods that
// take depths along the rays of a Camera take heights of this one, too.
#include <string>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {

/// Each pixel sees the point straight above it.
template <scalar S = double>
struct OrthographicCamera {
  S center_x_px = S(639) / S(2);  ///< pixel on the axis, along columns
  S center_y_px = S(479) / S(2);  ///< the same along rows
  S pitch_mm = S(8) / S(100);     ///< distance of the points that pixels side by side see, > 0
  S pixel_aspect = S(1);          ///< distance of those above one another over pitch_mm, > 0
};

/// Says which value is out of range; "" if none is.
template <scalar S>
std::string check(const OrthographicCamera<S>& c) {
  return check("OrthographicCamera", {{"center_x_px", c.center_x_px, finite_number},
                                      {"center_y_px", c.center_y_px, finite_number},
                                      {"pitch_mm", c.pitch_mm, positive},
                                      {"pixel_aspect", c.pixel_aspect, positive}});
}

/// The same camera in another scalar.
template <scalar To, scalar From>
OrthographicCamera<To> cast(const OrthographicCamera<From>& c) {
  return {To(c.center_x_px), To(c.center_y_px), To(c.pitch_mm), To(c.pixel_aspect)};
}

/// 0: pixels see points that are pitch_mm apart along x, at any depth.
template <scalar S>
S growth_per_mm(const OrthographicCamera<S>&) {
  return S(0);
}

/// The point above (row, col) at height depth_mm; NaN depth gives NaN.
template <scalar S>
Point3<S> point_at(const OrthographicCamera<S>& camera,
                   const S& row,
                   const S& col,
                   const S& depth_mm) {
  return {(col - camera.center_x_px) * camera.pitch_mm,
          (row - camera.center_y_px) * (camera.pitch_mm * camera.pixel_aspect), depth_mm};
}

/// The pixel that sees `point`.
template <scalar S>
Point2<S> pixel_of(const OrthographicCamera<S>& camera, const Point3<S>& point) {
  return {camera.center_x_px + point.x / camera.pitch_mm,
          camera.center_y_px + point.y / (camera.pitch_mm * camera.pixel_aspect)};
}

}  // namespace v1
}  // namespace fingerpad
