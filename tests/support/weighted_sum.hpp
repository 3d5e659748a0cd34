// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// One algorithm on grids in the form of the library's own: a constrained entry point, then a loop
// on views. Its weights differ from cell to cell, so a transposed, shifted or repeated cell changes
// the sum. The result must be the same to the last bit on every grid type.
#include <concepts>
#include <type_traits>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace test {

using fingerpad::Index;

/// The cell value that the test of every adapter writes at (row, col).
template <class T = double>
T pattern(Index row, Index col) {
  return T(1) / T(static_cast<double>(3 + 7 * row + 2 * col + row * col));
}

template <class S, class View>
S weighted_sum_of_view(View v) {
  S sum = S(0);
  for (Index i = 0; i < v.rows(); ++i) {
    for (Index j = 0; j < v.cols(); ++j) {
      sum = sum + S(v(i, j)) * S(static_cast<double>(1 + 31 * i + 17 * j));
    }
  }
  return sum;
}

template <fingerpad::grid G,
          fingerpad::scalar S =
              std::conditional_t<std::integral<fingerpad::cell_t<G>>, double, fingerpad::cell_t<G>>>
S weighted_sum(const G& g) {
  return weighted_sum_of_view<S>(fingerpad::as_view(g));
}

/// The sum of a rows x cols grid filled by `pattern`.
template <class T = double>
T pattern_sum(Index rows, Index cols) {
  return weighted_sum(fingerpad::LazyView(rows, cols, pattern<T>));
}

/// Fills a writable grid with the pattern.
template <fingerpad::writable_grid G>
void fill_with_pattern(G& g) {
  auto view = fingerpad::as_view(g);
  for (Index i = 0; i < view.rows(); ++i) {
    for (Index j = 0; j < view.cols(); ++j) {
      view(i, j) = pattern<fingerpad::cell_t<G>>(i, j);
    }
  }
}

}  // namespace test
