// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The surface on which the dots in contact lie.
#include <algorithm>
#include <array>

#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail::stick {

/// A surface z = c0 + c1 x + c2 y + c3 x^2 + c4 x y + c5 y^2, with coordinates relative to
/// `middle`.
template <class S>
struct Quadric {
  std::array<S, 6> c = {S(0), S(0), S(0), S(0), S(0), S(0)};
  Point3<S> middle = {S(0), S(0), S(0)};
  Index dots = 0;

  static std::array<S, 6> terms(const S& x, const S& y) {
    return {S(1), x, y, x * x, x * y, y * y};
  }
  S height(const Point3<S>& p) const {
    const auto t = terms(p.x - middle.x, p.y - middle.y);
    return middle.z + c[0] + c[1] * t[1] + c[2] * t[2] + c[3] * t[3] + c[4] * t[4] + c[5] * t[5];
  }
  /// Unit normal toward the object, by the mean slope of the points.
  Point3<S> normal() const { return normalized(Point3<S>{-c[1], -c[2], S(1)}); }
};

/// The surface through all points that for_each(visit) visits. It is called twice. A plane if the
/// points do not determine the quadratic terms; level if they do not determine a plane either.
template <class S, class ForEach>
Quadric<S> quadric_through(const ForEach& for_each) {
  Quadric<S> q;
  for_each([&](const Point3<S>& p) {
    q.middle += p;
    ++q.dots;
  });
  q.middle = q.middle / S(static_cast<double>((std::max)(q.dots, Index(1))));
  ProductSums<S, 7> sums;
  for_each([&](const Point3<S>& p) {
    const auto t = Quadric<S>::terms(p.x - q.middle.x, p.y - q.middle.y);
    sums.add({t[0], t[1], t[2], t[3], t[4], t[5], p.z - q.middle.z});
  });
  const NormalEquations<S, 6> bent(sums.template corner<6>(), 1e-3);
  const NormalEquations<S, 3> flat(sums.template corner<3>(), 1e-6);
  if (bent.good) {
    q.c = bent.solve(sums.template column<6>(6));
  } else if (flat.good) {
    const auto c = flat.solve(sums.template column<3>(6));
    q.c = {c[0], c[1], c[2], S(0), S(0), S(0)};
  }
  return q;
}

}  // namespace detail::stick
}  // namespace v1
}  // namespace fingerpad
