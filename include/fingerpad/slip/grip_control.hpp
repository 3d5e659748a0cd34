// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Controls the grip force by the stick ratio, so that an object of unknown weight and friction does
// not slip. Idea: Watanabe, Obinata, "Grip Force Control Using Vision-Based Tactile Sensor for
// Dexterous Handling" (2008), as summarized by the paper on slippage ("Definition of stick ratio"):
// the slippage degree is fed back proportionally. While everything sticks the force is not
// increased. At incipient slip it is increased before the object slips as a whole.
//
//   dF/dt = raise_gain (set_point - ratio)      ratio < set_point
//         = -lower_gain (ratio - lower_above)   ratio > lower_above; lower_gain is 0 by default
//         = 0                                   in between
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
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/slip/grip_law.hpp"

namespace fingerpad {
inline namespace v0 {

/// Grip force, call by call. One object serves any number of fingers, each with its own state. A
/// call is O(1), allocates nothing, throws nothing, and reacts to slip at once. With the ratio
/// alone, and the same state, update and time step, a smaller ratio never gives a smaller force.
template <scalar S = double>
class GripControl {
 public:
  /// A value: copy it to return to this call later.
  class State {
   public:
    const S& force_n() const { return force_n_; }
    /// L*, the friction demanded of the contact; NaN if the tangential force was never known.
    const S& friction() const { return friction_; }
    /// Sets the force from which the next call continues. Use it if the gripper does not follow the
    /// commands and its force is measured. Ignored if not finite.
    void follow(const S& measured_n) { force_n_ = is_finite(measured_n) ? measured_n : force_n_; }
    /// Returns to the state after start().
    void reset() { *this = State(start_n_); }

   private:
    friend class GripControl;
    explicit State(const S& force_n) : start_n_(force_n), force_n_(force_n) {}

    S start_n_;
    S force_n_;
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

  /// Refuses bad parameters (parameter_error).
  explicit GripControl(const GripLaw<S>& law = {}) : law_(law) { expects_valid(law); }

  const GripLaw<S>& law() const { return law_; }

  State start() const { return State(law_.min_force_n); }
  /// Starts from the force with which the object was grasped, clamped to the limits; NaN: the
  /// smallest.
  State start(const S& force_n) const { return State(within_limits(force_n)); }

  /// The force for a stick ratio. `step_s` is the time since the last call.
  GripResult<S> operator()(const StickReading<S>& seen, const S& step_s, State& state) const {
    state.force_n_ = within_limits(state.force_n_);
    if (!is_time(step_s)) {
      return {state.force_n_, GripStatus::holding, GripReason::no_time};
    }
    const RateCommand command = command_for(seen.ratio, seen.update, step_s, state);
    return apply(command, counted(step_s), state);
  }

  /// The same for a result of SpatialStickRatio or StickRatio.
  template <class Stick>
    requires requires(const Stick& seen) {
      seen.stick_ratio;
      update_of(seen.status);
    }
  GripResult<S> operator()(const Stick& seen, const S& step_s, State& state) const {
    return (*this)(StickReading<S>{S(seen.stick_ratio), update_of(seen.status)}, step_s, state);
  }

  /// The same for a SlipResult, the answer of dots and friction together. If it has the tangential
  /// force and the dots are seen, the force follows the load.
  template <class Slip>
    requires requires(const Slip& slip) {
      slip.stick_ratio;
      slip.update;
      slip.normal_n;
      slip.limit;
    }
  GripResult<S> operator()(const Slip& slip, const S& step_s, State& state) const {
    const S share = is_finite(slip.dots_ratio) ? S(slip.dots_ratio) : S(slip.stick_ratio);
    const bool sticks = !(value(share) < value(law_.sliding_ratio));
    // Dots fall back with an object whose load falls, or because an object slides under friction
    // that has fallen. A contact that is unloaded keeps (1/2)^(2/3) of its area stuck (Mindlin and
    // Deresiewicz 1953), so it slides if less than half sticks.
    const bool back = falls_back(slip) && !sticks;
    const bool seen =
        slip.update == RatioUpdate::fresh || slip.update == RatioUpdate::unmoved || back;
    const bool is_ratio = is_finite(slip.stick_ratio) || slip.update == RatioUpdate::unmoved;
    if (!is_time(step_s) || !seen || !is_ratio || !is_finite(slip.friction)) {
      return (*this)(StickReading<S>{S(slip.stick_ratio), slip.update}, step_s, state);
    }
    state.force_n_ = within_limits(state.force_n_);
    state.untouched_s_ = state.unseen_s_ = state.ratio_age_s_ = S(0);
    const S counted_s = counted(step_s);
    follow_load(S(slip.normal_n * slip.friction), S(slip.friction), sticks, counted_s, state);
    // a tenth exceeds the noise of a smoothed load, for forces known to 3 %
    const bool loses_load = !sticks && state.seen_load_n_ < S(9) / S(10) * state.load_n_;
    // a ratio whose reference is older than the last slip shows that slip again
    const S age_s = S(static_cast<double>(slip.reference_age)) * step_s;
    state.held_s_ = S(state.held_s_ + step_s);
    const bool recent = !state.has_slipped_ || value(age_s) < value(state.held_s_);
    const bool news = recent && is_finite(slip.dots_ratio);
    state.slipping_ =
        loses_load || (recent && back) || (news && value(slip.dots_ratio) < value(law_.slip_ratio));
    if (state.slipping_) {
      state.friction_ = state.smooth_friction_ / S(S(1) + law_.slip_margin);
      state.held_s_ = S(0);
      state.has_slipped_ = true;
    } else {
      search(news ? S(slip.dots_ratio) : not_a_number<S>(), counted_s, state);
      // without a new ratio, L* stays within the limit less the margin
      const S borne = S(slip.limit) / S(S(1) + law_.slip_margin);
      state.slipping_ = !news && borne < state.friction_;
      state.friction_ = state.slipping_ ? borne : state.friction_;
    }
    return apply(rate_to_load(counted_s, state), counted_s, state);
  }

 private:
  struct RateCommand {
    S rate_n_per_s;
    S ceiling_n;
    GripReason why;
  };

  template <class Slip>
  static bool falls_back(const Slip& slip) {
    if constexpr (requires { slip.falls_back; }) {
      return slip.falls_back;
    } else {
      return false;
    }
  }

  static bool is_time(const S& step_s) { return is_finite(step_s) && value(step_s) > 0; }
  S counted(const S& step_s) const {
    return value(law_.longest_step_s) < value(step_s) ? law_.longest_step_s : step_s;
  }

  /// Smooths load and friction over about four frames, because forces are noisier than loads are
  /// fast. While little sticks, a falling load may mean falling friction, so the load is assumed
  /// unchanged.
  static void follow_load(
      const S& load_n, const S& friction, bool may_fall, const S& step_s, State& state) {
    if (!is_finite(state.friction_)) {
      state.friction_ = state.smooth_friction_ = friction;
      state.load_n_ = state.seen_load_n_ = load_n;
      return;
    }
    state.seen_load_n_ = state.seen_load_n_ + S(4) / S(10) * S(load_n - state.seen_load_n_);
    const bool falls = load_n < state.load_n_;
    const S step_n = falls && !may_fall ? S(0) : S(S(4) / S(10) * S(load_n - state.load_n_));
    state.load_n_ = state.load_n_ + step_n;
    state.load_rate_n_per_s_ =
        state.load_rate_n_per_s_ + S(3) / S(10) * S(step_n / step_s - state.load_rate_n_per_s_);
    state.smooth_friction_ =
        state.smooth_friction_ + S(4) / S(10) * S(friction - state.smooth_friction_);
  }

  /// Increases L* while the contact has stick to spare, once it carries the L* demanded so far.
  void search(const S& ratio, const S& step_s, State& state) const {
    if (20 * value(state.smooth_friction_) < 19 * value(state.friction_)) {
      return;
    }
    const S spare = S(10) / S(3) * S(ratio - law_.slip_ratio);
    const S share = value(spare) < 1 ? spare : S(1);
    const S per_s = state.has_slipped_ ? law_.search_per_s : law_.first_search_per_s;
    const S growth = is_finite(ratio) ? S(share * per_s) : S(0);
    state.friction_ = state.friction_ * S(S(1) + growth * step_s);
  }

  /// The rate that brings the force to F_t / L* in this step, within the limits of the gripper.
  RateCommand rate_to_load(const S& step_s, const State& state) const {
    const S gained_n =
        value(state.load_rate_n_per_s_) > 0 ? S(state.load_rate_n_per_s_ * law_.response_s) : S(0);
    const bool some = value(state.friction_) > 0;
    const S wanted = some ? S(S(state.load_n_ + gained_n) / state.friction_) : state.force_n_;
    const S rate = S(within_limits(wanted) - state.force_n_) / step_s;
    const S top = law_.rise_limit_n_per_s, bottom = S(-law_.fall_limit_n_per_s);
    return {value(top) < value(rate)      ? top
            : value(rate) < value(bottom) ? bottom
                                          : rate,
            law_.max_force_n, state.slipping_ ? GripReason::slipping : GripReason::follows_load};
  }

  RateCommand command_for(const S& ratio, RatioUpdate update, const S& step_s, State& state) const {
    const bool known = value(ratio) >= 0 && value(ratio) <= 1;
    if (update == RatioUpdate::no_contact) {
      return without_contact(step_s, state);
    }
    state.untouched_s_ = S(0);
    const bool none_yet = update == RatioUpdate::unmoved && !(value(ratio) == value(ratio));
    if (update == RatioUpdate::missing || !(known || none_yet)) {
      return without_ratio(step_s, state);
    }
    state.unseen_s_ = S(0);
    return update == RatioUpdate::fresh ? by_fresh(ratio, state)
                                        : by_standing(ratio, known, step_s, state);
  }

  RateCommand by_fresh(const S& ratio, State& state) const {
    state.slipping_ = value(ratio) < value(law_.set_point);
    state.ratio_age_s_ = S(0);
    const GripReason why = state.slipping_                          ? GripReason::slipping
                           : value(ratio) > value(law_.lower_above) ? GripReason::all_sticks
                                                                    : GripReason::enough_sticks;
    return {grip_rate(law_, ratio), law_.max_force_n, why};
  }

  /// Raises or holds: dots at rest are no reason to loosen the grip.
  RateCommand by_standing(const S& ratio, bool known, const S& step_s, State& state) const {
    state.ratio_age_s_ = S(state.ratio_age_s_ + step_s);
    if (known && value(ratio) < value(law_.set_point)) {
      if (!(value(law_.ratio_lasts_s) < value(state.ratio_age_s_))) {
        return {grip_rate(law_, ratio), law_.safe_force_n, GripReason::slipping};
      }
      if (value(ratio) <= value(law_.sliding_ratio)) {
        return {grip_rate(law_, ratio), law_.safe_force_n, GripReason::may_slide};
      }
    }
    return {S(0), law_.safe_force_n, GripReason::unmoved};
  }

  /// Treats a short loss of contact like a missing ratio; after a long one there is no object.
  RateCommand without_contact(const S& step_s, State& state) const {
    state.untouched_s_ = S(state.untouched_s_ + step_s);
    const RateCommand command = without_ratio(step_s, state);
    const bool lost = value(law_.lost_after_s) < value(state.untouched_s_);
    return lost ? RateCommand{S(0), law_.safe_force_n, GripReason::lost} : command;
  }

  RateCommand without_ratio(const S& step_s, State& state) const {
    state.unseen_s_ = S(state.unseen_s_ + step_s);
    if (!state.slipping_ && !(value(law_.blind_after_s) < value(state.unseen_s_))) {
      return {S(0), law_.safe_force_n, GripReason::waiting};
    }
    const bool fast = value(law_.rise_limit_n_per_s) < value(law_.blind_rise_n_per_s);
    return {fast ? law_.rise_limit_n_per_s : law_.blind_rise_n_per_s, law_.safe_force_n,
            GripReason::blind};
  }

  GripResult<S> apply(const RateCommand& command, const S& step_s, State& state) const {
    const S force = state.force_n_;
    const bool rise = value(command.rate_n_per_s) > 0;
    const bool fall = value(command.rate_n_per_s) < 0;
    const bool at_limit = (rise && !(value(force) < value(command.ceiling_n))) ||
                          (fall && !(value(law_.min_force_n) < value(force)));
    if (at_limit || !(rise || fall)) {
      return {force, at_limit ? GripStatus::at_limit : GripStatus::holding, command.why};
    }
    const S wanted = force + S(command.rate_n_per_s * step_s);
    state.force_n_ = value(command.ceiling_n) < value(wanted) && rise ? command.ceiling_n
                                                                      : within_limits(wanted);
    return {state.force_n_, rise ? GripStatus::raising : GripStatus::lowering, command.why};
  }

  /// NaN becomes the smallest force.
  S within_limits(const S& force_n) const {
    const S raised = value(force_n) > value(law_.min_force_n) ? force_n : law_.min_force_n;
    return value(raised) < value(law_.max_force_n) ? raised : law_.max_force_n;
  }

  GripLaw<S> law_;
};

}  // namespace v0
}  // namespace fingerpad
