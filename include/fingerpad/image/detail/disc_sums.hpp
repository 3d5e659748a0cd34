// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Sums over a disc from a summed-area table: a fixed number of table entries per rectangle of the
// disc, whatever its size. For float and double the table holds integers (steps of 4e-6 and 9e-16
// rad for a radius of 30 px) that may wrap: their differences are exact, so nothing drifts, and a
// sum depends on nothing but the pixels of its own disc. Other numbers are summed as they are,
// which costs about epsilon (rows + cols) of the largest table entry.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "fingerpad/image/disc_shape.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

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
