// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The equilibrium of one segment as rows of a least-squares problem. Source: Ito, Kim, Obinata
// 2011, III.D, eqs. 6 and 7.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/force/compartments.hpp"
#include "fingerpad/force/detail/segments.hpp"
#include "fingerpad/force/detail/sparse_fronts.hpp"
#include "fingerpad/core/detail/point_algebra.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::membrane {

/// The equations of one segment, for tensions over pressure.
template <class R>
class SegmentRows {
 public:
  /// `low` is the lower border.
  template <scalar S>
  SegmentRows(const Segments<S>& segments,
              const Compartments<S>& nodes,
              const Border<S>& low,
              Index i,
              Index j) {
    using std::sqrt;
    const Index next = segments.next(i);
    const Point3<R> a = as<R>(nodes.node(i, j));
    const Point3<R> b = as<R>(nodes.node(next, j));
    const Point3<R> c = as<R>(nodes.node(next, j + 1));
    const Point3<R> d = as<R>(nodes.node(i, j + 1));
    const R quarter = R(1) / R(4);
    const Point3<R> upward = scaled(quarter, difference(sum(c, d), sum(a, b)));
    const Point3<R> onward = scaled(quarter, difference(sum(b, c), sum(a, d)));
    const Point3<R> area = as<R>(segments.area(i, j));
    const R size = sqrt(length_sq(area));
    has_area_ = value(size) > 0;
    if (!has_area_) {
      return;
    }
    root_ = sqrt(size);
    out_ = scaled(R(R(1) / size), area);
    set(0, low, R(-1), scaled(R(-1), upward));
    set(1, segments.around(i, j + 1), R(1), upward);
    set(2, segments.upward(i, j), R(-1), scaled(R(-1), onward));
    set(3, segments.upward(next, j), R(1), onward);
  }

  /// Adds the squares of (6) and (7).
  void add_to(SegmentEquations<R>& equations) const {
    if (!has_area_) {
      return;
    }
    for (std::size_t r = 0; r < 8; ++r) {
      for (std::size_t c = 0; c <= r; ++c) {
        equations.entries[r][c] =
            equations.entries[r][c] + dot(force_[r], force_[c]) + torque_[r] * torque_[c];
      }
      R& right = equations.entries[SegmentEquations<R>::right_row][r];
      right = right - root_ * dot(force_[r], out_);
    }
  }

 private:
  template <class To, scalar S>
  static Point3<To> as(const Point3<S>& p) {
    return {To(p.x), To(p.y), To(p.z)};
  }

  template <scalar S>
  void set(std::size_t border, const Border<S>& of, const R& sign, const Point3<R>& arm) {
    const R over_root = sign / root_;
    force_[2 * border] = scaled(over_root, as<R>(of.normal));
    force_[2 * border + 1] = scaled(over_root, as<R>(of.along));
    const Point3<R> turning = scaled(R(R(1) / root_), cross(out_, arm));  // out . (arm x f)
    torque_[2 * border] = dot(turning, force_[2 * border]);
    torque_[2 * border + 1] = dot(turning, force_[2 * border + 1]);
  }

  bool has_area_ = false;
  R root_ = R(0);  // of the area, mm
  Point3<R> out_{R(0), R(0), R(0)};
  std::array<Point3<R>, 8> force_;
  std::array<R, 8> torque_;
};

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
