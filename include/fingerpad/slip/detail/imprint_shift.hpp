// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Motion of an imprint between two frames: the translation and rotation that map the earlier image
// of the contact to the present one, up to a gain and an offset. Gauss-Newton steps on the squared
// differences (Baker and Matthews, "Lucas-Kanade 20 years on", 2004, inverse compositional); with
// gain and offset this maximises the correlation (Evangelidis and Psarakis, 2008). A round imprint
// does not determine the rotation, which would then fit noise. A prior toward no rotation limits it
// to what the imprint shows beyond its residuals.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Cells with a border of `pad` zeros, which is never written.
template <scalar S>
class PaddedCells {
 public:
  PaddedCells(Index rows, Index cols, Index pad)
      : rows_(rows),
        cols_(cols),
        pad_(pad),
        cells_(static_cast<std::size_t>((rows + 2 * pad) * stride()), S(0)) {}

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }
  Index stride() const { return cols_ + 2 * pad_; }
  S* row(Index i) { return cells_.data() + (i + pad_) * stride() + pad_; }
  const S* row(Index i) const { return cells_.data() + (i + pad_) * stride() + pad_; }
  S& operator()(Index i, Index j) { return row(i)[j]; }
  const S& operator()(Index i, Index j) const { return row(i)[j]; }
  StridedView<const S> view() const { return {row(0), rows_, cols_, stride()}; }

 private:
  Index rows_;
  Index cols_;
  Index pad_;
  std::vector<S> cells_;
};

/// A rotation about the middle of the imprint followed by a translation, in cells.
template <scalar S>
struct PlanarMotion {
  Point2<S> shift = {S(0), S(0)};
  S angle_rad = S(0);       ///< from x to y
  S shift_variance = S(0);  ///< mean of both axes
  S angle_variance = S(0);
  S correlation = S(0);
};

/// Tracks an imprint, stored as cells with their slopes. Allocates only in the constructor.
template <scalar S>
class ImprintShift {
 public:
  ImprintShift(Index rows, Index cols) {
    cells_.reserve(static_cast<std::size_t>((std::min)(rows * cols, 2 * max_cells)));
  }

  /// Stores the cells of `imprint` where `region` is > 0, about max_cells of them, evenly spaced.
  /// Cells with an unknown neighbour are left out.
  void take(const PaddedCells<S>& imprint, const PaddedCells<S>& region) {
    cells_.clear();
    const Index step = lattice_step(region);
    cells_per_sample_ = (std::max)(smoothed_cells / static_cast<double>(step), 1.0);
    for (Index i = 1; i + 1 < region.rows(); ++i) {
      for (Index j = 1 + i % step; j + 1 < region.cols(); j += step) {
        if (S(0) < region(i, j)) {
          add(imprint, i, j);
        }
      }
    }
    about_center();
  }

  /// Finds the imprint in `now`, from a guess of its shift and within `max_shift` of the guess.
  /// Correlation 0: not found.
  PlanarMotion<S> find(const PaddedCells<S>& now,
                       const Point2<S>& guess,
                       const S& max_shift) const {
    const PlanarMotion<S> nowhere{guess};
    PlanarMotion<S> motion = nowhere;
    for (int step = 0; step < max_steps; ++step) {
      Sums sums = compare(now, motion);
      const S noise = S(sums.noise() * S(cells_per_sample_));
      sums.expect_angle(motion.angle_rad, S(noise / S(square(expected_turn))));
      const NormalEquations<S, 5> equations(sums.matrix, 1e-7);
      if (sums.count() < min_cells || !equations.good) {
        return nowhere;
      }
      const Row q = equations.solve(sums.right);
      if (!(S(0) < q[3])) {
        return nowhere;  // inverted contrast
      }
      const Point2<S> back = {S(q[0] / q[3]), S(q[1] / q[3])};
      const S turn = S(q[2] / q[3]);
      motion.shift = motion.shift - back;
      motion.angle_rad = S(motion.angle_rad - turn);
      motion.correlation = sums.correlation();
      set_variances(noise, equations, motion);
      if (!(squared_norm(Point2<S>(motion.shift - guess)) < max_shift * max_shift)) {
        return nowhere;
      }
      if (squared_norm(back) + turn * turn * S(square(rim)) < S(square(enough))) {
        break;
      }
    }
    return motion;
  }

 private:
  static constexpr Index max_cells = 2048;
  static constexpr Index min_cells = 30;
  static constexpr int max_steps = 12;
  static constexpr double enough = 0.02;        // cells; each step reduces the error a hundredfold
  static constexpr double rim = 20;             // cells; converts a rotation into a displacement
  static constexpr double expected_turn = 0.1;  // prior sd, rad, since the imprint was taken
  static constexpr double smoothed_cells = 28;  // correlated cells: 4 pi sd^2 of a smoothing with
                                                // an sd of 1.5 cells
  static constexpr double least_noise = 0.01;   // relative to the spread of the imprint

  using Row = std::array<S, 5>;  // x slope, y slope, slope along a rotation, level, 1
  struct Cell {
    Point2<S> at;  // relative to the middle
    Row row;
  };

  struct Sums {
    SmallMatrix<S, 5> matrix = zero_matrix<S, 5>();
    Row right{};
    S now_sq = S(0);

