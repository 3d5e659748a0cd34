// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Finds the smallest force that holds an object whose weight and friction are unknown. Source:
// "Pre- Slip Sensing Using Tactile Sensor" (2007), its two experiments:
//
//   grasp-optimise-replace  the grip is loosened step by step until pre-slip: the smallest force
//   grasp-lift-replace      the object is lifted with little force; at pre-slip the lift pauses and
//                           the grip is tightened
//
// The caller moves the gripper as commanded, and passes the slip state of the fingers with each
// sample, from preslip.hpp or elsewhere. While the state is not known the command does not change.
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/foam/preslip.hpp"

namespace fingerpad {
inline namespace v1 {

enum class SearchPhase : std::uint8_t {
  settling,  ///< the vibration of the last command decays: only `slipped` is acted on
  watching,  ///< waits for pre-slip
  found,     ///< loosening: the smallest force is known. Final
  lifted,    ///< lifting: at the full height. Final
  at_limit,  ///< the force cannot be lowered or raised further. Final
  slipped,   ///< the object slipped as a whole. Final
};

/// "settling", "watching", ...
constexpr const char* name_of(SearchPhase phase) {
  constexpr std::array<const char*, 6> names = {"settling", "watching", "found",
                                                "lifted",   "at limit", "slipped"};
  const auto k = static_cast<std::size_t>(phase);
  return k < names.size() ? names[k] : "unknown";
}

/// Whether the phase is final: the command no longer changes.
constexpr bool is_end(SearchPhase phase) {
  return phase != SearchPhase::settling && phase != SearchPhase::watching;
}

/// What to do from now on, within the limits of the options.
template <scalar S = double>
struct [[nodiscard]] HoldingCommand {
  S force_n = S(0);    ///< grip force
  S height_mm = S(0);  ///< height to lift to; 0 while loosening, and after the lift is given up
  SearchPhase phase = SearchPhase::settling;
  Index steps = 0;  ///< number of times that the grip was loosened or tightened
  S preslip_force_n = not_a_number<S>();  ///< loosening: force at which pre-slip was first found
  Index warning_steps = 0;                ///< steps of loosening since then
};

namespace detail {
/// The range of a step that covers the way from `from` to `to` in at most a million steps.
template <scalar S>
Range step_range(const S& from, const S& to) {
  return {.min = static_cast<double>(value(to - from)) / 1e6, .above_min = true};
}
/// from + steps step, but not beyond `end`; without the rounding of a sum of steps.
template <scalar S>
S stepped(const S& from, Index steps, const S& step, const S& end) {
  const S at = from + S(static_cast<int>(steps)) * step;
  const bool is_beyond = S(0) < step ? end < at : at < end;
  return is_beyond ? end : at;
}
}  // namespace detail

/// How the grip is loosened. The paper prints no values.
template <scalar S = double>
struct LoosenOptions {
  S first_force_n = S(10);  ///< initial grip force, > min_force_n
  S min_force_n = S(0.5);   ///< smallest grip force, >= 0
  /// Reduction of the force per step, > 0, in at most a million steps to the smallest force.
  S step_n = S(0.25);
  /// Samples to wait after each step, >= 0. With a window of the taxels or more, the step itself
  /// does not count as vibration.
  Index settle_samples = 16;
  Index watch_samples = 16;    ///< samples to watch after that, >= 1
  Index margin_steps = 2;      ///< steps to tighten again once pre-slip is found, in [0, 1000000]
  bool until_slipped = false;  ///< goes on after pre-slip, as the paper does to check
};

/// Says which option has no meaning; "" if all have one.
template <scalar S>
std::string check(const LoosenOptions<S>& o) {
  const double min_n = static_cast<double>(value(o.min_force_n));
  return check("LoosenOptions",
               {{"min_force_n", o.min_force_n, not_negative},
                {"first_force_n", o.first_force_n, {.min = min_n, .above_min = true}},
                {"step_n", o.step_n, detail::step_range(o.min_force_n, o.first_force_n)},
                {"settle_samples", o.settle_samples, not_negative},
                {"watch_samples", o.watch_samples, at_least(1)},
                {"margin_steps", o.margin_steps, within(0, 1e6)}});
}

/// Loosens the grip step by step until pre-slip. A value: copy it to return to this sample later.
/// O(1), allocates nothing. Ends after at most (first - least) / step + 1 steps, not counting
/// samples with an unknown state.
template <scalar S = double>
class LoosenUntilPreslip {
 public:
  /// Refuses bad parameters (parameter_error).
  explicit LoosenUntilPreslip(const LoosenOptions<S>& options = {}) : options_(options) {
    require(options);
    command_.force_n = options.first_force_n;
  }

  const HoldingCommand<S>& command() const { return command_; }

  /// The command after one more sample.
  HoldingCommand<S> operator()(PreslipStatus signal) {
    if (is_end(command_.phase) || signal == PreslipStatus::cannot_tell) {
      return command_;
    }
    if (signal == PreslipStatus::slipped) {
      command_.phase = SearchPhase::slipped;
      command_.force_n = options_.first_force_n;
    } else if (++samples_ > options_.settle_samples) {
      command_.phase = SearchPhase::watching;
      watch(signal);
    }
    return command_;
  }

 private:
  void watch(PreslipStatus signal) {
    if (signal == PreslipStatus::preslip && !is_finite(command_.preslip_force_n)) {
      command_.preslip_force_n = command_.force_n;
      if (!options_.until_slipped) {
        command_.force_n = detail::stepped(command_.force_n, options_.margin_steps, options_.step_n,
                                           options_.first_force_n);
        command_.phase = SearchPhase::found;
        return;
      }
    }
    if (samples_ < options_.settle_samples + options_.watch_samples) {
      return;
    }
    if (!(options_.min_force_n < command_.force_n)) {
      command_.phase = SearchPhase::at_limit;
      return;
    }
    ++command_.steps;
    command_.warning_steps += is_finite(command_.preslip_force_n) ? 1 : 0;
    command_.force_n = detail::stepped(options_.first_force_n, command_.steps, -options_.step_n,
                                       options_.min_force_n);
    command_.phase = SearchPhase::settling;
    samples_ = 0;
  }

  LoosenOptions<S> options_;
  HoldingCommand<S> command_;
  Index samples_ = 0;  // since the last step
};

/// How the object is lifted. The paper prints no values.
template <scalar S = double>
struct LiftOptions {
  S first_force_n = S(1);  ///< grip force before the lift, > 0
  S max_force_n = S(20);   ///< largest grip force, >= first_force_n
  /// Increase of the force per tightening, > 0, in at most a million steps to the largest force.
  S force_step_n = S(0.5);
  S height_mm = S(50);  ///< height to lift to, > 0
  /// Lift per sample without pre-slip, > 0, in at most a million steps to the height.
  S height_step_mm = S(0.25);
  Index settle_samples = 16;  ///< samples for which the lift pauses after each tightening, >= 0
};

/// Says which option has no meaning; "" if all have one.
template <scalar S>
std::string check(const LiftOptions<S>& o) {
  const double first_n = static_cast<double>(value(o.first_force_n));
  return check(
      "LiftOptions",
      {{"first_force_n", o.first_force_n, positive},
       {"max_force_n", o.max_force_n, at_least(first_n)},
       {"force_step_n", o.force_step_n, detail::step_range(o.first_force_n, o.max_force_n)},
       {"height_mm", o.height_mm, positive},
       {"height_step_mm", o.height_step_mm, detail::step_range(S(0), o.height_mm)},
       {"settle_samples", o.settle_samples, not_negative}});
}

/// Lifts the object, and tightens the grip at pre-slip. A value: copy it to return to this sample
/// later. O(1), allocates nothing. It gives up the lift if pre-slip is found at the largest force.
/// If the object slips as a whole it gives up at once and leaves the grip as it is.
template <scalar S = double>
class LiftWithRegrip {
 public:
  /// Refuses bad parameters (parameter_error).
  explicit LiftWithRegrip(const LiftOptions<S>& options = {})
      : options_(options), samples_(options.settle_samples) {
    require(options);
    command_.force_n = options.first_force_n;
    command_.phase = SearchPhase::watching;
  }

  const HoldingCommand<S>& command() const { return command_; }

  /// The command after one more sample.
  HoldingCommand<S> operator()(PreslipStatus signal) {
    if (is_end(command_.phase) || signal == PreslipStatus::cannot_tell) {
      return command_;
    }
    if (signal == PreslipStatus::slipped) {
      give_up(SearchPhase::slipped);
    } else if (++samples_ > options_.settle_samples) {
      signal == PreslipStatus::preslip ? tighten() : lift();
    }
    return command_;
  }

 private:
  void give_up(SearchPhase phase) {
    command_.phase = phase;
    command_.height_mm = S(0);
  }

  void tighten() {
    if (!(command_.force_n < options_.max_force_n)) {
      give_up(SearchPhase::at_limit);
      return;
    }
    command_.force_n = detail::stepped(options_.first_force_n, ++command_.steps,
                                       options_.force_step_n, options_.max_force_n);
    command_.phase = SearchPhase::settling;
    samples_ = 0;
  }

  void lift() {
    command_.height_mm =
        detail::stepped(S(0), ++height_steps_, options_.height_step_mm, options_.height_mm);
    const bool is_up = !(command_.height_mm < options_.height_mm);
    command_.phase = is_up ? SearchPhase::lifted : SearchPhase::watching;
  }

  LiftOptions<S> options_;
  HoldingCommand<S> command_;
  Index samples_;           // since the last tightening
  Index height_steps_ = 0;  // steps lifted so far
};

}  // namespace v1
}  // namespace fingerpad
