// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// By how much a frame differs from the free pad, cell by cell: dots left out, gain matched,
// smoothed over what is left.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "fingerpad/core/detail/reserved_vector.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/cell_filter.hpp"
#include "fingerpad/image/detail/cell_means.hpp"
#include "fingerpad/image/detail/row_lanes.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Channel means of a frame's cells, and 1 for those that show the gel, 0 for dots and bad cells.
template <int Channels, scalar S>
struct CellColours {
  CellColours(Index rows, Index cols, Index pad)
      : mean(Channels, PaddedCells<S>(rows, cols, pad)), weight(rows, cols, pad) {}
  std::vector<PaddedCells<S>> mean;
  PaddedCells<S> weight;
};

/// What the reductions of a frame need to know.
struct CellLayout {
  Index rows, cols;  ///< of the frame, px
  Index cell_px;
  double smoothing_px, dot_px, dot_contrast, saturated;

  friend bool operator==(const CellLayout&, const CellLayout&) = default;
  Index cell_rows() const { return (rows + cell_px - 1) / cell_px; }
  Index cell_cols() const { return (cols + cell_px - 1) / cell_px; }
  double in_cells(double px) const { return px / static_cast<double>(cell_px); }
  /// Cells beside a dot's that it may reach into.
  Index dot_edge() const { return dot_px > 0 ? 1 : 0; }
};

/// Reads frames and compares them; the workspace of one thread.
template <int Channels, scalar S>
class FrameDifference {
 public:
  using Colours = CellColours<Channels, S>;

  explicit FrameDifference(const CellLayout& layout)
      : layout_(layout),
        mean_(EvenKernel<S>::gaussian(layout.in_cells(layout.smoothing_px))),
        around_(
            EvenKernel<S>::box(static_cast<Index>(std::ceil(2 * layout.in_cells(layout.dot_px))))),
        pad_((std::max)({mean_.reach(), around_.reach(), layout.dot_edge()})),
        step_(lattice_step(layout)),
        cells_(layout.rows, layout.cols, layout.cell_px),
        now_(layout.cell_rows(), layout.cell_cols(), pad_),
        edge_(layout.cell_rows(), layout.cell_cols(), layout.dot_edge()),
        weight_(now_.weight),
        part_(weight_),
        between_(weight_),
        share_(weight_),
        smooth_(weight_),
        length_(weight_) {
    samples_.reserve(static_cast<std::size_t>(weight_.rows() * weight_.cols()));
  }

  const CellLayout& layout() const { return layout_; }
  Index pad() const { return pad_; }
  /// What the frame that was read last shows.
  const Colours& now() const { return now_; }
  PaddedCells<S>& length() { return length_; }
  const PaddedCells<S>& length() const { return length_; }

  /// Takes a frame in.
  template <class View>
  void read(const View& frame) {
    cells_(frame, [&](Index i, Index j, int c, const S& mean) {
      now_.mean[static_cast<std::size_t>(c)](i, j) = mean;
    });
    brightness();
    if (layout_.dot_px > 0) {
      around_(part_, between_, smooth_);
      around_(now_.weight, between_, share_);
      leave_out_dots();
    }
    edge_.shrink(now_.weight);
  }

  /// length() becomes the root mean square over the channels of now / gain / free - 1, smoothed
  /// over the gel that both frames show; NaN where that is too little.
  void compare(const Colours& free) {
    for_cells([&]<class V>(Index i, Index j) {
      put<V>(weight_, i, j, V(get<V>(now_.weight, i, j) * get<V>(free.weight, i, j)));
      put<V>(length_, i, j, V{});
    });
    mean_(weight_, between_, share_);
    for (std::size_t c = 0; c < std::size_t(Channels); ++c) {
      const PaddedCells<S>& seen = now_.mean[c];
      const PaddedCells<S>& was = free.mean[c];
      const S per_gain = S(1) / gain(seen, was);
      for_cells([&]<class V>(Index i, Index j) {
        const V relative = get<V>(seen, i, j) * per_gain / get<V>(was, i, j) - S(1);
        // a cell without weight may hold anything
        put<V>(part_, i, j, V{} < get<V>(weight_, i, j) ? relative : V{});
      });
      mean_(part_, between_, smooth_);
      for_cells([&]<class V>(Index i, Index j) {
        const V share = get<V>(share_, i, j);
        const V known = share > V{} + S(min_share) ? V(get<V>(smooth_, i, j) / share)
                                                   : V(V{} + not_a_number<S>());
        put<V>(smooth_, i, j, known);
        put<V>(length_, i, j, V(get<V>(length_, i, j) + known * known));
      });
    }
    for_cells([&]<class V>(Index i, Index j) { finish<V>(i, j); });
  }

