// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How far apart the points are that neighbouring pixels see.
//
// Looking through a camera, that distance grows with depth, s = pitch (1 + c l), and a tilted plane
// looks hollow: by 2 c slope^2 / ((1 + c l) (1 + slope^2)^(3/2)) in a section along the slope,
// which is 5e-3 per mm at a slope of 1/2. Both are undone at once: with zeta = l / (1 + c l) planes
// are planes again, for a camera at 1/c behind the plate, and
//   K = K of (K1) for radius r / (1 + c l) and depths zeta, over (1 + c l)^2
// on the axis. A flat section stays flat; where K is not 0 it is off by a share of the order of
// c x slope, x the distance from the axis. Refraction makes c fall off the axis (3 % at 20
// degrees), which leaves less than 5e-4 per mm of a plane with slope 1/2 (tests/image/curvature.cpp).
#include <algorithm>
#include <cmath>
#include <concepts>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/row_lanes.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

/// The same distance everywhere, as published; right for height maps seen from infinitely far.
struct PlatePitch {
  double pitch_mm = 0.0768;  ///< in [1e-9, 1e9]
};

/// Seen by a camera through plate and fluid, as frames are.
struct PitchAtDepth {
  double pitch_mm;       ///< on the plate, in [1e-9, 1e9]
  double growth_per_mm;  ///< c, >= 0: 1 / virtual height of the camera on the axis

  constexpr PitchAtDepth(double pitch, double growth) : pitch_mm(pitch), growth_per_mm(growth) {}
  template <scalar S>
  PitchAtDepth(const Camera<S>& camera)  // NOLINT: a camera says how far apart its pixels see
      : pitch_mm(static_cast<double>(value(camera.pitch_mm))),
        growth_per_mm(
            static_cast<double>(value(tangent_per_px(camera))) / pitch_mm *
            detail::tangent_ratio(0.0, static_cast<double>(value(camera.refractive_index)))) {}
};

namespace detail {

inline void expects_pitch(const char* owner, double pitch_mm) {
  expects(pitch_mm >= 1e-9 && pitch_mm <= 1e9, owner, "pitch_mm", pitch_mm, "in [1e-9, 1e9]");
}
inline double checked_growth(const PlatePitch& plate) {
  expects_pitch("PlatePitch", plate.pitch_mm);
  return 0;
}
inline double checked_growth(const PitchAtDepth& camera) {
  expects_pitch("PitchAtDepth", camera.pitch_mm);
  expects(camera.growth_per_mm >= 0 && camera.growth_per_mm <= 1e9, "PitchAtDepth", "growth_per_mm",
          camera.growth_per_mm, "in [0, 1e9]");
  return camera.growth_per_mm;
}

/// Depths in units of about one pitch, a power of two so that nothing is rounded: the products of
/// six lengths in (K1) then stay far from the limits of float. Depths beyond a million units, or
/// next to the camera, are missing.
template <class Projection, class S>
struct DepthUnits {
  static constexpr bool at_depth = !std::same_as<Projection, PlatePitch>;

  explicit DepthUnits(const Projection& projection) {
    const double growth = checked_growth(projection);
    int exponent = 0;
    std::frexp(projection.pitch_mm, &exponent);
    const double unit_mm = std::ldexp(1.0, exponent);
    pitch = S(projection.pitch_mm / unit_mm);
    per_mm = S(1 / unit_mm);
    growth_per_unit = S(growth) * S(unit_mm);
    const double nearest = growth > 0 ? -0.99 / (growth * unit_mm) : -1e6;
    lowest = scalar_real_t<S>((std::max)(nearest, -1e6));
  }

  /// zeta, in units; NaN for what is missing.
  template <class V>
  [[gnu::always_inline]] V flattened(const V& depth_mm) const {
    const V l = depth_mm * per_mm;
    V zeta = l;
    if constexpr (at_depth) {
      zeta = l / (1 + growth_per_unit * l);
    }
    const V nan = V{} + not_a_number<S>();
    if constexpr (scalar<V>) {
      return value(l) > lowest && value(l) < highest ? zeta : nan;
    } else {
      return ((l > lowest) & (l < highest)) ? zeta : nan;
    }
  }

  /// 1 / (1 + c l).
  template <class V>
  [[gnu::always_inline]] V shrink(const V& zeta) const {
    if constexpr (at_depth) {
      return 1 - growth_per_unit * zeta;
    } else {
      return V{} + 1;
    }
  }

  S pitch;            ///< units per pixel
  S per_mm;           ///< units per mm
  S growth_per_unit;  ///< c
  scalar_real_t<S> lowest;
  scalar_real_t<S> highest = scalar_real_t<S>(1000000);
};

// Which projection of the curvature map belongs to a camera.

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
