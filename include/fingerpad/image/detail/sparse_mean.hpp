// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The mean of nine pixels, `distance` apart: of a map whose noise is as smooth as that, nearly as
// good as the mean over the whole window and several times cheaper.
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/row_lanes.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Mean of three; the middle one where another is missing.
template <class V, class S>
[[gnu::always_inline]] inline V mean_of_three(const V& before, const V& middle, const V& after) {
  const V sum = before + middle + after;
  return sum == sum ? V(sum * S(1.0 / 3)) : middle;
}

template <class S>
class SparseMean {
 public:
  SparseMean(Index cols, Index distance)
      : distance_(distance),
        line_(static_cast<std::size_t>(cols + 2 * distance), not_a_number<S>()) {}

  /// Rows [first, last) of `map` into those of `out`; the rows beyond count as missing. `map`
  /// is left averaged along its rows.
  void operator()(Index first, Index last, const StridedView<S>& map, const StridedView<S>& out) {
    for (Index i = first; i < last; ++i) {
      along(map.row(i), map.cols());
    }
    for (Index i = first; i < last; ++i) {
      const S* middle = map.row(i);
      const S* above = i - distance_ >= first ? map.row(i - distance_) : middle;
      const S* below = i + distance_ < last ? map.row(i + distance_) : middle;
      S* to = out.row(i);
      for_each_cell<S>(map.cols(), [&]<class V>(Index j) {
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
    for_each_cell<S>(cols, [&]<class V>(Index j) {
      const S* at = line + j;
      store_cells<S>(row + j,
                     mean_of_three<V, S>(load_cells<V, S>(at), load_cells<V, S>(at + distance_),
                                         load_cells<V, S>(at + 2 * distance_)));
    });
  }

  Index distance_;
  std::vector<S> line_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
