// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The rigid motion that best maps one set of points to another in weighted least squares (Kabsch's
// problem), in Horn's form: the best rotation is the quaternion that is the eigenvector of the
// largest eigenvalue of a 4x4 matrix built from the cross-covariance. Only proper rotations are
// considered, so that no reflection has to be repaired.
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/math/rotation.hpp"

namespace fingerpad {
inline namespace v1 {

/// Limit for collinear points: if their spread across the line is below a tenth of that along it,
/// they do not determine a rotation.
inline constexpr double collinear_spread_sq = 0.01;

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

/// Eigenvector of the largest eigenvalue of a symmetric positive semidefinite matrix, by squaring
/// it: twenty times are enough for fifty digits if that eigenvalue stands out by 1/2000.
template <scalar S>
std::array<S, 4> dominant_vector(SmallMatrix<S, 4> a) {
  for (int step = 0; step < 20; ++step) {
    const SmallMatrix<S, 4> b = a;
    const S trace = b[0][0] + b[1][1] + b[2][2] + b[3][3];
    // the square of a matrix of trace 1 has trace 1 - 2 m if the other eigenvalues add up to m,
    // which in the square add up to at most m^2
    if (step > 0 && square(1 - value(trace)) <= epsilon<S>() / 16) {
      break;
    }
    const S scale = S(1) / square(trace);
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        a[i][j] =
            scale * (b[i][0] * b[j][0] + b[i][1] * b[j][1] + b[i][2] * b[j][2] + b[i][3] * b[j][3]);
        a[j][i] = a[i][j];
      }
    }
  }
  std::size_t best = 0;
  for (std::size_t k = 1; k < 4; ++k) {
    best = value(a[best][best]) < value(a[k][k]) ? k : best;
  }
  return a[best];
}

/// The rotation that best maps `from` to `to`, from their cross-covariance about the two centers:
/// row x is sum of weight from.x to, and so on. Empty if the points do not determine it.
/// With singular values s1 >= s2 >= |s3| of the rows (s3 < 0 if a reflection would fit better), it
/// is determined if
///   (s2 + s3) (s1 + s3) (s1 + s2) / (s1 + s2 + s3)^3 > collinear_spread_sq,
/// where the left side is 1/4 for a flat disc and s2 / s1 for points near a line. O(1).
template <scalar S>
std::optional<Rotation<S>> best_rotation(const Point3<S>& x,
                                         const Point3<S>& y,
                                         const Point3<S>& z) {
  using std::sqrt;
  const S size_sq = squared_norm(x) + squared_norm(y) + squared_norm(z);
  const S above = sqrt(S(3) * size_sq);  // no eigenvalue of Horn's matrix is below -above
  const S yz = y.z - z.y, zx = z.x - x.z, xy = x.y - y.x;
  const S yz2 = y.z + z.y, zx2 = z.x + x.z, xy2 = x.y + y.x;
  const Rotation<S> best =
      rotation_of_quaternion(dominant_vector<S>({{{above + x.x + y.y + z.z, yz, zx, xy},
                                                  {yz, above + x.x - y.y - z.z, xy2, zx2},
                                                  {zx, xy2, above + y.y - x.x - z.z, yz2},
                                                  {xy, zx2, yz2, above + z.z - x.x - y.y}}}));
  const Rotation<S> back = inverse(best);
  const auto row = [&](int k) { return Point3<S>{back.m[k][0], back.m[k][1], back.m[k][2]}; };
  const S largest = dot(x, row(0)) + dot(y, row(1)) + dot(z, row(2));  // eigenvalue
  // Product of its distances to the others: slope of l^4 - 2 size^2 l^2 - 8 det l + ...
  const S gaps = S(4) * largest * (square(largest) - size_sq) - S(8) * dot(x, cross(y, z));
  if (!(value(gaps) > value(S(8 * collinear_spread_sq) * largest * square(largest)))) {
    return {};
  }
  return best;
}

}  // namespace detail::motion

/// The best rigid motion of count points; empty if they do not determine it: on a line, or all
/// equal. from(k) and to(k) are points, weight(k) >= 0. O(count), no allocation.
template <scalar S, class From, class To, class Weight>
std::optional<Pose<S>> fit_rigid(Index count,
                                 const From& from,
                                 const To& to,
                                 const Weight& weight) {
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
  const S per_mass = S(1) / mass;
  from_center = per_mass * from_center;
  to_center = per_mass * to_center;
  Point3<S> x = {S(0), S(0), S(0)}, y = x, z = x;  // rows of the cross-covariance
  S from_sq = S(0), to_sq = S(0);
  for (Index k = 0; k < count; ++k) {
    const S share = per_mass * S(weight(k));
    const Point3<S> a = Point3<S>(from(k)) - from_center, b = Point3<S>(to(k)) - to_center;
    const Point3<S> shared = share * a;
    from_sq = from_sq + dot(shared, a);
    to_sq = to_sq + share * squared_norm(b);
    x = x + shared.x * b;
    y = y + shared.y * b;
    z = z + shared.z * b;
  }
  // A spread within the roundoff of the coordinates does not count.
  const auto is_roundoff = [&](const S& spread_sq, const Point3<S>& center) {
    const scalar_real_t<S> tiny = 64 * epsilon<S>();
    return !(value(spread_sq) > tiny * tiny * value(squared_norm(center)));
  };
  if (is_roundoff(from_sq, from_center) || is_roundoff(to_sq, to_center)) {
    return {};
  }
  const std::optional<Rotation<S>> best = detail::motion::best_rotation(x, y, z);
  if (!best) {
    return {};
  }
  return Pose<S>{*best, to_center - (*best)(from_center)};
}

}  // namespace v1
}  // namespace fingerpad
