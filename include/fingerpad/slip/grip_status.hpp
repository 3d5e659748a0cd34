// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What grip control is told of the stick ratio, and what it says of its answer.
#include <cstdint>

namespace fingerpad {
inline namespace v0 {

/// What the camera had to say on the stick ratio since the last call.
enum class RatioNews : std::uint8_t {
  fresh,    ///< the ratio is that of now
  unmoved,  ///< the dots were seen and have not moved enough to tell more: the last ratio stands
  missing,  ///< nothing usable was seen
};

/// The news that a status of the stick ratio brings.
template <class StickStatus>
  requires requires {
    StickStatus::updated;
    StickStatus::standing;
    StickStatus::no_reference;
  }
constexpr RatioNews news_of(StickStatus status) {
  const bool unmoved = status == StickStatus::standing || status == StickStatus::no_reference;
  return status == StickStatus::updated ? RatioNews::fresh
         : unmoved                      ? RatioNews::unmoved
                                        : RatioNews::missing;
}

enum class GripStatus : std::uint8_t {
  holding,
  raising,
  lowering,
  at_limit,  ///< it would be raised or lowered further, but for a limit of the force
};

/// Why the force is what it is.
enum class GripReason : std::uint8_t {
  slipping,       ///< less than the set point sticks
  enough_sticks,  ///< the set point is reached
  all_sticks,     ///< more sticks than `lower_above`
  unmoved,        ///< the dots stand still, and nothing speaks for slip
  may_slide,      ///< the dots stand still, but the last ratio was at most `sliding_ratio`
  waiting,        ///< no ratio, for no longer than `blind_after_s`
  blind,          ///< no ratio for longer than that, or slipping when last seen
  no_time,        ///< the time step was not a positive number: nothing was done
};

/// "holding", "raising", ...
constexpr const char* name_of(GripStatus status) {
  switch (status) {
    case GripStatus::holding:
      return "holding";
    case GripStatus::raising:
      return "raising";
    case GripStatus::lowering:
      return "lowering";
    case GripStatus::at_limit:
      return "at limit";
  }
  return "unknown";
}

/// "slipping", "enough sticks", ...
constexpr const char* name_of(GripReason reason) {
  switch (reason) {
    case GripReason::slipping:
      return "slipping";
    case GripReason::enough_sticks:
      return "enough sticks";
    case GripReason::all_sticks:
      return "all sticks";
    case GripReason::unmoved:
      return "unmoved";
    case GripReason::may_slide:
      return "may slide";
    case GripReason::waiting:
      return "waiting";
    case GripReason::blind:
      return "blind";
    case GripReason::no_time:
      return "no time";
  }
  return "unknown";
}

}  // namespace v0
}  // namespace fingerpad
