// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How the object has moved in the image between two frames: the map that takes its dots of now back
// to where they were, by a shift, a turn and a scale. What it leaves of a dot's displacement is
// slip.
#include <cmath>

#include "fingerpad/slip/detail/dot_planes.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::stick {

/// then = [cosine sine; -sine cosine] (now - now_at) + then_at; cosine and sine carry the scale.
template <class S>
struct ObjectShift {
  S cosine = S(1);
  S sine = S(0);
  S now_x = S(0), now_y = S(0);
  S then_x = S(0), then_y = S(0);

  /// What of the displacement from `then` to `now` is not the object's, seen in the frame of then.
  template <class V>
  [[gnu::always_inline]] inline void residual(
      const V& nx, const V& ny, const V& tx, const V& ty, V& rx, V& ry) const {
    const V x = nx - now_x, y = ny - now_y;
    rx = cosine * x + sine * y - (tx - then_x);
    ry = cosine * y - sine * x - (ty - then_y);
  }

  /// The turn of the object from then to now, x to y positive.
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
template <class V>
struct PairSums {
  V weight{}, now_x{}, now_y{}, then_x{}, then_y{};
  V now_sq{};  ///< now . now
  V along{};   ///< now . then
  V across{};  ///< then x now

  [[gnu::always_inline]] inline void add(
      const V& one, const V& nx, const V& ny, const V& tx, const V& ty) {
    weight += one;
    now_x += nx;
    now_y += ny;
    then_x += tx;
    then_y += ty;
    now_sq += nx * nx + ny * ny;
    along += nx * tx + ny * ty;
    across += tx * ny - ty * nx;
  }
  void add_weighted(const V& w, const V& nx, const V& ny, const V& tx, const V& ty) {
    const V wx = w * nx, wy = w * ny;
    weight += w;
    now_x += wx;
    now_y += wy;
    then_x += w * tx;
    then_y += w * ty;
    now_sq += wx * nx + wy * ny;
    along += wx * tx + wy * ty;
    across += wy * tx - wx * ty;
  }
};

/// What may differ between two frames of one object, besides where it is.
enum class Freedom {
  translation,  ///< nothing: it is shifted
  rigid,        ///< it is turned about the line of sight
  scaling,      ///< it is seen larger or smaller, as the normal force changes
  similarity,   ///< both
};
constexpr bool may_turn(Freedom f) {
  return f == Freedom::rigid || f == Freedom::similarity;
}
constexpr bool may_scale(Freedom f) {
  return f == Freedom::scaling || f == Freedom::similarity;
}

/// A scale outside of 0.8 to 1.25 is none that a membrane can show between two frames.
template <class S>
constexpr bool is_plausible_scale(const S& scale) {
  return S(0.8) < scale && scale < S(1.25);
}

/// The map that fits the pairs best by least squares. `about` gives the origins of the sums, and
/// the turn and the scale where the pairs determine none: where they are one dot, or opposed.
template <Freedom Free, class S>
ObjectShift<S> fit(const PairSums<S>& sums, const ObjectShift<S>& about) {
  using std::sqrt;
  ObjectShift<S> best = about;
  const S nx = sums.now_x / sums.weight, ny = sums.now_y / sums.weight;
  const S tx = sums.then_x / sums.weight, ty = sums.then_y / sums.weight;
  best.now_x = about.now_x + nx;
  best.now_y = about.now_y + ny;
  best.then_x = about.then_x + tx;
  best.then_y = about.then_y + ty;
  if constexpr (Free == Freedom::translation) {
    return best;
  }
  const S spread = sums.now_sq - sums.weight * (nx * nx + ny * ny);
  const S along = sums.along - sums.weight * (nx * tx + ny * ty);
  const S across = may_turn(Free) ? S(sums.across - sums.weight * (tx * ny - ty * nx)) : S(0);
  const S size_sq = along * along + across * across;
  if (!(S(0) < spread) || !(S(0) < size_sq)) {
    return best;
  }
  const S size = sqrt(size_sq);
  const S ratio = size / spread;
  const bool scales = may_scale(Free) && is_plausible_scale(ratio);
  const S scale = scales ? ratio : S(1);
  best.cosine = scale * along / size;
  best.sine = scale * across / size;
  return best;
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