 private:
  static Index lattice_step(const CellLayout& layout) {
    constexpr double samples = 2048;
    const auto cells = static_cast<double>(layout.cell_rows() * layout.cell_cols());
    return static_cast<Index>(std::ceil(std::sqrt(cells / samples)));
  }

  template <class V>
  static V get(const PaddedCells<S>& from, Index i, Index j) {
    return load_cells<V, S>(from.row(i) + j);
  }
  template <class V>
  static void put(PaddedCells<S>& to, Index i, Index j, const V& v) {
    store_cells<S>(to.row(i) + j, v);
  }
  template <class Kernel>
  void for_cells(const Kernel& kernel) {
    for (Index i = 0; i < weight_.rows(); ++i) {
      for_each_cell<S>(weight_.cols(),
                       [&]<class V>(Index j) { kernel.template operator()<V>(i, j); });
    }
  }

  /// Brightness of a cell to part_, weight 0 where a channel says nothing.
  void brightness() {
    for_cells([&]<class V>(Index i, Index j) {
      V sum{};
      V weight = V{} + S(1);
      for (const PaddedCells<S>& mean : now_.mean) {
        const V m = get<V>(mean, i, j);
        weight = m > V{} ? weight : V{};  // NaN is not
        weight = m < V{} + S(layout_.saturated) ? weight : V{};
        sum = sum + m;
      }
      put<V>(now_.weight, i, j, weight);
      put<V>(part_, i, j, V{} < weight ? sum : V{});
    });
  }

  void leave_out_dots() {
    const S gel = S(1 - layout_.dot_contrast);
    for_cells([&]<class V>(Index i, Index j) {
      const V limit = get<V>(smooth_, i, j) * gel;
      const V dark = get<V>(part_, i, j) * get<V>(share_, i, j) < limit ? V{} : V(V{} + S(1));
      put<V>(now_.weight, i, j, V(get<V>(now_.weight, i, j) * dark));
    });
  }

  /// The median of seen / was over a lattice of the cells that count; 1 where there are none.
  S gain(const PaddedCells<S>& seen, const PaddedCells<S>& was) {
    samples_.clear();
    for (Index i = step_ / 2; i < weight_.rows(); i += step_) {
      for (Index j = step_ / 2; j < weight_.cols(); j += step_) {
        if (S(0) < weight_(i, j)) {
          samples_.push_back(S(seen(i, j) / was(i, j)));
        }
      }
    }
    if (samples_.empty()) {
      return S(1);
    }
    const auto middle = samples_.begin() + static_cast<std::ptrdiff_t>(samples_.size() / 2);
    std::nth_element(samples_.begin(), middle, samples_.end());
    return *middle;
  }

  template <class V>
  void finish(Index i, Index j) {
    using std::sqrt;
    const V square = get<V>(length_, i, j) * S(1.0 / Channels);
    V root = square;
    if constexpr (std::is_same_v<V, S>) {
      root = S(0) < square ? S(sqrt(square)) : square;
    } else {
      for (int k = 0; k < lanes_in<V, S>; ++k) {
        root[k] = sqrt(square[k]);
      }
    }
    put<V>(length_, i, j, root);
  }

  static constexpr double min_share = 0.05;  // of the kernel's weight that is on gel
  CellLayout layout_;
  EvenKernel<S> mean_;
  EvenKernel<S> around_;
  Index pad_;
  Index step_;
  CellMeans<Channels, S> cells_;
  Colours now_;
  CellMorphology<S> edge_;
  PaddedCells<S> weight_, part_, between_, share_, smooth_, length_;
  ReservedVector<S> samples_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
