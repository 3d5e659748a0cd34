// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Status of a force that is looked up in a calibrated curve or map.
#include <cstdint>

#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// Statuses from the best to the worst.
enum class ForceStatus : std::uint8_t {
  no_contact,    ///< the measure is 0 or negative: no force, whatever the displacement
  measured,      ///< within the calibrated range
  below_range,   ///< the contact is smaller than any in the calibration, and the force fades to 0
                 ///< with it; Shear: smaller than a hundredth of the reference. If this is always
                 ///< so, the measure may be in another unit
  beyond_range,  ///< a larger contact or displacement than in the calibration: the curve continues
                 ///< along its tangent
  held_at_zero,  ///< curve or compensation give a negative force, which is set to 0
  disagreeing,   ///< the forces by area and by depth differ by more than their errors allow: the
                 ///< contact is unlike those of the calibration, or a measure is in another unit
  implausible,   ///< a displacement above 100 mm, a rotation by more than half a turn, or a measure
                 ///< or force of a million or more: in px, um, degrees?
  not_finite,    ///< an input is not a number, or the force overflows
};

/// "measured", "below range", ...
constexpr const char* name_of(ForceStatus status) {
  switch (status) {
    case ForceStatus::measured:
      return "measured";
    case ForceStatus::below_range:
      return "below range";
    case ForceStatus::beyond_range:
      return "beyond range";
    case ForceStatus::held_at_zero:
      return "held at zero";
    case ForceStatus::no_contact:
      return "no contact";
    case ForceStatus::implausible:
      return "implausible: not in mm, rad?";
    case ForceStatus::disagreeing:
      return "disagreeing";
    case ForceStatus::not_finite:
      return "not finite";
  }
  return "unknown";
}

namespace detail {

/// Whether a value is finite but impossible for the contact of a fingertip.
template <class S>
constexpr bool beyond_displacement(const Point2<S>& displacement_mm) {
  return is_finite(displacement_mm) && value(squared_norm(displacement_mm)) > 10000;
}
/// The same for a measure or a force.
template <class S>
constexpr bool beyond_all(const S& measure_or_force) {
  return is_finite(measure_or_force) && !is_plausible(measure_or_force);
}
template <class S>
constexpr bool beyond_rotation(const S& rotation_rad) {
  return is_finite(rotation_rad) && value(S(rotation_rad * rotation_rad)) > 10;
}

constexpr ForceStatus worse(ForceStatus a, ForceStatus b) {
  return a < b ? b : a;
}
}  // namespace detail

}  // namespace v0
}  // namespace fingerpad
