// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The map between two frames of an object in the image: a shift, a rotation and a scale.
#include <cmath>

#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// The motion of the object in the image. It maps the present positions of its dots back to the
/// earlier ones; the residual of a dot is its slip. Cosine and sine include the scale:
///   then = [cosine sine; -sine cosine] (now - now_at) + then_at
template <class S>
struct Similarity {
  S cosine = S(1);
  S sine = S(0);
  Point2<S> now_at = {S(0), S(0)};
  Point2<S> then_at = {S(0), S(0)};

  /// Displacement from `then` to `now` beyond the object's motion, in the orientation of then.
  Point2<S> residual(const Point2<S>& now, const Point2<S>& then) const {
    const Point2<S> arm = now - now_at;
    const Point2<S> back = {S(cosine * arm.x + sine * arm.y), S(cosine * arm.y - sine * arm.x)};
    return back - (then - then_at);
  }
  /// The rotation of the object from then to now, positive from x to y.
  S angle_rad() const {
    using std::atan2;
    return S(atan2(sine, cosine));
  }
  /// alpha, the factor from the present size to the earlier one.
  S scale() const {
    using std::sqrt;
    const S sq = cosine * cosine + sine * sine;
    return S(sqrt(sq));
  }
};

/// Sums over pairs of present and earlier positions of dots, each relative to its own origin.
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

/// Whether a scale is possible for a membrane between two frames: 0.8 to 1.25.
template <class S>
constexpr bool is_plausible_scale(const S& scale) {
  return S(0.8) < scale && scale < S(1.25);
}

/// The least-squares map of the pairs. `about` gives the origins of the sums. It also gives
/// rotation and scale if the pairs do not determine them, as a single dot does not.
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
