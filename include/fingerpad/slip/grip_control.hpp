// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Controls the grip force by the stick ratio, so that an object of unknown weight and friction does
// not slip. Idea: Watanabe, Obinata, "Grip Force Control Using Vision-Based Tactile Sensor for
// Dexterous Handling" (2008), as summarized by the paper on slippage ("Definition of stick ratio"):
// the slippage degree is fed back proportionally. While everything sticks the force is not
// increased. At incipient slip it is increased before the object slips as a whole.
//
//   dF/dt = raise_gain (set_point - ratio)   ratio < set_point
//         = 0                                otherwise
//
// The force itself is the only integrator and is kept within its limits, so there is no windup. The
// form of the law, its limits and all defaults are this library's; the summary gives no formula.
//
// If the tangential force F_t is known, the force follows it at once,
//
//   F = F_t / L*,
//
// and the ratio only corrects L*, the friction demanded of the contact. L* grows slowly while the
// dots have stick to spare, and falls to L / (1 + slip_margin) when they slip at L = F_t / F_n.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/slip/friction_limit.hpp"

namespace fingerpad {
inline namespace v1 {

template <scalar S = double>
struct GripOptions {
  S set_point = S(0.8);          ///< stick ratio below which the force is raised, in (0, 1)
  S raise_gain_n_per_s = S(60);  ///< N/s per unit of ratio below the set point, > 0
  S rise_limit_n_per_s = S(40);  ///< limit of the gripper, > 0
  S fall_limit_n_per_s = S(2);   ///< limit of the gripper, >= 0
  S min_force_n = S(0.5);        ///< >= 0
  S max_force_n = S(20);         ///< limit of the object, > min_force_n
  S safe_force_n = S(10);        ///< no rise beyond this without a fresh ratio, in [min_force_n,
                                 ///< max_force_n]
  /// After a slip, L* is L / (1 + slip_margin), > 0. In the default, 0.09 is three times the noise
  /// of the difference of two L, 3.0 % for forces known to 1.5 %; the rest is what the load gains
  /// before the next frame.
  S slip_margin = S(0.15);
  S response_s =
      S(0.1);  ///< how far ahead the load is predicted: delay of camera and gripper, >= 0
};
/// Says which option has no meaning; "" if all have one.
template <scalar S>
std::string check(const GripOptions<S>& o) {
  const double min_n = static_cast<double>(value(o.min_force_n));
  const double max_n = static_cast<double>(value(o.max_force_n));
  return check(
      "GripOptions",
      {{"set_point", o.set_point, {.min = 0, .max = 1, .above_min = true, .below_max = true}},
       {"raise_gain_n_per_s", o.raise_gain_n_per_s, positive},
       {"rise_limit_n_per_s", o.rise_limit_n_per_s, positive},
       {"fall_limit_n_per_s", o.fall_limit_n_per_s, not_negative},
       {"min_force_n", o.min_force_n, not_negative},
       {"max_force_n", o.max_force_n, {.min = min_n, .above_min = true}},
       {"safe_force_n", o.safe_force_n, within(min_n, max_n)},
       {"slip_margin", o.slip_margin, positive},
       {"response_s", o.response_s, not_negative}});
}

/// Why the force changes or is held.
enum class GripReason : std::uint8_t {
  slipping,      ///< the ratio is below the set point; if the load is known: a slip was detected
  sticks,        ///< the ratio is not below it, or the dots are at rest without signs of slip
  follows_load,  ///< no slip: the force follows the load and approaches the smallest that holds
  blind,  ///< no usable ratio: held for 0.2 s unless it was slipping, then raised by 5 N/s to
          ///< safe_force_n. Also a time step that is not a positive number: nothing was done
  lost,   ///< no contact for 0.5 s: there is no object, and the force is held
};
/// "slipping", "sticks", ...
constexpr const char* name_of(GripReason reason) {
  constexpr std::array<const char*, 5> names = {"slipping", "sticks", "follows the load", "blind",
                                                "lost"};
  return names[static_cast<std::size_t>(reason)];
}

template <scalar S = double>
struct [[nodiscard]] GripResult {
  S force_n = S(0);  ///< to be applied now; always finite and within the limits
  GripReason why = GripReason::blind;
  bool at_limit = false;  ///< the force would change further, but is at a limit

  /// Whether the force is based on a stick ratio. False if there is none or it is invalid, such as
  /// a ratio in percent.
  bool ok() const { return why != GripReason::blind && why != GripReason::lost; }
};

/// Grip force of one finger on one object, call by call. A value: copy it to return to this call
/// later, and construct another when another object is grasped. A call is O(1), allocates nothing,
/// throws nothing, and reacts to slip at once.
template <scalar S = double>
class GripControl {
 public:
  /// `force_n` is that with which the object was grasped, within the limits; NaN: the smallest.
  /// Refuses bad parameters (parameter_error).
  explicit GripControl(const GripOptions<S>& options = {},
                       const std::type_identity_t<S>& force_n = S(0))
      : options_(options) {
    require(options);
    force_n_ = within_limits(force_n);
  }

  const GripOptions<S>& options() const { return options_; }
  const S& force_n() const { return force_n_; }
  /// L*, the friction demanded of the contact; NaN if the tangential force was never known.
  const S& friction() const { return friction_; }

  /// Sets the force from which the next call continues. Use it if the gripper does not follow the
  /// commands and its force is measured. Ignored if not finite.
  void follow(const S& measured_n) {
    force_n_ = is_finite(measured_n) ? within_limits(measured_n) : force_n_;
  }

  /// The law of the ratio. `ratio` is in [0, 1]; anything else, such as a ratio in percent, counts
  /// as missing. `step_s` is the time since the last call. Dots at rest do not loosen the grip: a
  /// ratio below the set point counts for 0.1 s, and one of at most a half, with which the object
  /// may slide as a whole over them, for as long as they rest. A smaller ratio never gives a
  /// smaller force.
  GripResult<S> operator()(const S& ratio, RatioUpdate update, const S& step_s) {
    if (!is_time(step_s)) {
      return {force_n_, GripReason::blind};
    }
    const bool fresh = update == RatioUpdate::fresh, unmoved = update == RatioUpdate::unmoved;
    const bool known = value(ratio) >= 0 && value(ratio) <= 1;
    const bool none_yet = unmoved && !(value(ratio) == value(ratio));
    untouched_s_ = update == RatioUpdate::no_contact ? untouched_s_ + step_s : S(0);
    if (!(fresh && known) && !(unmoved && (known || none_yet))) {
      unseen_s_ = unseen_s_ + step_s;
      const bool lost = S(lost_after_s) < untouched_s_;
      const bool waits = lost || (!slipping_ && !(S(blind_after_s) < unseen_s_));
      return move(waits ? S(0) : (std::min)(S(blind_rise_n_per_s), options_.rise_limit_n_per_s),
                  options_.safe_force_n, lost ? GripReason::lost : GripReason::blind, step_s);
    }
    unseen_s_ = S(0);
    ratio_age_s_ = fresh ? S(0) : ratio_age_s_ + step_s;
    const bool low = known && ratio < options_.set_point;
    slipping_ = fresh ? low : slipping_;
    if (!low || (S(ratio_lasts_s) < ratio_age_s_ && S(half) < ratio)) {
      return move(S(0), options_.safe_force_n, GripReason::sticks, step_s);
    }
    const S rise = options_.raise_gain_n_per_s * (options_.set_point - ratio);
    return move((std::min)(rise, options_.rise_limit_n_per_s),
                fresh ? options_.max_force_n : options_.safe_force_n, GripReason::slipping, step_s);
  }

  /// The same for a result of a stick ratio.
  template <scalar T>
  GripResult<S> operator()(const StickResult<T>& seen, const S& step_s) {
    return (*this)(S(seen.stick_ratio), update_of(seen.status), step_s);
  }

  /// The law of the load, for dots and friction together. Without the tangential force, or if the
  /// dots are not seen, the law of the ratio takes over.
  GripResult<S> operator()(const SlipResult<S>& slip, const S& step_s) {
    const S share = is_finite(slip.dots_ratio) ? slip.dots_ratio : slip.stick_ratio;
    const bool sticks = !(share < S(half));
    // Dots fall back with an object whose load falls, or because an object slides under friction
    // that has fallen. A contact that is unloaded keeps (1/2)^(2/3) of its area stuck (Mindlin and
    // Deresiewicz 1953), so it slides if less than half sticks.
    const bool back = slip.falls_back && !sticks, unmoved = slip.update == RatioUpdate::unmoved;
    const bool seen = slip.update == RatioUpdate::fresh || unmoved || back;
    if (!is_time(step_s) || !seen || !(is_finite(slip.stick_ratio) || unmoved) ||
        !is_finite(slip.friction)) {
      return (*this)(slip.stick_ratio, slip.update, step_s);
    }
    untouched_s_ = unseen_s_ = ratio_age_s_ = S(0);
    const S counted_s = (std::min)(step_s, S(longest_step_s));
    follow_load(slip.normal_n * slip.friction, slip.friction, sticks, counted_s);
    // a tenth exceeds the noise of a smoothed load, for forces known to 3 %
    const bool loses_load = !sticks && seen_load_n_ < S(0.9) * load_n_;
    // a ratio whose reference is older than the last slip shows that slip again
    held_s_ = held_s_ + step_s;
    const S age_s = S(static_cast<double>(slip.reference_age)) * step_s;
    const bool recent = !has_slipped_ || age_s < held_s_;
    const bool has_ratio = recent && is_finite(slip.dots_ratio);
    slipping_ = loses_load || (recent && back) || (has_ratio && slip.dots_ratio < S(slip_ratio));
    if (slipping_) {
      friction_ = smooth_friction_ / (S(1) + options_.slip_margin);
      held_s_ = S(0);
      has_slipped_ = true;
    } else {
      // without a new ratio, L* does not grow, and stays within the limit less the margin
      search(has_ratio ? slip.dots_ratio : S(slip_ratio), counted_s);
      const S borne = slip.limit / (S(1) + options_.slip_margin);
      slipping_ = !has_ratio && borne < friction_;
      friction_ = slipping_ ? borne : friction_;
    }
    const S gained_n = S(0) < load_rate_n_per_s_ ? load_rate_n_per_s_ * options_.response_s : S(0);
    const S wanted_n = S(0) < friction_ ? (load_n_ + gained_n) / friction_ : force_n_;
    const S rate = (within_limits(wanted_n) - force_n_) / counted_s;
    return move((std::max)((std::min)(rate, options_.rise_limit_n_per_s),
                           S(0) - options_.fall_limit_n_per_s),
                options_.max_force_n, slipping_ ? GripReason::slipping : GripReason::follows_load,
                step_s);
  }

 private:
  static constexpr double half = 0.5, slip_ratio = 0.2;
  static constexpr double ratio_lasts_s = 0.1, blind_after_s = 0.2, lost_after_s = 0.5;
  static constexpr double longest_step_s =
      0.1;  ///< a longer time step moves the force as this does
  static constexpr double blind_rise_n_per_s = 5;
  /// Relative growth of L* per second before the first slip, and after it.
  static constexpr double first_search_per_s = 0.2, search_per_s = 0.04;

  static bool is_time(const S& step_s) { return is_finite(step_s) && S(0) < step_s; }

  /// Smooths load and friction over about four frames, because forces are noisier than loads are
  /// fast. While little sticks, a falling load may mean falling friction, so the load is assumed
  /// unchanged.
  void follow_load(const S& load_n, const S& friction, bool may_fall, const S& step_s) {
    if (!is_finite(friction_)) {
      friction_ = smooth_friction_ = friction;
      load_n_ = seen_load_n_ = load_n;
      return;
    }
    seen_load_n_ = seen_load_n_ + S(0.4) * (load_n - seen_load_n_);
    const S step_n = load_n < load_n_ && !may_fall ? S(0) : S(0.4) * (load_n - load_n_);
    load_n_ = load_n_ + step_n;
    load_rate_n_per_s_ = load_rate_n_per_s_ + S(0.3) * (step_n / step_s - load_rate_n_per_s_);
    smooth_friction_ = smooth_friction_ + S(0.4) * (friction - smooth_friction_);
  }

  /// Increases L* while the contact has stick to spare, once it carries the L* demanded so far.
  void search(const S& ratio, const S& step_s) {
    if (!(smooth_friction_ < S(0.95) * friction_)) {
      const S share = (std::min)((ratio - S(slip_ratio)) / S(0.3), S(1));
      const S per_s = S(has_slipped_ ? search_per_s : first_search_per_s);
      friction_ = friction_ * (S(1) + share * per_s * step_s);
    }
  }

  GripResult<S> move(const S& rate, const S& ceiling_n, GripReason why, const S& step_s) {
    const S wanted_n = force_n_ + rate * (std::min)(step_s, S(longest_step_s));
    const bool at_limit = (S(0) < rate && !(force_n_ < ceiling_n)) ||
                          (rate < S(0) && !(options_.min_force_n < force_n_));
    if (!at_limit) {
      force_n_ = (std::max)(options_.min_force_n,
                            S(0) < rate ? (std::min)(wanted_n, ceiling_n) : wanted_n);
    }
    return {force_n_, why, at_limit};
  }

  /// NaN becomes the smallest force.
  S within_limits(const S& force_n) const {
    return options_.min_force_n < force_n ? (std::min)(force_n, options_.max_force_n)
                                          : options_.min_force_n;
  }

  GripOptions<S> options_;
  S force_n_ = S(0);
  S ratio_age_s_ = S(0);   ///< since the last fresh ratio
  S unseen_s_ = S(0);      ///< since the dots were last seen
  S untouched_s_ = S(0);   ///< since the last contact
  bool slipping_ = false;  ///< the last fresh ratio was below the set point
  S friction_ = not_a_number<S>();
  S load_n_ = S(0);       ///< assumed load: F_t, smoothed; does not fall while little sticks
  S seen_load_n_ = S(0);  ///< carried load: F_t, smoothed
  S load_rate_n_per_s_ = S(0);
  S smooth_friction_ = S(0);  ///< L, smoothed
  S held_s_ = S(0);           ///< since the last slip
  bool has_slipped_ = false;
};

}  // namespace v1
}  // namespace fingerpad
