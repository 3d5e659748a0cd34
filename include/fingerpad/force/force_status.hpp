// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What a force by look-up is worth.
#include <cstdint>

namespace fingerpad {
inline namespace v0 {

enum class ForceStatus : std::uint8_t {
  measured,      ///< within the range that was identified
  below_range,   ///< a smaller contact than any identified: the force fades to 0 with it
  beyond_range,  ///< a larger one, or a larger shift: the curve goes on along its tangent
  held_at_zero,  ///< the curve or a compensation is negative there
  no_contact,    ///< the measure is 0 or negative: no force, whatever is displaced
  not_finite,    ///< what it is computed from is no number, or it is too large for one
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
    case ForceStatus::not_finite:
      return "not finite";
  }
  return "unknown";
}

}  // namespace v0
}  // namespace fingerpad
