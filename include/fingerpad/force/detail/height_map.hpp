// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The membrane's shape as a function of the place in plan: its height, its slope, and whether it
// touches the object there.
#include <cmath>
#include <concepts>
#include <cstddef>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail::membrane {

/// Height of the membrane above a place, and its rise along x and y; NaN where there is none.
template <scalar S>
struct HeightAndSlope {
  S height_mm;
  S along_x;
  S along_y;
};

/// Middle of the contact, from a mesh of places all over the base; false where none touches.
template <class Shape, scalar S>
bool find_contact(const Shape& shape, const S& base_radius_mm, Point3<S>& center) {
  constexpr int places = 64;
  const S step = S(2) * base_radius_mm / S(places);
  S x_sum = S(0), y_sum = S(0);
  int count = 0;
  for (int i = 0; i < places; ++i) {
    const S y = (S(i) + S(1) / S(2)) * step - base_radius_mm;
    for (int j = 0; j < places; ++j) {
      const S x = (S(j) + S(1) / S(2)) * step - base_radius_mm;
      if (shape.in_contact(x, y)) {
        x_sum = x_sum + x;
        y_sum = y_sum + y;
        ++count;
      }
    }
  }
  if (count == 0) {
    return false;
  }
  center = {S(x_sum / S(count)), S(y_sum / S(count)), S(0)};
  return true;
}

/// Whether the membrane is seen anywhere along x or y: where it is not, that nothing touches is not
/// known.
template <class Shape, scalar S>
bool has_height(const Shape& shape, const S& base_radius_mm) {
  constexpr int places = 64;
  for (int i = 1 - places; i < places; ++i) {
    const S at = S(i) / S(places) * base_radius_mm;
    if (is_finite(shape(at, S(0)).height_mm) || is_finite(shape(S(0), at).height_mm)) {
      return true;
    }
  }
  return false;
}

/// Heights on a square mesh in plan about Q; between the nodes heights and slopes are interpolated
/// bilinearly, slopes being central differences. 24 bytes a node in double.
template <scalar S>
class HeightMap {
 public:
  /// Memory for places within `half_width_mm` > 0 of Q along x and y, nodes `spacing_mm` > 0 apart.
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

  /// Nodes along each side, an odd number; the middle one is at Q.
  Index side() const { return 2 * middle_ + 1; }
  const S& spacing_mm() const { return spacing_mm_; }
  /// x of a column of nodes, and y of a row of the same number.
  S position_mm(Index k) const { return S(static_cast<double>(k - middle_)) * spacing_mm_; }

  /// Height of a node and its rise along x and y.
  const HeightAndSlope<S>& node(Index row, Index col) const { return nodes_[at(row, col)]; }

  /// Writes every node, row after row: `height(row, col)` in mm (NaN: none), and which share of the
  /// membrane around it touches the object, from 0 to 1.
  template <class Height, class Share>
  void fill(const Height& height, const Share& contact_share) {
    for (Index i = 0; i < side(); ++i) {
      // one after the other: a node's share waits for its height, those of a row do not
      for (Index j = 0; j < side(); ++j) {
        nodes_[at(i, j)].height_mm = S(height(i, j));
      }
      for (Index j = 0; j < side(); ++j) {
        share_[at(i, j)] = S(contact_share(i, j, nodes_[at(i, j)].height_mm));
      }
    }
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

  /// Whether half of the membrane touches here, or more.
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
  /// The nodes around a place, and where it lies between them.
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
      return {false, 0, 0, S(0), S(0)};  // and for NaN
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
  S per_mm_;  ///< nodes
  Index middle_ = 0;
  std::vector<HeightAndSlope<S>> nodes_;
  std::vector<S> share_;
};

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
