// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The six-axis force as printed. Source: Ito, Kim, Obinata 2011. The iteration, III.F, is made
// explicit where the text leaves a choice (docs/errata.md, E025-E027):
//   1. column by column from the top down, eq. 12: vertical balance gives f_v
//   2. segment by segment, eq. 6 along x and y: f_h on both sides, each found twice, averaged
//   3. at the rim, eq. 3: the direction of the pull gives tau_v
//   4. row by row upward, eqs. 8 and 7: tau_h = (tau_v left + tau_v right) / 2, and tau_v of the
//      next row = tau_h left + tau_h right - tau_v
// The next pass uses the new tau_h in step 1. Shear is advanced by its symmetry, not by the balance
// of forces: the iteration converges, but not to a solution of eqs. 6-8 (E046).
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/force/rim_balance.hpp"
#include "fingerpad/force/wrench.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail::membrane {

/// Storage index of the tensions of M(i, j).
template <scalar S>
std::size_t at(const Segments<S>& g, Index i, Index j) {
  return static_cast<std::size_t>(j * g.columns() + i);
}

/// tau_v at the rim from the direction of the pull, eq. 3. False if a pull does not point upward.
template <scalar S>
bool shear_at_rim(const Segments<S>& g, const std::vector<Point3<S>>& pulls, Tensions<S>& t) {
  bool good = true;
  for (Index i = 0; i < g.columns(); ++i) {
    const std::size_t k = at(g, i, 0);
    const S across = dot(pulls[k], g.around(i, 0).normal);
    good = good && value(across) > 0;
    t.around_shear[k] =
        t.around_normal[k] * dot(pulls[k], g.around(i, 0).along) / (good ? across : S(1));
  }
  return good;
}

/// Eqs. 8 and 7, row by row upward.
template <scalar S>
void advance_shear(const Segments<S>& g, Tensions<S>& t) {
  for (Index j = 0; j < g.rows(); ++j) {
    for (Index i = 0; i < g.columns(); ++i) {
      t.upward_shear[at(g, i, j)] =
          (t.around_shear[at(g, g.previous(i), j)] + t.around_shear[at(g, i, j)]) / S(2);
    }
    for (Index i = 0; i < g.columns(); ++i) {
      t.around_shear[at(g, i, j + 1)] = t.upward_shear[at(g, i, j)] +
                                        t.upward_shear[at(g, g.next(i), j)] -
                                        t.around_shear[at(g, i, j)];
    }
  }
}

/// Forces on the rim: the vertical part is that of f_v, the direction that of the pull. False if a
/// pull does not point upward.
template <scalar S>
bool load_rim(const Segments<S>& g, const std::vector<Point3<S>>& pulls, Tensions<S>& t) {
  bool good = true;
  for (Index i = 0; i < g.columns(); ++i) {
    const std::size_t k = at(g, i, 0);
    const S load = t.around_normal[k] * g.around(i, 0).normal.z;
    good = force_along(pulls[k], load, t.rim[k]) && good;
  }
  return good;
}
}  // namespace detail::membrane

namespace published {

/// The pull has the direction of the side dots, as published; a dot on its border point has none.
/// On a pad stretched by 8.5 % it yields 72 % of the true tangential force of a drag and 36 % of the
/// true moment of a twist.
struct Direction {
  /// Whether pulls of different rim points can be compared.
  static constexpr bool tells_magnitude = false;

  template <scalar S>
  detail::membrane::RimPull<S> pull(const Point3<S>& along, const Point3<S>&) const {
    using Status = detail::membrane::RimPullStatus;
    return {value(squared_norm(along)) > 0 ? Status::ok : Status::unstretched, along};
  }
  /// By how much the pull changes when `along` changes by `change`.
  template <scalar S>
  Point3<S> change_of_pull(const Point3<S>&, const Point3<S>&, const Point3<S>& change) const {
    return change;
  }
};

inline void expects_valid(const Direction&) {}

/// The published lines: perpendicular to the contour lines, cut at equal steps of height. If the
/// summit is level all around (a contact parallel to the plate), the lines around are contour
/// lines. On a summit that is not level, the lines crowd at its highest points.
struct SteepestLines {
  static constexpr bool straight = false;
  static constexpr bool by_height = true;
};

/// One pass: each column carries the pressure on it, in the direction of its side dots. The shear
/// between columns is taken as 0. Used as reference and first guess.
struct ClosedForm {
  static constexpr auto magnitude = detail::membrane::Magnitude::of_column;
  static constexpr bool finds_tensions = false;
  template <scalar S>
  struct Work {
    Work(const ClosedForm&, Index, Index) {}
  };

  template <bool, scalar S>
  bool solve(const detail::membrane::Segments<S>& segments,
             const detail::membrane::Compartments<S>&,
             const std::vector<Point3<S>>& pulls,
             const S& pressure_mpa,
             Work<S>&,
             detail::membrane::Tensions<S>& tensions) const {
    bool good = true;
    for (Index i = 0; i < segments.columns(); ++i) {
      const std::size_t k = static_cast<std::size_t>(i);
      const S load = detail::membrane::column_load(segments, i, pressure_mpa);
      good = detail::membrane::force_along(pulls[k], load, tensions.rim[k]) && good;
    }
    return good;
  }
};

inline void expects_valid(const ClosedForm&) {}

/// The printed iteration, with eq. 12 for every column.
struct Iteration {
  static constexpr auto magnitude = detail::membrane::Magnitude::of_column;
  static constexpr bool finds_tensions = true;
  int passes = 5;  ///< in [1, 100]; the forces no longer change after 5

