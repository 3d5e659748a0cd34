// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A dot with its eight neighbours, and the two directions in which the papers measure how it has
// turned. Source: Ito, Kim, Nagai, Obinata 2011, eqs. 14 and 15:
//   q1 = sum over k of p(I+1, J+k) - p(I-1, J+k)     along the columns of the grid
//   q2 = sum over k of p(I+k, J+1) - p(I+k, J-1)     along its rows
// (I-th from the left, J-th from the top). These are the slopes of the affine map from the grid to
// space that fits the nine dots best; so, where dots are missing, the slopes of the map that fits
// the remaining ones take their place.
#include <array>
#include <cstddef>

#include "fingerpad/motion/detail/dot_frame.hpp"

namespace fingerpad {
inline namespace v0 {

/// Nine points of the grid, row by row, the middle one at index 4; NaN or inf: missing.
template <scalar S = double>
struct Neighbourhood {
  std::array<Point3<S>, 9> dot;
  std::array<bool, 9> found = {};
};

/// Which dots of two neighbourhoods are found in both.
struct CommonDots {
  std::array<bool, 9> found = {};
  Index count = 0;
};

template <scalar S>
CommonDots common_dots(const Neighbourhood<S>& a, const Neighbourhood<S>& b) {
  CommonDots common;
  for (std::size_t k = 0; k < 9; ++k) {
    common.found[k] = a.found[k] && b.found[k];
    common.count += common.found[k] ? 1 : 0;
  }
  return common;
}

/// q1 and q2 but for a common positive factor; both 0 where the dots lie on one line of the grid.
template <scalar S>
struct GridDirections {
  Point3<S> q1;
  Point3<S> q2;
};

namespace detail::motion {

/// The sums as printed, for nine dots.
template <scalar S>
GridDirections<S> directions_of_all(const std::array<Point3<S>, 9>& p) {
  const auto steps = [&](std::size_t a, std::size_t b, std::size_t c, std::size_t by) {
    return sum(sum(difference(p[a + by], p[a]), difference(p[b + by], p[b])),
               difference(p[c + by], p[c]));
  };
  return {steps(0, 3, 6, 2), steps(0, 1, 2, 6)};
}

/// The least-squares slopes over the dots that remain, times the positive determinant of the
/// normal equations, whose coefficients are whole numbers.
template <scalar S>
GridDirections<S> directions_of_some(const std::array<Point3<S>, 9>& p,
                                     const std::array<bool, 9>& found) {
  int n = 0, su = 0, sv = 0, suu = 0, svv = 0, suv = 0;
  for (int k = 0; k < 9; ++k) {
    const int u = k % 3 - 1, v = k / 3 - 1;
    if (found[static_cast<std::size_t>(k)]) {
      ++n;
      su += u;
      sv += v;
      suu += u * u;
      svv += v * v;
      suv += u * v;
    }
  }
  const int cuu = n * suu - su * su, cvv = n * svv - sv * sv, cuv = n * suv - su * sv;
  GridDirections<S> q = {{S(0), S(0), S(0)}, {S(0), S(0), S(0)}};
  if (cuu * cvv == cuv * cuv) {
    return q;
  }
  std::size_t first = 0;
  while (!found[first]) {
    ++first;
  }
  for (int k = 0; k < 9; ++k) {
    const int u = n * (k % 3 - 1) - su, v = n * (k / 3 - 1) - sv;
    const auto at = static_cast<std::size_t>(k);
    if (found[at]) {
      const Point3<S> from_first =
          difference(p[at], p[first]);  // 0, not roundoff, if all are equal
      q.q1 = sum(q.q1, scaled(S(cvv * u - cuv * v), from_first));
      q.q2 = sum(q.q2, scaled(S(cuu * v - cuv * u), from_first));
    }
  }
  return q;
}

template <scalar S, class Frame>
Neighbourhood<S> neighbourhood(const Frame& frame, DotIndex d) {
  Neighbourhood<S> n;
  for (std::size_t k = 0; k < 9; ++k) {
    const Index i = d.row - 1 + static_cast<Index>(k / 3);
    const Index j = d.col - 1 + static_cast<Index>(k % 3);
    const bool inside = i >= 0 && j >= 0 && i < frame.rows() && j < frame.cols();
    n.dot[k] = inside ? frame.dot(i, j) : missing_point<S>();
    n.found[k] = is_placed(n.dot[k]);
  }
  return n;
}

/// Center of the common dots.
template <scalar S>
Point3<S> center(const Neighbourhood<S>& n, const CommonDots& common) {
  Point3<S> c = {S(0), S(0), S(0)};
  for (std::size_t k = 0; k < 9; ++k) {
    c = common.found[k] ? sum(c, n.dot[k]) : c;
  }
  return scaled(S(S(1) / S(static_cast<double>(common.count))), c);
}

}  // namespace detail::motion

/// q1 and q2 over the dots of `common`.
template <scalar S>
GridDirections<S> grid_directions(const Neighbourhood<S>& n, const CommonDots& common) {
  return common.count == 9 ? detail::motion::directions_of_all(n.dot)
                           : detail::motion::directions_of_some(n.dot, common.found);
}

}  // namespace v0
}  // namespace fingerpad
