// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The membrane's shape as a function of the position in plan: height, slope, and contact with the
// object.
#include <cmath>
#include <concepts>
#include <cstddef>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail::membrane {

/// Height of the membrane above a position, and its slope along x and y; NaN if unknown.
template <scalar S>
struct HeightAndSlope {
  S height_mm;
  S along_x;
  S along_y;
};

/// Heights on a square mesh in plan about Q. Slopes at the nodes are central differences; between
/// nodes, heights and slopes are interpolated bilinearly. 32 bytes per node in double.
template <scalar S>
class HeightMap {
 public:
  /// Covers positions within `half_width_mm` > 0 of Q along x and y, with nodes `spacing_mm` > 0
  /// apart. Refuses bad parameters (parameter_error).
  explicit HeightMap(const S& half_width_mm, const S& spacing_mm = S(1) / S(2))
      : spacing_mm_(spacing_mm), per_mm_(S(1) / spacing_mm) {
    expects(is_finite(spacing_mm) && value(spacing_mm) > 0, "HeightMap", "spacing_mm", spacing_mm,
            "finite and > 0");
    const S cells = half_width_mm / spacing_mm;
    expects(is_finite(cells) && value(cells) >= 2 && value(cells) <= 2000, "HeightMap",
            "half_width_mm", half_width_mm, "2 to 2000 times spacing_mm");
    middle_ = static_cast<Index>(value(cells)) + 1;
    const std::size_t count = static_cast<std::size_t>(side() * side());
    nodes_.assign(count, {not_a_number<S>(), not_a_number<S>(), not_a_number<S>()});
    share_.assign(count, S(0));
  }

  /// Number of nodes along each side, odd; the middle node is at Q.
  Index side() const { return 2 * middle_ + 1; }
  const S& spacing_mm() const { return spacing_mm_; }
  /// x of node column k, which is also y of node row k.
  S position_mm(Index k) const { return S(static_cast<double>(k - middle_)) * spacing_mm_; }

  /// Height and slope of a node.
  const HeightAndSlope<S>& node(Index row, Index col) const { return nodes_[at(row, col)]; }

  /// Writes every node, row after row: `height(row, col)` in mm (NaN: unknown), and
  /// `contact_share(row, col, height)`, the share of the membrane around it in contact, from 0 to
  /// 1.
  template <class Height, class Share>
  void fill(const Height& height, const Share& contact_share) {
    fill_rows(0, side(), height, contact_share);
    find_slopes();
  }

  /// The same for rows [first, last) alone, so that threads can share a map. Call find_slopes()
  /// once all rows are filled.
  template <class Height, class Share>
  void fill_rows(Index first, Index last, const Height& height, const Share& contact_share) {
    for (Index i = first; i < last; ++i) {
      // two loops, because a share waits for the height of its node, but not for others of the row
      for (Index j = 0; j < side(); ++j) {
        nodes_[at(i, j)].height_mm = S(height(i, j));
      }
      for (Index j = 0; j < side(); ++j) {
        share_[at(i, j)] = S(contact_share(i, j, nodes_[at(i, j)].height_mm));
      }
    }
  }

  /// The slopes of the nodes, from their heights.
  void find_slopes() {
    const S per_step = S(1) / (S(2) * spacing_mm_);
    for (Index i = 1; i + 1 < side(); ++i) {
      for (Index j = 1; j + 1 < side(); ++j) {
        HeightAndSlope<S>& here = nodes_[at(i, j)];
        here.along_x = (nodes_[at(i, j + 1)].height_mm - nodes_[at(i, j - 1)].height_mm) * per_step;
        here.along_y = (nodes_[at(i + 1, j)].height_mm - nodes_[at(i - 1, j)].height_mm) * per_step;
      }
    }
  }

  HeightAndSlope<S> operator()(const S& x_mm, const S& y_mm) const {
    const Cell cell = cell_of(x_mm, y_mm);
    if (!cell.inside) {
      return {not_a_number<S>(), not_a_number<S>(), not_a_number<S>()};
    }
    const HeightAndSlope<S>* up = &nodes_[at(cell.row, cell.col)];
    const HeightAndSlope<S>* low = up + side();
    return {between(cell, up[0].height_mm, up[1].height_mm, low[0].height_mm, low[1].height_mm),
            between(cell, up[0].along_x, up[1].along_x, low[0].along_x, low[1].along_x),
            between(cell, up[0].along_y, up[1].along_y, low[0].along_y, low[1].along_y)};
  }

  /// Whether at least half of the membrane here is in contact.
  bool in_contact(const S& x_mm, const S& y_mm) const {
    const Cell cell = cell_of(x_mm, y_mm);
    if (!cell.inside) {
      return false;
    }
    const S* up = &share_[at(cell.row, cell.col)];
    const S* low = up + side();
    return !(between(cell, up[0], up[1], low[0], low[1]) < S(1) / S(2));
  }

 private:
  /// The nodes around a position, and the position between them.
  struct Cell {
    bool inside;
    Index row;
    Index col;
    S down;
    S right;
  };

  Cell cell_of(const S& x_mm, const S& y_mm) const {
    const S col = x_mm * per_mm_ + S(static_cast<double>(middle_));
    const S row = y_mm * per_mm_ + S(static_cast<double>(middle_));
    const auto last = static_cast<scalar_real_t<S>>(static_cast<double>(side() - 1));
    if (!(value(row) >= 0 && value(col) >= 0 && value(row) < last && value(col) < last)) {
      return {false, 0, 0, S(0), S(0)};  // also for NaN
    }
    const Index i = static_cast<Index>(value(row));
    const Index j = static_cast<Index>(value(col));
    return {true, i, j, S(row - S(static_cast<double>(i))), S(col - S(static_cast<double>(j)))};
  }

  static S between(
      const Cell& cell, const S& up_left, const S& up_right, const S& left, const S& right) {
    const S up = up_left + cell.right * (up_right - up_left);
    const S low = left + cell.right * (right - left);
    return S(up + cell.down * (low - up));
  }

  std::size_t at(Index row, Index col) const {
    return static_cast<std::size_t>(row * side() + col);
  }

  S spacing_mm_;
  S per_mm_;  ///< nodes per mm
  Index middle_ = 0;
  std::vector<HeightAndSlope<S>> nodes_;
  std::vector<S> share_;
};

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
