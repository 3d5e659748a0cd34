// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Dots of a frame as two planes of numbers, x and y, with a border of missing dots, so that a
// formula over all dots and their neighbours is one run without branches. A missing dot is NaN, and
// NaN makes every comparison false: that is all the bookkeeping there is.
#include <algorithm>
#include <cstddef>

#include "fingerpad/detail/vectors/line_vector.hpp"
#include "fingerpad/detail/vectors/run_lanes.hpp"
#include "fingerpad/dots.hpp"
#include "fingerpad/grid.hpp"
#include "fingerpad/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
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

  line_vector<S> x, y;
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

/// A frame as it was given.
template <class S>
struct GivenDots {
  DotPlanes<S> found;    ///< px; whatever was given, NaN or not
  line_vector<S> touch;  ///< 0 in contact, else NaN: found + touch are the dots in contact
  bool any_found = false;
  bool any_touch = false;
  Index first_row = 0, last_row = -1;  ///< that have a flag of contact

  GivenDots() = default;
  explicit GivenDots(const DotLayout& layout)
      : found(layout), touch(found.x.size(), not_a_number<S>()) {}

  template <class Dots, class Contact>
  void read(const DotLayout& layout, const Dots& dots, const Contact& contact) {
    using Point = cell_t<Dots>;
    first_row = layout.rows;
    last_row = -1;
    any_found = false;
    for (Index i = 0; i < layout.rows; ++i) {
      S* const x = found.x.data() + layout.at(i, 0);
      S* const y = found.y.data() + layout.at(i, 0);
      S* const t = touch.data() + layout.at(i, 0);
      bool row_found = false;
      bool row_touch = false;
      for (Index j = 0; j < layout.cols; ++j) {
        const Point p = dots(i, j);
        const bool touches = says_contact(cell_t<Contact>(contact(i, j)));
        x[j] = S(point_traits<Point>::x(p));
        y[j] = S(point_traits<Point>::y(p));
        t[j] = touches ? S(0) : not_a_number<S>();
        row_found = row_found || S(x[j] * x[j] + y[j] * y[j]) < no_distance_sq<S>();
        row_touch = row_touch || touches;
      }
      any_found = any_found || row_found;
      first_row = row_touch ? std::min(first_row, i) : first_row;
      last_row = row_touch ? i : last_row;
    }
    any_touch = last_row >= 0;
  }
};

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
