// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The difference between a frame and the free pad, cell by cell. Dots are left out, the gain is
// matched, and the remaining cells are smoothed.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/cell_filter.hpp"
#include "fingerpad/image/detail/cell_means.hpp"
#include "fingerpad/image/detail/lanes.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Channel means of a frame's cells. `weight` is 1 for cells that show the gel, and 0 for dots and
/// bad cells; `known` is 1 for cells whose mean is known, filled-in dots included.
template <int Channels, scalar S>
struct CellColours {
  CellColours(Index rows, Index cols, Index pad)
      : mean(Channels, PaddedCells<S>(rows, cols, pad)), weight(rows, cols, pad), known(weight) {}
  std::vector<PaddedCells<S>> mean;
  PaddedCells<S> weight, known;
};

/// The parameters for reducing frames to cells.
struct CellLayout {
  Index rows, cols;  ///< of the frame, px
  Index cell_px;
  double smoothing_px, dot_px, dot_contrast, saturated;

  friend bool operator==(const CellLayout&, const CellLayout&) = default;
  Index cell_rows() const { return (rows + cell_px - 1) / cell_px; }
  Index cell_cols() const { return (cols + cell_px - 1) / cell_px; }
  double in_cells(double px) const { return px / static_cast<double>(cell_px); }
  /// How many cells a dot may reach into beside its own.
  Index dot_edge() const { return dot_px > 0 ? 1 : 0; }
};

/// The part of a frame in which most cells are assumed to be free of contact.
enum class GainFrom { frame, border };

