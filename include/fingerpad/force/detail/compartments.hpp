// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The membrane cut into n x m segments M(i, j) by n lines from the rim to the line A_g and m + 1
// lines around. Source: Ito, Kim, Obinata 2011, III.C.
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/height_map.hpp"
#include "fingerpad/force/detail/meridian.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail::membrane {

/// Nodes x(i, j): line i = 0 ... n - 1, row j = 0 (rim) ... m (A_g). Allocates only in the
/// constructor.
template <scalar S>
class Compartments {
 public:
  Compartments(Index columns, Index rows, const S& base_radius_mm, const LineSteps<S>& steps)
      : columns_(columns),
        rows_(rows),
        base_radius_mm_(base_radius_mm),
        steps_(steps),
        nodes_(static_cast<std::size_t>(columns * (rows + 1))) {
    // five times the arc from the rim to the apex of a hemisphere
    const S most = S(8) * base_radius_mm / steps.arc_mm;
    const std::size_t points = static_cast<std::size_t>(value(most)) + 8;
    lines_.assign(static_cast<std::size_t>(columns), Meridian<S>(points));
    level_sums_.resize(lines_.size());
    for (Meridian<S>& line : lines_) {
      line = Meridian<S>(points);  // a copy would not keep the reserved memory
    }
  }

  Index columns() const { return columns_; }
  Index rows() const { return rows_; }
  const Point3<S>& node(Index line, Index row) const {
    return nodes_[static_cast<std::size_t>(row * columns_ + line)];
  }
  LineEnd end(Index line) const { return lines_[static_cast<std::size_t>(line)].end(); }
  const Point3<S>& end_normal(Index line) const {
    return lines_[static_cast<std::size_t>(line)].end_normal();
  }
  /// Number of lines that ended in a hole and were interpolated from their neighbours.
  Index broken() const { return broken_; }
  /// Number of lines at whose end the membrane is level.
  Index level() const {
    Index count = 0;
    for (const Meridian<S>& line : lines_) {
      count += line.is_level() ? 1 : 0;
    }
    return count;
  }

  /// The highest end of a line.
  S top_mm() const {
    S top = node(0, rows_).z;
    for (Index i = 1; i < columns_; ++i) {
      top = node(i, rows_).z > top ? node(i, rows_).z : top;
    }
    return top;
  }

  /// Area within A_g in plan, as a polygon. `per_mm`: root sum of squares, over the lines, of its
  /// change if a line ends 1 mm further out.
  S summit_area(S& per_mm) const {
    using std::sqrt;
    S area = S(0), squares = S(0);
    for (Index i = 0; i < columns_; ++i) {
      const Point3<S>& left = node(i == 0 ? columns_ - 1 : i - 1, rows_);
      const Point3<S>& here = node(i, rows_);
      const Point3<S>& right = node(i + 1 == columns_ ? 0 : i + 1, rows_);
      area = area + (here.x * right.y - here.y * right.x) / S(2);
      // the corner moves across the chord between its neighbours
      squares = squares + (square(S(right.x - left.x)) + square(S(right.y - left.y))) / S(4);
    }
    per_mm = sqrt(squares);
    return area;
  }

  /// Angle of line i at the rim.
  S angle(Index line) const {
    return S(2 * std::numbers::pi) * S(static_cast<double>(line)) /
           S(static_cast<double>(columns_));
  }

  /// Traces the lines over `shape`; `center` is the middle of the contact. Lines that end in a hole
  /// are interpolated from their neighbours.
  template <class Lines, class Shape>
  void lay(const Shape& shape, const Point3<S>& center) {
    using std::cos;
    using std::sin;
    S growth = S(0);
    S level = S(0);
    for (Index i = 0; i < columns_; ++i) {
      Meridian<S>& line = lines_[static_cast<std::size_t>(i)];
      const S at = angle(i);
      line.template trace<Lines::straight>(
          shape, {S(base_radius_mm_ * S(cos(at))), S(base_radius_mm_ * S(sin(at))), S(0)}, center,
          steps_);
      LevelSums<S>& sums = level_sums_[static_cast<std::size_t>(i)];
      sums = line.level_sums(center, steps_);
      sums.add_growth(growth, level);
    }
    const S most = S(1) / S(20);  // per mm: more is noise
    growth = value(level) == 0 ? S(0) : S(growth / level);
    growth = growth > most ? most : (growth < S(-most) ? S(-most) : growth);
    broken_ = 0;
    for (Index i = 0; i < columns_; ++i) {
      Meridian<S>& line = lines_[static_cast<std::size_t>(i)];
      line.finish(level_sums_[static_cast<std::size_t>(i)].level_radius_sq(growth), center, steps_);
      if (line.end() == LineEnd::hole) {
        ++broken_;
      } else {
        cut<Lines>(i);
      }
    }
    if (broken_ > 0 && broken_ < columns_) {
      bridge();
    }
  }

