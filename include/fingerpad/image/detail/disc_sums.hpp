// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Sums over a disc from a summed-area table. Each rectangle of the disc reads a fixed number of
// table entries, whatever its size. For float and double the table holds integers (steps of 4e-6
// and 9e-16 rad for a radius of 30 px) that may wrap: their differences are exact, so that errors
// do not accumulate and a sum depends only on the pixels of its own disc. Other scalars are summed
// as they are, with an error of about epsilon (rows + cols) times the largest table entry.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/row_lanes.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

// A disc of pixels as a stack of rectangles, for sums over the disc from a summed-area table.
//
//        ____            Rectangle k reaches half_cols[k] to each side and half_rows[k] up and
//      _|____|_          down; wider ones are lower. Their union is the sum of all rectangles
//     |_|____|_|         minus the overlaps of each with the next.
//       |____|

struct DiscLevel {
  Index half_rows;
  Index half_cols;
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

/// The union of rectangles with these decreasing half widths. The half heights are the same numbers
/// in reverse order, so that rows and columns are treated alike.
inline DiscShape staircase(const std::vector<Index>& half_cols) {
  DiscShape shape;
  const std::size_t n = half_cols.size();
  for (std::size_t k = 0; k < n; ++k) {
    shape.levels.push_back({half_cols[n - 1 - k], half_cols[k]});
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

/// Number of pixels and second moment sum(x^2) of a figure that is given by its half width in each
/// row.
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

/// At most five rectangles, weighted so that area and second moment are those of the disc. Sums are
/// exact for a change of inclination of up to second order over the disc, and the cost per pixel
/// does not depend on the radius. The number of rectangles is odd, so that the middle one is a
/// square.
struct SteppedDisc {
  static constexpr int levels = 5;

  static DiscShape shape(Index radius_px) {
    const DiscShape exact = exact_disc(radius_px);
    if (exact.levels.size() <= static_cast<std::size_t>(levels)) {
      return exact;
    }
    // Of steps in a few scales, take those that differ from the disc in the fewest pixels.
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

/// The number type of inclination sums: an integer for float and double, else S itself.
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
  /// Integer steps per rad: a power of two, at most 1 / epsilon, with which `area` right angles
  /// still fit.
  static S unit(double area) {
    S steps = S(1);
    const S most = S(std::uint64_t(1) << (8 * sizeof(S) - 2)) / S(area * 1.6);
    while (steps * 2 < most && steps < S(1) / (std::numeric_limits<S>::epsilon)()) {
      steps *= 2;
    }
    return steps;
  }
  /// Rounds steps >= 0 to integers; takes a number or a vector.
  template <class V>
  [[gnu::always_inline]] static auto from(const V& steps) {
    using Ints = typename RowVector<Signed, lanes_in<V, S>>::type;
    using Totals = typename RowVector<Unsigned, lanes_in<V, S>>::type;
    return std::bit_cast<Totals>(each_as<Ints>(V(steps + S(1) / S(2))));
  }
  template <class Totals>
  [[gnu::always_inline]] static auto to(const Totals& total) {
    constexpr int n = lanes_in<Totals, Unsigned>;
    using Ints = typename RowVector<Signed, n>::type;
    return each_as<typename RowVector<S, n>::type>(std::bit_cast<Ints>(total));
  }
};
template <>
struct InclinationTotal<float> : IntegerTotal<float, std::uint32_t, std::int32_t> {};
template <>
struct InclinationTotal<double> : IntegerTotal<double, std::uint64_t, std::int64_t> {};

/// Two rows of a table: below[j] - above[j] is the sum over a band of image rows and the columns
/// before j.
template <class T>
struct Band {
  const T* below;
  const T* above;
};

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
    Index j = 0;
#if defined(FINGERPAD_HAS_VECTORS)
    if constexpr (constexpr int n = row_lanes<T>; n > 1 && std::same_as<Cell, T>) {
      constexpr auto order = std::make_index_sequence<std::size_t(n)>{};
      lanes<T, n> carry{};
      for (; j + n <= cols_; j += n) {
        const lanes<T, n> local = running_sum<n>(load<T, n>(cells + j));
        store(here + j + 1, load<T, n>(above + j + 1) + local + carry);
        carry += last_everywhere(local, order);
      }
      run = carry[0];
    }
#endif
    for (; j < cols_; ++j) {
      run = T(run + T(cells[j]));
      here[j + 1] = T(above[j + 1] + run);
    }
  }

  /// The band of rows [row - half, row + half], clipped to the image.
  Band<T> band(Index row, Index half) const {
    return {line(row + half + 1 < rows_ ? row + half + 1 : rows_),
            line(row - half > 0 ? row - half : 0)};
  }
  Band<T> no_band() const {
    return {line(0), line(0)};
  }
  Index cols() const {
    return cols_;
  }

 private:
  const T* line(Index row) const {
    return table_.data() + row * (cols_ + 1);
  }

  Index rows_ = 0;
  Index cols_ = 0;
  std::vector<T> table_;
};

/// One row of disc sums in the table's number type: over the staircase, and over its square. Level
/// k adds the rows that the levels before it do not reach, over its own width:
///   sum over k of [D_k(j + half_cols[k] + 1) - D_k(j - half_cols[k])],  D_k = B_k - B_{k - 1},
/// where B_k(j) is the sum over the band of level k and the columns before j.
template <class T>
class DiscRow {
 public:
  DiscRow(Index cols, Index radius_px, const DiscShape& shape)
      : margin_(radius_px),
        pitch_(cols + 1 + 2 * radius_px),
        stairs_(static_cast<std::size_t>(cols), T(0)),
        square_(static_cast<std::size_t>(cols), T(0)),
        bands_(static_cast<std::size_t>(pitch_) * (shape.levels.size() + 1), T(0)) {
    for (std::size_t k = 0; k < shape.levels.size(); ++k) {
      ends_.push_back(ends_of(k, shape.levels[k]));
    }
    if (shape.square >= 0) {
      square_ends_ = ends_of(ends_.size(), shape.levels[static_cast<std::size_t>(shape.square)]);
    }
  }

  const T* stairs() const { return stairs_.data(); }
  const T* square() const { return square_.data(); }

  /// Whether it was made for this image width and radius.
  bool fits(Index cols, Index radius_px) const {
    return stairs_.size() == static_cast<std::size_t>(cols) && margin_ == radius_px;
  }

  /// Computes the sums over the discs centered on the columns [first, last) of a row.
  void sum(const SummedArea<T>& table, const DiscShape& shape, Index row, Index first, Index last) {
    Band<T> inner = table.no_band();
    for (std::size_t k = 0; k < ends_.size(); ++k) {
      const Band<T> band = table.band(row, shape.levels[k].half_rows);
      subtract(band, inner, k, first, last);
      inner = band;
    }
    add_up(ends_.data(), ends_.size(), stairs_.data(), first, last);
    if (shape.square >= 0) {
      const DiscLevel& level = shape.levels[static_cast<std::size_t>(shape.square)];
      subtract(table.band(row, level.half_rows), table.no_band(), ends_.size(), first, last);
      add_up(&square_ends_, 1, square_.data(), first, last);
    }
  }

 private:
  /// Offsets in bands_ of the two column sums that bound a disc around column 0: past its last
  /// column (`right`) and before its first (`left`).
  struct Ends {
    Index right = 0;
    Index left = 0;
  };
  Ends ends_of(std::size_t band, const DiscLevel& level) const {
    const Index center = static_cast<Index>(band) * pitch_ + margin_;
    return {center + level.half_cols + 1, center - level.half_cols};
  }

  /// Sets band k to outer - inner for all columns within reach. Beyond the image, the sums at its
  /// edge are repeated.
  void subtract(
      const Band<T>& outer, const Band<T>& inner, std::size_t k, Index first, Index last) {
    const Index cols = static_cast<Index>(stairs_.size());
    const Index begin = (std::max)(first - margin_, Index(0));
    const Index end = (std::min)(last + margin_, cols) + 1;
    T* to = bands_.data() + static_cast<Index>(k) * pitch_ + margin_;
    for_each_cell<T>(end - begin, [=]<class V>(Index i) {
      const auto at = [i, begin](const T* sums) { return load_cells<V, T>(sums + begin + i); };
      const V wider = at(outer.below) - at(outer.above);
      const V narrower = at(inner.below) - at(inner.above);
      store_cells<T>(to + begin + i, V(wider - narrower));
    });
    std::fill(to + end, to + (std::max)(end, last + margin_ + 1), to[end - 1]);
  }

  void add_up(const Ends* ends, std::size_t count, T* to, Index first, Index last) const {
    const T* bands = bands_.data() + first;
    for_each_cell<T>(last - first, [=]<class V>(Index j) {
      V sum = every_lane<V>(T(0));
      for (std::size_t k = 0; k < count; ++k) {
        sum = sum + load_cells<V, T>(bands + ends[k].right + j);
        sum = sum - load_cells<V, T>(bands + ends[k].left + j);
      }
      store_cells<T>(to + first + j, sum);
    });
  }

  Index margin_;
  Index pitch_;
  std::vector<T> stairs_, square_;
  std::vector<T> bands_;  ///< D_k of each level and B of the square, with a margin of the radius
  std::vector<Ends> ends_;
  Ends square_ends_;
};

}  // namespace detail

}  // namespace v0
}  // namespace fingerpad
