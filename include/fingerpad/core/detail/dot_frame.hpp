// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The dots of a frame, read once: what was found, and whether each is the dot that its place in the
// grid says, and not one of two exchanged or a spot of glare.
#include <cstddef>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// Cells of a grid with a border of one cell, so that each cell has neighbours, in rows of `width`.
template <class T>
struct Bordered : std::vector<T> {
  using std::vector<T>::vector;
  T& operator[](Index k) { return this->data()[k]; }
  const T& operator[](Index k) const { return this->data()[k]; }
};

/// Number of elements, as a signed number.
template <class T>
Index size_of(const std::vector<T>& cells) {
  return static_cast<Index>(cells.size());
}
template <scalar S>
S number(Index count) {
  return S(static_cast<double>(count));
}

/// A frame of dots; NaN for a dot that was not found. In the image z is 0.
template <scalar S>
struct FrameOfDots {
  Index rows, cols, width = cols + 2;
  Bordered<Point3<S>> found =
      Bordered<Point3<S>>(static_cast<std::size_t>((rows + 2) * width), missing_point<S>());
  Index count = 0;  ///< found
  bool in_image = false;

  Index cell(Index i, Index j) const { return (i + 1) * width + j + 1; }

  /// Dots at exactly 0 or exactly -1, as other software marks lost ones, are not found if several
  /// are there. `flat`: of points in space only x and y are read.
  template <class View>
  void read(const View& dots, bool flat = false) {
    using Cell = cell_t<View>;
    in_image = flat || !spatial_point<Cell>;
    count = 0;
    Index at_0 = 0, at_minus_1 = 0;
    const auto is_at = [&](const Point3<S>& p, const S& c) {
      return p.x == c && p.y == c && (in_image || p.z == c);
    };
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0, k = cell(i, 0); j < cols; ++j, ++k) {
        const Cell given = dots(i, j);
        Point3<S> p = {S(point_traits<Cell>::x(given)), S(point_traits<Cell>::y(given)), S(0)};
        if constexpr (spatial_point<Cell>) {
          p.z = flat ? S(0) : S(point_traits<Cell>::z(given));
        }
        const bool there = is_plausible(p);
        found[k] = there ? p : missing_point<S>();
        count += there ? 1 : 0;
        at_0 += is_at(p, S(0)) ? 1 : 0;
        at_minus_1 += is_at(p, S(-1)) ? 1 : 0;
      }
    }
    for (Point3<S>& p : found) {
      if ((at_0 > 1 && is_at(p, S(0))) || (at_minus_1 > 1 && is_at(p, S(-1)))) {
        p = missing_point<S>();
        --count;
      }
    }
  }

  /// Whether dot k, the `at`-th of `of` in a line, is further than half a pitch from the middle of
  /// the two beside it or, at an end, from where the next two point. False if one is missing.
  bool is_out_of_line(Index k, Index at, Index of, Index step) const {
    if (of < 3) {
      return false;
    }
    const bool ends = at == 0 || at == of - 1;
    const Index in = at == 0 ? step : -step;
    const Point3<S>& a = found[k + in];
    const Point3<S>& b = found[k + (ends ? 2 * in : -in)];
    const Point3<S> pitch = ends ? a - b : (a - b) / S(2);
    const Point3<S> expected = ends ? a + pitch : (a + b) / S(2);
    return value(squared_norm(pitch)) < 4 * value(squared_norm(found[k] - expected));
  }
};

/// Mean square distance of neighbours among the dots in these cells; 0 if there are none.
template <scalar S, class Cells>
S mean_pitch_sq(const Cells& cells, const Point3<S>* dots, Index width) {
  S sum = S(0);
  Index count = 0;
  for (const Index k : cells) {
    for (const Index beside : {Index(1), width}) {
      const S sq = squared_norm(dots[k + beside] - dots[k]);
      sum = is_finite(sq) ? sum + sq : sum;
      count += is_finite(sq) ? 1 : 0;
    }
  }
  return count > 0 ? sum / number<S>(count) : S(0);
}

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
