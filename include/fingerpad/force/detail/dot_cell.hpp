// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A cell of the dot grid: four dots and the membrane between them. Each of its two diagonals
// divides it into two triangles. Its energy is the mean over both diagonals, so that none is
// preferred.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::traction {

// Energy and corner forces of a uniformly stretched triangle of membrane. The membrane is
// incompressible and neo-Hookean. Per stress-free area, with the surface deformation gradient F and
// J = det F,
//   W = (mu t / 2) (|F|^2 + J^-2 - 3).
// |F|^2 of a triangle is a sum over its edges, weighted with half the cotangents of the stress-free
// angles opposite to them. J is its area over its stress-free area. Neither F nor a frame in the
// triangle's plane is therefore needed. All energies and forces here are for mu t = 1 N/mm.

/// Corners in the order of the grid, or any other.
template <scalar S>
using Triangle = std::array<Point3<S>, 3>;

/// Properties of a stress-free triangle for the energy.
template <scalar S>
struct StressFreeTriangle {
  S area_mm2 = S(0);
  std::array<S, 3> half_cotangent = {S(0), S(0), S(0)};  ///< of the angle at each corner
};

/// Twice the area vector: normal to the triangle, with the sense of its corners.
template <scalar S>
Point3<S> twice_area_vector(const Triangle<S>& x) {
  return cross(x[1] - x[0], x[2] - x[0]);
}

/// The corners must not lie on a line.
template <scalar S>
StressFreeTriangle<S> stress_free(const Triangle<S>& corners_mm) {
  using std::sqrt;
  StressFreeTriangle<S> out;
  const S twice_area = sqrt(squared_norm(twice_area_vector(corners_mm)));
  out.area_mm2 = S(0.5) * twice_area;
  for (std::size_t k = 0; k < 3; ++k) {
    const Point3<S> to_next = corners_mm[(k + 1) % 3] - corners_mm[k];
    const Point3<S> to_last = corners_mm[(k + 2) % 3] - corners_mm[k];
    const S along = dot(to_next, to_last);
    out.half_cotangent[k] = S(0.5) * along / twice_area;
  }
  return out;
}

/// Force per length across a line normal to a principal direction, N/mm for mu t = 1 N/mm, from the
/// square of the stretch along it: an eigenvalue of (B - J^-2 P) / J.
template <scalar S>
S principal_tension(const S& stretch_sq, const S& area_ratio) {
  const S shrunk = S(1) / area_ratio;
  return S(shrunk * (stretch_sq - shrunk * shrunk));
}

/// The principal tensions in a cell, N/mm. Below 0 the membrane is slack and would wrinkle.
template <scalar S>
struct CellTension {
  S larger = not_a_number<S>();
  S smaller = not_a_number<S>();
  Point3<S> direction = detail::missing_point<S>();  ///< unit vector of the larger one
};

/// In the order around the cell: (row, col), (row, col + 1), (row + 1, col + 1), (row + 1, col).
template <scalar S>
using Corners = std::array<Point3<S>, 4>;

/// The triangle of a corner with the corner before and after it. The four ears are the triangles of
/// both diagonals: ears 1 and 3 share one diagonal, ears 0 and 2 the other.
template <scalar S>
Triangle<S> ear(const Corners<S>& x, std::size_t corner) {
  return {x[(corner + 3) % 4], x[corner], x[(corner + 1) % 4]};
}

/// The two directions of the grid in the middle of a cell.
template <scalar S>
struct CellTangents {
  Point3<S> along_row;
  Point3<S> along_col;

  explicit CellTangents(const Corners<S>& x)
      : along_row(S(0.5) * (x[1] - x[0] + x[2] - x[3])),
        along_col(S(0.5) * (x[3] - x[0] + x[2] - x[1])) {}
};

