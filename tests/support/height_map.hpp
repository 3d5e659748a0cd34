// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Shapes of a membrane in plan: what published/segment_equilibrium.hpp takes.
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace test {

using fingerpad::Index;

/// The membrane at a position; NaN where unknown.
template <class S = double>
struct MembranePoint {
  S height_mm = fingerpad::not_a_number<S>();
  S along_x = fingerpad::not_a_number<S>();  ///< slopes
  S along_y = fingerpad::not_a_number<S>();
  S contact_share = S(0);  ///< of the membrane here that touches the object, from 0 to 1
};

/// Heights on a square mesh in plan about Q. Slopes at the nodes are
/// central differences; between nodes all is interpolated bilinearly. 32 bytes per node in double.
template <class S = double>
class HeightMap {
 public:
  /// Covers positions within `half_width_mm` of Q along x and y, with nodes `spacing_mm` apart.
  explicit HeightMap(const S& half_width_mm, const S& spacing_mm = S(0.5))
      : spacing_mm_(spacing_mm), per_mm_(S(1) / spacing_mm) {
    middle_ = static_cast<Index>(half_width_mm / spacing_mm) + 1;
    nodes_.resize(static_cast<std::size_t>(side() * side()));
  }

  /// Number of nodes along each side, odd; the middle node is at Q.
  Index side() const { return 2 * middle_ + 1; }
  const S& spacing_mm() const { return spacing_mm_; }
  /// x of node column k, which is also y of node row k.
  S position_mm(Index k) const { return S(static_cast<double>(k - middle_)) * spacing_mm_; }
  const MembranePoint<S>& node(Index row, Index col) const { return nodes_[at(row, col)]; }

  /// Writes every node, row after row: `height(row, col)` in mm (NaN: unknown), and
  /// `contact_share(row, col, height)`. `height` may read the heights of the nodes before.
  template <class Height, class Share>
  void fill(const Height& height, const Share& contact_share) {
    for (Index i = 0; i < side(); ++i) {
      // two loops, because a share waits for the height of its node, but not for others of the row
      for (Index j = 0; j < side(); ++j) {
        nodes_[at(i, j)].height_mm = height(i, j);
      }
      for (Index j = 0; j < side(); ++j) {
        nodes_[at(i, j)].contact_share = contact_share(i, j, nodes_[at(i, j)].height_mm);
      }
    }
    const S per_step = per_mm_ / S(2);
    for (Index i = 1; i + 1 < side(); ++i) {
      for (Index j = 1; j + 1 < side(); ++j) {
        const auto high = [&](Index row, Index col) { return nodes_[at(row, col)].height_mm; };
        nodes_[at(i, j)].along_x = (high(i, j + 1) - high(i, j - 1)) * per_step;
        nodes_[at(i, j)].along_y = (high(i + 1, j) - high(i - 1, j)) * per_step;
      }
    }
  }

  /// The membrane at a position. O(1).
  MembranePoint<S> operator()(const S& x_mm, const S& y_mm) const {
    const S col = x_mm * per_mm_ + S(static_cast<double>(middle_));
    const S row = y_mm * per_mm_ + S(static_cast<double>(middle_));
    const auto last = S(static_cast<double>(side() - 1));
    if (!(row >= 0 && col >= 0 && row < last && col < last)) {
      return {};  // also for NaN
    }
    const Index i = static_cast<Index>(row), j = static_cast<Index>(col);
    const S down = row - S(static_cast<double>(i)), right = col - S(static_cast<double>(j));
    const MembranePoint<S>* up = &nodes_[at(i, j)];
    const MembranePoint<S>* low = up + side();
    const auto between = [&](S MembranePoint<S>::*m) {
      const S above = up[0].*m + right * (up[1].*m - up[0].*m);
      const S below = low[0].*m + right * (low[1].*m - low[0].*m);
      return above + down * (below - above);
    };
    return {between(&MembranePoint<S>::height_mm), between(&MembranePoint<S>::along_x),
            between(&MembranePoint<S>::along_y), between(&MembranePoint<S>::contact_share)};
  }

  /// Whether at least half of the membrane here is in contact.
  bool in_contact(const S& x_mm, const S& y_mm) const {
    return !((*this)(x_mm, y_mm).contact_share < S(0.5));
  }

 private:
  std::size_t at(Index row, Index col) const {
    return static_cast<std::size_t>(row * side() + col);
  }

  S spacing_mm_;
  S per_mm_;  ///< nodes per mm
  Index middle_ = 0;
  std::vector<MembranePoint<S>> nodes_;
};

}  // namespace test
