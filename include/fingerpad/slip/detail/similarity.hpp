// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The map between two frames of an object seen in the image: a shift, a rotation and a scale.
#include <cmath>

#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// The motion of the object in the image: it takes its dots of now back to where they were. What it
/// leaves of a dot's displacement is slip.
///   then = [cosine sine; -sine cosine] (now - now_at) + then_at; cosine and sine carry the scale.
template <class S>
struct Similarity {
  S cosine = S(1);
  S sine = S(0);
  Point2<S> now_at = {S(0), S(0)};
  Point2<S> then_at = {S(0), S(0)};

  /// What of the displacement from `then` to `now` is not the object's, seen in the frame of then.
  Point2<S> residual(const Point2<S>& now, const Point2<S>& then) const {
    const Point2<S> arm = now - now_at;
    const Point2<S> back = {S(cosine * arm.x + sine * arm.y), S(cosine * arm.y - sine * arm.x)};
    return back - (then - then_at);
  }
  /// The rotation of the object from then to now, x to y positive.
  S angle_rad() const {
    using std::atan2;
    return S(atan2(sine, cosine));
  }
  /// alpha, by which now is multiplied to be as large as then.
  S scale() const {
    using std::sqrt;
    const S sq = cosine * cosine + sine * sine;
    return S(sqrt(sq));
  }
};

/// Sums over pairs of a dot now and then, both as seen from origins of their own.
template <class S>
struct PairSums {
  S weight = S(0);
  Point2<S> now = {S(0), S(0)};
  Point2<S> then = {S(0), S(0)};
  S now_sq = S(0);
  S along = S(0);   ///< now . then
  S across = S(0);  ///< then x now

  void add(const S& w, const Point2<S>& n, const Point2<S>& t) {
    weight = weight + w;
    now += w * n;
    then += w * t;
    now_sq = now_sq + w * squared_norm(n);
    along = along + w * dot(n, t);
    across = across + w * S(t.x * n.y - t.y * n.x);
  }
};

/// A scale outside of 0.8 to 1.25 is none that a membrane can show between two frames.
template <class S>
constexpr bool is_plausible_scale(const S& scale) {
  return S(0.8) < scale && scale < S(1.25);
}

/// The map that fits the pairs best by least squares. `about` gives the origins of the sums, and
/// the rotation and the scale where the pairs determine none: where they are one dot, or opposed.
template <bool rotates, bool scales, class S>
Similarity<S> fit(const PairSums<S>& sums, const Similarity<S>& about) {
  using std::sqrt;
  Similarity<S> best = about;
  const Point2<S> now = sums.now / sums.weight, then = sums.then / sums.weight;
  best.now_at = about.now_at + now;
  best.then_at = about.then_at + then;
  if constexpr (!rotates && !scales) {
    return best;
  }
  const S spread = sums.now_sq - sums.weight * squared_norm(now);
  const S along = sums.along - sums.weight * dot(now, then);
  const S crossed = then.x * now.y - then.y * now.x;
  const S across = rotates ? S(sums.across - sums.weight * crossed) : S(0);
  const S size_sq = along * along + across * across;
  if (!(S(0) < spread) || !(S(0) < size_sq)) {
    return best;
  }
  const S size = sqrt(size_sq);
  const S ratio = size / spread;
  const S scale = scales && is_plausible_scale(ratio) ? ratio : S(1);
  best.cosine = scale * along / size;
  best.sine = scale * across / size;
  return best;
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
