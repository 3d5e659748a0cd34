// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Policies: how the object's motion between the reference and now is found, from which the dots'
// own motion differs by their slip. Source: "Cancel of rotation", "Compensation of perspective
// transformation", "Reference dot" of 003.
#include <array>
#include <cmath>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/slip/object_shift.hpp"

namespace fingerpad {
inline namespace v0 {

using detail::stick::Freedom;

/// Which dot the object is taken to move with, or where the search for sticking dots begins.
struct TrackedDot {};  ///< the sticking dot nearest to the centroid of the last stick region
struct CentralDot {};  ///< the dot nearest to the centroid of the contact

/// Published: the object moves as the reference dot does, rotates as its four neighbours do about
/// it, and scales as all neighbours in contact do. The noise of those dots is in every dot's
/// answer.
template <Freedom Free = Freedom::similarity,
          class Scale = LeastSquaresScale,
          class Dot = TrackedDot>
struct ReferenceDotMotion {
  Scale scale = {};
};

/// The map that fits all sticking dots best. Beginning with the reference dot and its 24 nearest,
/// dots that follow the map are taken, and the map fitted to them, until they hardly become more.
/// Where a dot has outrun the map, which none can that the object drags, the search begins anew
/// from the one that has come furthest: the first has found dots that stand still together.
template <Freedom Free = Freedom::similarity, class Dot = TrackedDot>
struct StickConsensus {
  int max_passes = 10;  ///< 0 to 100; two or three are the rule
};

template <Freedom Free, class Scale, class Dot>
void expects_valid(const ReferenceDotMotion<Free, Scale, Dot>& motion) {
  expects_valid(motion.scale);
}
template <Freedom Free, class Dot>
void expects_valid(const StickConsensus<Free, Dot>& motion) {
  expects(motion.max_passes >= 0 && motion.max_passes <= 100, "StickConsensus", "max_passes",
          static_cast<long long>(motion.max_passes), "in [0, 100]");
}

namespace detail::stick {

template <Freedom Free, class Scale, class Dot>
Dot dot_of(const ReferenceDotMotion<Free, Scale, Dot>&) {
  return {};
}
template <Freedom Free, class Dot>
Dot dot_of(const StickConsensus<Free, Dot>&) {
  return {};
}

/// Origins at one dot; no turn, no scale.
template <class S>
ObjectShift<S> shift_of_dot(const FramePair<S>& pair, Index cell) {
  ObjectShift<S> shift;
  shift.now_x = pair.now.x[cell];
  shift.now_y = pair.now.y[cell];
  shift.then_x = pair.then.x[cell];
  shift.then_y = pair.then.y[cell];
  return shift;
}

/// Adds the pair at one cell, as seen from the origins of `about`, if both frames have it.
template <class S>
void add_dot(const FramePair<S>& pair,
             Index k,
             const S& weight,
             const ObjectShift<S>& about,
             PairSums<S>& sums) {
  const S nx = pair.now.x[k] - about.now_x, ny = pair.now.y[k] - about.now_y;
  const S tx = pair.then.x[k] - about.then_x, ty = pair.then.y[k] - about.then_y;
  const S sum_sq = nx * nx + ny * ny + tx * tx + ty * ty;
  if (sum_sq < no_distance_sq<S>()) {
    sums.add_weighted(weight, nx, ny, tx, ty);
  }
}

template <Freedom Free, class Scale, class Dot, class S>
ObjectShift<S> motion_between(const ReferenceDotMotion<Free, Scale, Dot>& policy,
                              const FramePair<S>& pair,
                              Index reference,
                              const S&) {
  using std::sqrt;
  ObjectShift<S> shift = shift_of_dot(pair, reference);
  if constexpr (may_turn(Free)) {
    PairSums<S> sums;
    const Index stride = pair.layout.stride();
    for (const Index step : {Index(-1), Index(1), -stride, stride}) {
      add_dot(pair, reference + step, S(1), shift, sums);
    }
    // about the dot itself, not the centroid of its neighbours: theta_0 as the angle of summed
    // products, which is the mean of four small angles and does not wrap (E034)
    const S size_sq = sums.along * sums.along + sums.across * sums.across;
    if (S(0) < size_sq) {
      const S size = sqrt(size_sq);
      shift.cosine = sums.along / size;
      shift.sine = sums.across / size;
    }
  }
  if constexpr (may_scale(Free)) {
    const S alpha = scale_between(policy.scale, pair, shift);
    shift.cosine = alpha * shift.cosine;
    shift.sine = alpha * shift.sine;
  }
  return shift;
}

/// The dots around the reference dot, with binomial weights.
template <class S>
PairSums<S> sums_around(const FramePair<S>& pair, Index reference, const ObjectShift<S>& about) {
  constexpr std::array<int, 5> binomial = {1, 4, 6, 4, 1};
  PairSums<S> sums;
  const DotIndex center = pair.layout.dot_at(reference);
  for (Index i = -2; i <= 2; ++i) {
    for (Index j = -2; j <= 2; ++j) {
      const bool inside = center.row + i >= 0 && center.row + i < pair.layout.rows &&
                          center.col + j >= 0 && center.col + j < pair.layout.cols;
      if (inside) {
        const int weight =
            binomial[static_cast<std::size_t>(i + 2)] * binomial[static_cast<std::size_t>(j + 2)];
        add_dot(pair, pair.layout.at(center.row + i, center.col + j), S(weight), about, sums);
      }
    }
  }
  return sums;
}

/// The dots that follow `shift` to within the square root of `slip_sq`, as seen from the origins of
/// `about`.
template <class S>
PairSums<S> sums_of_followers(const FramePair<S>& pair,
                              const ObjectShift<S>& shift,
                              const S& slip_sq,
                              const ObjectShift<S>& about) {
  using V = run_vector<S>;
  const S cosine = shift.cosine, sine = shift.sine;
  S from_x, from_y;  // residual of the origins
  shift.residual(about.now_x, about.now_y, about.then_x, about.then_y, from_x, from_y);
  PairSums<V> sums;
  const V one = V{} + S(1);
  for (Index k = pair.run.begin; k < pair.run.end; k += run_step<S>) {
    const V nx = load_cells<V, S>(pair.now.x + k) - about.now_x;
    const V ny = load_cells<V, S>(pair.now.y + k) - about.now_y;
    const V tx = load_cells<V, S>(pair.then.x + k) - about.then_x;
    const V ty = load_cells<V, S>(pair.then.y + k) - about.then_y;
    const V rx = cosine * nx + sine * ny - tx + from_x;
    const V ry = cosine * ny - sine * nx - ty + from_y;
    const auto follows = V(rx * rx + ry * ry) < slip_sq;
    sums.add(only_where(follows, one), only_where(follows, nx), only_where(follows, ny),
             only_where(follows, tx), only_where(follows, ty));
  }
  PairSums<S> total;
  total.weight = sum_of_lanes<S>(sums.weight);
  total.now_x = sum_of_lanes<S>(sums.now_x);
  total.now_y = sum_of_lanes<S>(sums.now_y);
  total.then_x = sum_of_lanes<S>(sums.then_x);
  total.then_y = sum_of_lanes<S>(sums.then_y);
  total.now_sq = sum_of_lanes<S>(sums.now_sq);
  total.along = sum_of_lanes<S>(sums.along);
  total.across = sum_of_lanes<S>(sums.across);
  return total;
}

/// The map on which the dots around one agree with those that follow it.
template <Freedom Free, class S>
ObjectShift<S> consensus(const FramePair<S>& pair, Index from, const S& slip_sq, int max_passes) {
  constexpr int fewest = 3;  // dots that a map can be wrong about
  const S hardly_more = S(1.005);
  const ObjectShift<S> about = shift_of_dot(pair, from);
  ObjectShift<S> shift = fit<Free>(sums_around(pair, from, about), about);
  S before = S(0);
  for (int pass = 0; pass < max_passes; ++pass) {
    const PairSums<S> sums = sums_of_followers(pair, shift, slip_sq, about);
    if (sums.weight < S(fewest)) {
      break;
    }
    shift = fit<Free>(sums, about);
    if (!(hardly_more * before < sums.weight)) {
      break;
    }
    before = sums.weight;
  }
  return shift;
}

/// Whether the object, as seen from the origins of the map, has come less than half of d_max.
template <class S>
bool has_hardly_moved(const ObjectShift<S>& shift, const S& furthest_sq) {
  const S x = shift.now_x - shift.then_x, y = shift.now_y - shift.then_y;
  return S(4) * (x * x + y * y) < furthest_sq;
}

/// Of the dots that have come half of d_max at least, and that the map leaves with more than half
/// of it, in its direction, the one that has come furthest; -1 if there is none. A dot that the
/// scale alone has moved by a quarter of that says nothing.
template <class S>
Index furthest_outrunner(const FramePair<S>& pair, const ObjectShift<S>& shift) {
  const S growth = shift.scale() - S(1);
  Index furthest = -1;
  S min_sq = pair.furthest_sq / S(4);
  for (Index k = pair.run.begin; k < pair.run.end; ++k) {
    const S dx = pair.now.x[k] - pair.then.x[k], dy = pair.now.y[k] - pair.then.y[k];
    const S sq = dx * dx + dy * dy;
    if (min_sq < sq && sq < no_distance_sq<S>()) {
      S rx, ry;
      shift.residual(pair.now.x[k], pair.now.y[k], pair.then.x[k], pair.then.y[k], rx, ry);
      const S from_x = growth * (pair.now.x[k] - shift.now_x);
      const S from_y = growth * (pair.now.y[k] - shift.now_y);
      const bool by_growth = sq < S(16) * (from_x * from_x + from_y * from_y);
      const S ahead = rx * dx + ry * dy;
      if (!by_growth && sq < S(2) * ahead) {
        furthest = k;
        min_sq = sq;
      }
    }
  }
  return furthest;
}

template <Freedom Free, class Dot, class S>
ObjectShift<S> motion_between(const StickConsensus<Free, Dot>& policy,
                              const FramePair<S>& pair,
                              Index reference,
                              const S& slip_sq) {
  const ObjectShift<S> shift = consensus<Free>(pair, reference, slip_sq, policy.max_passes);
  if (!has_hardly_moved(shift, pair.furthest_sq)) {
    return shift;
  }
  const Index ahead = furthest_outrunner(pair, shift);
  if (ahead < 0) {
    return shift;
  }
  const ObjectShift<S> other = consensus<Free>(pair, ahead, slip_sq, policy.max_passes);
  return has_hardly_moved(other, pair.furthest_sq) ? shift : other;
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