/// Properties of a cell without stress.
template <scalar S>
struct StressFreeCell {
  bool usable = false;  ///< all four dots exist, and no triangle is degenerate
  std::array<StressFreeTriangle<S>, 4> ear = {};
  std::array<S, 4> side_stiffness = {S(0), S(0), S(0), S(0)};  ///< from corner k to the next one
  std::array<S, 2> diagonal_stiffness = {S(0), S(0)};          ///< from corner k to k + 2
  /// Map from the tangents of the grid to an orthonormal pair in the cell's plane: column 1 of the
  /// inverse is {to_first, 0}, column 2 {shear, to_second}.
  S to_first = S(0), shear = S(0), to_second = S(0);
  S upward = S(0);  ///< z of along_row x along_col: normal times area

  StressFreeCell() = default;
  explicit StressFreeCell(const Corners<S>& x) {
    using std::sqrt;
    for (std::size_t t = 0; t < 4; ++t) {
      const Triangle<S> corners = traction::ear(x, t);
      S longest_sq = S(0);
      for (std::size_t k = 0; k < 3; ++k) {
        const S edge_sq = squared_norm(corners[(k + 1) % 3] - corners[k]);
        longest_sq = longest_sq < edge_sq ? edge_sq : longest_sq;
      }
      const S doubled_sq = squared_norm(twice_area_vector(corners));
      // a triangle flatter than 1 : 1000 is degenerate; false for NaN
      if (!(value(doubled_sq) > value(S(S(1e-6) * longest_sq * longest_sq)))) {
        return;
      }
      ear[t] = stress_free(corners);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const S here = ear[k].half_cotangent[0], there = ear[(k + 1) % 4].half_cotangent[2];
      side_stiffness[k] = S(0.5) * (here + there);
    }
    for (std::size_t k = 0; k < 2; ++k) {
      const S here = ear[k + 1].half_cotangent[1], there = ear[(k + 3) % 4].half_cotangent[1];
      diagonal_stiffness[k] = S(0.5) * (here + there);
    }
    const CellTangents<S> g(x);
    const S first = sqrt(squared_norm(g.along_row));
    const S slant = dot(g.along_row, g.along_col) / first;
    const S second_sq = squared_norm(g.along_col) - slant * slant;
    if (!(value(first) > 0) || !(value(second_sq) > 0)) {
      return;
    }
    const S second = sqrt(second_sq);
    to_first = S(1) / first;
    to_second = S(1) / second;
    shear = -slant / (first * second);
    upward = cross(g.along_row, g.along_col).z;
    usable = is_finite(to_first) && is_finite(to_second) && is_finite(shear);
  }
};

/// Forces and areas of a cell in a frame.
template <scalar S>
struct CellPull {
  bool sound = false;    ///< false: the other members have no meaning
  Corners<S> force;      ///< on each corner, N for mu t = 1 N/mm
  Corners<S> area;       ///< each corner's share of the area vector, mm^2
  Point3<S> whole_area;  ///< their sum
};

/// Squares of the largest and smallest plausible stretch.
template <scalar S>
struct StretchLimits {
  S high;
  S low;

  explicit StretchLimits(double largest)
      : high(S(largest * largest)), low(S(1.0 / (largest * largest))) {}

  /// Whether both principal stretches lie between the limits. Their squares are the roots of
  /// s^2 - sq_sum s + area_ratio_sq, whose sign at the limits decides; false for NaN.
  bool allow(const S& sq_sum, const S& area_ratio_sq) const {
    const S above = high * (high - sq_sum) + area_ratio_sq;
    const S below = low * (low - sq_sum) + area_ratio_sq;
    return value(above) >= 0 && value(below) >= 0 && value(S(high + high - sq_sum)) >= 0 &&
           value(S(sq_sum - low - low)) >= 0;
  }
};

