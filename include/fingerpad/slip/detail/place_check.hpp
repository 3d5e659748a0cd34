// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Dots that carry another dot's name: two exchanged, one found at a spot of glare, or the whole
// pattern taken for its neighbour. One such dot would be the furthest of all and set the threshold.
#include <algorithm>
#include <cstddef>

#include "fingerpad/slip/detail/dot_planes.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// True, lane by lane, where the dot between two neighbours `step` away lies further than half a
/// pitch from their middle; false where one of the three is missing.
template <class V, class S>
[[gnu::always_inline]] inline auto is_out_of_line(const PlanesView<S>& p, Index k, Index step) {
  const V ax = load_cells<V, S>(p.x + k - step), bx = load_cells<V, S>(p.x + k + step);
  const V ay = load_cells<V, S>(p.y + k - step), by = load_cells<V, S>(p.y + k + step);
  const V off_x = ax + bx - S(2) * load_cells<V, S>(p.x + k);
  const V off_y = ay + by - S(2) * load_cells<V, S>(p.y + k);
  const V along_x = bx - ax, along_y = by - ay;
  const V off_sq = off_x * off_x + off_y * off_y;
  const V along_sq = along_x * along_x + along_y * along_y;
  return along_sq < S(4) * off_sq;  // along: two pitches; off: twice the distance
}

struct PlacedDots {
  Index dots = 0;          ///< in place
  Index out_of_place = 0;  ///< found, but not where their neighbours say
};

/// Writes to `placed` the dots that are where their neighbours say, the others as missing; with
/// `OnlyTouching` those that do not touch are missing too. Counts those that touch.
template <bool OnlyTouching, class S>
PlacedDots place_dots(const GivenDots<S>& given,
                      const Run& run,
                      Index stride,
                      DotPlanes<S>& placed) {
  using V = run_vector<S>;
  const PlanesView<S> found = view(given.found);
  const V nothing = V{} + not_a_number<S>(), one = V{} + S(1), zero = V{} + S(0);
  V dots = zero, touching = zero;
  for (Index k = run.begin; k < run.end; k += run_step<S>) {
    const V touch = load_cells<V, S>(given.touch.data() + k);
    const V x = load_cells<V, S>(found.x + k), y = load_cells<V, S>(found.y + k);
    const V near = choose(V(x * x + y * y) < no_distance_sq<S>(), x, nothing);
    const V held = choose(is_out_of_line<V>(found, k, 1), nothing,
                          V(choose(is_out_of_line<V>(found, k, stride), nothing, near)));
    const V is_touching = only_where(V(near + touch) < no_distance_sq<S>(), one);
    touching += is_touching;
    dots += only_where(held < no_distance_sq<S>(), is_touching);
    store_cells<S>(placed.x.data() + k, V(OnlyTouching ? V(held + touch) : held));
    store_cells<S>(placed.y.data() + k, y);
  }
  const auto count = [](const V& v) { return static_cast<Index>(value(sum_of_lanes<S>(v))); };
  return {count(dots), count(touching) - count(dots)};
}

/// The corners of the pattern lie between no two neighbours: they are held against the line through
/// the next two, along their row and their column.
template <class S>
void place_corners(const GivenDots<S>& given,
                   const DotLayout& layout,
                   DotPlanes<S>& placed,
                   PlacedDots& counts) {
  const PlanesView<S> p = view(given.found);
  const auto is_off = [&](Index k, Index step) {
    const S ax = p.x[k + step], ay = p.y[k + step];
    const S along_x = ax - p.x[k + 2 * step], along_y = ay - p.y[k + 2 * step];
    const S off_x = p.x[k] - ax - along_x, off_y = p.y[k] - ay - along_y;
    return along_x * along_x + along_y * along_y < S(4) * (off_x * off_x + off_y * off_y);
  };
  for (const Index row : {Index(0), layout.rows - 1}) {
    for (const Index col : {Index(0), layout.cols - 1}) {
      const Index k = layout.at(row, col);
      const std::size_t cell = static_cast<std::size_t>(k);
      const bool there = is_finite(placed.x[cell]) && is_finite(placed.y[cell]);
      const bool off =
          (layout.cols > 2 && is_off(k, col == 0 ? 1 : -1)) ||
          (layout.rows > 2 && is_off(k, row == 0 ? layout.stride() : -layout.stride()));
      if (there && off) {
        const bool touches = is_finite(given.touch[cell]);
        placed.x[cell] = not_a_number<S>();
        counts.dots -= touches ? 1 : 0;
        counts.out_of_place += touches ? 1 : 0;
      }
    }
  }
}

/// True when the dots have all moved by one pitch of the pattern, along rows, columns or diagonals,
/// to a quarter of a pitch: the names have jumped, not the dots.
template <class S>
bool has_jumped(const PlanesView<S>& now,
                const PlanesView<S>& before,
                const Run& run,
                Index stride) {
  struct Mean {
    double x = 0, y = 0, sq = 0;
    Index count = 0;
    void add(double dx, double dy) {
      if (dx * dx + dy * dy < value(no_distance_sq<double>())) {
        x += dx, y += dy, sq += dx * dx + dy * dy;
        ++count;
      }
    }
    void finish() {
      const double n = static_cast<double>((std::max<Index>)(count, 1));
      x /= n, y /= n, sq /= n;
    }
  };
  const auto number = [](const S& s) { return static_cast<double>(value(s)); };
  Mean moved, next_col, next_row;
  for (Index k = run.begin; k < run.end; ++k) {
    moved.add(number(now.x[k]) - number(before.x[k]), number(now.y[k]) - number(before.y[k]));
    next_col.add(number(before.x[k + 1]) - number(before.x[k]),
                 number(before.y[k + 1]) - number(before.y[k]));
    next_row.add(number(before.x[k + stride]) - number(before.x[k]),
                 number(before.y[k + stride]) - number(before.y[k]));
  }
  for (Mean* m : {&moved, &next_col, &next_row}) {
    m->finish();
  }
  const double pitch_sq = (std::min)(next_col.x * next_col.x + next_col.y * next_col.y,
                                     next_row.x * next_row.x + next_row.y * next_row.y);
  const double near_sq = pitch_sq / 16;
  const double spread_sq = moved.sq - moved.x * moved.x - moved.y * moved.y;
  if (!(pitch_sq > 0) || !(spread_sq < near_sq)) {
    return false;
  }
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      const double off_x = moved.x - i * next_row.x - j * next_col.x;
      const double off_y = moved.y - i * next_row.y - j * next_col.y;
      if ((i != 0 || j != 0) && off_x * off_x + off_y * off_y < near_sq) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
