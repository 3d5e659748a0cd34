// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The surface on which the dots in contact lie: its normals, and axes along it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// A surface z = c0 + c1 x + c2 y + c3 x^2 + c4 x y + c5 y^2, with coordinates relative to
/// `middle`.
template <class S>
struct Quadric {
  std::array<S, 6> c = {S(0), S(0), S(0), S(0), S(0), S(0)};
  Point3<S> middle = {S(0), S(0), S(0)};
  Index dots = 0;

  static std::array<S, 6> terms(const S& x, const S& y) {
    return {S(1), x, y, S(x * x), S(x * y), S(y * y)};
  }
  S height(const Point3<S>& p) const {
    const auto t = terms(S(p.x - middle.x), S(p.y - middle.y));
    return middle.z + c[0] + c[1] * t[1] + c[2] * t[2] + c[3] * t[3] + c[4] * t[4] + c[5] * t[5];
  }
  /// dz/dx and dz/dy.
  Point2<S> slope(const Point3<S>& p) const {
    const S x = p.x - middle.x, y = p.y - middle.y;
    return {S(c[1] + S(2) * c[3] * x + c[4] * y), S(c[2] + c[4] * x + S(2) * c[5] * y)};
  }
  /// Unit normal toward the object.
  Point3<S> normal(const Point3<S>& p) const {
    const Point2<S> z = slope(p);
    return normalized(Point3<S>{S(-z.x), S(-z.y), S(1)});
  }
};

/// The surface from the normal equations of its terms. A plane if these do not determine the
/// quadratic terms; level if they do not determine a plane either.
template <class S>
Quadric<S> quadric_of(const SmallMatrix<S, 6>& a, const std::array<S, 6>& b) {
  Quadric<S> q;
  const NormalEquations<S, 6> bent(a, 1e-3);
  if (bent.good) {
    q.c = bent.solve(b);
    return q;
  }
  SmallMatrix<S, 3> flat = zero_matrix<S, 3>();
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      flat[i][j] = a[i][j];
    }
  }
  const NormalEquations<S, 3> plane(flat, 1e-6);
  if (plane.good) {
    const auto c = plane.solve({b[0], b[1], b[2]});
    q.c = {c[0], c[1], c[2], S(0), S(0), S(0)};
  }
  return q;
}

/// The surface through all points that for_each(visit) visits. It is called twice.
template <class S, class ForEach>
Quadric<S> quadric_through(const ForEach& for_each) {
  Point3<S> middle = {S(0), S(0), S(0)};
  Index dots = 0;
  for_each([&](const Point3<S>& p) {
    middle += p;
    ++dots;
  });
  middle = middle / S(static_cast<double>((std::max)(dots, Index(1))));
  SmallMatrix<S, 6> a = zero_matrix<S, 6>();
  std::array<S, 6> b = detail::zeros<S, 6>();
  for_each([&](const Point3<S>& p) {
    const auto t = Quadric<S>::terms(S(p.x - middle.x), S(p.y - middle.y));
    const S z = p.z - middle.z;
    for (std::size_t i = 0; i < 6; ++i) {
      b[i] = b[i] + t[i] * z;
      for (std::size_t j = 0; j <= i; ++j) {
        a[i][j] = a[i][j] + t[i] * t[j];
      }
    }
  });
  Quadric<S> q = quadric_of(a, b);
  q.middle = middle;
  q.dots = dots;
  return q;
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
