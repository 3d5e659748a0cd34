// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Exact Euclidean distance of every pixel from the nearest one of a set, O(1) per pixel: first
// along the columns, then by the lower envelope of parabolas along each row.
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

class MaskDistance {
 public:
  MaskDistance(Index rows, Index cols)
      : rows_(rows),
        cols_(cols),
        far_(rows + cols),
        along_(static_cast<std::size_t>(rows * cols)),
        vertex_(static_cast<std::size_t>(cols)),
        start_(static_cast<std::size_t>(cols)) {}

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }

  /// Takes the pixels for which is_in(row, col) is true as the set.
  template <class IsIn>
  void measure(const IsIn& is_in) {
    for (Index i = 0; i < rows_; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        along(i, j) = is_in(i, j) ? 0 : i > 0 ? nearer(along(i - 1, j)) : far_;
      }
    }
    for (Index i = rows_ - 2; i >= 0; --i) {
      for (Index j = 0; j < cols_; ++j) {
        const Index from_below = nearer(along(i + 1, j));
        along(i, j) = from_below < along(i, j) ? from_below : along(i, j);
      }
    }
  }

  /// Calls visit(col, squared distance in px^2) for the pixels of a row. Distances in an empty set
  /// are beyond any in the image.
  template <class Visit>
  void row(Index i, const Visit& visit) {
    Index count = 0;
    for (Index j = 0; j < cols_; ++j) {
      if (along(i, j) == far_) {
        continue;  // nothing in the whole column
      }
      double from = 0;
      while (count > 0) {
        from = crossing(i, vertex_[static_cast<std::size_t>(count - 1)], j);
        if (from > start_[static_cast<std::size_t>(count - 1)]) {
          break;
        }
        --count;
      }
      vertex_[static_cast<std::size_t>(count)] = j;
      start_[static_cast<std::size_t>(count)] = count > 0 ? from : -1;
      ++count;
    }
    Index k = 0;
    for (Index j = 0; j < cols_; ++j) {
      if (count == 0) {
        visit(j, static_cast<double>(far_) * static_cast<double>(far_));
        continue;
      }
      while (k + 1 < count && start_[static_cast<std::size_t>(k + 1)] < static_cast<double>(j)) {
        ++k;
      }
      const Index at = vertex_[static_cast<std::size_t>(k)];
      visit(j, static_cast<double>((j - at) * (j - at)) + squared(i, at));
    }
  }

 private:
  Index& along(Index i, Index j) { return along_[static_cast<std::size_t>(i * cols_ + j)]; }
  Index nearer(Index distance) const { return distance < far_ ? distance + 1 : far_; }
  double squared(Index i, Index j) {
    const double d = static_cast<double>(along(i, j));
    return d * d;
  }
  /// Column at which the parabola of `right` falls below that of `left`.
  double crossing(Index i, Index left, Index right) {
    const double l = static_cast<double>(left);
    const double r = static_cast<double>(right);
    return ((squared(i, right) + r * r) - (squared(i, left) + l * l)) / (2 * (r - l));
  }

  Index rows_;
  Index cols_;
  Index far_;
  std::vector<Index> along_;  ///< distance along the column
  std::vector<Index> vertex_;
  std::vector<double> start_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
