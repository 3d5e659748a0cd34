// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Vocabulary: dots printed inside the membrane. A dot grid is a grid whose cells are points, in the
// order in which the dots are printed, so that a dot's neighbours in the grid are its neighbours on
// the membrane. A dot that was not found is a point with a coordinate that is not finite, or has a
// magnitude of a million (px or mm) or more.
#include <concepts>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {

/// Reads the coordinates of a point type: the members x, y (and z) if it has them, else p[0], p[1]
/// (and p[2]) as in Eigen vectors, cv::Vec and arrays. Specialise it for other types.
template <class P>
struct point_traits {
  static constexpr auto x(const P& p) { return p[0]; }
  static constexpr auto y(const P& p) { return p[1]; }
  static constexpr auto z(const P& p) { return p[2]; }
};
template <class P>
  requires requires(const P& p) {
    +p.x;
    +p.y;
  }
struct point_traits<P> {
  static constexpr auto x(const P& p) { return p.x; }
  static constexpr auto y(const P& p) { return p.y; }
  static constexpr auto z(const P& p) requires requires { +p.z; }
  { return p.z; }
};

namespace detail {
template <class P> concept has_coordinates = requires(const P& p) {
  +p.x;
}
|| requires(const P& p) {
  p[0];
}
|| requires {
  point_traits<P>::adapted;
};
}  // namespace detail

/// Models: Point2, Point3, cv::Point2f, cv::Vec2d, Eigen::Vector2d, std::array<float, 2>.
template <class P> concept planar_point = detail::has_coordinates<P> && requires(const P& p) {
  { point_traits<P>::x(p) } -> scalar;
  { point_traits<P>::y(p) } -> scalar;
};

/// A planar point that also has a depth z, and room for it: p[2] of a vector of two compiles too.
template <class P> concept spatial_point = planar_point<P> && requires(const P& p) {
  { point_traits<P>::z(p) } -> scalar;
  requires sizeof(P) >= 3 * sizeof(point_traits<P>::z(p));
};

/// A grid of points in the order in which the dots are printed.
template <class G> concept dot_grid = grid<G> && planar_point<cell_t<G>>;

/// A dot grid whose points have depths, in mm.
template <class G> concept spatial_dot_grid = dot_grid<G> && spatial_point<cell_t<G>>;

/// True when the dot was found: x and y (and z where the point has it as a member) are finite and
/// below a million in magnitude.
template <planar_point P>
constexpr bool is_present(const P& p) {
  using Traits = point_traits<P>;
  bool present = is_plausible(Traits::x(p)) && is_plausible(Traits::y(p));
  if constexpr (requires { +p.z; }) {
    present = present && is_plausible(Traits::z(p));
  }
  return present;
}

/// Row and column of a dot in the grid; row -1 means no dot.
struct DotIndex {
  Index row = -1;
  Index col = -1;

  constexpr bool exists() const { return row >= 0; }
  friend constexpr bool operator==(const DotIndex&, const DotIndex&) = default;
};

namespace detail {
/// The dot converted to the scalar S; all NaN if it was not found.
template <scalar S, spatial_point P>
constexpr Point3<S> spatial_dot(const P& p) {
  using Traits = point_traits<P>;
  const Point3<S> dot = {S(Traits::x(p)), S(Traits::y(p)), S(Traits::z(p))};
  return is_plausible(dot) ? dot : missing_point<S>();
}

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

/// How many dots of the grid were found.
template <dot_grid G>
constexpr Index count_present(const G& dots) {
  Index count = 0;
  for (Index i = 0; i < rows(dots); ++i) {
    for (Index j = 0; j < cols(dots); ++j) {
      count += is_present(cell_t<G>(grid_traits<G>::at(dots, i, j))) ? 1 : 0;
    }
  }
  return count;
}

}  // namespace v1
}  // namespace fingerpad