 private:
  Point3<S>& at(Index line, Index row) {
    return nodes_[static_cast<std::size_t>(row * columns_ + line)];
  }

  static S length_of(const S& sq) {
    using std::sqrt;
    return value(sq) > 0 ? S(sqrt(sq)) : S(0);
  }
  static S measure(const Point3<S>& a, const Point3<S>& b, bool by_height) {
    using std::sqrt;
    const S climb = b.z - a.z;
    return by_height ? (climb < S(0) ? S(0) : climb) : length_of(S(squared_norm(b - a)));
  }

  /// Places the nodes of a line at equal parts of its height or length, or at fixed steps if Lines
  /// has a step_mm. With fixed steps, nodes beyond the end of the line lie at its end, and the last
  /// segment takes the rest of a longer line.
  template <class Lines>
  void cut(Index line) {
    constexpr bool ByHeight = Lines::by_height;
    const std::vector<Point3<S>>& points = lines_[static_cast<std::size_t>(line)].points();
    S total = S(0);
    for (std::size_t k = 1; k < points.size(); ++k) {
      total = total + measure(points[k - 1], points[k], ByHeight);
    }
    S step = total / S(static_cast<double>(rows_));
    if constexpr (requires { Lines::step_mm; }) {
      step = S(Lines::step_mm);
    }
    at(line, 0) = points.front();
    at(line, rows_) = points.back();
    std::size_t k = 1;
    S before = S(0);  // up to point k - 1
    S length = measure(points[0], points[1], ByHeight);
    for (Index j = 1; j < rows_; ++j) {
      const S wanted = step * S(static_cast<double>(j));
      while (k + 1 < points.size() && before + length < wanted) {
        before = before + length;
        ++k;
        length = measure(points[k - 1], points[k], ByHeight);
      }
      S share = value(length) > 0 ? S((wanted - before) / length) : S(0);
      share = before + length < wanted ? S(1) : share;  // beyond the end
      at(line, j) = points[k - 1] + share * (points[k] - points[k - 1]);
    }
  }

  /// Interpolates broken lines between the nearest whole ones on both sides, rotated about the
  /// axis.
  void bridge() {
    for (Index i = 0; i < columns_; ++i) {
      if (end(i) != LineEnd::hole) {
        continue;
      }
      Index left = 1, right = 1;
      while (end((i - left + columns_) % columns_) == LineEnd::hole) {
        ++left;
      }
      while (end((i + right) % columns_) == LineEnd::hole) {
        ++right;
      }
      const S share = S(static_cast<double>(left)) / S(static_cast<double>(left + right));
      for (Index j = 0; j <= rows_; ++j) {
        const Point3<S> a = rotated(node((i - left + columns_) % columns_, j), left);
        const Point3<S> b = rotated(node((i + right) % columns_, j), -right);
        at(i, j) = a + share * (b - a);
      }
    }
  }

  Point3<S> rotated(const Point3<S>& p, Index by) const {
    using std::cos;
    using std::sin;
    const S c = cos(angle(by));
    const S s = sin(angle(by));
    return {S(c * p.x - s * p.y), S(s * p.x + c * p.y), p.z};
  }

  Index columns_;
  Index rows_;
  S base_radius_mm_;
  LineSteps<S> steps_;
  Index broken_ = 0;
  std::vector<Point3<S>> nodes_;
  std::vector<Meridian<S>> lines_;
  std::vector<LevelSums<S>> level_sums_;  // of each line
};

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
