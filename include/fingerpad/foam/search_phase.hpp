// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What the searches for the holding force are told at each sample, and what they say they do.
#include <cstdint>

namespace fingerpad {
inline namespace v0 {

/// What the fingers say at one sample.
enum class SlipNews : std::uint8_t {
  steady,   ///< no sign of slip
  preslip,  ///< some of the contact begins to slip
  slipped,  ///< the object slips as a whole, or is gone
  missing,  ///< nothing can be told: the command stays as it is
};

enum class SearchPhase : std::uint8_t {
  settling,  ///< what the last command stirred up dies away; news but `slipped` is not listened to
  watching,  ///< pre-slip is waited for
  found,     ///< loosening: the least force is known. The end
  lifted,    ///< lifting: at the full height. The end
  at_limit,  ///< the force cannot be lowered or raised further. The end
  slipped,   ///< the object slipped as a whole. The end
};

/// "settling", "watching", ...
constexpr const char* name_of(SearchPhase phase) {
  switch (phase) {
    case SearchPhase::settling:
      return "settling";
    case SearchPhase::watching:
      return "watching";
    case SearchPhase::found:
      return "found";
    case SearchPhase::lifted:
      return "lifted";
    case SearchPhase::at_limit:
      return "at limit";
    case SearchPhase::slipped:
      return "slipped";
  }
  return "unknown";
}

/// No command changes after these.
constexpr bool is_end(SearchPhase phase) {
  return phase != SearchPhase::settling && phase != SearchPhase::watching;
}

}  // namespace v0
}  // namespace fingerpad
