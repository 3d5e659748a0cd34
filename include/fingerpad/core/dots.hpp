// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Vocabulary: dots printed inside the membrane. A dot grid is a grid whose cells are points, in the
// order in which the dots are printed, so that a dot's neighbours in the grid are its neighbours on
// the membrane. A dot that was not found is a point with a coordinate that is not finite, or has a
// magnitude of a million (px or mm) or more.
#include <concepts>
#include <type_traits>
#include <utility>

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
