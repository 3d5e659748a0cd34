// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What became of the object in a frame.
#include <cstdint>

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
  }
  return "unknown";
}

}  // namespace v0
}  // namespace fingerpad
