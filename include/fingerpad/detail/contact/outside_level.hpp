// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The curvature of the free membrane around a contact, where a ring sees nothing of it: a mean over
// a window, because a sheared pad is flatter before the object than behind it. On every fourth
// pixel, which is finer than the ring can tell.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "fingerpad/detail/contact/regions.hpp"
#include "fingerpad/grid.hpp"
#include "fingerpad/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Sums over windows of 2 reach + 1 cells, by running along the rows and then along the columns.
template <class S>
class CellSums {
 public:
  CellSums(Index rows, Index cols) : rows_(rows), cols_(cols) {
    line_.resize(static_cast<std::size_t>((std::max)(rows, cols)));
  }

  void operator()(std::vector<S>& cells, Index reach) {
    for (Index i = 0; i < rows_; ++i) {
      run(cells.data() + i * cols_, cols_, 1, reach);
    }
    for (Index j = 0; j < cols_; ++j) {
      run(cells.data() + j, rows_, cols_, reach);
    }
  }

 private:
  void run(S* cells, Index count, Index stride, Index reach) {
    for (Index k = 0; k < count; ++k) {
      line_[static_cast<std::size_t>(k)] = cells[k * stride];
    }
    S sum = S(0);
    for (Index k = 0; k < (std::min)(reach, count); ++k) {
      sum = sum + line_[static_cast<std::size_t>(k)];
    }
    for (Index k = 0; k < count; ++k) {
      if (k + reach < count) {
        sum = sum + line_[static_cast<std::size_t>(k + reach)];
      }
      if (k - reach > 0) {
        sum = sum - line_[static_cast<std::size_t>(k - reach - 1)];
      }
      cells[k * stride] = sum;
    }
  }

  Index rows_;
  Index cols_;
  std::vector<S> line_;
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
  /// In 1/mm.
  const S& operator[](std::size_t cell) const { return level_[cell]; }

  /// From the curvatures of a frame and its seeds of contact. Negative sections count as 0 in
  /// `curvature`, or do not: there are none on a free membrane. What is below the threshold is not
  /// free, even if cleaning dropped it. Where nothing is, the threshold is taken for half of it.
  template <class Curvature, class Marks>
  void measure(const Curvature& curvature, const Marks& marks, const S& threshold) {
    for (Index c = 0; c < cells(); ++c) {
      const bool touched = is_seed(marks, c) || at(curvature, c) < threshold;
      weight_[static_cast<std::size_t>(c)] = touched ? S(1) : S(0);
    }
    sums_(weight_, near_);
    S total = S(0);
    S count = S(0);
    for (Index c = 0; c < cells(); ++c) {
      const auto k = static_cast<std::size_t>(c);
      const S here = at(curvature, c);
      const bool free = weight_[k] < S(0.5) && is_finite(here);
      level_[k] = free ? here : S(0);
      weight_[k] = free ? S(1) : S(0);
      total = total + level_[k];
      count = count + weight_[k];
    }
    const S everywhere = count > S(0.5) ? S(total / count) : S(threshold + threshold);
    sums_(level_, window_);
    sums_(weight_, window_);
    for (std::size_t k = 0; k < level_.size(); ++k) {
      level_[k] = weight_[k] > S(0.5) ? S(level_[k] / weight_[k]) : everywhere;
    }
  }

 private:
  template <class Map>
  decltype(auto) at(const Map& map, Index c) const {
    return map(c / cols_ * step, c % cols_ * step);
  }
  template <class Marks>
  bool is_seed(const Marks& marks, Index c) const {
    return at(marks, c) == Mark::seed;
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
