// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// One line B(i) up the membrane, from a point of the rim to the line A_g above which the membrane
// no longer carries the load by tension alone: its summit, where it is level, or the edge of the
// contact. Source: Ito, Kim, Obinata 2011, III.C.
//
// A smoothed depth map does not show the edge of a contact, but what lies a little beside it. At a
// distance r from the middle of a level contact of radius r_g the vertical balance of what lies
// between is
//   p (r^2 - r_g^2) / 2 = T r sin(inclination),
// and the tension T grows slowly outward, as 1 + g (r - r_g). So r_g^2 is what a straight line
// through (r (1 + g (r - r_g)) sin(inclination), r^2) says of inclination 0, and g the curvature of
// the same points, which all lines of a frame share.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fingerpad/core/detail/reserved_vector.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/height_map.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"
#include "fingerpad/math/detail/zeros.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::membrane {

/// How a line ended.
enum class LineEnd : std::uint8_t {
  edge,    ///< at the edge of the contact
  summit,  ///< where the membrane is level without touching
  hole,    ///< where there is no height
};

template <scalar S>
struct LineSteps {
  S arc_mm;    ///< length of a step along the membrane
  S blur_mm;   ///< what lies nearer to the edge is not looked at: half the width of smoothing
  S reach_mm;  ///< how far beyond that inclinations are looked at
};

/// Sums for the least squares of r^2 - r_edge^2 = r_g^2 - r_edge^2 + level x + growth x (r -
/// r_edge), x = r sin(inclination), r_edge where the contact is seen to begin.
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

  /// Adds what the points say of g: its numerator and its denominator.
  void add_growth(S& growth, S& level) const {
    const NormalEquations<S, 3> equations(normal, 1e-10);
    if (count >= 6 && equations.good) {
      const std::array<S, 3> found = equations.solve(right);
      growth = growth + found[2];
      level = level + found[1];
    }
  }

  /// r_g^2 for a given g; NaN where the points do not tell.
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

/// The points of a line; memory is taken once.
template <scalar S>
class Meridian {
 public:
  explicit Meridian(std::size_t max_points)
      : most_(max_points), points_(max_points), rises_(max_points) {}

  /// From the rim to the end, one step apart but for the first and the last.
  const std::vector<Point3<S>>& points() const { return points_; }
  LineEnd end() const { return end_; }
  /// Normal of what the membrane lies against at the end: of the object, or of its own summit.
  const Point3<S>& end_normal() const { return end_normal_; }
  /// Whether it is level there, along the line.
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

  /// What the free membrane beside the contact says of the place of its edge.
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

  /// Ends the line: at the edge, where r^2 = `edge_sq` (if that is a number and near), or at the
  /// summit.
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

  /// Goes on along (x, y), if that is a direction.
  void turn(const S& x, const S& y) {
    using std::sqrt;
    const S length_sq = x * x + y * y;
    if (is_finite(length_sq) && length_sq > S(1e-12)) {
      const S length = sqrt(length_sq);
      dir_x_ = x / length;
      dir_y_ = y / length;
    }
  }

  /// To the first slope beside the rim: a map has none at its border.
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
    if (end_ == LineEnd::summit) {  // it has been passed by a part of a step
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

  /// Between the last two points the inclination goes through 0.
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

  /// The last point lies between those numbered k - 1 and k.
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
