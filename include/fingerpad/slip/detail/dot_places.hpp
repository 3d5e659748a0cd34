// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Detects wrongly labelled dots: two exchanged, one found at a spot of glare, or the whole pattern
// shifted by a pitch. A single such dot would have the largest displacement and set the threshold.
#include <algorithm>

#include "fingerpad/slip/detail/dot_frames.hpp"
#include "fingerpad/slip/detail/similarity.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// Whether dot d is further than half a pitch from the middle of the two dots beside it; false if
/// one of the three is missing.
template <class P>
bool is_out_of_line(
    const P* dots, const DotLayout& layout, const DotIndex& d, Index down, Index right) {
  if (d.row < down || d.row + down >= layout.rows || d.col < right ||
      d.col + right >= layout.cols) {
    return false;
  }
  const Index next = down * layout.cols + right;
  const P* const dot = dots + d.row * layout.cols + d.col;
  const P across = dot[next] - dot[-next];                         // two pitches
  const P off = dot[next] + dot[-next] - coordinate<P>(2) * *dot;  // twice the distance
  return squared_norm(across) < coordinate<P>(4) * squared_norm(off);
}

/// The same for the corners of the pattern, which do not lie between two neighbours. They are
/// compared with the line through the next two dots, along their row and their column.
template <class P>
bool is_corner_out_of_line(const P* dots, const DotLayout& layout, const DotIndex& d) {
  if ((d.row != 0 && d.row != layout.rows - 1) || (d.col != 0 && d.col != layout.cols - 1)) {
    return false;
  }
  const auto is_off = [&](Index down, Index right) {
    const P next = beside(dots, layout, d, down, right);
    const P along = next - beside(dots, layout, d, 2 * down, 2 * right);
    const P off = beside(dots, layout, d, 0, 0) - next - along;
    return squared_norm(along) < coordinate<P>(4) * squared_norm(off);
  };
  return is_off(0, d.col == 0 ? 1 : -1) || is_off(d.row == 0 ? 1 : -1, 0);
}

template <class P>
bool is_out_of_place(const P* dots, const DotLayout& layout, const DotIndex& d) {
  return is_out_of_line(dots, layout, d, 0, 1) || is_out_of_line(dots, layout, d, 1, 0) ||
         is_corner_out_of_line(dots, layout, d);
}

struct PlacedDots {
  Index dots = 0;          ///< in contact and in place
  Index out_of_place = 0;  ///< in contact and found, but not between their neighbours
  Index crossed = 0;       ///< of these, out of line in both row and column, which a single wrong
                           ///< neighbour does not cause
};

/// Writes to `now` the dots in contact that lie between their neighbours; all others are missing.
template <class P>
PlacedDots place_dots(const GivenDots<P>& given, const DotLayout& layout, Dots<P>& now) {
  std::fill(now.begin(), now.end(), no_dot<P>());
  PlacedDots placed;
  DotWalk walk(layout);
  const P* const dots = given.found.data();
  for (const Index k : given.touching) {
    if (!is_finite(dots[k])) {
      continue;
    }
    const DotIndex d = walk.to(k);
    const bool row = is_out_of_line(dots, layout, d, 0, 1);
    const bool col = is_out_of_line(dots, layout, d, 1, 0);
    if (row || col || is_corner_out_of_line(dots, layout, d)) {
      ++placed.out_of_place;
      placed.crossed += row && col ? 1 : 0;
    } else {
      ++placed.dots;
      at(now, k) = dots[k];
    }
  }
  return placed;
}

/// Whether more than a fifth of the dots are out of place in row and column, so that the others
/// cannot be trusted either.
inline bool is_not_in_order(const PlacedDots& placed) {
  return 5 * placed.crossed > placed.out_of_place + placed.dots;
}

/// Mean square distance of neighbours in contact; 0 if there are none.
template <class P>
coordinate<P> mean_pitch_sq(const std::vector<Index>& touching,
                            const P* now,
                            const DotLayout& layout) {
  using S = coordinate<P>;
  S sum = S(0);
  int count = 0;
  DotWalk walk(layout);
  const auto add = [&](const P& a, const P& b) {
    const S sq = squared_norm(a - b);
    const bool known = is_distance_sq(sq);
    sum = known ? S(sum + sq) : sum;
    count += known ? 1 : 0;
  };
  for (const Index k : touching) {
    const DotIndex d = walk.to(k);
    if (d.col + 1 < layout.cols) {
      add(now[k + 1], now[k]);
    }
    if (d.row + 1 < layout.rows) {
      add(now[k + layout.cols], now[k]);
    }
  }
  return count > 0 ? S(sum / S(count)) : S(0);
}

