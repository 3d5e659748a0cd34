// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Masks made larger or smaller by a disc of any radius, in a time that does not depend on it.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

// Exact Euclidean distance of every pixel from the nearest one of a set, O(1) per pixel: first
// along the columns, then by the lower envelope of parabolas along each row.

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

/// Grows (by_px > 0) or shrinks (by_px < 0) masks of one size. What lies beyond the image neither
/// adds nor takes away. O(rows cols), no allocation.
class MaskGrowth {
 public:
  /// rows, cols >= 1 (parameter_error).
  MaskGrowth(Index rows, Index cols) : rows_(rows), cols_(cols) {
    expects(rows >= 1, "MaskGrowth", "rows", static_cast<long long>(rows), ">= 1");
    expects(cols >= 1, "MaskGrowth", "cols", static_cast<long long>(cols), ">= 1");
  }

  using Workspace = detail::MaskDistance;
  Workspace workspace() const { return Workspace(rows_, cols_); }

  /// Writes 255 (true) to `out` in the changed mask and 0 elsewhere; it may be `mask` itself.
  /// False, and nothing written, where a size differs or by_px is not finite.
  template <grid Mask, class Out>
    requires(writable_grid<Out>)
  bool operator()(const Mask& mask, double by_px, Out&& out, Workspace& distance) const {
    const auto from = as_view(mask);
    const auto to = as_view(out);
    if (!has_size(from) || !has_size(to) || !has_size(distance) || !is_finite(by_px)) {
      return false;
    }
    const bool grows = by_px >= 0;
    // what is in no mask is farther than this
    const double reach = (std::min)(std::abs(by_px), static_cast<double>(rows_ + cols_ - 1));
    distance.measure(
        [&](Index i, Index j) { return is_contact(cell_t<Mask>(from(i, j))) == grows; });
    for (Index i = 0; i < rows_; ++i) {
      distance.row(i, [&](Index j, double squared_px) {
        const bool near = squared_px <= reach * reach;
        to(i, j) = static_cast<cell_t<Out>>(near == grows ? 255 : 0);
      });
    }
    return true;
  }

 private:
  template <class G>
  bool has_size(const G& g) const {
    return g.rows() == rows_ && g.cols() == cols_;
  }
  Index rows_;
  Index cols_;
};

}  // namespace v0
}  // namespace fingerpad
