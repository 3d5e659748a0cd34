// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Sparse Cholesky for normal equations that couple only the borders of one segment: the
// multifrontal method (Duff and Reid 1983), small dense blocks piece by piece. Eigen's
// SimplicialLDLT takes memory at every factorisation, knows no blocks, and would have to be told
// the order anyway.
//
// Two rows ride along at the foot of every block, so that the factorisation carries them forward:
// the couplings with one unknown that is coupled with many borders, and the right side.
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/sparse_dissection.hpp"
#include "fingerpad/force/detail/sparse_kernels.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::membrane {

/// What one segment adds: two unknowns for each of its borders below, above, left and right. Only
/// the lower half of the first eight rows is read.
template <class R>
struct SegmentEquations {
  static constexpr std::size_t unknowns = 8;
  static constexpr std::size_t shared_row = 8;
  static constexpr std::size_t right_row = 9;

  std::array<std::array<R, unknowns>, 10> entries;
};

template <class R, int Bytes = native_vector_bytes>
class FrontalCholesky {
 public:
  FrontalCholesky(Index columns, Index rows)
      : dissection_(columns, rows), unknowns_(2 * dissection_.numbers().count()) {
    std::size_t factor = 0;
    std::size_t open = 0;
    std::size_t max_open = 0;
    std::size_t max_gathered = 0;
    for (const Front& front : dissection_.fronts()) {
      factor_at_.push_back(factor);
      factor += height(front) * 2 * front.eliminated;
      // its own remainder is made above those of its parts, then takes their place
      max_open = (std::max)(max_open, open + remainder_size(front));
      if (!front.is_segment) {
        open -= remainder_size(dissection_.fronts()[front.first]);
        open -= remainder_size(dissection_.fronts()[front.second]);
      }
      open += remainder_size(front);
      max_gathered = (std::max)(max_gathered, height(front));
    }
    factor_.assign(factor, R(0));
    remainders_.assign(max_open, R(0));
    gathered_.assign(max_gathered, R(0));
  }

  const BorderNumbers& numbers() const { return dissection_.numbers(); }

  /// Factorises the sum of what `add(i, j, equations)` writes for all segments; false where that is
  /// not positive definite.
  template <class Add>
  bool factorise(const Add& add) {
    std::size_t open = 0;
    shared_shared_ = R(0);
    shared_right_ = R(0);
    for (std::size_t k = 0; k < dissection_.fronts().size(); ++k) {
      const Front& front = dissection_.fronts()[k];
      const Block block = {&factor_[factor_at_[k]], remainders_.data() + open, height(front),
                           2 * front.eliminated, 2 * front.kept + 2};
      std::fill(block.pivots, block.pivots + block.height * block.pivot_columns, R(0));
      std::fill(block.rest, block.rest + remainder_size(front), R(0));
      std::size_t below = open;
      if (front.is_segment) {
        SegmentEquations<R> equations;
        add(front.first, front.second, equations);
        add_segment(equations, dissection_.own_places(front), block);
      } else {
        for (const std::size_t part : {front.second, front.first}) {
          const Front& from = dissection_.fronts()[part];
          below -= remainder_size(from);
          add_remainder(from, remainders_.data() + below, block);
        }
      }
      if (!eliminate(block)) {
        return false;
      }
      if (below < open) {
        std::copy(block.rest, block.rest + remainder_size(front), remainders_.data() + below);
      }
      open = below + remainder_size(front);
    }
    return true;
  }

  /// With N the matrix, c the couplings of the shared unknown and g the right side: c^T N^-1 c.
  const R& shared_shared() const { return shared_shared_; }
  /// c^T N^-1 g.
  const R& shared_right() const { return shared_right_; }

  /// N^-1 (g - shared c); the two unknowns of border k are at 2 k.
  void solve(const R& shared) {
    for (std::size_t k = dissection_.fronts().size(); k-- > 0;) {
      const Front& front = dissection_.fronts()[k];
      if (front.eliminated > 0) {
        substitute(front, &factor_[factor_at_[k]], shared);
      }
    }
  }
  const std::vector<R>& unknowns() const { return unknowns_; }

 private:
  /// The columns of the borders eliminated with a piece, over all its rows; and the rest, over the
  /// rows of those it keeps. The two rows that ride along are the last of both.
  struct Block {
    R* pivots;
    R* rest;
    std::size_t height;
    std::size_t pivot_columns;
    std::size_t rest_height;

