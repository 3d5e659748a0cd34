// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Result and statuses of the motion of the object.
#include <cstdint>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/rotation.hpp"

namespace fingerpad {
inline namespace v0 {

enum class MotionStatus : std::uint8_t {
  ok,
  no_contact,        ///< dots are there and none is in contact: the object is gone
  no_dots,           ///< no dot at all was found: nothing can be said of the object
  no_reference_dot,  ///< no dot in contact has all its neighbours, and none was being followed
  too_few_dots,      ///< fewer than three dots to go by, or too few to begin with
  collinear,         ///< the dots to go by lie on a line: they determine no rotation
  lost,              ///< what was followed has left the contact, and nothing known is in it
  not_rigid,  ///< the dots are further than a quarter of a pitch from any rigid motion, or have
              ///< turned over: other names than before, or a place for those that are lost?
  slipping,   ///< fewer than a fifth of the dots in contact stick: the pose is not known
  refused,    ///< a grid, state or workspace has another size: nothing was done
};

/// "ok", "no contact", ...
constexpr const char* name_of(MotionStatus status) {
  switch (status) {
    case MotionStatus::ok:
      return "ok";
    case MotionStatus::no_contact:
      return "no contact";
    case MotionStatus::no_dots:
      return "no dots";
    case MotionStatus::no_reference_dot:
      return "no reference dot";
    case MotionStatus::too_few_dots:
      return "too few dots";
    case MotionStatus::collinear:
      return "collinear";
    case MotionStatus::lost:
      return "lost";
    case MotionStatus::not_rigid:
      return "not rigid";
    case MotionStatus::slipping:
      return "slipping";
    case MotionStatus::refused:
      return "refused";
  }
  return "unknown";
}

/// The motion of the object in a frame. Everything but `status` is the last known state
/// where the status is not ok; before an object begins it is that of an object at rest.
template <scalar S = double>
struct [[nodiscard]] ObjectMotionResult {
  MotionStatus status = MotionStatus::refused;
  DotIndex reference = {};         ///< contact reference dot of this frame; row -1: there is none
  bool reference_changed = false;  ///< it is another dot than in the frame before
  bool begun = false;              ///< the object begins with this frame: pose is the identity
  Index dots_used = 0;             ///< dots from which the pose was computed
  Pose<S> pose = {};  ///< x_now = R x_first + t, from the frame in which the object began
  Angles<S> angles =
      {};  ///< about z, y, x; with published::SumOfAngles the sums, which may exceed pi
  Point3<S> position_mm = {not_a_number<S>(), not_a_number<S>(),
                           not_a_number<S>()};  ///< where the point of the object is now that lay
                                                ///< under the contact reference dot at first;
                                                ///< NaN before an object has begun
  Point3<S> displacement_mm = {S(0), S(0), S(0)};  ///< of that point
  S residual_rms_mm = S(0);                        ///< of the dots used, against the rigid motion

  bool accepted() const { return status != MotionStatus::refused; }
  bool ok() const { return status == MotionStatus::ok; }
};

}  // namespace v0
}  // namespace fingerpad
