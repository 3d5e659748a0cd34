// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The mean of nine pixels (3 x 3) that are some distance apart. If the map's noise is smooth over
// this distance, it is nearly as good as the mean over the whole window and several times cheaper.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/pixel_box.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Mean of three values; the middle one if another is missing (NaN).
template <class V, class S>
[[gnu::always_inline]] inline V mean_of_three(const V& before, const V& middle, const V& after) {
  const V sum = before + middle + after;
  return sum == sum ? V(sum * S(1.0 / 3)) : middle;
}

template <class S>
class SparseMean {
 public:
  /// `distance` along rows, `row_distance` from row to row.
  SparseMean(Index cols, Index distance, Index row_distance)
      : distance_(distance),
        row_distance_(row_distance),
        line_(static_cast<std::size_t>(cols + 2 * distance), not_a_number<S>()) {}

  /// Averages a part of `map` into the same part of `out`. Beyond the part, columns count as
  /// missing, and rows as equal to the middle row. `map` is left averaged along its rows.
  void operator()(const PixelBox& part, const StridedView<S>& map, const StridedView<S>& out) {
    const Index cols = part.last_col - part.first_col;
    for (Index i = part.first_row; i < part.last_row; ++i) {
      along(map.row(i) + part.first_col, cols);
    }
    for (Index i = part.first_row; i < part.last_row; ++i) {
      const auto row = [&](Index at) {
        const bool is_there = at >= part.first_row && at < part.last_row;
        return map.row(is_there ? at : i) + part.first_col;
      };
      const S* middle = row(i);
      const S* above = row(i - row_distance_);
      const S* below = row(i + row_distance_);
      S* to = out.row(i) + part.first_col;
      for_each_cell<S>(cols, [&]<class V>(Index j) {
        store_cells<S>(
            to + j, mean_of_three<V, S>(load_cells<V, S>(above + j), load_cells<V, S>(middle + j),
                                        load_cells<V, S>(below + j)));
      });
    }
  }

 private:
  void along(S* row, Index cols) {
    S* line = line_.data();
    for (Index j = 0; j < cols; ++j) {
      line[j + distance_] = row[j];
    }
    std::fill_n(line + cols + distance_, distance_, not_a_number<S>());
    for_each_cell<S>(cols, [&]<class V>(Index j) {
      const S* at = line + j;
      store_cells<S>(row + j,
                     mean_of_three<V, S>(load_cells<V, S>(at), load_cells<V, S>(at + distance_),
                                         load_cells<V, S>(at + 2 * distance_)));
    });
  }

  Index distance_;
  Index row_distance_;
  std::vector<S> line_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
