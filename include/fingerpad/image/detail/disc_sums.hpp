// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Sums over a disc from a summed-area table: a fixed number of table entries per rectangle of the
// disc, whatever its size. For float and double the table holds integers (steps of 4e-6 and 9e-16
// rad for a radius of 30 px) that may wrap: their differences are exact, so nothing drifts, and a
// sum depends on nothing but the pixels of its own disc. Other numbers are summed as they are,
// which costs about epsilon (rows + cols) of the largest table entry.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

// A disc of pixels as a pile of rectangles, for sums over the disc from a summed-area table.
//
//        ____            Rectangle k reaches half_cols[k] to each side and half_rows[k] up and
//      _|____|_          down; wider ones are lower. Their union is the sum of all rectangles
//     |_|____|_|         minus the overlaps of each with the next, half_cols[k + 1] by
//       |____|           half_rows[k].

struct DiscLevel {
  Index half_rows;
  Index half_cols;
  Index overlap_half_cols;  ///< of the next, narrower rectangle; -1 for the last
};

/// sum = staircase_weight * (sum over the union) + square_weight * (sum over levels[square]).
struct DiscShape {
  std::vector<DiscLevel> levels;
  std::ptrdiff_t square = -1;  ///< which level is square; -1: none is needed
  double staircase_weight = 1;
  double square_weight = 0;
};

/// Largest w with w^2 + row^2 <= radius^2.
inline Index disc_half_width(Index radius, Index row) {
  Index w = 0;
  while ((w + 1) * (w + 1) + row * row <= radius * radius) {
    ++w;
  }
  return w;
}

/// The union of rectangles with these falling half widths; half heights are the same numbers from
/// the other end, so that rows and columns count alike.
inline DiscShape staircase(const std::vector<Index>& half_cols) {
  DiscShape shape;
  const std::size_t n = half_cols.size();
  for (std::size_t k = 0; k < n; ++k) {
    shape.levels.push_back({half_cols[n - 1 - k], half_cols[k], k + 1 < n ? half_cols[k + 1] : -1});
  }
  return shape;
}

/// Half width of the staircase in a row; -1 above its top.
inline Index staircase_half_width(const DiscShape& shape, Index row) {
  for (const DiscLevel& level : shape.levels) {
    if (row <= level.half_rows) {
      return level.half_cols;
    }
  }
  return -1;
}

/// Number of pixels and their second moment sum(x^2) of a figure given by half width per row.
struct DiscMoments {
  double area = 0;
  double second = 0;

  void add_row(Index half_width) {
    const double w = static_cast<double>(half_width);
    area += 2 * w + 1;
    second += w * (w + 1) * (2 * w + 1) / 3;
  }
};

/// Every pixel whose center lies within the radius: about 0.6 radius rectangles.
inline DiscShape exact_disc(Index radius_px) {
  std::vector<Index> half_cols;
  for (Index row = 0; row <= radius_px; ++row) {
    const Index w = disc_half_width(radius_px, row);
    if (half_cols.empty() || half_cols.back() != w) {
      half_cols.push_back(w);
    }
  }
  return staircase(half_cols);
}

/// At most five rectangles, weighted so that area and second moment are those of the disc: exact
/// for a change of inclination up to second order over the disc, at a cost per pixel that does not
/// depend on the radius. Their number is odd, so that the middle rectangle is a square.
struct SteppedDisc {
  static constexpr int levels = 5;

  static DiscShape shape(Index radius_px) {
    const DiscShape exact = exact_disc(radius_px);
    if (exact.levels.size() <= static_cast<std::size_t>(levels)) {
      return exact;
    }
    // The steps that share the fewest pixels with what the disc leaves out, over a few scales.
    std::vector<Index> best;
    Index best_difference = 0;
    for (int percent = 95; percent <= 106; ++percent) {
      const std::vector<Index> steps = steps_of(radius_px, percent / 100.0);
      const Index difference = difference_from_disc(staircase(steps), radius_px);
      if (best.empty() || difference < best_difference) {
        best = steps;
        best_difference = difference;
      }
    }
    return weighted(staircase(best), radius_px);
  }

 private:
  static std::vector<Index> steps_of(Index radius_px, double scale) {
    std::vector<Index> steps;
    for (int k = 0; k < levels; ++k) {
      const double angle = (k + 0.5) / levels * 1.5707963267948966;
      const double w = scale * static_cast<double>(radius_px) * std::cos(angle);
      const Index whole = static_cast<Index>(w + 0.5);
      steps.push_back(whole < radius_px ? whole : radius_px);
    }
    return steps;
  }

  static Index difference_from_disc(const DiscShape& shape, Index radius_px) {
    Index difference = 0;
    for (Index row = 0; row <= radius_px; ++row) {
      const Index a = staircase_half_width(shape, row);
      const Index b = disc_half_width(radius_px, row);
      difference += a < b ? b - a : a - b;
    }
    return difference;
  }

