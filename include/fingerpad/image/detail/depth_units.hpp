// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The distance between the points that neighbouring pixels see.
//
// Through a camera, this distance grows with the depth l, s = pitch (1 + c l), and a tilted plane
// seems to be concave, by 2 c slope^2 / ((1 + c l) (1 + slope^2)^(3/2)) in a section along the
// slope: 5e-3 per mm at a slope of 1/2. The substitution zeta = l / (1 + c l) removes both effects:
// it maps planes to planes for a camera at 1/c behind the plate, and
//   K = K of (K1) for radius r / (1 + c l) and depths zeta, over (1 + c l)^2
// on the axis. A flat section stays flat. Where K is not 0, its relative error is of the order of c
// times the slope times the distance from the axis. Refraction makes c smaller off the axis (by 3 %
// at 20 degrees), which leaves less than 5e-4 per mm on a plane of slope 1/2
// (tests/image/curvature.cpp).
#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/row_lanes.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Distance in mm between the points that neighbouring pixels see: pitch (1 + c l).
template <scalar T = double>
struct PixelPitch {
  T at_plate_mm;    ///< in [1e-9, 1e9]
  T growth_per_mm;  ///< c, in [0, 1e9]: 1 / virtual height of the camera on the axis

  PixelPitch<double> plain() const {
    return {static_cast<double>(value(at_plate_mm)), static_cast<double>(value(growth_per_mm))};
  }
  T at_depth(const T& depth_mm) const {
    return T(at_plate_mm * T(T(1) + growth_per_mm * depth_mm));
  }
};

template <scalar T>
PixelPitch<T> checked(const PixelPitch<T>& pitch) {
  const PixelPitch<double> plain = pitch.plain();
  expects(plain.at_plate_mm >= 1e-9 && plain.at_plate_mm <= 1e9, "CurvatureMap", "camera.pitch_mm",
          plain.at_plate_mm, "in [1e-9, 1e9]");
  expects(plain.growth_per_mm >= 0 && plain.growth_per_mm <= 1e9, "CurvatureMap",
          "growth of the pitch per mm", plain.growth_per_mm, "in [0, 1e9]");
  return pitch;
}

/// The scalar in which a pitch is computed: at least double.
template <scalar S>
using pitch_scalar_t = std::conditional_t<std::is_same_v<S, float>, double, S>;

template <scalar S>
auto pixel_pitch(const Camera<S>& camera) {
  using T = pitch_scalar_t<S>;
  const T pitch_mm = T(camera.pitch_mm), per_px = T(tangent_per_px(camera));
  const T growth = per_px / pitch_mm * tangent_ratio(T(0), T(camera.refractive_index));
  return checked(PixelPitch<T>{pitch_mm, growth});
}
template <scalar S>
auto pixel_pitch(const OrthographicCamera<S>& camera) {
  using T = pitch_scalar_t<S>;
  return checked(PixelPitch<T>{T(camera.pitch_mm), T(0)});
}

/// x converted to S, without its derivatives if S has none.
template <scalar S, scalar T>
S narrowed(const T& x) {
  if constexpr (std::is_constructible_v<S, T>) {
    return S(x);
  } else {
    return S(static_cast<double>(value(x)));
  }
}

template <class CameraType>
inline constexpr bool sees_perspective = true;
template <scalar S>
inline constexpr bool sees_perspective<OrthographicCamera<S>> = false;

/// Converts depths to units of about one pitch, so that the products of six lengths in (K1) stay
/// far from the limits of float. The unit is a power of two, so that nothing is rounded. Depths of
/// magnitude 4096 units or `too_deep_mm` or more, or next to the camera, count as missing.
template <class CameraType, class S>
struct DepthUnits {
  static constexpr bool at_depth = sees_perspective<CameraType>;

  template <scalar T>
  explicit DepthUnits(const PixelPitch<T>& pitch_mm,
                      double too_deep_mm = std::numeric_limits<double>::infinity()) {
    int exponent = 0;
    std::frexp(pitch_mm.plain().at_plate_mm, &exponent);
    const double unit_mm = std::ldexp(1.0, exponent);
    pitch = narrowed<S>(T(pitch_mm.at_plate_mm / T(unit_mm)));
    per_mm = S(1 / unit_mm);
    const double growth = pitch_mm.plain().growth_per_mm;
    growth_per_unit = narrowed<S>(pitch_mm.growth_per_mm) * S(unit_mm);
    const double farthest = (std::min)(too_deep_mm / unit_mm, 4096.0);
    const double nearest = growth > 0 ? -0.99 / (growth * unit_mm) : -farthest;
    lowest = scalar_real_t<S>((std::max)(nearest, -farthest));
    highest = scalar_real_t<S>(farthest);
  }

  /// zeta in units; NaN if the depth is missing.
  template <class V>
  [[gnu::always_inline]] V flattened(const V& depth_mm) const {
    const V l = depth_mm * per_mm;
    V zeta = l;
    if constexpr (at_depth) {
      zeta = l / (1 + growth_per_unit * l);
    }
    const V nan = every_lane<V>(not_a_number<S>());
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
      return every_lane<V>(S(1));
    }
  }

  S pitch;            ///< units per pixel
  S per_mm;           ///< units per mm
  S growth_per_unit;  ///< c
  scalar_real_t<S> lowest;
  scalar_real_t<S> highest;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
