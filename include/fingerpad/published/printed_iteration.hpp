// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The iteration of the six-axis force, word for word. Source: Ito, Kim, Obinata 2011, III.C and
// III.F; misprints: docs/errata.md, E025-E027. Steps of a pass:
//   1. eq. 12 for the lines i_0 that end level: f_v(i_0, 1)
//   2. eq. 6 on M(i_0, j) in order of j: f_v(i_0, j + 1), then f_h(i_0, j) and f_h(i_0 + 1, j)
//   3. eq. 6 on M(i, j) of the other lines, from i_0 around: f_h(i + 1, j) from f_h(i, j)
//   4. eq. 9 with these f_h: f_v(i, 1) of the other lines
//   5. eq. 3, direction of the side dots: tau_v(i, 1); then eqs. 8 and 7 upward: tau_h, tau_v
// published::Iteration differs: it applies eq. 12 to every line, level or not, and its f_h does not
// affect the other tensions.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/published/wrench.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// Lines perpendicular to the contour lines, cut by contour lines at every 0.2 mm of height. Each
/// line has its own number m(i) of segments; the last segment ends at A_g.
struct ContourLines {
  static constexpr bool straight = false;
  static constexpr bool by_height = true;
  static constexpr double step_mm = 0.2;  ///< delta_z
};

/// The printed iteration, unchanged. Where lines do not end level, the error of f_h propagates from
/// line to line. Over tilted or curved objects the result is far off or diverges (`not_solved`).
struct PrintedIteration {
  static constexpr auto magnitude = detail::membrane::Magnitude::of_column;
  static constexpr bool finds_tensions = true;
  int passes = 5;  ///< in [1, 100]

  template <scalar S>
  struct Work {
    Work(const PrintedIteration&, Index, Index) {}
  };

  template <bool, scalar S>
  bool solve(const detail::membrane::Segments<S>& g,
             const detail::membrane::Compartments<S>&,
             const std::vector<Point3<S>>& pulls,
             const S& pressure_mpa,
             Work<S>&,
             detail::membrane::Tensions<S>& t) const {
    const Index first = free_line(g);
    if (first < 0) {
      return false;
    }
    for (std::vector<S>* shear : {&t.around_shear, &t.upward_shear, &t.upward_normal}) {
      std::fill(shear->begin(), shear->end(), S(0));
    }
    bool good = true;
    for (int pass = 0; pass < passes && good; ++pass) {
      for (Index k = 0; k < g.columns(); ++k) {
        const Index i = (first + k) % g.columns();
        if (ends_level(g, i)) {
          balance_free(g, i, pressure_mpa, t);
        } else {
          carry_on(g, i, pressure_mpa, t);
        }
      }
      good = detail::membrane::shear_at_rim(g, pulls, t);
      detail::membrane::advance_shear(g, t);
    }
    S all = S(0);
    for (Index i = 0; i < g.columns(); ++i) {
      all = all + detail::membrane::column_load(g, i, pressure_mpa);
    }
    for (Index i = 0; i < g.columns(); ++i) {
      const std::size_t k = at(g, i, 0);
      const S load = t.around_normal[k] * g.around(i, 0).normal.z;
      good = good && load < all && -load < all;  // a single line cannot carry the load of all
    }
    return detail::membrane::load_rim(g, pulls, t) && good;
  }

 private:
  template <scalar S>
  static bool ends_level(const detail::membrane::Segments<S>& g, Index i) {
    const Point3<S>& top = g.around(i, g.rows()).normal;
    return value(S(S(100) * top.z * top.z)) < value(squared_norm(top));
  }

  /// i_0: the first line that ends level; -1 where there is none.
  template <scalar S>
  static Index free_line(const detail::membrane::Segments<S>& g) {
    for (Index i = 0; i < g.columns(); ++i) {
      if (ends_level(g, i)) {
        return i;
      }
    }
    return -1;
  }

  /// The known terms of eq. 6 on M(i, j): pressure and shear.
  template <scalar S>
  static Point3<S> known(const detail::membrane::Segments<S>& g,
                         Index i,
                         Index j,
                         const S& pressure_mpa,
                         const detail::membrane::Tensions<S>& t) {
    const Index next = g.next(i);
    return pressure_mpa * g.area(i, j) +
           t.around_shear[at(g, i, j + 1)] * g.around(i, j + 1).along +
           t.upward_shear[at(g, next, j)] * g.upward(next, j).along +
           S(-t.around_shear[at(g, i, j)]) * g.around(i, j).along +
           S(-t.upward_shear[at(g, i, j)]) * g.upward(i, j).along;
  }

  static bool has_area(const auto& g, Index i, Index j) {
    return value(squared_norm(g.area(i, j))) > 0;
  }

