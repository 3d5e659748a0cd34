// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Small images with a border of zeros, and separable filters on them: weighted means, and dilation,
// erosion and closing of masks by counting.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"

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

/// A symmetric kernel, given by its weights at distance 0, 1, ...; the weights of both sides sum to
/// 1.
template <scalar S>
class EvenKernel {
 public:
  static EvenKernel gaussian(double sd_cells) {
    const auto reach = static_cast<Index>(std::ceil(3 * sd_cells));
    std::vector<double> weights;
    for (Index k = 0; k <= reach; ++k) {
      const double x = static_cast<double>(k) / sd_cells;
      weights.push_back(k == 0 ? 1.0 : std::exp(-x * x / 2));
    }
    return EvenKernel(weights);
  }
  static EvenKernel box(Index reach) {
    return EvenKernel(std::vector<double>(static_cast<std::size_t>(reach + 1), 1.0));
  }

  Index reach() const { return static_cast<Index>(weights_.size()) - 1; }

  /// Writes the weighted sum of `from` around each cell to `to`; `between` is scratch memory.
  /// `from` and `between` have a border of reach() or more.
  void operator()(const PaddedCells<S>& from, PaddedCells<S>& between, PaddedCells<S>& to) const {
    for (Index i = 0; i < from.rows(); ++i) {
      along(from.row(i), from.stride(), from.cols(), between.row(i));
    }
    for (Index i = 0; i < from.rows(); ++i) {
      along(between.row(i), 1, from.cols(), to.row(i));
    }
  }

 private:
  explicit EvenKernel(const std::vector<double>& weights) {
    double sum = -weights[0];
    for (const double w : weights) {
      sum += 2 * w;
    }
    for (const double w : weights) {
      weights_.push_back(S(w / sum));
    }
  }

  void along(const S* from, Index step, Index count, S* to) const {
    for_each_cell<S>(count, [&]<class V>(Index j) {
      V sum = load_cells<V, S>(from + j) * weights_[0];
      for (Index k = 1; k <= reach(); ++k) {
        sum =
            sum + (load_cells<V, S>(from + j - k * step) + load_cells<V, S>(from + j + k * step)) *
                      weights_[static_cast<std::size_t>(k)];
      }
      store_cells<S>(to + j, sum);
    });
  }

  std::vector<S> weights_;
};

/// Dilation (grow) and erosion (shrink) of masks (0 and 1) of one size by a square of 2 reach + 1
/// cells. Cells beyond the image have no influence.
template <scalar S>
class CellMorphology {
 public:
  CellMorphology(Index rows, Index cols, Index reach)
      : box_(EvenKernel<S>::box(reach)),
        inside_(rows, cols, reach),
        between_(rows, cols, reach),
        count_(rows, cols, reach),
        half_(S(0.5 / static_cast<double>((2 * reach + 1) * (2 * reach + 1)))) {
    PaddedCells<S> ones(rows, cols, reach);
    for (Index i = 0; i < rows; ++i) {
      std::fill(ones.row(i), ones.row(i) + cols, S(1));
    }
    box_(ones, between_, inside_);
  }

  void grow(PaddedCells<S>& mask) { apply<true>(mask); }
  void shrink(PaddedCells<S>& mask) { apply<false>(mask); }

 private:
  template <bool Grow>
  void apply(PaddedCells<S>& mask) {
    box_(mask, between_, count_);
    for (Index i = 0; i < mask.rows(); ++i) {
      const S* share = count_.row(i);
      const S* all = inside_.row(i);
      S* to = mask.row(i);
      for_each_cell<S>(mask.cols(), [&]<class V>(Index j) {
        const V n = load_cells<V, S>(share + j);
        const V limit = Grow ? every_lane<V>(half_) : V(load_cells<V, S>(all + j) - half_);
        store_cells<S>(to + j, n < limit ? every_lane<V>(S(0)) : every_lane<V>(S(1)));
      });
    }
  }

  EvenKernel<S> box_;
  PaddedCells<S> inside_;
  PaddedCells<S> between_;
  PaddedCells<S> count_;
  S half_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