/// visit(i, j) for the cells along the four sides.
template <class Visit>
void for_border(Index rows, Index cols, const Visit& visit) {
  for (Index i = 0; i < rows; ++i) {
    const bool whole_row = i == 0 || i + 1 == rows;
    for (Index j = 0; j < cols; j += whole_row ? 1 : (std::max)(cols - 1, Index(1))) {
      visit(i, j);
    }
  }
}

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
        known_(weight_),
        part_(weight_),
        filled_(weight_),
        between_(weight_),
        share_(weight_),
        known_share_(weight_),
        smooth_(weight_),
        length_(weight_),
        imprint_(weight_) {
    samples_.reserve(static_cast<std::size_t>(weight_.rows() * weight_.cols()));
  }

  const CellLayout& layout() const { return layout_; }
  Index pad() const { return pad_; }
  /// The cells of the frame that was read last.
  const Colours& now() const { return now_; }
  PaddedCells<S>& length() { return length_; }
  const PaddedCells<S>& length() const { return length_; }
  const PaddedCells<S>& imprint() const { return imprint_; }

  /// Reduces a frame to cells, and leaves out and fills its dots.
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
    now_.known = now_.weight;
    if (layout_.dot_px > 0) {
      fill_dots();
    }
  }

  /// Sets length() to the root mean square over the channels of now / gain / free - 1, smoothed
  /// over the gel that both frames show; NaN where there is too little gel. imprint() is the same
  /// but includes gel that dots hide.
  void compare(const Colours& free, GainFrom from) {
    for_cells([&]<class V>(Index i, Index j) {
      put<V>(weight_, i, j, V(get<V>(now_.weight, i, j) * get<V>(free.weight, i, j)));
      put<V>(known_, i, j, V(get<V>(now_.known, i, j) * get<V>(free.known, i, j)));
      put<V>(length_, i, j, V{});
      put<V>(imprint_, i, j, V{});
    });
    mean_(weight_, between_, share_);
    mean_(known_, between_, known_share_);
    for (std::size_t c = 0; c < std::size_t(Channels); ++c) {
      const PaddedCells<S>& seen = now_.mean[c];
      const PaddedCells<S>& was = free.mean[c];
      const S per_gain = S(1) / gain(seen, was, from);
      for_cells([&]<class V>(Index i, Index j) {
        const V relative = get<V>(seen, i, j) * per_gain / get<V>(was, i, j) - S(1);
        // a cell without weight may hold anything
        put<V>(part_, i, j, V{} < get<V>(weight_, i, j) ? relative : V{});
        put<V>(filled_, i, j, V{} < get<V>(known_, i, j) ? relative : V{});
      });
      add_square(part_, share_, length_);
      add_square(filled_, known_share_, imprint_);
    }
    for_cells([&]<class V>(Index i, Index j) {
      finish<V>(length_, i, j);
      finish<V>(imprint_, i, j);
    });
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

  /// Writes the brightness of each cell to part_; its weight is 0 if a channel is NaN, not positive
  /// or saturated.
  void brightness() {
    for_cells([&]<class V>(Index i, Index j) {
      V sum{};
      V weight = V{} + S(1);
      for (const PaddedCells<S>& mean : now_.mean) {
        const V m = get<V>(mean, i, j);
        weight = m > V{} ? weight : V{};  // false for NaN
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

  /// Adds the square of the mean of `part` around each cell to `sum`.
  void add_square(const PaddedCells<S>& part, const PaddedCells<S>& shares, PaddedCells<S>& sum) {
    mean_(part, between_, smooth_);
    for_cells([&]<class V>(Index i, Index j) {
      const V share = get<V>(shares, i, j);
      const V mean = share > V{} + S(min_share) ? V(get<V>(smooth_, i, j) / share)
                                                : V(V{} + not_a_number<S>());
      put<V>(sum, i, j, V(get<V>(sum, i, j) + mean * mean));
    });
  }

  /// Fills gaps no wider than a dot from the gel beside them. An imprint with holes at the dots
  /// would seem to move with the dots.
  void fill_dots() {
    const auto is_hole = [&](Index i, Index j) { return !(S(0) < now_.weight(i, j)); };
    for (Index i = 0; i < weight_.rows(); ++i) {
      for (Index j = 0; j < weight_.cols(); ++j) {
        if (is_hole(i, j)) {
          const Index first = j;
          while (j < weight_.cols() && is_hole(i, j)) {
            ++j;
          }
          for (Index k = first; k < j; ++k) {
            fill(i, k, {first - 1, j}, gap_in_column(i, k));
          }
        }
      }
    }
  }
  /// The last gel cell before a hole in a row or column and the first one behind it.
  struct Gap {
    Index before, behind;

    Index size() const { return behind - before; }
    bool is_of_dot(Index max_size, Index end) const {
      return before >= 0 && behind < end && size() <= max_size;
    }
    S share(Index at) const {
      return S(static_cast<double>(at - before) / static_cast<double>(size()));
    }
  };
  Index max_gap() const {
    return static_cast<Index>(std::ceil(layout_.in_cells(layout_.dot_px))) +
           2 * layout_.dot_edge() + 2;
  }
  Gap gap_in_column(Index i, Index j) const {
    Gap gap{i - 1, i + 1};
    while (gap.before >= 0 && gap.size() <= max_gap() && !(S(0) < now_.weight(gap.before, j))) {
      --gap.before;
    }
    while (gap.behind < weight_.rows() && gap.size() <= max_gap() &&
           !(S(0) < now_.weight(gap.behind, j))) {
      ++gap.behind;
    }
    return gap;
  }
  /// Interpolates between the ends of both gaps, each weighted by 1 / size^2.
  void fill(Index i, Index j, const Gap& row, const Gap& column) {
    const bool in_row = row.is_of_dot(max_gap(), weight_.cols());
    const bool in_column = column.is_of_dot(max_gap(), weight_.rows());
    if (!in_row && !in_column) {
      return;
    }
    const auto weight = [](bool counts, const Gap& gap) {
      return counts ? 1 / static_cast<double>(gap.size() * gap.size()) : 0.0;
    };
    const double across = weight(in_row, row);
    const S share = S(across / (across + weight(in_column, column)));
    for (PaddedCells<S>& mean : now_.mean) {
      const auto between = [](const S& a, const S& b, const S& at) { return S(a + at * (b - a)); };
      const S beside =
          in_row ? between(mean(i, row.before), mean(i, row.behind), row.share(j)) : S(0);
      const S above = in_column
                          ? between(mean(column.before, j), mean(column.behind, j), column.share(i))
                          : S(0);
      mean(i, j) = between(above, beside, share);
    }
    now_.known(i, j) = S(1);
  }

  /// The median of seen / was over the gel cells of the border, or of a lattice over the whole
  /// frame; 1 if there are none.
  S gain(const PaddedCells<S>& seen, const PaddedCells<S>& was, GainFrom from) {
    samples_.clear();
    const auto add = [&](Index i, Index j) {
      if (S(0) < weight_(i, j)) {
        samples_.push_back(S(seen(i, j) / was(i, j)));
      }
    };
    if (from == GainFrom::border) {
      for_border(weight_.rows(), weight_.cols(), add);
    } else {
      for (Index i = step_ / 2; i < weight_.rows(); i += step_) {
        for (Index j = step_ / 2; j < weight_.cols(); j += step_) {
          add(i, j);
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
  static void finish(PaddedCells<S>& sum, Index i, Index j) {
    using std::sqrt;
    const V square = get<V>(sum, i, j) * S(1.0 / Channels);
    V root = square;
    if constexpr (std::is_same_v<V, S>) {
      root = S(0) < square ? S(sqrt(square)) : square;
    } else {
      for (int k = 0; k < lanes_in<V, S>; ++k) {
        root[k] = sqrt(square[k]);
      }
    }
    put<V>(sum, i, j, root);
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
  PaddedCells<S> weight_, known_, part_, filled_, between_, share_, known_share_, smooth_, length_,
      imprint_;
  ReservedVector<S> samples_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
