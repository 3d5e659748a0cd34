// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A membrane triangle by the definition of its energy, as the reference of the traction field.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace test {

using fingerpad::Point3;

template <class S>
using Corners = std::array<Point3<S>, 3>;

/// Normal to the triangle, with the sense of its corners.
template <class S>
Point3<S> twice_area_vector(const Corners<S>& x) {
  return cross(x[1] - x[0], x[2] - x[0]);
}

/// A triangle without stress.
template <class S>
struct FreeTriangle {
  S area_mm2 = S(0);
  std::array<S, 3> half_cotangent = {S(0), S(0), S(0)};  ///< of the angle at each corner
};
template <class S>
FreeTriangle<S> stress_free(const Corners<S>& x) {
  using std::sqrt;
  const S twice_area = S(sqrt(squared_norm(twice_area_vector(x))));
  FreeTriangle<S> out;
  out.area_mm2 = S(0.5) * twice_area;
  for (std::size_t k = 0; k < 3; ++k) {
    const S along = dot(x[(k + 1) % 3] - x[k], x[(k + 2) % 3] - x[k]);
    out.half_cotangent[k] = S(0.5) * along / twice_area;
  }
  return out;
}

/// |F|^2: the sum of the squares of the two principal stretches.
template <class S>
S stretch_sq_sum(const FreeTriangle<S>& free, const Corners<S>& x) {
  S sum = S(0);
  for (std::size_t k = 0; k < 3; ++k) {
    const S edge_sq = squared_norm(x[(k + 2) % 3] - x[(k + 1) % 3]);
    sum = sum + free.half_cotangent[k] * edge_sq;
  }
  return S(sum / free.area_mm2);
}

/// Stored energy, N mm for mu t = 1 N/mm.
template <class S>
S stored_energy(const FreeTriangle<S>& free, const Corners<S>& x) {
  using std::sqrt;
  const S area = S(0.5) * S(sqrt(squared_norm(twice_area_vector(x))));
  const S shrunk = free.area_mm2 / area;
  return S(S(0.5) * free.area_mm2 * (stretch_sq_sum(free, x) + shrunk * shrunk - S(3)));
}

/// Forces of the triangle on its corners, -d(energy)/dx, N for mu t = 1 N/mm. Their sum and their
/// moment are 0.
template <class S>
std::array<Point3<S>, 3> corner_forces(const FreeTriangle<S>& free, const Corners<S>& x) {
  const Point3<S> doubled = twice_area_vector(x);
  const S shrunk_sq = S(4) * free.area_mm2 * free.area_mm2 / squared_norm(doubled);  // J^-2
  // dA/dx of a corner is half the opposite edge, rotated about the normal
  const S resist = shrunk_sq * shrunk_sq / S(S(4) * free.area_mm2);
  std::array<Point3<S>, 3> force;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
    const Point3<S> to_next = x[next] - x[k];
    const Point3<S> to_last = x[last] - x[k];
    const Point3<S> rotated = cross(doubled, x[last] - x[next]);
    const Point3<S> pull =
        free.half_cotangent[last] * to_next + free.half_cotangent[next] * to_last;
    force[k] = pull + resist * rotated;
  }
  return force;
}

}  // namespace test
