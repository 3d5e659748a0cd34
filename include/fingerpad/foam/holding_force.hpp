// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Finds the smallest force that holds an object whose weight and friction are unknown. Source:
// "Pre- Slip Sensing Using Tactile Sensor" (2007), its two experiments:
//
//   grasp-optimise-replace  the object hangs between the fingers; the grip is loosened step by step
//                           until pre-slip is found: this is the smallest force. To check, the
//                           paper goes on until the object slips as a whole, three to six steps
//                           later
//   grasp-lift-replace      the object stands on a surface and is lifted with little force; at
//                           pre-slip the lift pauses and the grip is tightened
//
// The caller moves the gripper as commanded, and passes the slip state of the fingers with each
// sample, from preslip.hpp or elsewhere. While the state is not known the command does not change.
#include <cstdint>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/foam/preslip_status.hpp"

namespace fingerpad {
inline namespace v0 {

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
/// Whether steps of this size cover `way` in at most a million steps.
template <scalar S>
bool divides(const S& step, const S& way) {
  return is_finite(step) && value(step) > 0 && value(way) <= value(S(S(1000000) * step));
}
}  // namespace detail

/// How the grip is loosened. The paper prints no values.
template <scalar S = double>
struct LoosenOptions {
  S first_force_n = S(10);      ///< initial grip force, > min_force_n
  S min_force_n = S(1) / S(2);  ///< smallest grip force, >= 0
  S step_n = S(1) / S(4);       ///< reduction of the force per step, > 0
  /// Samples to wait after each step, >= 0. With a window of the taxels or more, the step itself
  /// does not count as vibration.
  Index settle_samples = 16;
  Index watch_samples = 16;    ///< samples to watch after that, >= 1
  Index margin_steps = 2;      ///< steps to tighten again once pre-slip is found, in [0, 1000000]
  bool until_slipped = false;  ///< goes on after pre-slip, as the paper does to check
};

/// Refuses bad parameters (parameter_error).
template <scalar S>
void expects_valid(const LoosenOptions<S>& options) {
  const char* const owner = "LoosenOptions";
  expects(is_finite(options.min_force_n) && value(options.min_force_n) >= 0, owner, "min_force_n",
          options.min_force_n, "finite and >= 0");
  expects(
      is_finite(options.first_force_n) && value(options.first_force_n) > value(options.min_force_n),
      owner, "first_force_n", options.first_force_n, "finite and > min_force_n");
  expects(detail::divides(options.step_n, S(options.first_force_n - options.min_force_n)), owner,
          "step_n", options.step_n,
          "finite and > 0, in at most a million steps from first to least force");
  expects(options.settle_samples >= 0, owner, "settle_samples",
          static_cast<long long>(options.settle_samples), ">= 0");
  expects(options.watch_samples >= 1, owner, "watch_samples",
          static_cast<long long>(options.watch_samples), ">= 1");
  expects(options.margin_steps >= 0 && options.margin_steps <= 1000000, owner, "margin_steps",
          static_cast<long long>(options.margin_steps), "in [0, 1000000]");
}

/// Loosens the grip step by step until pre-slip. Const, O(1), allocates nothing. Ends after at most
/// (first - least) / step + 1 steps, not counting samples with an unknown state.
template <scalar S = double>
class LoosenUntilPreslip {
 public:
  /// A value: copy it to return to this sample later.
  class State {
   public:
    const HoldingCommand<S>& command() const { return command_; }

   private:
    friend class LoosenUntilPreslip;
    HoldingCommand<S> command_;
    Index samples_ = 0;  // in this phase
  };

  /// Refuses bad parameters (parameter_error).
  explicit LoosenUntilPreslip(const LoosenOptions<S>& options = {}) : options_(options) {
    expects_valid(options);
  }

  const LoosenOptions<S>& options() const { return options_; }

  State start() const {
    State state;
    state.command_.force_n = options_.first_force_n;
    return state;
  }

  /// The command after one more sample.
  HoldingCommand<S> operator()(PreslipStatus signal, State& state) const {
    HoldingCommand<S>& command = state.command_;
    if (is_end(command.phase) || signal == PreslipStatus::cannot_tell) {
      return command;
    }
    if (signal == PreslipStatus::slipped) {
      command.phase = SearchPhase::slipped;
      command.force_n = options_.first_force_n;
      return command;
    }
    ++state.samples_;
    if (command.phase == SearchPhase::settling) {
      if (state.samples_ > options_.settle_samples) {
        enter(SearchPhase::watching, state);
        watch(signal, state);
      }
    } else {
      watch(signal, state);
    }
    return command;
  }

 private:
  static void enter(SearchPhase phase, State& state) {
    state.command_.phase = phase;
    state.samples_ = phase == SearchPhase::watching ? 1 : 0;
  }

  void watch(PreslipStatus signal, State& state) const {
    HoldingCommand<S>& command = state.command_;
    const bool is_first = signal == PreslipStatus::preslip && !is_finite(command.preslip_force_n);
    if (is_first) {
      command.preslip_force_n = command.force_n;
      if (!options_.until_slipped) {
        const S margin = S(static_cast<int>(options_.margin_steps)) * options_.step_n;
        const S held = command.force_n + margin;
        command.force_n =
            value(held) < value(options_.first_force_n) ? held : options_.first_force_n;
        command.phase = SearchPhase::found;
        return;
      }
    }
    if (state.samples_ >= options_.watch_samples) {
      loosen(state);
    }
  }