  template <scalar S>
  struct Work {
    Work(const Iteration&, Index columns, Index rows)
        : right(static_cast<std::size_t>(columns * rows)) {}
    std::vector<S> right;  // f_h found from the segment to its left
  };

  template <bool, scalar S>
  bool solve(const detail::membrane::Segments<S>& g,
             const detail::membrane::Compartments<S>&,
             const std::vector<Point3<S>>& pulls,
             const S& pressure_mpa,
             Work<S>& work,
             detail::membrane::Tensions<S>& t) const {
    std::fill(t.around_shear.begin(), t.around_shear.end(), S(0));
    std::fill(t.upward_shear.begin(), t.upward_shear.end(), S(0));
    for (int pass = 0; pass < passes; ++pass) {
      balance_columns(g, pressure_mpa, t);
      if (pass + 1 == passes) {  // f_h does not affect the other tensions
        balance_segments(g, pressure_mpa, work, t);
      }
      if (!detail::membrane::shear_at_rim(g, pulls, t)) {
        return false;
      }
      detail::membrane::advance_shear(g, t);
    }
    return detail::membrane::load_rim(g, pulls, t);
  }

 private:
  /// Eq. 12 from the summit down, where f_v has no vertical component (eq. 11).
  template <scalar S>
  static void balance_columns(const detail::membrane::Segments<S>& g,
                              const S& pressure_mpa,
                              detail::membrane::Tensions<S>& t) {
    for (Index i = 0; i < g.columns(); ++i) {
      const Index right = g.next(i);
      S load = S(0);
      for (Index j = g.rows(); j-- > 0;) {
        load = load + pressure_mpa * g.area(i, j).z +
               t.upward_shear[at(g, right, j)] * g.upward(right, j).along.z -
               t.upward_shear[at(g, i, j)] * g.upward(i, j).along.z;
        t.around_normal[at(g, i, j)] = load / g.around(i, j).normal.z;
        if (!is_finite(t.around_normal[at(g, i, j)])) {  // a level row
          t.around_normal[at(g, i, j)] = S(0);
        }
      }
      // a level membrane gives 0 / 0: take the value below
      t.around_normal[at(g, i, g.rows())] = t.around_normal[at(g, i, g.rows() - 1)];
    }
  }

  /// Eq. 6 along x and y, for the tensions across the two lines beside each segment.
  template <scalar S>
  static void balance_segments(const detail::membrane::Segments<S>& g,
                               const S& pressure_mpa,
                               Work<S>& work,
                               detail::membrane::Tensions<S>& t) {
    for (Index j = 0; j < g.rows(); ++j) {
      for (Index i = 0; i < g.columns(); ++i) {
        const Index next = g.next(i);
        const auto& low = g.around(i, j);
        const auto& up = g.around(i, j + 1);
        const auto& a = g.upward(i, j);
        const auto& b = g.upward(next, j);
        const S fl = t.around_normal[at(g, i, j)];
        const S fu = t.around_normal[at(g, i, j + 1)];
        const S sl = t.around_shear[at(g, i, j)];
        const S su = t.around_shear[at(g, i, j + 1)];
        const S sa = t.upward_shear[at(g, i, j)];
        const S sb = t.upward_shear[at(g, next, j)];
        const Point3<S>& area = g.area(i, j);
        const S x = fl * low.normal.x - fu * up.normal.x + sl * low.along.x - su * up.along.x +
                    sa * a.along.x - sb * b.along.x - pressure_mpa * area.x;
        const S y = fl * low.normal.y - fu * up.normal.y + sl * low.along.y - su * up.along.y +
                    sa * a.along.y - sb * b.along.y - pressure_mpa * area.y;
        // -f_a a + f_b b = (x, y)
        const S det = a.normal.y * b.normal.x - a.normal.x * b.normal.y;
        const S fa = (x * b.normal.y - y * b.normal.x) / det;
        const S fb = (x * a.normal.y - y * a.normal.x) / det;
        t.upward_normal[at(g, i, j)] = is_finite(fa) ? fa : S(0);
        work.right[at(g, next, j)] = is_finite(fb) ? fb : S(0);
      }
    }
    for (std::size_t k = 0; k < work.right.size(); ++k) {
      t.upward_normal[k] = (t.upward_normal[k] + work.right[k]) / S(2);
    }
  }
};

/// Refuses what has no meaning (parameter_error).
inline void expects_valid(const Iteration& iteration) {
  expects(iteration.passes >= 1 && iteration.passes <= 100, "published::Iteration", "passes",
          static_cast<long long>(iteration.passes), "in [1, 100]");
}

/// The published method: direction of the side dots, steepest lines, 72 columns and 65 rows of
/// segments, tensions by iteration. It loses 28 % of a drag and 64 % of a twist: docs/errata.md,
/// E043.
template <scalar S = double>
using Wrench = fingerpad::Wrench<Iteration, OneRow, Direction, SteepestLines, S>;

template <scalar S = double>
WrenchOptions<S> wrench_options() {
  WrenchOptions<S> options;
  options.columns = 72;
  options.rows = 65;
  return options;
}

/// `border_mm` as for Wrench. Refuses bad parameters (parameter_error).
template <scalar S = double, spatial_dot_grid Border>
Wrench<S> wrench(const Border& border_mm, const WrenchOptions<S>& options = wrench_options<S>()) {
  return Wrench<S>(border_mm, options);
}

}  // namespace published

}  // namespace v0
}  // namespace fingerpad
