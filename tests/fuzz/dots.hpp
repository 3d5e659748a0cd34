// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Printed dots as the fuzzer's bytes have them.
#include "fingerpad/core/point.hpp"
#include "fuzz/input.hpp"

namespace fuzz {

/// Dots near a lattice, so that they can be those of a pad, and strange ones among them.
template <class Point>
Grid<Point> any_dots(Input& in, Index rows, Index cols) {
  using Number = decltype(Point::x);
  Grid<Point> dots(rows, cols, in.whole(0, 2));
  dots.fill(in, [&] {
    Point dot;
    dot.x = static_cast<Number>(in.number(-1, 1));
    dot.y = static_cast<Number>(in.number(-1, 1));
    if constexpr (requires { dot.z; }) {
      dot.z = static_cast<Number>(in.number(5, 12));
    }
    return dot;
  });
  const double pitch = in.number(0.5, 25);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      Point& dot = dots.view()(i, j);
      dot.x += static_cast<Number>(pitch * static_cast<double>(j));
      dot.y += static_cast<Number>(pitch * static_cast<double>(i));
    }
  }
  return dots;
}

/// The same dots, each moved alike but for a few.
template <class Point>
Grid<Point> moved_dots(Input& in, const Grid<Point>& from) {
  using Number = decltype(Point::x);
  Grid<Point> dots = from;
  const auto by_x = static_cast<Number>(in.number(-1, 1));
  const auto by_y = static_cast<Number>(in.number(-1, 1));
  const auto view = dots.view();
  for (Index i = 0; i < view.rows(); ++i) {
    for (Index j = 0; j < view.cols(); ++j) {
      view(i, j).x += by_x;
      view(i, j).y += by_y;
    }
  }
  for (Index k = in.whole(0, 4); k > 0 && view.rows() > 0 && view.cols() > 0; --k) {
    Point& dot = view(in.whole(0, view.rows() - 1), in.whole(0, view.cols() - 1));
    dot.x = static_cast<Number>(in.number(-30, 30));
    dot.y = static_cast<Number>(in.number(-30, 30));
  }
  return dots;
}

}  // namespace fuzz
