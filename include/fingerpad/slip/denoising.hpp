// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Policies: less noise in the positions of dots, by their neighbours. Source: "Method to decrease
// of data variation of dots" of 003; its weights are not printed.
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "fingerpad/slip/detail/dot_planes.hpp"
#include "fingerpad/slip/motion_between.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail::stick {

// Dots that carry another dot's name: two exchanged, one found at a spot of glare, or the whole
// pattern taken for its neighbour. One such dot would be the furthest of all and set the threshold.

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

struct NoDenoising {};

/// Weights of a dot, of its four neighbours and of those across; > 0, >= 0, >= 0. The defaults
/// leave 0.42 of the noise, as the published 0.06 of 0.14 px.
struct DotWeights {
  double self = 6;      ///< S1
  double side = 2;      ///< S2
  double diagonal = 1;  ///< S3
};

/// Published: positions are averaged before anything else; dots at the edge of the pattern stay.
/// Two opposite neighbours count or miss together: one alone would pull the mean by its distance.
struct DotMean {
  DotWeights weights = {};
};

/// What is left of the displacements when the object's motion is taken out is averaged instead, of
/// the dots in contact only: the same where all of them are there, and not pulled by neighbours
/// that are missing or do not touch. Neighbours that slip by more than `gate` times the threshold
/// are left out, so that they do not smear into the sticking dots beside them.
struct ResidualMean {
  DotWeights weights = {};
  double gate = 6;  ///< >= 1
};

inline void expects_valid(const DotWeights& weights, const char* owner) {
  expects(is_finite(weights.self) && weights.self > 0, owner, "weights.self", weights.self,
          "finite and > 0");
  expects(is_finite(weights.side) && weights.side >= 0, owner, "weights.side", weights.side,
          "finite and >= 0");
  expects(is_finite(weights.diagonal) && weights.diagonal >= 0, owner, "weights.diagonal",
          weights.diagonal, "finite and >= 0");
}
inline void expects_valid(const NoDenoising&) {}
inline void expects_valid(const DotMean& mean) {
  expects_valid(mean.weights, "DotMean");
}
inline void expects_valid(const ResidualMean& mean) {
  expects_valid(mean.weights, "ResidualMean");
  expects(is_finite(mean.gate) && mean.gate >= 1, "ResidualMean", "gate", mean.gate,
          "finite and >= 1");
}

namespace detail::stick {

/// The dots in contact that are in their places, to `now`.
template <class Denoising, class S>
PlacedDots prepare_dots(const Denoising&,
                        const GivenDots<S>& given,
                        const DotLayout& layout,
                        const Run& run,
                        const aligned_vector<S>&,
                        DotPlanes<S>&,
                        DotPlanes<S>& now) {
  PlacedDots counts = place_dots<true>(given, run, layout.stride(), now);
  place_corners(given, layout, now, counts);
  return counts;
}

/// The same, averaged. `inner` is 0 for dots that have all neighbours, else NaN.
template <class S>
PlacedDots prepare_dots(const DotMean& mean,
                        const GivenDots<S>& given,
                        const DotLayout& layout,
                        const Run& run,
                        const aligned_vector<S>& inner,
                        DotPlanes<S>& placed,
                        DotPlanes<S>& now) {
  using V = run_vector<S>;
  const Index stride = layout.stride();
  PlacedDots counts =
      place_dots<false>(given, {run.begin - stride, run.end + stride}, stride, placed);
  place_corners(given, layout, placed, counts);
  const S side = S(mean.weights.side), diagonal = S(mean.weights.diagonal);
  const V self = V{} + S(mean.weights.self), zero = V{} + S(0);
  const PlanesView<S> p = view(placed);
  for (Index k = run.begin; k < run.end; k += run_step<S>) {
    const V x = load_cells<V, S>(p.x + k), y = load_cells<V, S>(p.y + k);
    const V allowed = load_cells<V, S>(inner.data() + k);
    V sum_x = zero, sum_y = zero, weight = self;
    const auto add_pair = [&](Index step, const S& w) {
      const V off_x =
          load_cells<V, S>(p.x + k - step) + load_cells<V, S>(p.x + k + step) - S(2) * x + allowed;
      const V off_y =
          load_cells<V, S>(p.y + k - step) + load_cells<V, S>(p.y + k + step) - S(2) * y;
      const auto both = V(off_x * off_x + off_y * off_y) < no_distance_sq<S>();
      sum_x += only_where(both, V(w * off_x));
      sum_y += only_where(both, V(w * off_y));
      weight += only_where(both, V(zero + S(2) * w));
    };
    add_pair(1, side);
    add_pair(stride, side);
    add_pair(stride - 1, diagonal);
    add_pair(stride + 1, diagonal);
    const V touch = load_cells<V, S>(given.touch.data() + k);
    store_cells<S>(now.x.data() + k, V(x + sum_x / weight + touch));
    store_cells<S>(now.y.data() + k, V(y + sum_y / weight));
  }
  return counts;
}

/// What is left of the dots' displacements, and whether they may count in their neighbours' mean.
template <class S>
struct Residuals {
  Residuals() = default;
  explicit Residuals(const DotLayout& layout) : planes(layout), counts(planes.x.size(), S(0)) {}

