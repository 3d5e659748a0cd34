// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The curvature of the free membrane around a contact, measured where a ring sees nothing of the
// contact. It is a mean over a window, because a sheared pad bulges unevenly around the object. It
// is computed for every fourth pixel, which is finer than the ring can resolve.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/regions.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Sums over square windows of 2 reach + 1 cells: running sums along each row, then down all
/// columns at once.
template <class S>
class CellSums {
 public:
  CellSums(Index rows, Index cols)
      : rows_(rows),
        cols_(cols),
        before_(static_cast<std::size_t>(rows * cols)),
        sum_(static_cast<std::size_t>(cols)) {}

  void operator()(std::vector<S>& cells, Index reach) {
    before_ = cells;
    for (Index i = 0; i < rows_; ++i) {
      along_row(row(before_, i), row(cells, i), reach);
    }
    before_ = cells;
    along_columns(cells, reach);
  }

 private:
  S* row(std::vector<S>& cells, Index i) const { return cells.data() + i * cols_; }

  void along_row(const S* from, S* to, Index reach) const {
    S sum = S(0);
    for (Index k = 0; k < (std::min)(reach, cols_); ++k) {
      sum = sum + from[k];
    }
    for (Index k = 0; k < cols_; ++k) {
      const S enters = k + reach < cols_ ? from[k + reach] : S(0);
      const S leaves = k - reach > 0 ? from[k - reach - 1] : S(0);
      const S change = enters - leaves;
      sum = sum + change;
      to[k] = sum;
    }
  }

  void along_columns(std::vector<S>& cells, Index reach) {
    std::fill(sum_.begin(), sum_.end(), S(0));
    for (Index k = 0; k < (std::min)(reach, rows_); ++k) {
      add(row(before_, k), S(1));
    }
    for (Index k = 0; k < rows_; ++k) {
      if (k + reach < rows_) {
        add(row(before_, k + reach), S(1));
      }
      if (k - reach > 0) {
        add(row(before_, k - reach - 1), S(-1));
      }
      std::copy(sum_.begin(), sum_.end(), row(cells, k));
    }
  }
  void add(const S* from, const S& sign) {
    S* sum = sum_.data();
    for (Index j = 0; j < cols_; ++j) {
      sum[j] = sum[j] + sign * from[j];
    }
  }

  Index rows_;
  Index cols_;
  std::vector<S> before_;
  std::vector<S> sum_;
};

template <class S>
class OutsideLevel {
 public:
  static constexpr Index step = 4;

  OutsideLevel(const BorderedImage& image, Index ring_px)
      : rows_((image.rows + step - 1) / step),
        cols_((image.cols + step - 1) / step),
        near_((3 * ring_px / 2 + step - 1) / step),
        window_((5 * ring_px / 2 + step - 1) / step),
        level_(static_cast<std::size_t>(rows_ * cols_)),
        weight_(level_.size()),
        sums_(rows_, cols_) {}

  Index cells() const { return rows_ * cols_; }
  /// The cell nearest to a pixel.
  Index cell(Index row, Index col) const {
    const Index i = (std::min)((row + step / 2) / step, rows_ - 1);
    const Index j = (std::min)((col + step / 2) / step, cols_ - 1);
    return i * cols_ + j;
  }
  /// The level at a cell, 1/mm.
  const S& operator[](std::size_t cell) const { return level_[cell]; }

  /// Computes the levels from the curvatures of a frame and its seeds of contact. `curvature` may
  /// count negative sections as 0 or not: a free membrane has none. Pixels below the threshold are
  /// not free, even if cleaning dropped them. A window without free pixels gets the mean over the
  /// frame, and twice the threshold if the frame has none either.
  template <class Curvature, class Marks>
  void measure(const Curvature& curvature, const Marks& marks, const S& threshold) {
    visit_cells([&](std::size_t k, Index i, Index j) {
      const bool touched = marks(i, j) == Mark::seed || curvature(i, j) < threshold;
      weight_[k] = touched ? S(1) : S(0);
    });
    sums_(weight_, near_);
    S total = S(0);
    S count = S(0);
    visit_cells([&](std::size_t k, Index i, Index j) {
      const S here = curvature(i, j);
      const bool free = weight_[k] < S(0.5) && is_finite(here);
      level_[k] = free ? here : S(0);
      weight_[k] = free ? S(1) : S(0);
      total = total + level_[k];
      count = count + weight_[k];
    });
    const S everywhere = count > S(0.5) ? S(total / count) : S(threshold + threshold);
    sums_(level_, window_);
    sums_(weight_, window_);
    for (std::size_t k = 0; k < level_.size(); ++k) {
      level_[k] = weight_[k] > S(0.5) ? S(level_[k] / weight_[k]) : everywhere;
    }
  }

 private:
  /// Calls visit(cell, row, col) with the pixel that represents the cell.
  template <class Visit>
  void visit_cells(const Visit& visit) const {
    std::size_t k = 0;
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j, ++k) {
        visit(k, i * step, j * step);
      }
    }
  }

  Index rows_;
  Index cols_;
  Index near_;
  Index window_;
  std::vector<S> level_;
  std::vector<S> weight_;
  CellSums<S> sums_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
