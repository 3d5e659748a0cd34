// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The tensions of a membrane cut into segments, and how well they balance the pressure. Source:
// Ito, Kim, Obinata 2011, III.D, eq. 6.
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
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

/// The left side of (6) for M(i, j), N. The force on the lowest border is the pull on the base.
template <scalar S>
Point3<S> unbalanced_force(const Segments<S>& segments,
                           const Tensions<S>& tensions,
                           const S& pressure_mpa,
                           Index i,
                           Index j) {
  const Index next = segments.next(i);
  const auto low = static_cast<std::size_t>(j * segments.columns() + i);
  const auto up = static_cast<std::size_t>((j + 1) * segments.columns() + i);
  const auto right = static_cast<std::size_t>(j * segments.columns() + next);
  const Point3<S> f_low = j == 0 ? tensions.rim[low]
                                 : border_force(segments.around(i, j), tensions.around_normal[low],
                                                tensions.around_shear[low]);
  const Point3<S> f_up = border_force(segments.around(i, j + 1), tensions.around_normal[up],
                                      tensions.around_shear[up]);
  const Point3<S> f_left =
      border_force(segments.upward(i, j), tensions.upward_normal[low], tensions.upward_shear[low]);
  const Point3<S> f_right = border_force(segments.upward(next, j), tensions.upward_normal[right],
                                         tensions.upward_shear[right]);
  return f_up - f_low + f_right - f_left + pressure_mpa * segments.area(i, j);
}

/// Residual of (6) for any solution, relative to the effect of the pressure:
/// sqrt(sum |force|^2 / |S| / (p^2 sum |S|)), the rms, by area, of |force| / (p |S|). Segments
/// without area do not count; NaN if none has an area. O(segments).
template <scalar S>
S residual(const Segments<S>& segments, const Tensions<S>& tensions, const S& pressure_mpa) {
  using std::sqrt;
  S force = S(0);
  S total = S(0);
  for (Index j = 0; j < segments.rows(); ++j) {
    for (Index i = 0; i < segments.columns(); ++i) {
      const S area_sq = squared_norm(segments.area(i, j));
      if (!(value(area_sq) > 0)) {
        continue;
      }
      const S area = sqrt(area_sq);
      const Point3<S> left_n = unbalanced_force(segments, tensions, pressure_mpa, i, j);
      force = force + squared_norm(left_n) / area;
      total = total + area;
    }
  }
  return S(sqrt(S(force / (square(pressure_mpa) * total))));
}

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
