// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Accumulation over a chain of dots: the contact reference dot is followed with its neighbours
// until another takes its place. Source: Ito, Kim, Nagai, Obinata 2011, eq. 19, which prints
// theta_x twice (E024): the angles of the object are the sums of those of the steps. Sums of angles
// are not the angles of the composed rotation unless all turning is about one axis: a roll of 40
// degrees about y and then about x ends 27 degrees off.
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/motion/local_rotation.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail::motion {

/// A dot with its neighbours as they were in an earlier frame.
template <scalar S>
struct FollowedDot {
  DotIndex index = {};
  Neighbourhood<S> anchor = {};
  std::array<bool, 9> touching = {};  ///< the dots of the anchor that were in contact
  bool has_left = false;              ///< it was found out of contact in the last frame
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

/// False when the dot is out of contact for the second time. Once it may be asked, so that another
/// can take its place without a gap; after that its motion is no longer the object's.
template <scalar S, class Frame>
bool is_still_held(const Frame& frame, FollowedDot<S>& followed) {
  const bool found = frame.found(followed.index.row, followed.index.col);
  const bool out = found && !frame.flagged(followed.index.row, followed.index.col);
  const bool was_out = followed.has_left;
  followed.has_left = found ? out : was_out;
  return !(out && was_out);
}

/// The step of those that touch the object, then and now; of all where those are too few.
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

/// What every way of accumulation keeps.
template <scalar S>
struct Track {
  Pose<S> pose = {};
  Angles<S> angles = {};
  Point3<S> start_mm = {S(0), S(0), S(0)};  ///< the point whose position is reported, at first
  Index dots_used = 0;
  S residual_rms_mm = S(0);
};

/// A dot is followed from the frame in which the object begins.
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
  }
  return step;
}

}  // namespace detail::motion

/// Published: the angles and the displacement of the object are the sums of those of the steps from
/// frame to frame, each of the dot that was the contact reference dot before it. Noise grows with
/// the number of frames only where the dot changes, but the error of summed angles is there without
/// any: see docs/motion/object_motion.md.
template <class Local = PublishedBasis>
struct SumOfAngles {
  template <scalar S>
  struct Track : detail::motion::Track<S> {
    detail::motion::FollowedDot<S> followed = {};
    Point3<S> displacement_mm = {S(0), S(0), S(0)};
  };
  template <scalar S>
  Track<S> track(Index, Index) const {
    return {};
  }

  template <scalar S, class Frame>
  MotionStatus begin(const Frame& frame, DotIndex reference, Track<S>& t) const {
    return detail::motion::begin_following<S>(frame, reference, t);
  }

  template <scalar S, class Frame>
  MotionStatus advance(const Frame& frame, DotIndex reference, Track<S>& t) const {
    const detail::motion::DotStep<S> step =
        detail::motion::next_step<Local>(frame, reference, t.followed);
    if (step.status != MotionStatus::ok) {
      return step.status;
    }
    t.dots_used = step.dots_used;
    t.residual_rms_mm = step.residual_rms_mm;
    const Angles<S> rotated = zyx_angles(step.pose.rotation);
    t.angles = {S(t.angles.x_rad + rotated.x_rad), S(t.angles.y_rad + rotated.y_rad),
                S(t.angles.z_rad + rotated.z_rad)};
    t.displacement_mm += moved(t.followed.anchor, step);
    const Rotation<S> rotation = rotation_of(t.angles);
    const Point3<S> position = t.start_mm + t.displacement_mm;
    t.pose = {rotation, position - rotation(t.start_mm)};
    t.followed.anchor = step.now;
    if (reference.exists() && reference != t.followed.index) {
      t.followed = detail::motion::follow<S>(frame, reference);
    }
    return MotionStatus::ok;
  }

 private:
  /// Of the dot itself, or of its neighbours where it is missing.
  template <scalar S>
  static Point3<S> moved(const Neighbourhood<S>& anchor, const detail::motion::DotStep<S>& step) {
    CommonDots self = {{false, false, false, false, true, false, false, false, false}, 1};
    const CommonDots all = common_dots(anchor, step.now);
    const CommonDots& used = all.found[4] ? self : all;
    return detail::motion::center(step.now, used) - detail::motion::center(anchor, used);
  }
};

/// The exact composition: the pose is that of the followed dot since its anchor frame, after the
/// pose of the object in that frame; only when another dot becomes the contact reference dot is it
/// composed. So noise grows with the number of changes, not with that of the frames.
template <class Local = SymmetricFrame>
struct AnchoredComposition {
  static_assert(Local::gives_rotations, "only rotations can be composed: use SymmetricFrame");

  template <scalar S>
  struct Track : detail::motion::Track<S> {
    detail::motion::FollowedDot<S> followed = {};
    Pose<S> at_anchor = {};
  };
  template <scalar S>
  Track<S> track(Index, Index) const {
    return {};
  }

  template <scalar S, class Frame>
  MotionStatus begin(const Frame& frame, DotIndex reference, Track<S>& t) const {
    return detail::motion::begin_following<S>(frame, reference, t);
  }

  template <scalar S, class Frame>
  MotionStatus advance(const Frame& frame, DotIndex reference, Track<S>& t) const {
    const detail::motion::DotStep<S> step =
        detail::motion::next_step<Local>(frame, reference, t.followed);
    if (step.status != MotionStatus::ok) {
      return step.status;
    }
    t.dots_used = step.dots_used;
    t.residual_rms_mm = step.residual_rms_mm;
    t.pose = step.pose * t.at_anchor;
    t.angles = zyx_angles(t.pose.rotation);
    if (reference.exists() && reference != t.followed.index) {
      t.pose.rotation = detail::motion::renormalized(t.pose.rotation);
      t.at_anchor = t.pose;
      t.followed = detail::motion::follow<S>(frame, reference);
    }
    return MotionStatus::ok;
  }
};

}  // namespace v0
}  // namespace fingerpad
