// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The forces on a segment and their balance. Source: Ito, Kim, Obinata 2011, III.D, eqs. 6-12.
//
// A segment M(i, j) has four borders: two pieces of the lines around, below (j) and above (j + 1),
// and two of the lines from the rim, left (i) and right (i + 1). Each border transmits a tension
// normal to it, f_v or f_h, and a shear along it, tau_v or tau_h (N/mm), both in the membrane. The
// pressure acts on the area vector S. The force of a border on the segment below or to the left of
// it is opposite to that on the segment above or to the right.
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/compartments.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::membrane {

/// A border of two segments. The force on the segment on the near side (below, left) is
/// f `normal` + tau `along`; the vectors include the length of the border.
template <scalar S>
struct Border {
  Point3<S> along;   ///< from line i to i + 1, or from row j to j + 1; as long as the border, mm
  Point3<S> normal;  ///< in the membrane, upward or toward line i + 1; as long as the border, mm
};

/// Borders and areas of all segments. Allocates only in the constructor.
template <scalar S>
class Segments {
 public:
  Segments(Index columns, Index rows)
      : columns_(columns),
        rows_(rows),
        around_(static_cast<std::size_t>(columns * (rows + 1))),
        upward_(static_cast<std::size_t>(columns * rows)),
        area_(static_cast<std::size_t>(columns * rows)),
        normal_(area_.size()) {}

  Index columns() const { return columns_; }
  Index rows() const { return rows_; }
  Index next(Index line) const { return line + 1 == columns_ ? 0 : line + 1; }
  Index previous(Index line) const { return line == 0 ? columns_ - 1 : line - 1; }

  /// Border between lines i and i + 1 in row j = 0 ... m.
  const Border<S>& around(Index i, Index j) const { return around_[at(i, j)]; }
  /// Border on line i, between rows j and j + 1.
  const Border<S>& upward(Index i, Index j) const { return upward_[at(i, j)]; }
  /// Area vector of M(i, j), out of the fluid, mm^2.
  const Point3<S>& area(Index i, Index j) const { return area_[at(i, j)]; }

  void measure(const Compartments<S>& nodes) {
    for (Index j = 0; j < rows_; ++j) {
      for (Index i = 0; i < columns_; ++i) {
        const Point3<S>& a = nodes.node(i, j);
        const Point3<S>& b = nodes.node(next(i), j);
        const Point3<S>& c = nodes.node(next(i), j + 1);
        const Point3<S>& d = nodes.node(i, j + 1);
        const Point3<S> area = S(S(1) / S(2)) * cross(c - a, d - b);
        area_[at(i, j)] = area;
        normal_[at(i, j)] =
            value(squared_norm(area)) > 0 ? normalized(area) : Point3<S>{S(0), S(0), S(0)};
      }
    }
    for (Index j = 0; j <= rows_; ++j) {
      for (Index i = 0; i < columns_; ++i) {
        const Point3<S> along = nodes.node(next(i), j) - nodes.node(i, j);
        // the membrane's normal at the border is the mean of both sides
        const Point3<S> out = j == 0       ? normal(i, 0)
                              : j == rows_ ? (nodes.end_normal(i) + nodes.end_normal(next(i)))
                                           : (normal(i, j) + normal(i, j - 1));
        around_[at(i, j)] = {along, stretched(cross(out, along), along)};
      }
    }
    for (Index j = 0; j < rows_; ++j) {
      for (Index i = 0; i < columns_; ++i) {
        const Point3<S> along = nodes.node(i, j + 1) - nodes.node(i, j);
        const Point3<S> out = normal(i, j) + normal(previous(i), j);
        upward_[at(i, j)] = {along, stretched(cross(along, out), along)};
      }
    }
  }

 private:
  std::size_t at(Index i, Index j) const { return static_cast<std::size_t>(j * columns_ + i); }

  const Point3<S>& normal(Index i, Index j) const { return normal_[at(i, j)]; }

  /// `direction` scaled to the length of `like`; 0 stays 0.
  static Point3<S> stretched(const Point3<S>& direction, const Point3<S>& like) {
    using std::sqrt;
    const S from = squared_norm(direction);
    return value(from) > 0 ? (S(sqrt(S(squared_norm(like) / from))) * direction)
                           : Point3<S>{S(0), S(0), S(0)};
  }

  Index columns_;
  Index rows_;
  std::vector<Border<S>> around_;
  std::vector<Border<S>> upward_;
  std::vector<Point3<S>> area_;
  std::vector<Point3<S>> normal_;  // unit vectors of the areas; 0 for area 0
};

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