/// The corner forces of a cell, averaged over its two diagonals with common terms computed once.
/// `sound`: not folded along a diagonal, and no principal stretch beyond the limits.
template <scalar S>
CellPull<S> cell_pull(const StressFreeCell<S>& free,
                      const Corners<S>& x,
                      const StretchLimits<S>& limits) {
  CellPull<S> out;
  const Corners<S> side = {x[1] - x[0], x[2] - x[1], x[3] - x[2], x[0] - x[3]};
  const std::array<Point3<S>, 2> diagonal = {x[2] - x[0], x[3] - x[1]};
  for (std::size_t k = 0; k < 4; ++k) {
    out.force[k] =
        free.side_stiffness[k] * side[k] + S(-free.side_stiffness[(k + 3) % 4]) * side[(k + 3) % 4];
    const S toward = k < 2 ? free.diagonal_stiffness[k] : S(-free.diagonal_stiffness[k - 2]);
    out.force[k] = out.force[k] + toward * diagonal[k % 2];
  }
  Corners<S> doubled;
  for (std::size_t k = 0; k < 4; ++k) {
    const StressFreeTriangle<S>& f = free.ear[k];
    const std::size_t last = (k + 3) % 4, next = (k + 1) % 4;
    doubled[k] = cross(side[last], side[k]);
    const S sq_sum = (f.half_cotangent[2] * squared_norm(side[last]) +
                      f.half_cotangent[0] * squared_norm(side[k]) +
                      f.half_cotangent[1] * squared_norm(diagonal[next % 2])) /
                     f.area_mm2;
    const S area_ratio_sq = squared_norm(doubled[k]) / S(S(4) * f.area_mm2 * f.area_mm2);
    if (!limits.allow(sq_sum, area_ratio_sq)) {
      return out;
    }
    const S resist = S(0.5) / S(S(4) * f.area_mm2 * area_ratio_sq * area_ratio_sq);
    const Point3<S> on_last = resist * cross(doubled[k], side[k]);
    const Point3<S> on_next = resist * cross(doubled[k], side[last]);
    out.force[last] = out.force[last] + on_last;
    out.force[next] = out.force[next] + on_next;
    out.force[k] = out.force[k] - (on_last + on_next);
  }
  out.whole_area = S(0.5) * (doubled[0] + doubled[2]);
  for (std::size_t k = 0; k < 4; ++k) {  // corner k belongs to all ears but the opposite one
    out.area[k] = S(S(1) / S(12)) * (S(4) * out.whole_area - doubled[(k + 2) % 4]);
  }
  out.sound = value(dot(doubled[0], doubled[2])) > 0 && value(dot(doubled[1], doubled[3])) > 0;
  return out;
}

/// The tensions in the middle of a cell, for mu t = 1 N/mm.
template <scalar S>
CellTension<S> cell_tension(const StressFreeCell<S>& free, const Corners<S>& x) {
  using std::sqrt;
  const CellTangents<S> g(x);
  // the columns of F in an orthonormal pair of the stress-free plane
  const Point3<S> first = free.to_first * g.along_row;
  const Point3<S> second = free.shear * g.along_row + free.to_second * g.along_col;
  const S c11 = squared_norm(first), c22 = squared_norm(second), c12 = dot(first, second);
  const S half_sum = S(0.5) * (c11 + c22), half_difference = S(0.5) * (c11 - c22);
  const S spread_sq = half_difference * half_difference + c12 * c12;
  // the square root has no derivative at 0
  const S spread = value(spread_sq) > 0 ? S(sqrt(spread_sq)) : S(0);
  const S area_ratio_sq = squared_norm(cross(first, second));
  const S area_ratio = sqrt(area_ratio_sq);
  const S along_sq = half_sum + spread;
  const S across_sq = area_ratio_sq / along_sq;
  // the eigenvector (c12, spread - half_difference), in the form without cancellation
  const bool first_leads = value(half_difference) >= 0;
  const S a = first_leads ? S(spread + half_difference) : c12;
  const S b = first_leads ? c12 : S(spread - half_difference);
  const bool alike = value(spread) == 0;
  const Point3<S> pulled = alike ? first : (a * first + b * second);
  const S per_length = S(1) / S(sqrt(squared_norm(pulled)));
  return {principal_tension(along_sq, area_ratio), principal_tension(across_sq, area_ratio),
          per_length * pulled};
}

}  // namespace detail::traction

}  // namespace v0
}  // namespace fingerpad
