// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The contact reference dot, followed with its neighbours from frame to frame.
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "fingerpad/published/detail/neighbourhood.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::motion {

/// A dot with its neighbours in an earlier frame, its anchor frame.
template <scalar S>
struct FollowedDot {
  DotIndex index = {};
  Neighbourhood<S> anchor = {};
  std::array<bool, 9> touching = {};  ///< the dots of the anchor that were in contact
  bool has_left = false;              ///< when last found, the dot was out of contact
};

/// How a followed dot has moved since its anchor.
template <scalar S>
struct DotStep {
  MotionStatus status = MotionStatus::too_few_dots;
  Pose<S> pose = {};
  Neighbourhood<S> now = {};
  Index dots_used = 0;
  S residual_rms_mm = S(0);
};

template <class Local, scalar S>
DotStep<S> step_between(const Neighbourhood<S>& anchor, const Neighbourhood<S>& now) {
  using std::sqrt;
  DotStep<S> step;
  const LocalRotation<S> turn = Local::turn(anchor, now);
  step.status = turn.status;
  step.now = now;
  if (turn.status != MotionStatus::ok) {
    return step;
  }
  const CommonDots common = common_dots(anchor, now);
  const Point3<S> before = center(anchor, common);
  const Point3<S> after = center(now, common);
  step.pose = {turn.rotation, after - turn.rotation(before)};
  step.dots_used = common.count;
  S sum_sq = S(0);
  for (std::size_t k = 0; k < 9; ++k) {
    if (common.found[k]) {
      sum_sq = sum_sq + squared_norm(now.dot[k] - step.pose(anchor.dot[k]));
    }
  }
  sum_sq = sum_sq / S(static_cast<double>(common.count));
  step.residual_rms_mm = value(sum_sq) > 0 ? S(sqrt(sum_sq)) : S(0);
  return step;
}

template <class Frame>
std::array<bool, 9> touching(const Frame& frame, DotIndex d) {
  std::array<bool, 9> flags = {};
  for (std::size_t k = 0; k < 9; ++k) {
    const Index i = d.row - 1 + static_cast<Index>(k / 3);
    const Index j = d.col - 1 + static_cast<Index>(k % 3);
    const bool inside = i >= 0 && j >= 0 && i < frame.rows() && j < frame.cols();
    flags[k] = inside && frame.flagged(i, j);
  }
  return flags;
}

template <scalar S, class Frame>
FollowedDot<S> follow(const Frame& frame, DotIndex index) {
  return {index, neighbourhood<S>(frame, index), touching(frame, index), false};
}

/// False if the dot is found out of contact for the second time in a row. The first time it is
/// still used, so that another dot can replace it without a gap. After that its motion is no longer
/// the object's.
template <scalar S, class Frame>
bool is_still_held(const Frame& frame, FollowedDot<S>& followed) {
  const bool found = frame.found(followed.index.row, followed.index.col);
  const bool out = found && !frame.flagged(followed.index.row, followed.index.col);
  const bool was_out = followed.has_left;
  followed.has_left = found ? out : was_out;
  return !(out && was_out);
}

/// The step of the dots in contact both then and now; of all dots if those give no rotation.
template <class Local, scalar S, class Frame>
DotStep<S> step_of(const Frame& frame, const FollowedDot<S>& followed) {
  const Neighbourhood<S> now = neighbourhood<S>(frame, followed.index);
  Neighbourhood<S> held = now;
  const std::array<bool, 9> flags = touching(frame, followed.index);
  for (std::size_t k = 0; k < 9; ++k) {
    held.found[k] = now.found[k] && flags[k] && followed.touching[k];
  }
  const DotStep<S> step = step_between<Local>(followed.anchor, held);
  return step.status == MotionStatus::ok ? step : step_between<Local>(followed.anchor, now);
}

/// Starts to follow the reference dot in the first frame of the object.
template <scalar S, class Frame, class FollowingTrack>
MotionStatus begin_following(const Frame& frame, DotIndex reference, FollowingTrack& t) {
  if (!reference.exists()) {
    return MotionStatus::no_reference_dot;
  }
  t = {};
  t.followed = follow<S>(frame, reference);
  t.start_mm = frame.dot(reference.row, reference.col);
  t.dots_used = 9;
  return MotionStatus::ok;
}

/// Whether the dots moved rigidly: the residual is at most a quarter of the pitch.
template <scalar S>
bool is_rigid(const Neighbourhood<S>& anchor, const S& residual_mm) {
  S least_sq = S(std::numeric_limits<scalar_real_t<S>>::infinity());
  for (std::size_t k = 1; k < 9; k += 2) {  // the four nearest neighbours
    if (anchor.found[k] && anchor.found[4]) {
      const S sq = squared_norm(anchor.dot[k] - anchor.dot[4]);
      least_sq = value(sq) < value(least_sq) ? sq : least_sq;
    }
  }
  return !(value(least_sq) < 16 * value(S(residual_mm * residual_mm)));
}

/// The step of a followed dot in the next frame, or why there is none.
template <class Local, scalar S, class Frame>
DotStep<S> next_step(const Frame& frame, DotIndex reference, FollowedDot<S>& followed) {
  DotStep<S> step;
  if (!is_still_held(frame, followed)) {
    step.status = MotionStatus::lost;
    return step;
  }
  step = step_of<Local>(frame, followed);
  if (step.status == MotionStatus::ok && followed.has_left && !reference.exists()) {
    step.status = MotionStatus::no_reference_dot;
  } else if (step.status == MotionStatus::ok && !is_rigid(followed.anchor, step.residual_rms_mm)) {
    step.status = MotionStatus::not_rigid;
  }
  return step;
}

}  // namespace detail::motion

}  // namespace v0
}  // namespace fingerpad
