// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Inputs, law and results of grip control (grip_control.hpp).
#include <cstdint>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/slip/friction_limit.hpp"

namespace fingerpad {
inline namespace v0 {

enum class GripStatus : std::uint8_t {
  holding,  ///< the force does not change
  raising,  ///< the ratio is below the set point or missing for long, or the force follows the load
  lowering,  ///< the ratio is above `lower_above`, or the force follows the load
  at_limit,  ///< the force would change further, but is at a limit
};

/// Why the force changes or is held.
enum class GripReason : std::uint8_t {
  slipping,       ///< the ratio is below the set point; if the load is known: a slip was detected
  enough_sticks,  ///< the ratio is between the set point and `lower_above`
  all_sticks,     ///< the ratio is above `lower_above`
  follows_load,   ///< no slip: the force follows the load and approaches the smallest that holds
  unmoved,        ///< the dots are at rest, without signs of slip
  may_slide,      ///< the dots are at rest, but the last ratio was at most `sliding_ratio`
  waiting,        ///< no ratio, for at most `blind_after_s`
  blind,          ///< no ratio for longer than that, or slipping when last seen
  lost,           ///< no contact for longer than `lost_after_s`: there is no object
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

/// Parameters of the control law. Forces in N, rates in N/s, all finite.
template <scalar S = double>
struct GripLaw {
  S set_point = S(8) / S(10);      ///< stick ratio below which the force is raised, in (0, 1)
  S raise_gain_n_per_s = S(60);    ///< N/s per unit of ratio below the set point, > 0
  S lower_above = S(95) / S(100);  ///< ratio above which it is lowered, in [set_point, 1]
  S lower_gain_n_per_s = S(0);   ///< N/s per unit of ratio above that, >= 0; 0: held, never lowered
  S rise_limit_n_per_s = S(40);  ///< limit of the gripper, > 0
  S fall_limit_n_per_s = S(2);   ///< limit of the gripper, >= 0
  S min_force_n = S(1) / S(2);   ///< >= 0
  S max_force_n = S(20);         ///< limit of the object, > min_force_n
  /// No rise beyond this without a fresh ratio, in [min_force_n, max_force_n].
  S safe_force_n = S(10);
  /// How long a ratio is acted on while the dots move too little for a new one, >= 0.
  S ratio_lasts_s = S(1) / S(10);
  /// At or below this ratio the object may slide as a whole over dots at rest, so the ratio is
  /// acted on for as long as they rest. In [0, set_point].
  S sliding_ratio = S(5) / S(10);
  /// How long a missing ratio is waited for, unless the object was slipping when last seen, >= 0.
  S blind_after_s = S(2) / S(10);
  S blind_rise_n_per_s = S(5);  ///< rate after that, up to safe_force_n, >= 0; 0: held
  /// Without contact for longer than this the object is lost and the force no longer raised, >= 0.
  S lost_after_s = S(5) / S(10);
  S longest_step_s = S(1) / S(10);  ///< a longer time step counts as this, > 0

  // used if the tangential force is known
  S slip_ratio = S(2) / S(10);  ///< ratio of the dots below which the contact slips, in [0, 0.5]
  /// After a slip, L* is L / (1 + slip_margin), > 0. In the default, 0.09 is three times the noise
  /// of the difference of two L, 3.0 % for forces known to 1.5 %; the rest is what the load gains
  /// before the next frame.
  S slip_margin = S(15) / S(100);
  /// Relative growth of L* per second while the contact has stick to spare, before the first slip,
  /// >= 0. L* does not grow while no ratio is known.
  S first_search_per_s = S(2) / S(10);
  S search_per_s = S(4) / S(100);  ///< the same after the first slip, >= 0
  /// How far ahead the load is predicted: delay of camera and gripper, >= 0.
  S response_s = S(1) / S(10);
};

/// Refuses bad parameters (parameter_error).
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

/// A stick ratio and its update, by name: a bare number could as well be the time step.
template <scalar S = double>
struct StickReading {
  /// In [0, 1]; anything else, such as a ratio in percent, counts as missing.
  S ratio = not_a_number<S>();
  RatioUpdate update = RatioUpdate::fresh;
};

/// The law: rate of the force in N/s for a stick ratio in [0, 1], within the limits of the gripper.
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

  /// Whether the force is based on a stick ratio. False if there is none or it is invalid, such as
  /// a ratio in percent.
  bool ok() const {
    return why != GripReason::no_time && why != GripReason::waiting && why != GripReason::blind &&
           why != GripReason::lost;
  }
};

}  // namespace v0
}  // namespace fingerpad
