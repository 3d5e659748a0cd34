// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The rigid motion that best maps one set of points to another in weighted least squares (Kabsch's
// problem). It is solved in Horn's form: the best rotation is the quaternion that is the
// eigenvector of the largest eigenvalue of a 4x4 matrix built from the cross-covariance. Only
// proper rotations are considered, so that no reflection has to be repaired. No singular vectors
// are needed: Newton's method finds the eigenvalue and the adjugate the eigenvector, for every
// scalar.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/rotation.hpp"

namespace fingerpad {
inline namespace v0 {

/// Limit for collinear points: if their spread across the line is below a tenth of that along it,
/// they do not determine a rotation.
inline constexpr double collinear_spread_sq = 0.01;

namespace detail::motion {

template <scalar S>
using Matrix4 = std::array<std::array<S, 4>, 4>;

/// Horn's matrix of a cross-covariance c[i][j] = sum of weight from_i to_j.
template <scalar S>
Matrix4<S> horn_matrix(const S (&c)[3][3]) {
  const S yz = c[1][2] - c[2][1];
  const S zx = c[2][0] - c[0][2];
  const S xy = c[0][1] - c[1][0];
  const S xy2 = c[0][1] + c[1][0];
  const S zx2 = c[2][0] + c[0][2];
  const S yz2 = c[1][2] + c[2][1];
  return {{{S(c[0][0] + c[1][1] + c[2][2]), yz, zx, xy},
           {yz, S(c[0][0] - c[1][1] - c[2][2]), xy2, zx2},
           {zx, xy2, S(c[1][1] - c[0][0] - c[2][2]), yz2},
           {xy, zx2, yz2, S(c[2][2] - c[0][0] - c[1][1])}}};
}

/// Determinants of the 2x2 blocks of two rows, from which determinants and adjugates are built.
template <scalar S>
std::array<S, 6> minors(const std::array<S, 4>& a, const std::array<S, 4>& b) {
  return {S(a[0] * b[1] - b[0] * a[1]), S(a[0] * b[2] - b[0] * a[2]), S(a[0] * b[3] - b[0] * a[3]),
          S(a[1] * b[2] - b[1] * a[2]), S(a[1] * b[3] - b[1] * a[3]), S(a[2] * b[3] - b[2] * a[3])};
}

template <scalar S>
S determinant(const Matrix4<S>& a) {
  const std::array<S, 6> s = minors(a[0], a[1]);
  const std::array<S, 6> c = minors(a[2], a[3]);
  return S(s[0] * c[5] - s[1] * c[4] + s[2] * c[3] + s[3] * c[2] - s[4] * c[1] + s[5] * c[0]);
}

/// Adjugate of a symmetric matrix. If the matrix is singular with null vector v, it is a multiple
/// of v v^T.
template <scalar S>
Matrix4<S> symmetric_adjugate(const Matrix4<S>& a) {
  const std::array<S, 6> s = minors(a[0], a[1]);
  const std::array<S, 6> c = minors(a[2], a[3]);
  const S b01 = a[0][2] * c[4] - a[0][1] * c[5] - a[0][3] * c[3];
  const S b02 = a[3][1] * s[5] - a[3][2] * s[4] + a[3][3] * s[3];
  const S b03 = a[2][2] * s[4] - a[2][1] * s[5] - a[2][3] * s[3];
  const S b12 = a[3][2] * s[2] - a[3][0] * s[5] - a[3][3] * s[1];
  const S b13 = a[2][0] * s[5] - a[2][2] * s[2] + a[2][3] * s[1];
  const S b23 = a[2][1] * s[2] - a[2][0] * s[4] - a[2][3] * s[0];
  return {{{S(a[1][1] * c[5] - a[1][2] * c[4] + a[1][3] * c[3]), b01, b02, b03},
           {b01, S(a[0][0] * c[5] - a[0][2] * c[2] + a[0][3] * c[1]), b12, b13},
           {b02, b12, S(a[3][0] * s[4] - a[3][1] * s[2] + a[3][3] * s[0]), b23},
           {b03, b13, b23, S(a[2][0] * s[3] - a[2][1] * s[1] + a[2][2] * s[0])}}};
}

/// Rotation of a quaternion (w, x, y, z) of any length but 0.
template <scalar S>
Rotation<S> rotation_of_quaternion(const std::array<S, 4>& q) {
  const S norm_sq = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  const S two = S(2) / norm_sq;
  const S xx = two * q[1] * q[1], yy = two * q[2] * q[2], zz = two * q[3] * q[3];
  const S xy = two * q[1] * q[2], xz = two * q[1] * q[3], yz = two * q[2] * q[3];
  const S wx = two * q[0] * q[1], wy = two * q[0] * q[2], wz = two * q[0] * q[3];
  return {{{S(S(1) - yy - zz), S(xy - wz), S(xz + wy)},
           {S(xy + wz), S(S(1) - xx - zz), S(yz - wx)},
           {S(xz - wy), S(yz + wx), S(S(1) - xx - yy)}}};
}

/// Largest root of l^4 + c2 l^2 + c1 l + c0, all of whose roots are real, by Newton's method from
/// above, which descends to the root without overshooting.
template <scalar S>
S largest_root(const S& c2, const S& c1, const S& c0, const S& above) {
  S l = above;
  for (int step = 0; step < 60; ++step) {
    const S l_sq = l * l;
    const S slope = (S(4) * l_sq + S(2) * c2) * l + c1;
    if (!(value(slope) > 0)) {
      break;  // a double root, reached up to roundoff
    }
    const S change = ((l_sq + c2) * l_sq + c1 * l + c0) / slope;
    l = l - change;
    const scalar_real_t<S> size = value(change) < 0 ? -value(change) : value(change);
    if (!(size > 4 * epsilon<S>() * value(l))) {
      break;
    }
  }
  return l;
}

/// The rotation that best maps `from` to `to`, from their cross-covariance about the two centers
/// and the sums of squares of both. Returns false if the points do not determine it. With singular
/// values s1 >= s2 >= |s3| of the cross-covariance (s3 < 0 if a reflection would fit better), it is
/// determined if
///   (s2 + s3) (s1 + s3) (s1 + s2) / (s1 + s2 + s3)^3 >= collinear_spread_sq,
/// where the left side is 1/4 for a flat disc and s2 / s1 for points near a line. O(1).
template <scalar S>
bool best_rotation(const S (&covariance)[3][3],
                   const S& from_sq,
                   const S& to_sq,
                   Rotation<S>& rotation) {
  using std::sqrt;
  S sum_sq = S(0);
  for (const auto& row : covariance) {
    sum_sq = sum_sq + row[0] * row[0] + row[1] * row[1] + row[2] * row[2];
  }
  if (!(value(sum_sq) > 0)) {
    return false;
  }
  const S norm = sqrt(sum_sq);
  S c[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      c[i][j] = covariance[i][j] / norm;
    }
  }
  const S det = c[0][0] * (c[1][1] * c[2][2] - c[1][2] * c[2][1]) -
                c[0][1] * (c[1][0] * c[2][2] - c[1][2] * c[2][0]) +
                c[0][2] * (c[1][0] * c[2][1] - c[1][1] * c[2][0]);
  detail::motion::Matrix4<S> horn = detail::motion::horn_matrix(c);
  // Both are upper bounds of the sum of singular values; rigid motions nearly reach the first.
  const S of_spreads = (from_sq + to_sq) / (S(2) * norm);
  const S of_norm = sqrt(S(3));
  const S above = value(of_spreads) < value(of_norm) ? of_spreads : of_norm;
  const S largest =
      detail::motion::largest_root(S(-2), S(S(-8) * det), detail::motion::determinant(horn), above);
  for (std::size_t i = 0; i < 4; ++i) {
    horn[i][i] = horn[i][i] - largest;
  }
  const detail::motion::Matrix4<S> adjugate = detail::motion::symmetric_adjugate(horn);
  std::size_t best = 0;
  for (std::size_t i = 1; i < 4; ++i) {
    best = value(adjugate[i][i]) < value(adjugate[best][best]) ? i : best;
  }
  const S gaps = S(0) - adjugate[0][0] - adjugate[1][1] - adjugate[2][2] - adjugate[3][3];
  const S limit = S(8 * collinear_spread_sq) * largest * largest * largest;
  if (!(value(gaps) > value(limit))) {
    return false;
  }
  rotation = detail::motion::rotation_of_quaternion(adjugate[best]);
  return true;
}

}  // namespace detail::motion

/// The best rigid motion, and whether the points determine it.
template <scalar S = double>
struct RigidFit {
  Pose<S> pose = {};
  bool determined = false;  ///< false: collinear points, or all equal; the pose is the identity
};

/// The best rigid motion of count points. from(k) and to(k) are points, weight(k) >= 0.
/// O(count), no allocation.
template <scalar S, class From, class To, class Weight>
RigidFit<S> fit_rigid(Index count, const From& from, const To& to, const Weight& weight) {
  S mass = S(0);
  Point3<S> from_center = {S(0), S(0), S(0)};
  Point3<S> to_center = from_center;
  for (Index k = 0; k < count; ++k) {
    const S w = weight(k);
    mass = mass + w;
    from_center = from_center + (w * Point3<S>(from(k)));
    to_center = to_center + (w * Point3<S>(to(k)));
  }
  if (!(value(mass) > 0)) {
    return {};
  }
  from_center = S(S(1) / mass) * from_center;
  to_center = S(S(1) / mass) * to_center;

  S covariance[3][3] = {{S(0), S(0), S(0)}, {S(0), S(0), S(0)}, {S(0), S(0), S(0)}};
  S from_sq = S(0);
  S to_sq = S(0);
  for (Index k = 0; k < count; ++k) {
    const S w = weight(k);
    const Point3<S> a = (Point3<S>(from(k))) - from_center;
    const Point3<S> b = (Point3<S>(to(k))) - to_center;
    const Point3<S> wa = w * a;
    from_sq = from_sq + dot(wa, a);
    to_sq = to_sq + w * squared_norm(b);
    covariance[0][0] = covariance[0][0] + wa.x * b.x;
    covariance[0][1] = covariance[0][1] + wa.x * b.y;
    covariance[0][2] = covariance[0][2] + wa.x * b.z;
    covariance[1][0] = covariance[1][0] + wa.y * b.x;
    covariance[1][1] = covariance[1][1] + wa.y * b.y;
    covariance[1][2] = covariance[1][2] + wa.y * b.z;
    covariance[2][0] = covariance[2][0] + wa.z * b.x;
    covariance[2][1] = covariance[2][1] + wa.z * b.y;
    covariance[2][2] = covariance[2][2] + wa.z * b.z;
  }
  // A spread within the roundoff of the coordinates does not count.
  const auto is_roundoff = [&](const S& spread_sq, const Point3<S>& center) {
    const scalar_real_t<S> tiny = 64 * epsilon<S>();
    return !(value(spread_sq) > tiny * tiny * value(S(mass * squared_norm(center))));
  };
  RigidFit<S> fit;
  fit.determined = !is_roundoff(from_sq, from_center) && !is_roundoff(to_sq, to_center) &&
                   detail::motion::best_rotation(covariance, from_sq, to_sq, fit.pose.rotation);
  if (fit.determined) {
    fit.pose.translation_mm = to_center - fit.pose.rotation(from_center);
  }
  return fit;
}

}  // namespace v0
}  // namespace fingerpad
