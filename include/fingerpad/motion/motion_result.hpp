// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Result and statuses of the object motion.
#include <cstdint>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/rotation.hpp"

namespace fingerpad {
inline namespace v0 {

enum class MotionStatus : std::uint8_t {
  ok,
  no_contact,        ///< dots were found, but none is in contact: the object is gone
  no_dots,           ///< no dot was found: nothing is known of the object
  no_reference_dot,  ///< no dot in contact has all its neighbours, and none was followed before
  too_few_dots,      ///< fewer than three usable dots, or too few to begin an object
  collinear,         ///< the usable dots lie on a line and do not determine a rotation
  lost,  ///< all dots that were followed have left the contact, and only new ones are in it
  /// The rms residual from the best rigid motion exceeds a quarter of a pitch, or the dots have
  /// turned over: dots labelled differently than before, or lost dots marked by a position?
  not_rigid,
  /// Fewer than a fifth of the dots in contact stick, or no more than half since they slid: the
  /// pose is not known.
  slipping,
  refused,  ///< a grid, state or workspace has another size: nothing was done
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

/// Motion of the object in a frame. If the status is not ok, dots_used is 0, and pose, angles,
/// position, displacement and residual are the last known ones; before an object begins they are
/// those of an object at rest.
template <scalar S = double>
struct [[nodiscard]] ObjectMotionResult {
  MotionStatus status = MotionStatus::refused;
  DotIndex reference = {};         ///< contact reference dot of this frame; row -1: none
  bool reference_changed = false;  ///< it differs from that of the frame before
  bool begun = false;              ///< the object begins with this frame: the pose is the identity
  Index dots_used = 0;             ///< dots from which the pose was computed
  Pose<S> pose = {};  ///< x_now = R x_first + t, from the frame in which the object began
  Angles<S> angles =
      {};  ///< about z, y and x; with published::SumOfAngles the sums, which may exceed pi
  /// Present position of the object's point that lay under the contact reference dot at first, or,
  /// if there was none, at the centroid of the dots with which the object began. NaN before an
  /// object has begun.
  Point3<S> position_mm = {not_a_number<S>(), not_a_number<S>(), not_a_number<S>()};
  Point3<S> displacement_mm = {S(0), S(0), S(0)};  ///< of that point
  S residual_rms_mm = S(0);  ///< rms residual of the dots used from the rigid motion

  bool accepted() const { return status != MotionStatus::refused; }
  bool ok() const { return status == MotionStatus::ok; }
};

}  // namespace v0
}  // namespace fingerpad