/// Whether the pitch does not fit U (`reference`) and delta_0 (`slip`), probably because of another
/// unit. A U of more than half a pitch reaches the next dot. A pitch of less than 4 delta_0 is
/// noise. With a pitch of more than 200 U any noise is slip. False for pitch 0: no neighbours.
template <class S>
bool is_wrong_scale(const S& pitch_sq, double reference, double slip) {
  const S least =
      S(4 * (reference * reference > 4 * slip * slip ? reference * reference : 4 * slip * slip));
  const S most = S(40000 * reference * reference);
  return S(0) < pitch_sq && (pitch_sq < least || most < pitch_sq);
}

/// Whether the pitch is more than twice or less than half the first one. No load causes this: the
/// unit has changed, or these are other dots.
template <class S>
bool is_rescaled(const S& pitch_sq, const S& first_sq) {
  return S(0) < pitch_sq && S(0) < first_sq &&
         (S(4) * first_sq < pitch_sq || S(4) * pitch_sq < first_sq);
}

/// Mean and variance of vectors.
template <class S>
struct MeanOfVectors {
  Point2<S> sum = {S(0), S(0)};
  S sum_sq = S(0);
  int count = 0;

  void add(const Point2<S>& v) {
    if (is_distance_sq(squared_norm(v))) {
      sum += v;
      sum_sq = sum_sq + squared_norm(v);
      ++count;
    }
  }
  Point2<S> mean() const { return sum / S((std::max)(count, 1)); }
  S spread_sq() const { return sum_sq / S((std::max)(count, 1)) - squared_norm(mean()); }
};

/// Mean squared residual of a similarity fitted to the dots found in both frames; 0 without dots.
template <class P>
coordinate<P> mean_residual_sq(const std::vector<Index>& touching, const P* now, const P* before) {
  using S = coordinate<P>;
  Similarity<S> about;
  PairSums<S> sums;
  for (const Index k : touching) {
    const Point2<S> n{now[k].x, now[k].y}, t{before[k].x, before[k].y};
    if (is_distance_sq(squared_norm(n - t))) {
      about.now_at = S(0) < sums.weight ? about.now_at : n;
      about.then_at = S(0) < sums.weight ? about.then_at : t;
      sums.add(S(1), n - about.now_at, t - about.then_at);
    }
  }
  if (!(S(0) < sums.weight)) {
    return S(0);
  }
  const Similarity<S> map = fit<true, true>(sums, about);
  S sum = S(0);
  for (const Index k : touching) {
    const Point2<S> n{now[k].x, now[k].y}, t{before[k].x, before[k].y};
    const S sq = squared_norm(map.residual(n, t));
    sum = is_distance_sq(sq) ? S(sum + sq) : sum;
  }
  return sum / sums.weight;
}

/// Whether the labels have jumped, not the dots. Either all have moved by one pitch of the pattern,
/// along rows, columns or diagonals, to within a quarter of a pitch. Or the rms residual of a
/// similarity exceeds half a pitch, which no stretch of a membrane between two frames causes: rows
/// and columns exchanged, a mirrored pattern, two halves exchanged.
template <class P>
bool has_jumped(const std::vector<Index>& touching,
                const P* now,
                const P* before,
                const DotLayout& layout) {
  using S = coordinate<P>;
  const auto step = [](const P& to, const P& from) {
    return Point2<S>{S(to.x - from.x), S(to.y - from.y)};
  };
  MeanOfVectors<S> moved, across, down;
  for (const Index k : touching) {
    moved.add(step(now[k], before[k]));
    across.add(step(beside(before, layout, k, 0, 1), before[k]));
    down.add(step(beside(before, layout, k, 1, 0), before[k]));
  }
  const Point2<S> next_col = across.mean(), next_row = down.mean();
  const S col_sq = squared_norm(next_col), row_sq = squared_norm(next_row);
  const S near_sq = (col_sq < row_sq ? col_sq : row_sq) / S(16);
  if (!(S(0) < near_sq)) {
    return false;
  }
  if (!(moved.spread_sq() < near_sq)) {
    return S(4) * near_sq < mean_residual_sq(touching, now, before);
  }
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      const Point2<S> off = moved.mean() - S(i) * next_row - S(j) * next_col;
      if ((i != 0 || j != 0) && squared_norm(off) < near_sq) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