  void loosen(State& state) const {
    HoldingCommand<S>& command = state.command_;
    if (!(value(options_.min_force_n) < value(command.force_n))) {
      command.phase = SearchPhase::at_limit;
      return;
    }
    ++command.steps;
    command.warning_steps += is_finite(command.preslip_force_n) ? 1 : 0;
    // computed from the first force, so that rounding does not accumulate
    const S taken = S(static_cast<int>(command.steps)) * options_.step_n;
    const S next = options_.first_force_n - taken;
    command.force_n = value(options_.min_force_n) < value(next) ? next : options_.min_force_n;
    enter(SearchPhase::settling, state);
  }

  LoosenOptions<S> options_;
};

/// How the object is lifted. The paper prints no values.
template <scalar S = double>
struct LiftOptions {
  S first_force_n = S(1);          ///< grip force before the lift, > 0
  S max_force_n = S(20);           ///< largest grip force, >= first_force_n
  S force_step_n = S(1) / S(2);    ///< increase of the force per tightening, > 0
  S height_mm = S(50);             ///< height to lift to, > 0
  S height_step_mm = S(1) / S(4);  ///< lift per sample without pre-slip, > 0
  Index settle_samples = 16;  ///< samples for which the lift pauses after each tightening, >= 0
};

/// Refuses bad parameters (parameter_error).
template <scalar S>
void expects_valid(const LiftOptions<S>& options) {
  const auto expect_positive = [](const S& x, const char* name) {
    expects(is_finite(x) && value(x) > 0, "LiftOptions", name, x, "finite and > 0");
  };
  expect_positive(options.first_force_n, "first_force_n");
  expects(
      is_finite(options.max_force_n) && value(options.max_force_n) >= value(options.first_force_n),
      "LiftOptions", "max_force_n", options.max_force_n, "finite and >= first_force_n");
  expect_positive(options.height_mm, "height_mm");
  expects(detail::divides(options.force_step_n, S(options.max_force_n - options.first_force_n)),
          "LiftOptions", "force_step_n", options.force_step_n,
          "finite and > 0, in at most a million steps from first to most force");
  expects(detail::divides(options.height_step_mm, options.height_mm), "LiftOptions",
          "height_step_mm", options.height_step_mm,
          "finite and > 0, in at most a million steps to the height");
  expects(options.settle_samples >= 0, "LiftOptions", "settle_samples",
          static_cast<long long>(options.settle_samples), ">= 0");
}

/// Lifts the object, and tightens the grip at pre-slip. Const, O(1), allocates nothing. It gives up
/// the lift if pre-slip is found at the largest force. If the object slips as a whole it gives up
/// at once and leaves the grip as it is.
template <scalar S = double>
class LiftWithRegrip {
 public:
  /// A value: copy it to return to this sample later.
  class State {
   public:
    const HoldingCommand<S>& command() const { return command_; }

   private:
    friend class LiftWithRegrip;
    HoldingCommand<S> command_;
    Index samples_ = 0;       // samples of settling
    Index height_steps_ = 0;  // steps lifted so far
  };

  /// Refuses bad parameters (parameter_error).
  explicit LiftWithRegrip(const LiftOptions<S>& options = {}) : options_(options) {
    expects_valid(options);
  }

  const LiftOptions<S>& options() const { return options_; }

  State start() const {
    State state;
    state.command_.force_n = options_.first_force_n;
    state.command_.phase = SearchPhase::watching;
    return state;
  }

  /// The command after one more sample.
  HoldingCommand<S> operator()(PreslipStatus signal, State& state) const {
    HoldingCommand<S>& command = state.command_;
    if (is_end(command.phase) || signal == PreslipStatus::cannot_tell) {
      return command;
    }
    if (signal == PreslipStatus::slipped) {
      give_up(SearchPhase::slipped, command);
    } else if (command.phase == SearchPhase::settling &&
               ++state.samples_ <= options_.settle_samples) {
      return command;
    } else if (signal == PreslipStatus::preslip) {
      tighten(state);
    } else {
      lift(state);
    }
    return command;
  }

 private:
  static void give_up(SearchPhase phase, HoldingCommand<S>& command) {
    command.phase = phase;
    command.height_mm = S(0);
  }

  void tighten(State& state) const {
    HoldingCommand<S>& command = state.command_;
    if (!(value(command.force_n) < value(options_.max_force_n))) {
      give_up(SearchPhase::at_limit, command);
      return;
    }
    ++command.steps;
    const S added = S(static_cast<int>(command.steps)) * options_.force_step_n;
    const S next = options_.first_force_n + added;
    command.force_n = value(next) < value(options_.max_force_n) ? next : options_.max_force_n;
    command.phase = SearchPhase::settling;
    state.samples_ = 0;
  }

  void lift(State& state) const {
    HoldingCommand<S>& command = state.command_;
    ++state.height_steps_;
    const S next = S(static_cast<int>(state.height_steps_)) * options_.height_step_mm;
    const bool is_up = !(value(next) < value(options_.height_mm));
    command.height_mm = is_up ? options_.height_mm : next;
    command.phase = is_up ? SearchPhase::lifted : SearchPhase::watching;
  }

  LiftOptions<S> options_;
};

}  // namespace v0
}  // namespace fingerpad
