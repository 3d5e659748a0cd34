// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A membrane triangle by the definition of its energy, as the reference of the cells of the
// traction field.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/force/traction.hpp"

namespace test {

using fingerpad::Point3;
using fingerpad::detail::traction::stress_free;
using fingerpad::detail::traction::StressFreeTriangle;
using fingerpad::detail::traction::Triangle;
using fingerpad::detail::traction::twice_area_vector;

/// |F|^2: the sum of the squares of the two principal stretches.
template <class S>
S stretch_sq_sum(const StressFreeTriangle<S>& free, const Triangle<S>& x) {
  S sum = S(0);
  for (std::size_t k = 0; k < 3; ++k) {
    const S edge_sq = squared_norm(x[(k + 2) % 3] - x[(k + 1) % 3]);
    sum = sum + free.half_cotangent[k] * edge_sq;
  }
  return S(sum / free.area_mm2);
}

/// Stored energy, N mm for mu t = 1 N/mm.
template <class S>
S stored_energy(const StressFreeTriangle<S>& free, const Triangle<S>& x) {
  using std::sqrt;
  const S area = S(0.5) * S(sqrt(squared_norm(twice_area_vector(x))));
  const S shrunk = free.area_mm2 / area;
  return S(S(0.5) * free.area_mm2 * (stretch_sq_sum(free, x) + shrunk * shrunk - S(3)));
}

/// Forces of the triangle on its corners, -d(energy)/dx, N for mu t = 1 N/mm. Their sum and their
/// moment are 0.
template <class S>
std::array<Point3<S>, 3> corner_forces(const StressFreeTriangle<S>& free, const Triangle<S>& x) {
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
