// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Rotations and poses in three dimensions, and the angles about z, y and x in which the papers
// state them. Source: Ito, Kim, Nagai, Obinata 2011, eq. 18: R = Rz(z) Ry(y) Rx(x). The slides
// compute y by asin first, which loses half the digits near 90 degrees and gives NaN if roundoff
// exceeds 1. Here every angle comes from atan2.
#include <cmath>

#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {

/// A 3x3 rotation matrix: x_now = R x_before. Indexed as m[row][col], identity by default.
template <scalar S = double>
struct Rotation {
  S m[3][3] = {{S(1), S(0), S(0)}, {S(0), S(1), S(0)}, {S(0), S(0), S(1)}};

  const S& operator()(Index row, Index col) const { return m[row][col]; }
  Point3<S> operator()(const Point3<S>& v) const {
    return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z,
            m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
            m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
  }
};

/// The inverse rotation: the transpose.
template <scalar S>
Rotation<S> inverse(const Rotation<S>& r) {
  return {{{r.m[0][0], r.m[1][0], r.m[2][0]},
           {r.m[0][1], r.m[1][1], r.m[2][1]},
           {r.m[0][2], r.m[1][2], r.m[2][2]}}};
}

/// Applies `first`, then `second`.
template <scalar S>
Rotation<S> operator*(const Rotation<S>& second, const Rotation<S>& first) {
  Rotation<S> product;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      product.m[i][j] = second.m[i][0] * first.m[0][j] + second.m[i][1] * first.m[1][j] +
                        second.m[i][2] * first.m[2][j];
    }
  }
  return product;
}

/// A rigid motion: x_now = R x_before + t, in mm in the sensor's frame.
template <scalar S = double>
struct Pose {
  Rotation<S> rotation = {};
  Point3<S> translation_mm = {S(0), S(0), S(0)};

  Point3<S> operator()(const Point3<S>& before) const { return rotation(before) + translation_mm; }
};

template <scalar S>
Pose<S> inverse(const Pose<S>& pose) {
  const Rotation<S> back = inverse(pose.rotation);
  return {back, -back(pose.translation_mm)};
}

/// Applies `first`, then `second`.
template <scalar S>
Pose<S> operator*(const Pose<S>& second, const Pose<S>& first) {
  return {second.rotation * first.rotation, second(first.translation_mm)};
}

/// Angles about the sensor's axes, in rad: R = Rz(z) Ry(y) Rx(x), x first. x and z in [-pi, pi],
/// y in [-pi/2, pi/2].
template <scalar S = double>
struct Angles {
  S x_rad = S(0);
  S y_rad = S(0);
  S z_rad = S(0);
};

/// The angles of a rotation. z is computed after x is undone, so that the angles reproduce R even
/// where x and z alone are ill-conditioned. In gimbal lock (y = +-90 degrees) only x -+ z is
/// defined; z is then 0.
template <scalar S>
Angles<S> zyx_angles(const Rotation<S>& r) {
  using std::atan2;
  using std::sqrt;
  const S cos_y = sqrt(r.m[2][1] * r.m[2][1] + r.m[2][2] * r.m[2][2]);
  const S y = atan2(-r.m[2][0], cos_y);
  if (!(value(cos_y) > 16 * epsilon<S>())) {
    return {atan2(-r.m[1][2], r.m[1][1]), y, S(0)};
  }
  const S sin_x = r.m[2][1] / cos_y;
  const S cos_x = r.m[2][2] / cos_y;
  const S sin_z = sin_x * r.m[0][2] - cos_x * r.m[0][1];
  const S cos_z = cos_x * r.m[1][1] - sin_x * r.m[1][2];
  return {atan2(r.m[2][1], r.m[2][2]), y, atan2(sin_z, cos_z)};
}

/// Rz(z) Ry(y) Rx(x).
template <scalar S>
Rotation<S> rotation_of(const Angles<S>& angles) {
  using std::cos;
  using std::sin;
  const S cx = cos(angles.x_rad), sx = sin(angles.x_rad);
  const S cy = cos(angles.y_rad), sy = sin(angles.y_rad);
  const S cz = cos(angles.z_rad), sz = sin(angles.z_rad);
  return {{{cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx},
           {sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx},
           {-sy, cy * sx, cy * cx}}};
}

/// The angle between two rotations, in rad: how far one must be rotated to become the other. It is
/// computed from its sine and its cosine, so that small angles keep their digits.
template <scalar S>
S angle_between(const Rotation<S>& a, const Rotation<S>& b) {
  using std::atan2;
  const Rotation<S> d = b * inverse(a);
  const Point3<S> twice_sine = {d.m[2][1] - d.m[1][2], d.m[0][2] - d.m[2][0],
                                d.m[1][0] - d.m[0][1]};
  return atan2(norm(twice_sine), d.m[0][0] + d.m[1][1] + d.m[2][2] - S(1));
}

}  // namespace v1
}  // namespace fingerpad
