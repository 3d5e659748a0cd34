// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The law of the rubber: what a sheet pulls with when it is stretched. Everything here is per
// modulus and thickness, mu t, and per stress-free length. Mooney-Rivlin with one number, the share
// m = C2 / (C1 + C2); 0 is neo-Hookean.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {

/// Pull across the direction of `other`, dW/d(along). `along` and `other` are derivatives of the
/// position along two directions that are perpendicular unit vectors without stress. With
/// J^2 = |along x other|^2,
///   W / (mu t) = (1 - m) / 2 (|along|^2 + |other|^2 + J^-2 - 3)
///              + m / 2 ((|along|^2 + |other|^2) J^-2 + J^2 - 3).
template <scalar S>
Point3<S> rubber_pull(const Point3<S>& along, const Point3<S>& other, const S& mooney_share) {
  const S a = squared_norm(along), b = squared_norm(other), c = dot(along, other);
  const S inverse = S(1) / (a * b - c * c);
  const S neo_hookean = S(1) - mooney_share;
  const S by_area = mooney_share - (neo_hookean + mooney_share * (a + b)) * inverse * inverse;
  return (neo_hookean + mooney_share * inverse) * along + by_area * (b * along - c * other);
}

/// The same for two principal stretches: the pull along the first.
template <scalar S>
S rubber_pull(const S& along, const S& other, const S& mooney_share) {
  const S sq = other * other;
  return (along - S(1) / (along * along * along * sq)) * (S(1) - mooney_share + mooney_share * sq);
}

namespace detail::membrane {

template <scalar S>
using Matrix3 = std::array<std::array<S, 3>, 3>;

/// Derivatives of rubber_pull by its two vectors.
template <scalar S>
struct PullSlopes {
  Matrix3<S> by_along, by_other;
};

template <scalar S>
PullSlopes<S> pull_slopes(const Point3<S>& along, const Point3<S>& other, const S& m) {
  const S a = squared_norm(along), b = squared_norm(other), c = dot(along, other);
  const S inverse = S(1) / (a * b - c * c), squared = inverse * inverse;
  const S neo_hookean = S(1) - m;
  const S by_area = m - (neo_hookean + m * (a + b)) * squared;
  const S rise = S(4) * (neo_hookean + m * (a + b)) * squared * inverse;
  // half the derivatives of J^2
  const Point3<S> n = b * along - c * other, k = a * other - c * along;
  const auto parts = [](const Point3<S>& p) { return std::array<S, 3>{p.x, p.y, p.z}; };
  const auto u = parts(along), v = parts(other), nu = parts(n), kv = parts(k);
  PullSlopes<S> slope;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const S same = S(i == j ? 1 : 0);
      slope.by_along[i][j] = (neo_hookean + m * inverse + by_area * b) * same -
                             S(2) * m * squared * (u[i] * nu[j] + nu[i] * u[j]) +
                             rise * nu[i] * nu[j] - by_area * v[i] * v[j];
      slope.by_other[i][j] = -S(2) * m * squared * (u[i] * kv[j] + nu[i] * v[j]) +
                             rise * nu[i] * kv[j] +
                             by_area * (S(2) * u[i] * v[j] - v[i] * u[j] - c * same);
    }
  }
  return slope;
}

/// The vector `along` whose pull is `pull`: the inverse of rubber_pull. Along `other` the law is
/// linear but for J^2; across it, the part c of `along` solves
///   q = (1 - m) (c - c^-3 / b) + m (b c - (s^2 + b) c^-3 / b),   b = |other|^2,
/// by Newton's method from `across`, which is set to c.
template <scalar S>
Point3<S> stretch_of_pull(const Point3<S>& pull, const Point3<S>& other, const S& m, S& across) {
  using std::sqrt;
  const S b = squared_norm(other), along = dot(pull, other);
  const Point3<S> normal = pull - (along / b) * other;
  const S q = norm(normal);
  const S neo_hookean = S(1) - m;
  S c = across, shear = S(0);
  for (int step = 0; step < 8; ++step) {
    const S inverse = S(1) / c, cubed = inverse * inverse * inverse / b;
    shear = along / (neo_hookean + m * inverse * inverse / b);
    const S excess = neo_hookean + m * (shear * shear / b + b);
    const S miss = neo_hookean * c + m * b * c - excess * cubed - q;
    const S change = miss / (neo_hookean + m * b + S(3) * excess * cubed * inverse);
    c = value(c - change) > scalar_real_t<S>(0.4) ? c - change : S(0.4);
    if (value(change * change) <= square(S(4) * epsilon<S>())) {
      break;
    }
  }
  across = c;
  return (shear / b) * other + (c / q) * normal;
}

}  // namespace detail::membrane
}  // namespace v1
}  // namespace fingerpad
