// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The tensions of a membrane cut into segments, and how well they balance the pressure. Source:
// Ito, Kim, Obinata 2011, III.D, eqs. 6 and 7.
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/compartments.hpp"
#include "fingerpad/force/detail/segments.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::membrane {

/// Forces per length in the membrane on every border. Allocates only in the constructor.
template <scalar S>
struct Tensions {
  Tensions(Index columns, Index rows)
      : around_normal(static_cast<std::size_t>(columns * (rows + 1))),
        around_shear(around_normal.size()),
        upward_normal(static_cast<std::size_t>(columns * rows)),
        upward_shear(upward_normal.size()),
        rim(static_cast<std::size_t>(columns)) {}

  std::vector<S> around_normal;  ///< f_v of border (i, j), N/mm, at j * columns + i, j = 0 ... m
  std::vector<S> around_shear;   ///< tau_v
  std::vector<S> upward_normal;  ///< f_h, j = 0 ... m - 1
  std::vector<S> upward_shear;   ///< tau_h
  std::vector<Point3<S>> rim;    ///< pull of the membrane on the base at rim segment i, N
};

/// Force of a border on the segment on its near side, N.
template <scalar S>
Point3<S> border_force(const Border<S>& border, const S& normal, const S& shear) {
  return normal * border.normal + shear * border.along;
}

/// A segment's unbalanced force and its unbalanced torque about its own normal.
template <scalar S>
struct Unbalanced {
  Point3<S> force_n;
  S torque_nmm;
};

/// The left sides of (6) and (7) for M(i, j). Forces act at the middles of the borders, pressure at
/// the mean of the four nodes. The force on the lowest border is the pull on the base.
template <scalar S>
Unbalanced<S> unbalanced(const Segments<S>& segments,
                         const Compartments<S>& nodes,
                         const Tensions<S>& tensions,
                         const S& pressure_mpa,
                         Index i,
                         Index j) {
  const Index next = segments.next(i);
  const auto low = static_cast<std::size_t>(j * segments.columns() + i);
  const auto up = static_cast<std::size_t>((j + 1) * segments.columns() + i);
  const auto right = static_cast<std::size_t>(j * segments.columns() + next);
  const S half = S(1) / S(2);
  const Point3<S>& area = segments.area(i, j);
  // half the diagonals: the arms of opposite borders about the mean of the nodes
  const Point3<S> first = nodes.node(next, j + 1) - nodes.node(i, j);
  const Point3<S> second = nodes.node(i, j + 1) - nodes.node(next, j);
  const S quarter = half * half;
  const Point3<S> upward = quarter * (first + second);
  const Point3<S> onward = quarter * (first - second);

  const Point3<S> f_low = j == 0 ? tensions.rim[low]
                                 : border_force(segments.around(i, j), tensions.around_normal[low],
                                                tensions.around_shear[low]);
  const Point3<S> f_up = border_force(segments.around(i, j + 1), tensions.around_normal[up],
                                      tensions.around_shear[up]);
  const Point3<S> f_left =
      border_force(segments.upward(i, j), tensions.upward_normal[low], tensions.upward_shear[low]);
  const Point3<S> f_right = border_force(segments.upward(next, j), tensions.upward_normal[right],
                                         tensions.upward_shear[right]);
  const Point3<S> force = f_up - f_low + f_right - f_left + pressure_mpa * area;
  const Point3<S> torque = cross(upward, f_up + f_low) + cross(onward, f_right + f_left);
  const bool flat = !(value(squared_norm(area)) > 0);
  return {force, flat ? S(0) : dot(torque, normalized(area))};
}

/// Deviation of the tensions from balance, relative to the effect of the pressure.
template <scalar S>
struct Imbalance {
  S force;   ///< sqrt(sum |force|^2 / |S| / (p^2 sum |S|)): rms, by area, of |force| / (p |S|)
  S torque;  ///< sqrt(sum torque^2 / |S|^2 / (p^2 sum |S|)): rms, by area, of torque / (p |S|^1.5)
};

/// Residual of (6) and (7) for any solution. Segments without area do not count; NaN if none has an
/// area. O(segments).
template <scalar S>
Imbalance<S> residual(const Segments<S>& segments,
                      const Compartments<S>& nodes,
                      const Tensions<S>& tensions,
                      const S& pressure_mpa) {
  using std::sqrt;
  S force = S(0);
  S torque = S(0);
  S total = S(0);
  for (Index j = 0; j < segments.rows(); ++j) {
    for (Index i = 0; i < segments.columns(); ++i) {
      const S area_sq = squared_norm(segments.area(i, j));
      if (!(value(area_sq) > 0)) {
        continue;
      }
      const Unbalanced<S> left = unbalanced(segments, nodes, tensions, pressure_mpa, i, j);
      const S area = sqrt(area_sq);
      force = force + squared_norm(left.force_n) / area;
      torque = torque + square(left.torque_nmm) / area_sq;
      total = total + area;
    }
  }
  const S scale = square(pressure_mpa) * total;
  return {S(sqrt(S(force / scale))), S(sqrt(S(torque / scale)))};
}

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
