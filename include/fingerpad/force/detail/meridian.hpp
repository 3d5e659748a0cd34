// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// One line B(i) up the membrane, from a point of the rim to the line A_g, above which the membrane
// no longer carries the load by tension alone. A_g is the summit, where the membrane is level, or
// the edge of the contact. Source: Ito, Kim, Obinata 2011, III.C.
//
// A smoothed depth map blurs the edge of a contact, so the edge is extrapolated from the free
// membrane beside it. At a distance r from the middle of a level contact of radius r_g the vertical
// balance of the membrane between r_g and r is
//   p (r^2 - r_g^2) / 2 = T r sin(inclination),
// and the tension T grows slowly outward, as 1 + g (r - r_g). A straight line through the points
// (r (1 + g (r - r_g)) sin(inclination), r^2) therefore has the value r_g^2 at inclination 0. g
// follows from the curvature of the same points; all lines of a frame share it.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fingerpad/core/detail/vectors.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/height_map.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::membrane {

/// Where a line ended.
enum class LineEnd : std::uint8_t {
  edge,    ///< at the edge of the contact
  summit,  ///< where the membrane is level without contact
  hole,    ///< where the height is unknown
};

template <scalar S>
struct LineSteps {
  S arc_mm;    ///< length of a step along the membrane
  S blur_mm;   ///< points nearer to the edge are not used: half the width of smoothing
  S reach_mm;  ///< inclinations are used up to this far beyond blur_mm
};

/// Sums for the least-squares fit of
///   r^2 - r_edge^2 = r_g^2 - r_edge^2 + level x + growth x (r - r_edge),   x = r sin(inclination).
/// r_edge is where the contact begins in the map.
template <scalar S>
struct LevelSums {
  SmallMatrix<S, 3> normal = zero_matrix<S, 3>();
  std::array<S, 3> right = detail::zeros<S, 3>();
  S edge_sq = S(0);
  Index count = 0;

  void add(const S& r_sq, const S& leaning, const S& beside) {
    const std::array<S, 3> row = {S(1), leaning, S(leaning * beside)};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        normal[i][j] = normal[i][j] + row[i] * row[j];
      }
      right[i] = right[i] + row[i] * (r_sq - edge_sq);
    }
    ++count;
  }

  /// Adds this line's contribution to g: its numerator and its denominator.
  void add_growth(S& growth, S& level) const {
    const NormalEquations<S, 3> equations(normal, 1e-10);
    if (count >= 6 && equations.good) {
      const std::array<S, 3> found = equations.solve(right);
      growth = growth + found[2];
      level = level + found[1];
    }
  }

  /// r_g^2 for a given g; NaN with fewer than 3 points.
  S level_radius_sq(const S& growth) const {
    // x (1 + g (r - r_edge)) as the one unknown
    const S xx = normal[1][1] + S(2) * growth * normal[1][2] + growth * growth * normal[2][2];
    const S x = normal[0][1] + growth * normal[0][2];
    const S xy = right[1] + growth * right[2];
    const S n = normal[0][0];
    return count >= 3 ? S(edge_sq + (xx * right[0] - x * xy) / (n * xx - x * x))
                      : not_a_number<S>();
  }
};

/// The points of a line. Allocates only in the constructor.
template <scalar S>
class Meridian {
 public:
  explicit Meridian(std::size_t max_points)
      : most_(max_points), points_(max_points), rises_(max_points) {}

  /// Points from the rim to the end, one step apart except for the first and the last.
  const std::vector<Point3<S>>& points() const { return points_; }
  LineEnd end() const { return end_; }
  /// Normal at the end: of the object at an edge, of the membrane at a summit.
  const Point3<S>& end_normal() const { return end_normal_; }
  /// Whether the membrane is level at the end, along the line.
  bool is_level() const {
    const S rise = end_rise();
    return end_ == LineEnd::summit || (end_ == LineEnd::edge && rise * rise < S(1) / S(100));
  }

  /// Follows `shape` from `rim` uphill, or straight toward `center` (in plan) if `Straight`, until
  /// it is level or well within the contact.
  template <bool Straight, class Shape>
  void trace(const Shape& shape,
             const Point3<S>& rim,
             const Point3<S>& center,
             const LineSteps<S>& steps) {
    using std::sqrt;
    begin(rim, center);
    Point3<S> at = rim;
    if (!leave_rim(shape, at, steps)) {
      return;
    }
    while (points_.size() < most_) {
      const auto here = shape(at.x, at.y);
      if (!is_finite(here.height_mm)) {
        break;
      }
      at.z = here.height_mm;
      if (!Straight && touched_ == 0) {
        turn(here.along_x, here.along_y);
      }
      const S rise = here.along_x * dir_x_ + here.along_y * dir_y_;
      add(at, is_finite(rise) ? rise : S(0));
      if (touched_ == 0 && shape.in_contact(at.x, at.y)) {
        touched_ = points_.size() - 1;
      }
      if (is_over(at, center, steps)) {
        end_at(here);
        return;
      }
      const S plan = steps.arc_mm / S(sqrt(S(S(1) + rises_.back() * rises_.back())));
      at.x = at.x + plan * dir_x_;
      at.y = at.y + plan * dir_y_;
    }
  }

  /// Sums over the free membrane beside the contact, to locate its edge.
  LevelSums<S> level_sums(const Point3<S>& center, const LineSteps<S>& steps) const {
    using std::sqrt;
    LevelSums<S> sums;
    sums.edge_sq = radius_sq(points_[touched_], center);
    const S object = S(sqrt(sums.edge_sq)) * sine(end_rise());
    for (std::size_t k = 1; k < touched_; ++k) {
      const S beside = distance(points_[k], points_[touched_]);
      if (!(beside < steps.blur_mm) && !(beside > steps.blur_mm + steps.reach_mm)) {
        const S r_sq = radius_sq(points_[k], center);
        const S leaning = S(sqrt(r_sq)) * sine(rises_[k]) - object;
        sums.add(r_sq, leaning, beside);
      }
    }
    return sums;
  }