    /// Row `row` >= column of the lower half.
    R* at(std::size_t row, std::size_t column) const {
      return column < pivot_columns
                 ? pivots + column * height + row
                 : rest + (column - pivot_columns) * rest_height + (row - pivot_columns);
    }
  };

  static std::size_t height(const Front& front) { return 2 * (front.eliminated + front.kept) + 2; }
  static std::size_t remainder_size(const Front& front) {
    return (2 * front.kept + 2) * 2 * front.kept;
  }

  static void add_segment(const SegmentEquations<R>& equations,
                          const std::size_t* places,
                          const Block& block) {
    for (std::size_t c = 0; c < SegmentEquations<R>::unknowns; ++c) {
      const std::size_t column = 2 * places[c / 2] + c % 2;
      for (std::size_t r = 0; r < SegmentEquations<R>::unknowns; ++r) {
        const std::size_t row = 2 * places[r / 2] + r % 2;
        if (row >= column) {
          *block.at(row, column) = r >= c ? equations.entries[r][c] : equations.entries[c][r];
        }
      }
      R* foot = block.at(block.height - 2, column);
      foot[0] = equations.entries[SegmentEquations<R>::shared_row][c];
      foot[1] = equations.entries[SegmentEquations<R>::right_row][c];
    }
  }

  /// Adds what is left of a part, border by border: 2 x 2 numbers at a time.
  void add_remainder(const Front& part, const R* from, const Block& block) const {
    const std::size_t* places = dissection_.kept_places(part);
    const std::size_t step = 2 * part.kept + 2;
    for (std::size_t c = 0; c < part.kept; ++c) {
      const R* one = from + 2 * c * step;
      const R* other = one + step;
      const std::size_t column = 2 * places[c];
      R* to = block.at(column, column);
      R* beside = block.at(column + 1, column + 1) - 1;
      for (std::size_t r = c; r < part.kept; ++r) {
        const std::size_t down = 2 * (places[r] - places[c]);
        to[down] = to[down] + one[2 * r];
        to[down + 1] = to[down + 1] + one[2 * r + 1];
        beside[down] = beside[down] + other[2 * r];
        beside[down + 1] = beside[down + 1] + other[2 * r + 1];
      }
      const std::size_t foot = block.height - 2 - column;
      to[foot] = to[foot] + one[step - 2];
      to[foot + 1] = to[foot + 1] + one[step - 1];
      beside[foot] = beside[foot] + other[step - 2];
      beside[foot + 1] = beside[foot + 1] + other[step - 1];
    }
  }

  bool eliminate(const Block& block) {
    if (block.pivot_columns == 0) {
      return true;
    }
    if (!detail::membrane::factorise<Bytes>(block.pivots, block.height, block.pivot_columns)) {
      return false;
    }
    subtract_square<Bytes>(block.rest, block.rest_height, block.rest_height, block.rest_height - 2,
                           block.pivots + block.pivot_columns, block.height, block.pivot_columns);
    for (std::size_t c = 0; c < block.pivot_columns; ++c) {
      const R* foot = block.at(block.height - 2, c);
      shared_shared_ = shared_shared_ + foot[0] * foot[0];
      shared_right_ = shared_right_ + foot[0] * foot[1];
    }
    return true;
  }

  void substitute(const Front& front, const R* pivots, const R& shared) {
    const std::size_t* borders = dissection_.borders(front);
    const std::size_t columns = 2 * front.eliminated;
    for (std::size_t k = 0; k < front.eliminated + front.kept; ++k) {
      gathered_[2 * k] = unknowns_[2 * borders[k]];
      gathered_[2 * k + 1] = unknowns_[2 * borders[k] + 1];
    }
    for (std::size_t c = columns; c-- > 0;) {
      const R* column = pivots + c * height(front);
      const R* foot = column + height(front) - 2;
      const R known = foot[1] - shared * foot[0];
      const R others = product(column + c + 1, &gathered_[c] + 1, height(front) - 3 - c);
      gathered_[c] = (known - others) / column[c];
    }
    for (std::size_t k = 0; k < front.eliminated; ++k) {
      unknowns_[2 * borders[k]] = gathered_[2 * k];
      unknowns_[2 * borders[k] + 1] = gathered_[2 * k + 1];
    }
  }

  Dissection dissection_;
  std::vector<std::size_t> factor_at_;  // where the columns of each piece begin in factor_
  std::vector<R> factor_;
  std::vector<R> remainders_;  // what the pieces not yet joined have left, a stack
  std::vector<R> gathered_;    // the unknowns of one piece
  std::vector<R> unknowns_;
  R shared_shared_ = R(0);
  R shared_right_ = R(0);
};

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