  static DiscShape weighted(DiscShape shape, Index radius_px) {
    DiscMoments disc, stairs, square;
    shape.square = levels / 2;
    const Index side = shape.levels[static_cast<std::size_t>(shape.square)].half_cols;
    for (Index row = -radius_px; row <= radius_px; ++row) {
      const Index distance = row < 0 ? -row : row;
      disc.add_row(disc_half_width(radius_px, distance));
      const Index w = staircase_half_width(shape, distance);
      if (w >= 0) {
        stairs.add_row(w);
      }
      if (distance <= side) {
        square.add_row(side);
      }
    }
    const double determinant = stairs.area * square.second - square.area * stairs.second;
    shape.staircase_weight = (disc.area * square.second - square.area * disc.second) / determinant;
    shape.square_weight = (stairs.area * disc.second - disc.area * stairs.second) / determinant;
    return shape;
  }
};

/// How sums of inclinations are kept.
template <scalar S>
struct InclinationTotal {
  using type = S;
  static S unit(double /*area*/) { return S(1); }
  static S from(const S& steps) { return steps; }
  static S to(const S& total) { return total; }
};
template <class S, class Unsigned, class Signed>
struct IntegerTotal {
  using type = Unsigned;
  /// Steps per rad: a power of two at which `area` right angles still fit.
  static S unit(double area) {
    S steps = S(1);
    const S most = S(std::uint64_t(1) << (8 * sizeof(S) - 2)) / S(area * 1.6);
    while (steps * 2 < most && steps < S(1) / (std::numeric_limits<S>::epsilon)()) {
      steps *= 2;
    }
    return steps;
  }
  static Unsigned from(S steps) {
    return static_cast<Unsigned>(static_cast<Signed>(steps + S(1) / S(2)));
  }
  static S to(Unsigned total) { return static_cast<S>(static_cast<Signed>(total)); }
};
template <>
struct InclinationTotal<float> : IntegerTotal<float, std::uint32_t, std::int32_t> {};
template <>
struct InclinationTotal<double> : IntegerTotal<double, std::uint64_t, std::int64_t> {};

/// Table of sums over all cells above and to the left; (rows + 1) x (cols + 1).
template <class T>
class SummedArea {
 public:
  SummedArea() = default;
  SummedArea(Index rows, Index cols)
      : rows_(rows), cols_(cols), table_(static_cast<std::size_t>((rows + 1) * (cols + 1)), T(0)) {}

  template <class Cell>
  void set_row(Index row, const Cell* cells) {
    const T* above = line(row);
    T* here = table_.data() + (row + 1) * (cols_ + 1);
    T run = T(0);
    for (Index j = 0; j < cols_; ++j) {
      run = T(run + T(cells[j]));
      here[j + 1] = T(above[j + 1] + run);
    }
  }

  /// to[j + margin] = sum over rows [row - half, row + half] of the columns before j, for j from
  /// -margin to cols + margin; rows and columns beyond the image are empty.
  void band(Index row, Index half, Index margin, T* to) const {
    const T* low = line(row + half + 1 < rows_ ? row + half + 1 : rows_);
    const T* high = line(row - half > 0 ? row - half : 0);
    T* inside = to + margin;
    for (Index j = 0; j <= cols_; ++j) {
      inside[j] = T(low[j] - high[j]);
    }
    for (Index j = 0; j < margin; ++j) {
      to[j] = T(0);
      inside[cols_ + 1 + j] = inside[cols_];
    }
  }

 private:
  const T* line(Index row) const { return table_.data() + row * (cols_ + 1); }

  Index rows_ = 0;
  Index cols_ = 0;
  std::vector<T> table_;
};

/// One row of disc sums in the table's own number: over the staircase, and over its square.
template <class T>
struct DiscRow {
  std::vector<T> stairs, square, band;

  DiscRow() = default;
  DiscRow(Index cols, Index radius_px)
      : stairs(static_cast<std::size_t>(cols), T(0)),
        square(static_cast<std::size_t>(cols), T(0)),
        band(static_cast<std::size_t>(cols + 1 + 2 * radius_px), T(0)) {}

  void sum(const SummedArea<T>& table, const DiscShape& shape, Index radius_px, Index row) {
    const Index cols = static_cast<Index>(stairs.size());
    for (std::size_t k = 0; k < shape.levels.size(); ++k) {
      const DiscLevel& level = shape.levels[k];
      table.band(row, level.half_rows, radius_px, band.data());
      const T* center = band.data() + radius_px;
      const T* right = center + level.half_cols + 1;
      const T* left = center - level.half_cols;
      const bool last = level.overlap_half_cols < 0;
      const T* inner_right = last ? center : center + level.overlap_half_cols + 1;
      const T* inner_left = last ? center : center - level.overlap_half_cols;
      add(k == 0, cols, right, left, inner_right, inner_left, stairs.data());
      if (static_cast<std::ptrdiff_t>(k) == shape.square) {
        add(true, cols, right, left, center, center, square.data());
      }
    }
  }

 private:
  static void add(bool first,
                  Index cols,
                  const T* right,
                  const T* left,
                  const T* inner_right,
                  const T* inner_left,
                  T* to) {
    if (first) {
      for (Index j = 0; j < cols; ++j) {
        to[j] = T(T(right[j] - left[j]) - T(inner_right[j] - inner_left[j]));
      }
    } else {
      for (Index j = 0; j < cols; ++j) {
        to[j] = T(to[j] + T(T(right[j] - left[j]) - T(inner_right[j] - inner_left[j])));
      }
    }
  }
};

}  // namespace detail

}  // namespace v0
}  // namespace fingerpad
