// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A triangle of membrane, stretched alike all over: its energy and what it pulls its corners with.
// The membrane is incompressible and neo-Hookean; per stress-free area, with the surface
// deformation gradient F and J = det F,
//   W = (mu t / 2) (|F|^2 + J^-2 - 3).
// |F|^2 of a triangle is a sum over its edges, weighted with half the cotangents of the stress-free
// angles opposite to them; J is its area now by that without stress. So neither F nor a frame in
// the triangle's plane is needed. All energies and forces here are for mu t = 1 N/mm.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/core/detail/point_algebra.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// Corners in the order of the grid, or any other.
template <scalar S>
using Triangle = std::array<Point3<S>, 3>;

/// What the energy needs of a triangle without stress.
template <scalar S>
struct StressFreeTriangle {
  S area_mm2 = S(0);
  std::array<S, 3> half_cotangent = {S(0), S(0), S(0)};  ///< of the angle at each corner
};

/// Twice the area vector: normal to the triangle, by the order of its corners.
template <scalar S>
Point3<S> twice_area_vector(const Triangle<S>& x) {
  return cross(detail::difference(x[1], x[0]), detail::difference(x[2], x[0]));
}

/// The corners must not lie on a line.
template <scalar S>
StressFreeTriangle<S> stress_free(const Triangle<S>& corners_mm) {
  using std::sqrt;
  StressFreeTriangle<S> out;
  const S twice_area = sqrt(detail::length_sq(twice_area_vector(corners_mm)));
  out.area_mm2 = S(0.5) * twice_area;
  for (std::size_t k = 0; k < 3; ++k) {
    const Point3<S> to_next = detail::difference(corners_mm[(k + 1) % 3], corners_mm[k]);
    const Point3<S> to_last = detail::difference(corners_mm[(k + 2) % 3], corners_mm[k]);
    const S along = dot(to_next, to_last);
    out.half_cotangent[k] = S(0.5) * along / twice_area;
  }
  return out;
}

/// |F|^2: the sum of the squares of the two principal stretches.
template <scalar S>
S stretch_sq_sum(const StressFreeTriangle<S>& free, const Triangle<S>& x) {
  S sum = S(0);
  for (std::size_t k = 0; k < 3; ++k) {
    const S edge_sq = detail::length_sq(detail::difference(x[(k + 2) % 3], x[(k + 1) % 3]));
    sum = sum + free.half_cotangent[k] * edge_sq;
  }
  return S(sum / free.area_mm2);
}

/// Stored energy, N mm for mu t = 1 N/mm.
template <scalar S>
S stored_energy(const StressFreeTriangle<S>& free, const Triangle<S>& x) {
  using std::sqrt;
  const S area = S(0.5) * S(sqrt(detail::length_sq(twice_area_vector(x))));
  const S shrunk = free.area_mm2 / area;
  return S(S(0.5) * free.area_mm2 * (stretch_sq_sum(free, x) + shrunk * shrunk - S(3)));
}

/// What the triangle pulls its corners with, -d(energy)/dx, N for mu t = 1 N/mm. Their sum and
/// their moment are 0.
template <scalar S>
std::array<Point3<S>, 3> corner_forces(const StressFreeTriangle<S>& free, const Triangle<S>& x) {
  const Point3<S> doubled = twice_area_vector(x);
  const S shrunk_sq = S(4) * free.area_mm2 * free.area_mm2 / detail::length_sq(doubled);  // J^-2
  // dA/dx of a corner is half the opposite edge, turned about the normal
  const S resist = shrunk_sq * shrunk_sq / S(S(4) * free.area_mm2);
  std::array<Point3<S>, 3> force;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
    const Point3<S> to_next = detail::difference(x[next], x[k]);
    const Point3<S> to_last = detail::difference(x[last], x[k]);
    const Point3<S> turned = cross(doubled, detail::difference(x[last], x[next]));
    const Point3<S> pull = detail::moved(detail::scaled(free.half_cotangent[last], to_next),
                                         free.half_cotangent[next], to_last);
    force[k] = detail::moved(pull, resist, turned);
  }
  return force;
}

/// Force per length across a line normal to a principal direction, N/mm for mu t = 1 N/mm, from the
/// square of the stretch along it: an eigenvalue of (B - J^-2 P) / J.
template <scalar S>
S principal_tension(const S& stretch_sq, const S& area_ratio) {
  const S shrunk = S(1) / area_ratio;
  return S(shrunk * (stretch_sq - shrunk * shrunk));
}

}  // namespace v0
}  // namespace fingerpad
