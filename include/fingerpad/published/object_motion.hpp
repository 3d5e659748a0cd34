// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The object's motion as printed: Ito, Kim, Nagai, Obinata, "Acquisition of tactile information by
// vision-based tactile sensor for dexterous handling of robot hands", III.C, eqs. 13-19. A basis of
// its neighbours gives the rotation of the contact reference dot, and Euler angles are added up
// from frame to frame. The sum is wrong because rotations do not commute: docs/errata.md,
// E019-E024.
#include "fingerpad/motion/object_motion.hpp"
#include "fingerpad/published/detail/followed_dot.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// The published basis, with E021 and E022 repaired. The result is exact for a rigid motion;
/// otherwise it is in general not a rotation matrix.
struct PublishedBasis {
  template <scalar S>
  static detail::motion::LocalRotation<S> turn(const detail::motion::Neighbourhood<S>& from,
                                               const detail::motion::Neighbourhood<S>& to) {
    return detail::motion::turn_of_bases(
        from, to,
        [](const detail::motion::GridDirections<S>& q) {
          return detail::motion::published_basis(q);
        },
        [](const detail::motion::Basis<S>& k, const detail::motion::Basis<S>& l) {
          return detail::motion::turn_between(detail::motion::inverse_transposed(k), l);
        });
  }
};

/// The same two directions, orthonormalised symmetrically.
struct SymmetricFrame {
  template <scalar S>
  static detail::motion::LocalRotation<S> turn(const detail::motion::Neighbourhood<S>& from,
                                               const detail::motion::Neighbourhood<S>& to) {
    return detail::motion::turn_of_bases(
        from, to,
        [](const detail::motion::GridDirections<S>& q) {
          return detail::motion::symmetric_frame(q);
        },
        [](const detail::motion::Basis<S>& k, const detail::motion::Basis<S>& l) {
          return detail::motion::turn_between(k, l);
        });
  }
};

/// As published: the angles and the displacement of the object are sums over the steps from frame
/// to frame. Each step is that of the contact reference dot before it. Noise accumulates only when
/// the dot changes, but summed angles are wrong even without noise: docs/motion/object_motion.md.
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
  /// Displacement of the dot itself, or of the center of the common dots where it is missing.
  template <scalar S>
  static Point3<S> moved(const detail::motion::Neighbourhood<S>& anchor,
                         const detail::motion::DotStep<S>& step) {
    detail::motion::CommonDots self = {
        {false, false, false, false, true, false, false, false, false}, 1};
    const detail::motion::CommonDots all = detail::motion::common_dots(anchor, step.now);
    const detail::motion::CommonDots& used = all.found[4] ? self : all;
    return detail::motion::center(step.now, used) - detail::motion::center(anchor, used);
  }
};

/// Exact composition of poses: the motion of the followed dot since its anchor frame is applied
/// after the pose of the object in that frame. The anchor moves only when another dot becomes the
/// contact reference dot, so noise grows with the number of changes, not of frames.
struct AnchoredComposition {
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
        detail::motion::next_step<SymmetricFrame>(frame, reference, t.followed);
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

template <scalar S = double>
using ObjectMotion = fingerpad::ObjectMotion<SumOfAngles<PublishedBasis>, S>;

/// `initial_mm` are the dots of the free pad. Refuses bad parameters (parameter_error).
template <scalar S = double, spatial_dot_grid Dots>
ObjectMotion<S> object_motion(const Dots& initial_mm) {
  return ObjectMotion<S>(initial_mm);
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
