// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Inputs of grip control (grip_control.hpp), its law, and its results.
#include <cstdint>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// How current the stick ratio is since the last call.
enum class RatioUpdate : std::uint8_t {
  fresh,       ///< the ratio is that of now
  unmoved,     ///< the dots were seen and have not moved enough to tell more: the last ratio stands
  missing,     ///< nothing usable was seen
  no_contact,  ///< nothing touches: there is no object, or it has just been lost
};

/// The update that a status of the stick ratio brings.
template <class StickStatus>
  requires requires {
    StickStatus::updated;
    StickStatus::standing;
    StickStatus::no_reference;
    StickStatus::no_contact;
  }
constexpr RatioUpdate update_of(StickStatus status) {
  const bool unmoved = status == StickStatus::standing || status == StickStatus::no_reference;
  return status == StickStatus::updated      ? RatioUpdate::fresh
         : unmoved                           ? RatioUpdate::unmoved
         : status == StickStatus::no_contact ? RatioUpdate::no_contact
                                             : RatioUpdate::missing;
}

enum class GripStatus : std::uint8_t {
  holding,   ///< the force stays
  raising,   ///< less than the set point sticks, or nothing is known for long
  lowering,  ///< more than enough sticks
  at_limit,  ///< it would be raised or lowered further, but for a limit of the force
};

/// Why the force is what it is.
enum class GripReason : std::uint8_t {
  slipping,       ///< less than the set point sticks
  enough_sticks,  ///< the set point is reached
  all_sticks,     ///< more sticks than `lower_above`
  follows_load,   ///< enough sticks: the force follows the load, and comes closer to what it needs
  unmoved,        ///< the dots stand still, and nothing speaks for slip
  may_slide,      ///< the dots stand still, but the last ratio was at most `sliding_ratio`
  waiting,        ///< no ratio, for no longer than `blind_after_s`
  blind,          ///< no ratio for longer than that, or slipping when last seen
  lost,           ///< nothing has touched for longer than `lost_after_s`: there is no object
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
    case GripReason::follows_load:
      return "follows the load";
    case GripReason::unmoved:
      return "unmoved";
    case GripReason::may_slide:
      return "may slide";
    case GripReason::waiting:
      return "waiting";
    case GripReason::blind:
      return "blind";
    case GripReason::lost:
      return "lost";
    case GripReason::no_time:
      return "no time";
  }
  return "unknown";
}

/// The law and its limits. Forces in N, rates in N/s, all finite.
template <scalar S = double>
struct GripLaw {
  S set_point = S(8) / S(10);       ///< stick ratio below which the force is raised, in (0, 1)
  S raise_gain_n_per_s = S(60);     ///< N/s for each unit of ratio below the set point, > 0
  S lower_above = S(95) / S(100);   ///< ratio above which it is lowered, in [set_point, 1]
  S lower_gain_n_per_s = S(0);      ///< N/s for each unit above that, >= 0; 0: held, never lowered
  S rise_limit_n_per_s = S(40);     ///< what the gripper can do, > 0
  S fall_limit_n_per_s = S(2);      ///< >= 0
  S min_force_n = S(1) / S(2);      ///< >= 0
  S max_force_n = S(20);            ///< what the object can bear, > min_force_n
  S safe_force_n = S(10);           ///< no rise beyond this without a fresh ratio, within the two
  S ratio_lasts_s = S(1) / S(10);   ///< how long a ratio is acted on while the dots do not move
                                    ///< enough for the next, >= 0
  S sliding_ratio = S(5) / S(10);   ///< at or below this the object may slide as a whole under dots
                                    ///< that stand still: acted on for as long as it stands, in
                                    ///< [0, set_point]
  S blind_after_s = S(2) / S(10);   ///< how long a missing ratio is waited for unless the object
                                    ///< was slipping when last seen, >= 0
  S blind_rise_n_per_s = S(5);      ///< from then on the force is raised so, to the safe force,
                                    ///< >= 0; 0: held
  S lost_after_s = S(5) / S(10);    ///< without contact for longer than this the object is lost:
                                    ///< the force is no longer raised, >= 0
  S longest_step_s = S(1) / S(10);  ///< a longer time between calls counts as this, > 0

  // where the tangential force is known
  S slip_ratio = S(2) / S(10);     ///< dots' ratio below which the contact slips, in [0, 0.5]
  S slip_margin = S(15) / S(100);  ///< after a slip the friction asked for is less by this share,
                                   ///< > 0: 0.09 is three times the noise of two L by forces known
                                   ///< to 1.5 %, the rest what the load gains before the next frame
  S first_search_per_s = S(2) / S(10);  ///< share by which it grows while all sticks, before the
                                        ///< first slip, >= 0
  S search_per_s = S(4) / S(100);       ///< and later, >= 0; by neither while no ratio is known
  S response_s = S(1) / S(10);  ///< by how much the load is foreseen: camera and gripper, >= 0
};

