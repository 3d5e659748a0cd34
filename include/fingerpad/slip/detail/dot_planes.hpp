// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Dots of a frame as two planes of numbers, x and y, with a border of missing dots, so that a
// formula over all dots and their neighbours is one run without branches. A missing dot is NaN, and
// NaN makes every comparison false: that is all the bookkeeping there is.
#include <algorithm>
#include <cstddef>

#include "fingerpad/core/detail/aligned_vector.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/row_lanes.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

// One formula along a run of cells whose memory goes on past its end by at least a vector: whole
// vectors only. A kernel is written once for V, which is a vector of S, or S itself where there
// are none.

template <class S>
using run_vector = typename RowVector<S, row_lanes<S>>::type;

/// A run is worked through by so many cells at a time.
template <class S>
inline constexpr Index run_step = row_lanes<S>;

/// By so many cells a kernel on `run_vector<S>` may read and write past the end of a run.
template <class S>
inline constexpr Index run_overhang = row_lanes<S> - 1;

/// Where `condition` a, else b.
template <scalar S>
S choose(bool condition, const S& a, const S& b) {
  return condition ? a : b;
}

/// Where `condition` a, else 0.
template <scalar S>
S only_where(bool condition, const S& a) {
  return condition ? a : S(0);
}

template <scalar S>
S sum_of_lanes(const S& v) {
  return v;
}
template <scalar S>
S largest_lane(const S& v) {
  return v;
}
#if defined(FINGERPAD_HAS_VECTORS)
template <class V, class M>
  requires(!scalar<V>)
[[gnu::always_inline]] inline V only_where(M mask, const V& a) {
  return V(M(a) & mask);
}
template <class S, class V>
  requires(!scalar<V>)
S sum_of_lanes(const V& v) {
  S sum = v[0];
  for (int i = 1; i < lanes_in<V, S>; ++i) {
    sum += v[i];
  }
  return sum;
}
template <class S, class V>
  requires(!scalar<V>)
S largest_lane(const V& v) {
  S largest = v[0];
  for (int i = 1; i < lanes_in<V, S>; ++i) {
    largest = largest < v[i] ? v[i] : largest;
  }
  return largest;
}
#endif

}  // namespace detail

namespace detail::stick {

/// A run of cells of a plane.
struct Run {
  Index begin = 0;
  Index end = 0;
};

/// Where a dot's cell lies in a plane: two rows of border before and after, one border cell between
/// rows, so that the neighbours of the neighbours of a dot are cells too.
struct DotLayout {
  Index rows = 0;
  Index cols = 0;

  Index stride() const { return cols + 1; }
  Index at(Index row, Index col) const { return (row + 2) * stride() + 1 + col; }
  Index row_of(Index cell) const { return (cell - 1) / stride() - 2; }
  Index col_of(Index cell) const { return (cell - 1) % stride(); }
  DotIndex dot_at(Index cell) const { return {row_of(cell), col_of(cell)}; }

  /// Rows first..last; row -1 and row `rows` are border.
  Run run(Index first, Index last) const { return {at(first, 0), at(last + 1, 0) - 1}; }

  /// Cells of a plane, with the border and what a vector may read past it.
  template <class S>
  std::size_t cells() const {
    return static_cast<std::size_t>(at(rows + 2, 0) + run_overhang<S> + 1);
  }
  friend constexpr bool operator==(const DotLayout&, const DotLayout&) = default;
};

template <class S>
struct DotPlanes {
  DotPlanes() = default;
  explicit DotPlanes(const DotLayout& layout)
      : x(layout.cells<S>(), not_a_number<S>()), y(x.size(), not_a_number<S>()) {}

  aligned_vector<S> x, y;
};

/// A run of two planes that others own.
template <class S>
struct PlanesView {
  const S* x;
  const S* y;
};
template <class S>
PlanesView<S> view(const DotPlanes<S>& p) {
  return {p.x.data(), p.y.data()};
}

/// Squares of distances from here on are no distances between dots, NaN neither.
template <class S>
constexpr S no_distance_sq() {
  return S(1e18);
}

/// Calls use(cell_of) with cell_of(j) the cell of row i, col j: where the cells of a row lie side
/// by side, without a multiplication.
template <class View, class Use>
void with_row(const View& view, Index i, const Use& use) {
  if constexpr (requires {
                  view.row(i);
                  view.col_stride();
                }) {
    if (view.col_stride() == 1) {
      auto* const row = view.row(i);
      use([row](Index j) -> auto& { return row[j]; });
      return;
    }
  }
  use([&view, i](Index j) -> decltype(auto) { return view(i, j); });
}

/// A frame as it was given.
template <class S>
struct GivenDots {
  DotPlanes<S> found;    ///< whatever was given, NaN or not
  aligned_vector<S> touch;  ///< 0 in contact, else NaN: found + touch are the dots in contact
  Index first_row = 0, last_row = -1;  ///< with a flag of contact

  GivenDots() = default;
  explicit GivenDots(const DotLayout& layout)
      : found(layout), touch(found.x.size(), not_a_number<S>()) {}

  bool any_touch() const { return first_row <= last_row; }

  template <class Dots, class Contact>
  void read(const DotLayout& layout, const Dots& dots, const Contact& contact) {
    using Point = cell_t<Dots>;
    first_row = layout.rows;
    last_row = -1;
    for (Index i = 0; i < layout.rows; ++i) {
      const std::size_t row = static_cast<std::size_t>(layout.at(i, 0));
      S* const x = found.x.data() + row;
      S* const y = found.y.data() + row;
      S* const t = touch.data() + row;
      bool row_touch = false;
      with_row(dots, i, [&](const auto& row_dots) {
        for (Index j = 0; j < layout.cols; ++j) {
          const Point p = row_dots(j);
          x[j] = S(point_traits<Point>::x(p));
          y[j] = S(point_traits<Point>::y(p));
        }
      });
      with_row(contact, i, [&](const auto& row_contact) {
        for (Index j = 0; j < layout.cols; ++j) {
          const bool touches = is_contact(cell_t<Contact>(row_contact(j)));
          t[j] = touches ? S(0) : not_a_number<S>();
          row_touch |= touches;
        }
      });
      first_row = row_touch ? (std::min)(first_row, i) : first_row;
      last_row = row_touch ? i : last_row;
    }
  }
};

/// How many dots of the run are found.
template <class S>
Index count_dots(const PlanesView<S>& p, const Run& run) {
  using V = run_vector<S>;
  const V one = V{} + S(1), zero = V{} + S(0);
  V count = zero;
  for (Index k = run.begin; k < run.end; k += run_step<S>) {
    const V x = load_cells<V, S>(p.x + k), y = load_cells<V, S>(p.y + k);
    count += only_where(V(x * x + y * y) < no_distance_sq<S>(), one);
  }
  return static_cast<Index>(value(sum_of_lanes<S>(count)));
}

}  // namespace detail::stick

}  // namespace v0
}  // namespace fingerpad