    double count() const { return static_cast<double>(value(matrix[4][4])); }
    S mean() const { return S(matrix[4][3] / matrix[4][4]); }
    /// Variance of the imprint.
    S spread() const { return S(matrix[3][3] / matrix[4][4] - mean() * mean()); }
    S correlation() const {
      using std::sqrt;
      const S n = matrix[4][4];
      const S mean_now = S(right[4] / n);
      const S both = S(right[3] / n - mean() * mean_now);
      const S spreads = S(spread() * (now_sq / n - mean_now * mean_now));
      return S(0) < spreads ? S(both / S(sqrt(spreads))) : S(0);
    }
    /// Mean squared residual, at the gain of the imprint.
    S noise() const {
      constexpr double least_correlation = 0.1;
      const S r = correlation();
      const S known = S(least_correlation) < r ? r : S(least_correlation);
      const S left = S(S(1) / (known * known) - S(1));
      return S(spread() * (left + S(square(least_noise))));
    }
    /// Adds the prior weight (angle - q[2] / q[3])^2 q[3]^2 to the squares: the step should undo
    /// `angle`.
    void expect_angle(const S& angle, const S& weight) {
      matrix[2][2] = matrix[2][2] + weight;
      matrix[3][2] = matrix[2][3] = S(matrix[3][2] - weight * angle);
      matrix[3][3] = matrix[3][3] + weight * angle * angle;
    }
  };

  static void set_variances(const S& noise,
                            const NormalEquations<S, 5>& equations,
                            PlanarMotion<S>& motion) {
    const auto of = [&](std::size_t k) {
      Row unit = zeros<S, 5>();
      unit[k] = S(1);
      return S(noise * equations.variance(unit));
    };
    motion.shift_variance = S((of(0) + of(1)) * S(0.5));
    motion.angle_variance = of(2);
  }

  static Index lattice_step(const PaddedCells<S>& region) {
    Index count = 0;
    for (Index i = 0; i < region.rows(); ++i) {
      count += std::count_if(region.row(i), region.row(i) + region.cols(),
                             [](const S& cell) { return S(0) < cell; });
    }
    return 1 + count / max_cells;
  }

  void add(const PaddedCells<S>& imprint, Index i, Index j) {
    const S x_slope = S((imprint(i, j + 1) - imprint(i, j - 1)) * S(0.5));
    const S y_slope = S((imprint(i + 1, j) - imprint(i - 1, j)) * S(0.5));
    const S level = imprint(i, j);
    if (is_finite(S(x_slope + y_slope + level)) && cells_.size() < cells_.capacity()) {
      cells_.push_back({{S(static_cast<double>(j)), S(static_cast<double>(i))},
                        {x_slope, y_slope, S(0), level, S(1)}});
    }
  }

  /// Moves the origin to the middle of the cells, and computes the sums that do not depend on the
  /// frame.
  void about_center() {
    center_ = {S(0), S(0)};
    for (const Cell& cell : cells_) {
      center_ += cell.at / S(static_cast<double>(cells_.size()));
    }
    matrix_ = {};
    for (Cell& cell : cells_) {
      cell.at = cell.at - center_;
      cell.row[2] = S(cell.at.x * cell.row[1] - cell.at.y * cell.row[0]);
      add_product(matrix_, cell.row, S(1));
    }
  }

  static void add_product(SmallMatrix<S, 5>& sums, const Row& row, const S& factor) {
    for (std::size_t i = 0; i < 5; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        sums[i][j] = sums[i][j] + factor * row[i] * row[j];
      }
    }
  }

  Sums compare(const PaddedCells<S>& now, const PlanarMotion<S>& motion) const {
    using std::cos;
    using std::sin;
    const S c = S(cos(motion.angle_rad));
    const S s = S(sin(motion.angle_rad));
    const Point2<S> to = center_ + motion.shift;
    Sums sums;
    sums.matrix = matrix_;
    for (const Cell& cell : cells_) {
      const Point2<S> turned = {S(c * cell.at.x - s * cell.at.y), S(s * cell.at.x + c * cell.at.y)};
      const S seen = sample(now, to + turned);
      if (!is_finite(seen)) {
        add_product(sums.matrix, cell.row, S(-1));
        continue;
      }
      for (std::size_t k = 0; k < 5; ++k) {
        sums.right[k] = sums.right[k] + cell.row[k] * seen;
      }
      sums.now_sq = sums.now_sq + seen * seen;
    }
    for (std::size_t i = 0; i < 5; ++i) {
      for (std::size_t j = i + 1; j < 5; ++j) {
        sums.matrix[i][j] = sums.matrix[j][i];
      }
    }
    return sums;
  }

  /// Bilinear interpolation; NaN beyond the image.
  static S sample(const PaddedCells<S>& from, const Point2<S>& at) {
    const double x = static_cast<double>(value(at.x));
    const double y = static_cast<double>(value(at.y));
    if (!(x >= 0 && y >= 0 && x < static_cast<double>(from.cols() - 1) &&
          y < static_cast<double>(from.rows() - 1))) {
      return not_a_number<S>();
    }
    const Index j = static_cast<Index>(x);
    const Index i = static_cast<Index>(y);
    const S u = S(at.x - S(static_cast<double>(j)));
    const S v = S(at.y - S(static_cast<double>(i)));
    const S* row = from.row(i) + j;
    const S* next = row + from.stride();
    const S upper = S(row[0] + u * (row[1] - row[0]));
    const S lower = S(next[0] + u * (next[1] - next[0]));
    return S(upper + v * (lower - upper));
  }

  ReservedVector<Cell> cells_;
  Point2<S> center_ = {S(0), S(0)};
  double cells_per_sample_ = smoothed_cells;
  SmallMatrix<S, 5> matrix_ = zero_matrix<S, 5>();
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