  DotPlanes<S> planes;
  aligned_vector<S> counts;  ///< 1 or 0; where 0, so are x and y
};

/// Dots of a frame, as numbers in a plane.
template <class S>
struct DotMarks {
  static constexpr S unknown() { return S(1); }
  static constexpr S slip() { return S(2); }
  static constexpr S stick() { return S(3); }
};

/// Marks the dots of both frames: those that follow the object to within the square root of
/// slip_sq stick.
template <class Denoising, class S>
void mark_dots(const Denoising&,
               const FramePair<S>& pair,
               const ObjectShift<S>& shift,
               const S& slip_sq,
               Residuals<S>&,
               aligned_vector<S>& marks) {
  using V = run_vector<S>;
  const V unknown = V{} + DotMarks<S>::unknown(), slip = V{} + DotMarks<S>::slip(),
          stick = V{} + DotMarks<S>::stick();
  for (Index k = pair.run.begin; k < pair.run.end; k += run_step<S>) {
    V rx, ry;
    shift.residual(load_cells<V, S>(pair.now.x + k), load_cells<V, S>(pair.now.y + k),
                   load_cells<V, S>(pair.then.x + k), load_cells<V, S>(pair.then.y + k), rx, ry);
    const V sq = rx * rx + ry * ry;
    const V known = choose(sq < slip_sq, stick, slip);
    store_cells<S>(marks.data() + k, V(choose(sq < no_distance_sq<S>(), known, unknown)));
  }
}

/// Weighted sum of a dot and its eight neighbours.
template <class S>
class WeightedSum {
 public:
  WeightedSum(const DotWeights& weights, Index stride)
      : self_(S(weights.self)),
        side_(S(weights.side)),
        diagonal_(S(weights.diagonal)),
        stride_(stride) {}

  [[gnu::always_inline]] inline run_vector<S> operator()(const S* p) const {
    using V = run_vector<S>;
    const S* const above = p - stride_;
    const S* const below = p + stride_;
    const V sides = load_cells<V, S>(p - 1) + load_cells<V, S>(p + 1) + load_cells<V, S>(above) +
                    load_cells<V, S>(below);
    const V diagonals = load_cells<V, S>(above - 1) + load_cells<V, S>(above + 1) +
                        load_cells<V, S>(below - 1) + load_cells<V, S>(below + 1);
    return self_ * load_cells<V, S>(p) + side_ * sides + diagonal_ * diagonals;
  }

 private:
  S self_, side_, diagonal_;
  Index stride_;
};

template <class S>
void write_residuals(const FramePair<S>& pair,
                     const ObjectShift<S>& shift,
                     const S& gate_sq,
                     Residuals<S>& out,
                     aligned_vector<S>& marks) {
  using V = run_vector<S>;
  const V one = V{} + S(1);
  const V unknown = V{} + DotMarks<S>::unknown(), slip = V{} + DotMarks<S>::slip();
  const Index stride = pair.layout.stride();
  // the neighbours of the first and of the last dot too
  const Index first = pair.run.begin - stride - 1, last = pair.run.end + stride;
  for (Index k = first; k <= last; k += run_step<S>) {
    V rx, ry;
    shift.residual(load_cells<V, S>(pair.now.x + k), load_cells<V, S>(pair.now.y + k),
                   load_cells<V, S>(pair.then.x + k), load_cells<V, S>(pair.then.y + k), rx, ry);
    const V sq = rx * rx + ry * ry;
    const auto counts = sq < gate_sq;
    store_cells<S>(out.planes.x.data() + k, V(only_where(counts, rx)));
    store_cells<S>(out.planes.y.data() + k, V(only_where(counts, ry)));
    store_cells<S>(out.counts.data() + k, V(only_where(counts, one)));
    store_cells<S>(marks.data() + k, V(choose(sq < no_distance_sq<S>(), slip, unknown)));
  }
}

template <class S>
void mark_dots(const ResidualMean& mean,
               const FramePair<S>& pair,
               const ObjectShift<S>& shift,
               const S& slip_sq,
               Residuals<S>& residuals,
               aligned_vector<S>& marks) {
  using V = run_vector<S>;
  write_residuals(pair, shift, S(slip_sq * S(mean.gate * mean.gate)), residuals, marks);
  const WeightedSum<S> around(mean.weights, pair.layout.stride());
  const V stick = V{} + DotMarks<S>::stick(), zero = V{} + S(0);
  for (Index k = pair.run.begin; k < pair.run.end; k += run_step<S>) {
    const V x = around(residuals.planes.x.data() + k);
    const V y = around(residuals.planes.y.data() + k);
    const V weight = around(residuals.counts.data() + k);
    const V before = load_cells<V, S>(marks.data() + k);
    const auto follows = V(x * x + y * y) < V(slip_sq * weight * weight);
    const auto counts = zero < load_cells<V, S>(residuals.counts.data() + k);
    store_cells<S>(marks.data() + k, V(choose(counts, V(choose(follows, stick, before)), before)));
  }
}

}  // namespace detail::stick

}  // namespace v0
}  // namespace fingerpad
