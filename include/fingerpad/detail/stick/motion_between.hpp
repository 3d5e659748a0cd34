// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Policies: how the object's motion between the reference and now is found, from which the dots'
// own motion differs by their slip. Source: "Cancel of rotation", "Compensation of perspective
// transformation", "Reference dot" of 003.
#include <array>
#include <cmath>

#include "fingerpad/detail/stick/zoom.hpp"
#include "fingerpad/expects.hpp"

namespace fingerpad {
inline namespace v0 {

using detail::stick::Freedom;

/// Which dot the object is taken to move with, or where the search for sticking dots begins.
struct TrackedDot {};  ///< the sticking dot nearest to the centroid of the last stick region
struct CentralDot {};  ///< the dot nearest to the centroid of the contact

/// Published: the object moves as the reference dot does, turns as its four neighbours do about it,
/// and zooms as all neighbours in contact do. The noise of those dots is in every dot's answer.
template <Freedom Free = Freedom::similarity, class Zoom = LeastSquaresZoom, class Dot = TrackedDot>
struct ReferenceDotMotion {
  Zoom zoom = {};
};

/// The map that fits all sticking dots best. Beginning with the reference dot and its 24 nearest,
/// dots that follow the map are taken, and the map fitted to them, `passes` times.
template <Freedom Free = Freedom::similarity, class Dot = TrackedDot>
struct StickConsensus {
  int passes = 2;  ///< 0 to 10
};

template <Freedom Free, class Zoom, class Dot>
void expects_valid(const ReferenceDotMotion<Free, Zoom, Dot>& motion) {
  expects_valid(motion.zoom);
}
template <Freedom Free, class Dot>
void expects_valid(const StickConsensus<Free, Dot>& motion) {
  expects(motion.passes >= 0 && motion.passes <= 10, "StickConsensus", "passes",
          static_cast<long long>(motion.passes), "in [0, 10]");
}

namespace detail::stick {

template <Freedom Free, class Zoom, class Dot>
Dot dot_of(const ReferenceDotMotion<Free, Zoom, Dot>&) {
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

template <Freedom Free, class Zoom, class Dot, class S>
ObjectShift<S> motion_between(const ReferenceDotMotion<Free, Zoom, Dot>& policy,
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
    const S alpha = scale_between(policy.zoom, pair, shift);
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

template <Freedom Free, class Dot, class S>
ObjectShift<S> motion_between(const StickConsensus<Free, Dot>& policy,
                              const FramePair<S>& pair,
                              Index reference,
                              const S& slip_sq) {
  constexpr int fewest = 3;  // dots that a map can be wrong about
  const ObjectShift<S> about = shift_of_dot(pair, reference);
  ObjectShift<S> shift = fit<Free>(sums_around(pair, reference, about), about);
  for (int pass = 0; pass < policy.passes; ++pass) {
    const PairSums<S> sums = sums_of_followers(pair, shift, slip_sq, about);
    if (value(sums.weight) < fewest) {
      break;
    }
    shift = fit<Free>(sums, about);
  }
  return shift;
}

}  // namespace detail::stick
}  // namespace v0
}  // namespace fingerpad
