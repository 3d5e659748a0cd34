// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The rigid motion that best maps one set of points to another in weighted least squares (Kabsch's
// problem), in Horn's form: the best rotation is the quaternion that is the eigenvector of the
// largest eigenvalue of a 4x4 matrix built from the cross-covariance. Only proper rotations are
// considered, so that no reflection has to be repaired.
#include <array>
#include <cstddef>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/math/rotation.hpp"

namespace fingerpad {
inline namespace v0 {

/// Limit for collinear points: if their spread across the line is below a tenth of that along it,
/// they do not determine a rotation.
inline constexpr double collinear_spread_sq = 0.01;

/// The best rigid motion, and whether the points determine it.
template <scalar S = double>
struct RigidFit {
  Pose<S> pose = {};
  bool determined = false;  ///< false: collinear points, or all equal; the pose is the identity
};

namespace detail::motion {

/// Rotation of a quaternion (w, x, y, z) of any length but 0.
template <scalar S>
Rotation<S> rotation_of_quaternion(const std::array<S, 4>& q) {
  const S two = S(2) / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const S xx = two * q[1] * q[1], yy = two * q[2] * q[2], zz = two * q[3] * q[3];
  const S xy = two * q[1] * q[2], xz = two * q[1] * q[3], yz = two * q[2] * q[3];
  const S wx = two * q[0] * q[1], wy = two * q[0] * q[2], wz = two * q[0] * q[3];
  return {{{S(1) - yy - zz, xy - wz, xz + wy},
           {xy + wz, S(1) - xx - zz, yz - wx},
           {xz - wy, yz + wx, S(1) - xx - yy}}};
}

/// The rotation that best maps `from` to `to`, from their cross-covariance about the two centers,
/// c[i][j] = sum of weight from_i to_j. Returns false if the points do not determine it. With
/// singular values s1 >= s2 >= |s3| of c (s3 < 0 if a reflection would fit better), it is
/// determined if
///   (s2 + s3) (s1 + s3) (s1 + s2) / (s1 + s2 + s3)^3 > collinear_spread_sq,
/// where the left side is 1/4 for a flat disc and s2 / s1 for points near a line. Horn's
/// eigenvalues are s1 + s2 + s3 and those with two of the signs turned. O(1).
template <scalar S>
bool best_rotation(const SmallMatrix<S, 3>& c, Rotation<S>& rotation) {
  const S yz = c[1][2] - c[2][1], zx = c[2][0] - c[0][2], xy = c[0][1] - c[1][0];
  const S yz2 = c[1][2] + c[2][1], zx2 = c[2][0] + c[0][2], xy2 = c[0][1] + c[1][0];
  SmallMatrix<S, 4> horn = {{{c[0][0] + c[1][1] + c[2][2], yz, zx, xy},
                             {yz, c[0][0] - c[1][1] - c[2][2], xy2, zx2},
                             {zx, xy2, c[1][1] - c[0][0] - c[2][2], yz2},
                             {xy, zx2, yz2, c[2][2] - c[0][0] - c[1][1]}}};
  const SmallMatrix<S, 4> vectors = diagonalise(horn);
  std::size_t best = 0;
  for (std::size_t k = 1; k < 4; ++k) {
    best = value(horn[best][best]) < value(horn[k][k]) ? k : best;
  }
  scalar_real_t<S> gaps(1);
  for (std::size_t k = 0; k < 4; ++k) {
    gaps = k == best ? gaps : gaps * (1 - value(horn[k][k]) / value(horn[best][best]));
  }
  if (!(value(horn[best][best]) > 0 && gaps > scalar_real_t<S>(8 * collinear_spread_sq))) {
    return false;
  }
  rotation = rotation_of_quaternion(vectors[best]);
  return true;
}

}  // namespace detail::motion

/// The best rigid motion of count points. from(k) and to(k) are points, weight(k) >= 0.
/// O(count), no allocation.
template <scalar S, class From, class To, class Weight>
RigidFit<S> fit_rigid(Index count, const From& from, const To& to, const Weight& weight) {
  S mass = S(0);
  Point3<S> from_center = {S(0), S(0), S(0)}, to_center = from_center;
  for (Index k = 0; k < count; ++k) {
    const S w = weight(k);
    mass = mass + w;
    from_center += w * Point3<S>(from(k));
    to_center += w * Point3<S>(to(k));
  }
  if (!(value(mass) > 0)) {
    return {};
  }
  from_center = S(1) / mass * from_center;
  to_center = S(1) / mass * to_center;

  auto covariance = detail::zero_matrix<S, 3>();
  S from_sq = S(0), to_sq = S(0);
  for (Index k = 0; k < count; ++k) {
    const Point3<S> a = Point3<S>(from(k)) - from_center;
    const Point3<S> b = Point3<S>(to(k)) - to_center;
    const Point3<S> wa = S(weight(k)) * a;
    from_sq = from_sq + dot(wa, a);
    to_sq = to_sq + S(weight(k)) * squared_norm(b);
    const S across[3] = {wa.x, wa.y, wa.z};
    for (std::size_t i = 0; i < 3; ++i) {
      covariance[i][0] = covariance[i][0] + across[i] * b.x;
      covariance[i][1] = covariance[i][1] + across[i] * b.y;
      covariance[i][2] = covariance[i][2] + across[i] * b.z;
    }
  }
  // A spread within the roundoff of the coordinates does not count.
  const auto is_roundoff = [&](const S& spread_sq, const Point3<S>& center) {
    const scalar_real_t<S> tiny = 64 * epsilon<S>();
    return !(value(spread_sq) > tiny * tiny * value(mass * squared_norm(center)));
  };
  RigidFit<S> fit;
  fit.determined = !is_roundoff(from_sq, from_center) && !is_roundoff(to_sq, to_center) &&
                   detail::motion::best_rotation(covariance, fit.pose.rotation);
  if (fit.determined) {
    fit.pose.translation_mm = to_center - fit.pose.rotation(from_center);
  }
  return fit;
}

}  // namespace v0
}  // namespace fingerpad
