// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The weighted least-squares rigid motion of dots in the plane: it maps centroid to centroid, and
// rotates by atan2(sum of cross products, sum of dot products) about it.
#include <cmath>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// A dot in the reference and in the frame, and its weight.
template <scalar S>
struct DotPair {
  Point2<S> from;
  Point2<S> to;
  S weight;
};

template <scalar S>
class RigidShift {
 public:
  /// Needs at least one pair with a weight > 0.
  explicit RigidShift(const std::vector<DotPair<S>>& pairs) {
    for (const DotPair<S>& p : pairs) {
      weight_ = weight_ + p.weight;
    }
    // The second pass removes the roundoff of summing positions far from the origin. It also makes
    // the centroid of coinciding dots exact.
    move_middles(pairs);
    move_middles(pairs);
    turn(pairs);
  }

  const S& weight() const { return weight_; }
  const Point2<S>& from() const { return from_; }
  /// False if the dots do not determine an angle: a single dot, or all in one place.
  bool turns() const { return turns_; }
  S angle_rad() const {
    using std::atan2;
    return turns_ ? S(atan2(cross_, dot_)) : not_a_number<S>();
  }

  /// Displacement of a position by the motion.
  Point2<S> carried(const Point2<S>& place) const {
    const Point2<S> arm = {S(place.x - from_.x), S(place.y - from_.y)};
    const Point2<S> end = rotated(arm);
    return {S(S(to_.x - from_.x) + S(end.x - arm.x)), S(S(to_.y - from_.y) + S(end.y - arm.y))};
  }

  /// Squared distance of a dot from its mapped position.
  S residual_sq(const DotPair<S>& p) const {
    const Point2<S> end = rotated({S(p.from.x - from_.x), S(p.from.y - from_.y)});
    return S(square(S(S(p.to.x - to_.x) - end.x)) + square(S(S(p.to.y - to_.y) - end.y)));
  }

 private:
  Point2<S> rotated(const Point2<S>& v) const {
    return {S(S(cosine_ * v.x) - S(sine_ * v.y)), S(S(sine_ * v.x) + S(cosine_ * v.y))};
  }

  void move_middles(const std::vector<DotPair<S>>& pairs) {
    Point2<S> from = {S(0), S(0)}, to = {S(0), S(0)};
    for (const DotPair<S>& p : pairs) {
      from = {S(from.x + S(p.weight * S(p.from.x - from_.x))),
              S(from.y + S(p.weight * S(p.from.y - from_.y)))};
      to = {S(to.x + S(p.weight * S(p.to.x - to_.x))), S(to.y + S(p.weight * S(p.to.y - to_.y)))};
    }
    from_ = {S(from_.x + S(from.x / weight_)), S(from_.y + S(from.y / weight_))};
    to_ = {S(to_.x + S(to.x / weight_)), S(to_.y + S(to.y / weight_))};
  }

  void turn(const std::vector<DotPair<S>>& pairs) {
    using std::sqrt;
    for (const DotPair<S>& p : pairs) {
      const S ax = p.from.x - from_.x, ay = p.from.y - from_.y;
      const S bx = p.to.x - to_.x, by = p.to.y - to_.y;
      cross_ = cross_ + S(p.weight * S(S(ax * by) - S(ay * bx)));
      dot_ = dot_ + S(p.weight * S(S(ax * bx) + S(ay * by)));
    }
    const S size_sq = square(cross_) + square(dot_);
    turns_ = value(size_sq) > 0;
    if (turns_) {
      const S size = sqrt(size_sq);
      cosine_ = dot_ / size;
      sine_ = cross_ / size;
    }
  }

  S weight_ = S(0);
  Point2<S> from_ = {S(0), S(0)};  ///< centroid in the reference
  Point2<S> to_ = {S(0), S(0)};    ///< centroid in the frame
  S cross_ = S(0);
  S dot_ = S(0);
  S cosine_ = S(1);
  S sine_ = S(0);
  bool turns_ = false;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