/// Refuses what has no meaning (parameter_error).
template <scalar S>
void expects_valid(const GripLaw<S>& law) {
  const auto check = [](bool good, const char* name, const S& given, const char* range) {
    expects(good && is_finite(given), "GripLaw", name, given, range);
  };
  check(value(law.set_point) > 0 && value(law.set_point) < 1, "set_point", law.set_point,
        "in (0, 1)");
  check(value(law.raise_gain_n_per_s) > 0, "raise_gain_n_per_s", law.raise_gain_n_per_s,
        "finite and > 0");
  check(value(law.lower_above) >= value(law.set_point) && value(law.lower_above) <= 1,
        "lower_above", law.lower_above, "in [set_point, 1]");
  check(value(law.lower_gain_n_per_s) >= 0, "lower_gain_n_per_s", law.lower_gain_n_per_s,
        "finite and >= 0");
  check(value(law.rise_limit_n_per_s) > 0, "rise_limit_n_per_s", law.rise_limit_n_per_s,
        "finite and > 0");
  check(value(law.fall_limit_n_per_s) >= 0, "fall_limit_n_per_s", law.fall_limit_n_per_s,
        "finite and >= 0");
  check(value(law.min_force_n) >= 0, "min_force_n", law.min_force_n, "finite and >= 0");
  check(value(law.max_force_n) > value(law.min_force_n), "max_force_n", law.max_force_n,
        "finite and > min_force_n");
  check(value(law.safe_force_n) >= value(law.min_force_n) &&
            value(law.safe_force_n) <= value(law.max_force_n),
        "safe_force_n", law.safe_force_n, "in [min_force_n, max_force_n]");
  check(value(law.ratio_lasts_s) >= 0, "ratio_lasts_s", law.ratio_lasts_s, "finite and >= 0");
  check(value(law.sliding_ratio) >= 0 && value(law.sliding_ratio) <= value(law.set_point),
        "sliding_ratio", law.sliding_ratio, "in [0, set_point]");
  check(value(law.blind_after_s) >= 0, "blind_after_s", law.blind_after_s, "finite and >= 0");
  check(value(law.blind_rise_n_per_s) >= 0, "blind_rise_n_per_s", law.blind_rise_n_per_s,
        "finite and >= 0");
  check(value(law.lost_after_s) >= 0, "lost_after_s", law.lost_after_s, "finite and >= 0");
  check(value(law.longest_step_s) > 0, "longest_step_s", law.longest_step_s, "finite and > 0");
  check(value(law.slip_ratio) >= 0 && 2 * value(law.slip_ratio) <= 1, "slip_ratio", law.slip_ratio,
        "in [0, 0.5]");
  check(value(law.slip_margin) > 0, "slip_margin", law.slip_margin, "finite and > 0");
  check(value(law.first_search_per_s) >= 0, "first_search_per_s", law.first_search_per_s,
        "finite and >= 0");
  check(value(law.search_per_s) >= 0, "search_per_s", law.search_per_s, "finite and >= 0");
  check(value(law.response_s) >= 0, "response_s", law.response_s, "finite and >= 0");
}

/// What the dots say, by name: a number alone could as well be the time step.
template <scalar S = double>
struct StickReading {
  S ratio = not_a_number<S>();  ///< in [0, 1]; anything else, as a ratio in percent: missing
  RatioUpdate update = RatioUpdate::fresh;
};

/// The equation: N/s for a stick ratio in [0, 1], within what the gripper can do.
template <scalar S>
S grip_rate(const GripLaw<S>& law, const S& ratio) {
  if (value(ratio) < value(law.set_point)) {
    const S rise = law.raise_gain_n_per_s * S(law.set_point - ratio);
    return value(rise) < value(law.rise_limit_n_per_s) ? rise : law.rise_limit_n_per_s;
  }
  if (value(ratio) > value(law.lower_above)) {
    const S fall = law.lower_gain_n_per_s * S(ratio - law.lower_above);
    return value(fall) < value(law.fall_limit_n_per_s) ? S(-fall) : S(-law.fall_limit_n_per_s);
  }
  return S(0);
}

template <scalar S = double>
struct [[nodiscard]] GripResult {
  S force_n = S(0);  ///< to be applied now; always finite and within the limits
  GripStatus status = GripStatus::holding;
  GripReason why = GripReason::no_time;

  /// Whether the force rests on a stick ratio: false while none is seen, or what is given is none,
  /// as a ratio in percent.
  bool ok() const {
    return why != GripReason::no_time && why != GripReason::waiting && why != GripReason::blind &&
           why != GripReason::lost;
  }
};

}  // namespace v0
}  // namespace fingerpad
