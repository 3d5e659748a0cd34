// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Compensation of perspective: by how much the contact region is seen larger or smaller than in the
// reference, as the normal force presses it toward the camera or lets it go. Source: slides
// "Calculation of scale parameter alpha", "Elimination of parallel component" of 003.
#include <array>
#include <cmath>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/image/detail/quick_math.hpp"
#include "fingerpad/slip/detail/dot_planes.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail::stick {

// How the object has moved in the image between two frames: the map that takes its dots of now back
// to where they were, by a shift, a turn and a scale. What it leaves of a dot's displacement is
// slip.

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
  rigid,        ///< it is rotated about the line of sight
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

/// alpha from the distances between neighbouring dots across the direction in which they move, sums
/// of absolute values: as published. Where nothing moves there is no direction and alpha is 1
/// (E036). Noise makes the larger sum of the two no larger than the other, but both larger.
struct PublishedScale {};

/// The same by least squares, and the part along the motion is taken out the less, the less there
/// is of motion: as much as 1 - (fading / motion)^2 of it where dots move by much more than
/// `fading_px`, none where they stand still, so that a plain press has its alpha too.
struct LeastSquaresScale {
  double fading_px = 0.25;  ///< > 0
};
inline void expects_valid(const PublishedScale&) {}
inline void expects_valid(const LeastSquaresScale& scale) {
  expects(is_finite(scale.fading_px) && scale.fading_px > 0, "LeastSquaresScale", "fading_px",
          scale.fading_px, "finite and > 0");
}

namespace detail::stick {

/// Two frames to compare.
template <class S>
struct FramePair {
  PlanesView<S> now, then;
  Run run;
  DotLayout layout;
  S furthest_sq;  ///< d_max^2
};

/// Sums over pairs of neighbours: of what the distance was, and of what it is.
template <class V>
struct ScaleSums {
  V then{}, now{};
};

/// Two neighbours: the vector between them then, and now with the object rotated back; and the sum
/// of their displacements.
template <class V>
struct NeighbourPair {
  V then_x, then_y;
  V now_x, now_y;
  V motion_x, motion_y;
};

template <class S, class V>
void add_pair(const PublishedScale&, const NeighbourPair<V>& p, ScaleSums<V>& sums) {
  const V zero{};
  const V motion_sq = p.motion_x * p.motion_x + p.motion_y * p.motion_y;
  const V then = p.then_x * p.motion_y - p.then_y * p.motion_x;
  const V now = p.now_x * p.motion_y - p.now_y * p.motion_x;
  const V then_size = choose(then < zero, V(zero - then), then);
  const V now_size = choose(now < zero, V(zero - now), now);
  // 1e-12: what moves less has no direction
  const V per_motion = only_where(S(1e-12) < motion_sq, V(inverse_sqrt(motion_sq)));
  const auto known = motion_sq < no_distance_sq<S>();
  sums.then += only_where(known, V(then_size * per_motion));
  sums.now += only_where(known, V(now_size * per_motion));
}
template <class S, class V>
void add_pair(const LeastSquaresScale& scale, const NeighbourPair<V>& p, ScaleSums<V>& sums) {
  const V motion_sq = p.motion_x * p.motion_x + p.motion_y * p.motion_y;
  const V weight = S(1) / (motion_sq + S(scale.fading_px * scale.fading_px));
  const V then_along = p.then_x * p.motion_x + p.then_y * p.motion_y;
  const V now_along = p.now_x * p.motion_x + p.now_y * p.motion_y;
  const V both = p.then_x * p.now_x + p.then_y * p.now_y - weight * then_along * now_along;
  const V now = p.now_x * p.now_x + p.now_y * p.now_y - weight * now_along * now_along;
  const auto known = motion_sq < no_distance_sq<S>();
  sums.then += only_where(known, both);
  sums.now += only_where(known, now);
}

/// alpha of the frames, `rotated` being the object's motion without it; 1 where the pairs determine
/// none or one that is not plausible.
template <class Scale, class S>
S scale_between(const Scale& scale, const FramePair<S>& pair, const ObjectShift<S>& rotated) {
  using V = run_vector<S>;
  const Index stride = pair.layout.stride();
  const S object_x = rotated.now_x - rotated.then_x, object_y = rotated.now_y - rotated.then_y;
  ScaleSums<V> sums;
  struct Dot {
    V tx, ty, nx, ny, dx, dy;  // then, now rotated back, displacement
  };
  const auto dot = [&](Index k) {
    const V nx = load_cells<V, S>(pair.now.x + k), ny = load_cells<V, S>(pair.now.y + k);
    Dot d;
    d.tx = load_cells<V, S>(pair.then.x + k);
    d.ty = load_cells<V, S>(pair.then.y + k);
    rotated.residual(nx, ny, d.tx, d.ty, d.dx, d.dy);
    d.nx = d.dx + d.tx;
    d.ny = d.dy + d.ty;
    d.dx += object_x;
    d.dy += object_y;
    return d;
  };
  for (Index k = pair.run.begin; k < pair.run.end; k += run_step<S>) {
    const Dot a = dot(k);
    for (const Index step : {Index(1), stride - 1, stride, stride + 1}) {
      const Dot b = dot(k + step);
      add_pair<S, V>(scale,
                     {a.tx - b.tx, a.ty - b.ty, a.nx - b.nx, a.ny - b.ny, a.dx + b.dx, a.dy + b.dy},
                     sums);
    }
  }
  const S alpha = sum_of_lanes<S>(sums.then) / sum_of_lanes<S>(sums.now);
  return is_plausible_scale(alpha) ? alpha : S(1);
}

}  // namespace detail::stick

}  // namespace v0
}  // namespace fingerpad