  /// Steps 1 and 2.
  template <scalar S>
  static void balance_free(const detail::membrane::Segments<S>& g,
                           Index i,
                           const S& pressure_mpa,
                           detail::membrane::Tensions<S>& t) {
    S load = S(0);
    for (Index j = 0; j < g.rows(); ++j) {
      load = load + known(g, i, j, pressure_mpa, t).z;
    }
    t.around_normal[at(g, i, 0)] = load / g.around(i, 0).normal.z;
    climb(g, i, pressure_mpa, t);
    for (Index j = 0; j < g.rows(); ++j) {
      const Index next = g.next(i);
      const Point3<S>&a = g.upward(i, j).normal, &b = g.upward(next, j).normal;
      const Point3<S> r = around_forces(g, i, j, t) + known(g, i, j, pressure_mpa, t);
      // f_h(i) a - f_h(i + 1) b = r, along x and y
      const S det = a.y * b.x - a.x * b.y;
      const S left = (r.y * b.x - r.x * b.y) / det, right = (r.y * a.x - r.x * a.y) / det;
      t.upward_normal[at(g, i, j)] = is_finite(left) ? left : S(0);
      t.upward_normal[at(g, next, j)] = is_finite(right) ? right : S(0);
    }
  }

  /// Force on M(i, j) from f_v at its lower and upper end.
  template <scalar S>
  static Point3<S> around_forces(const detail::membrane::Segments<S>& g,
                                 Index i,
                                 Index j,
                                 const detail::membrane::Tensions<S>& t) {
    return t.around_normal[at(g, i, j + 1)] * g.around(i, j + 1).normal +
           S(-t.around_normal[at(g, i, j)]) * g.around(i, j).normal;
  }

  /// Step 2, f_v(i, j + 1) from f_v(i, j): eq. 6 along z in order of j.
  template <scalar S>
  static void climb(const detail::membrane::Segments<S>& g,
                    Index i,
                    const S& pressure_mpa,
                    detail::membrane::Tensions<S>& t) {
    S load = t.around_normal[at(g, i, 0)] * g.around(i, 0).normal.z;
    for (Index j = 0; j < g.rows(); ++j) {
      load = load - known(g, i, j, pressure_mpa, t).z;
      const Point3<S>& up = g.around(i, j + 1).normal;
      // a level membrane gives 0 / 0: take the value below
      const bool steep = value(S(S(400) * up.z * up.z)) > value(squared_norm(up));
      t.around_normal[at(g, i, j + 1)] = steep ? S(load / up.z) : t.around_normal[at(g, i, j)];
    }
  }

  /// Steps 3 and 4: f_h(i + 1, j) from f_h(i, j), then f_v(i, 1) by eq. 9.
  template <scalar S>
  static void carry_on(const detail::membrane::Segments<S>& g,
                       Index i,
                       const S& pressure_mpa,
                       detail::membrane::Tensions<S>& t) {
    const Index next = g.next(i);
    const auto flat = [](const Point3<S>& n) { return Point3<S>{n.x, n.y, S(0)}; };  // eq. 10
    Point3<S> sum = {S(0), S(0), S(0)};
    for (Index j = 0; j < g.rows(); ++j) {
      if (!has_area(g, i, j)) {
        continue;
      }
      const S left = t.upward_normal[at(g, i, j)];
      const Point3<S> r = known(g, i, j, pressure_mpa, t) + S(-left) * flat(g.upward(i, j).normal);
      const Point3<S> b = flat(g.upward(next, j).normal);
      // f_v(i, j + 1) up - f_v(i, j) low + f_h(i + 1, j) b = -r, without both f_v
      const Point3<S> axis = cross(g.around(i, j + 1).normal, g.around(i, j).normal);
      const S found = -dot(r, axis) / dot(b, axis);
      t.upward_normal[at(g, next, j)] = is_finite(found) ? found : left;
      sum = sum + r + t.upward_normal[at(g, next, j)] * b;
    }
    // eq. 9: f_v(i, 1) low - f_v(i, m' + 1) up = sum
    const Point3<S>&low = g.around(i, 0).normal, &up = g.around(i, g.rows()).normal;
    const S ll = squared_norm(low), lu = dot(low, up), uu = squared_norm(up);
    t.around_normal[at(g, i, 0)] = (uu * dot(sum, low) - lu * dot(sum, up)) / (ll * uu - lu * lu);
    climb(g, i, pressure_mpa, t);
  }
};

/// Refuses what has no meaning (parameter_error).
inline void expects_valid(const PrintedIteration& iteration) {
  expects(iteration.passes >= 1 && iteration.passes <= 100, "published::PrintedIteration", "passes",
          static_cast<long long>(iteration.passes), "in [1, 100]");
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