  /// Cuts the line at its end: at the edge, where r^2 = `edge_sq` (if that is finite and near the
  /// visible edge), or at the summit.
  void finish(const S& edge_sq, const Point3<S>& center, const LineSteps<S>& steps) {
    using std::sqrt;
    if (end_ == LineEnd::summit) {
      cut_at_summit();
    } else if (end_ == LineEnd::edge) {
      const S seen = sqrt(radius_sq(points_[touched_], center));
      const S found = is_finite(edge_sq) && value(edge_sq) > 0 ? S(sqrt(edge_sq)) : seen;
      const S most = steps.blur_mm + S(1);
      const bool near = !(found < seen - most) && !(found > seen + most);
      const S radius = near ? found : seen;
      cut_at(S(radius * radius), center);
    }
  }

 private:
  void begin(const Point3<S>& rim, const Point3<S>& center) {
    points_.clear();
    rises_.clear();
    touched_ = 0;
    end_ = LineEnd::hole;
    add(rim, S(0));
    dir_x_ = dir_y_ = S(0);
    turn(S(center.x - rim.x), S(center.y - rim.y));
  }

  void add(const Point3<S>& p, const S& rise) {
    points_.push_back(p);
    rises_.push_back(rise);
  }

  /// Sets the direction to (x, y), unless it is 0 or not finite.
  void turn(const S& x, const S& y) {
    using std::sqrt;
    const S length_sq = x * x + y * y;
    if (is_finite(length_sq) && length_sq > S(1e-12)) {
      const S length = sqrt(length_sq);
      dir_x_ = x / length;
      dir_y_ = y / length;
    }
  }

  /// Moves from the rim to the first position with a slope: a map has none at its border.
  template <class Shape>
  bool leave_rim(const Shape& shape, Point3<S>& at, const LineSteps<S>& steps) const {
    const S step = steps.arc_mm / S(4);
    for (int k = 0; k < 40; ++k) {
      at.x = at.x + step * dir_x_;
      at.y = at.y + step * dir_y_;
      if (is_finite(shape(at.x, at.y).along_x)) {
        return true;
      }
    }
    return false;
  }

  bool is_over(const Point3<S>& at, const Point3<S>& center, const LineSteps<S>& steps) const {
    const bool past = (center.x - at.x) * dir_x_ + (center.y - at.y) * dir_y_ < S(0);
    if (touched_ == 0) {
      return past || value(rises_.back()) < 0;
    }
    return past || distance(at, points_[touched_]) > steps.blur_mm + S(1);
  }

  /// Inclination of the object along the line.
  S end_rise() const {
    return S(-(end_normal_.x * dir_x_ + end_normal_.y * dir_y_) / end_normal_.z);
  }

  template <class Slope>
  void end_at(const Slope& here) {
    end_ = touched_ == 0 ? LineEnd::summit : LineEnd::edge;
    S x = here.along_x;
    S y = here.along_y;
    if (end_ == LineEnd::summit) {  // the last step went beyond the summit
      const S rise = x * dir_x_ + y * dir_y_;
      x = x - rise * dir_x_;
      y = y - rise * dir_y_;
    }
    const bool known = is_finite(x) && is_finite(y);
    end_normal_ = known ? normalized(Point3<S>{S(-x), S(-y), S(1)}) : Point3<S>{S(0), S(0), S(1)};
  }

  static S distance(const Point3<S>& a, const Point3<S>& b) {
    using std::sqrt;
    return S(sqrt(S(square(S(a.x - b.x)) + square(S(a.y - b.y)))));
  }
  static S radius_sq(const Point3<S>& p, const Point3<S>& center) {
    return S(square(S(p.x - center.x)) + square(S(p.y - center.y)));
  }
  static S sine(const S& rise) {
    using std::sqrt;
    return S(rise / S(sqrt(S(S(1) + rise * rise))));
  }

  /// Cuts where the inclination is 0, between the last two points.
  void cut_at_summit() {
    const std::size_t k = points_.size() - 1;
    const S share = rises_[k - 1] / S(rises_[k - 1] - rises_[k]);
    shorten(k, k > 1 ? share : S(1));
  }

  void cut_at(const S& found_sq, const Point3<S>& center) {
    std::size_t k = 1;
    while (k + 1 < points_.size() && radius_sq(points_[k], center) > found_sq) {
      ++k;
    }
    const S outer = radius_sq(points_[k - 1], center);
    const S inner = radius_sq(points_[k], center);
    shorten(k, S((outer - found_sq) / (outer - inner)));
  }

  /// Makes a point between points k - 1 and k the last one.
  void shorten(std::size_t k, S share) {
    share = is_finite(share) ? share : S(1);
    share = share < S(0) ? S(0) : (share > S(1) ? S(1) : share);
    points_[k] = points_[k - 1] + share * (points_[k] - points_[k - 1]);
    points_.resize(k + 1);
  }

  std::size_t most_;
  std::size_t touched_ = 0;  // the first point in contact; 0: none
  LineEnd end_ = LineEnd::hole;
  Point3<S> end_normal_ = {S(0), S(0), S(1)};
  S dir_x_ = S(0);
  S dir_y_ = S(0);
  ReservedVector<Point3<S>> points_;
  ReservedVector<S> rises_;
};

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
