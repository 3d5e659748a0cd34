// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The mass-spring-damper model of the contact (paper, eqs. 3-8), in closed form and step by step:
//
//   m y'' + c (y' - y_ie') + k (y - y_ie) = f(t)
//
// The paper uses m = c = k = 1. Units: mm, N, s, so that masses are in N s^2/mm = 1000 kg. Float is
// computed in double and double in long double. Without damping, a motion is as accurate as the
// phase sqrt(k/m) t in that type.
#include <cmath>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/sim/detail/oscillation.hpp"

namespace fingerpad {
inline namespace v0 {

/// A mass on a spring and a dashpot, with the values of the paper.
template <scalar S = double>
struct MassSpringDamper {
  S mass_n_s2_per_mm = S(1);    ///< m > 0; 0.001 is 1 kg
  S damping_n_s_per_mm = S(1);  ///< c >= 0
  S stiffness_n_per_mm = S(1);  ///< k > 0: without a spring there is no rest position

  /// Motion of the mass at one time.
  struct Motion {
    S position_mm = S(0);
    S velocity_mm_per_s = S(0);
  };
};

/// Refuses values out of range (parameter_error).
template <scalar S>
void expects_valid(const MassSpringDamper<S>& oscillator) {
  const auto check = [](bool good, const char* name, const S& given, const char* range) {
    expects(good && is_finite(given), "MassSpringDamper", name, given, range);
  };
  check(value(oscillator.mass_n_s2_per_mm) > 0, "mass_n_s2_per_mm", oscillator.mass_n_s2_per_mm,
        "finite and > 0");
  check(value(oscillator.damping_n_s_per_mm) >= 0, "damping_n_s_per_mm",
        oscillator.damping_n_s_per_mm, "finite and >= 0");
  check(value(oscillator.stiffness_n_per_mm) > 0, "stiffness_n_per_mm",
        oscillator.stiffness_n_per_mm, "finite and > 0");
}

/// f(t) = A + B t, the load of eq. 8.
template <scalar S = double>
struct RampLoad {
  S start_n = S(0);       ///< A
  S rise_n_per_s = S(0);  ///< B

  S operator()(const S& time_s) const { return S(start_n + S(rise_n_per_s * time_s)); }
};

/// The load that a moving frame at y_ie with the speed y_ie' adds: c y_ie' + k y_ie.
template <scalar S>
S frame_load(const MassSpringDamper<S>& oscillator,
             const typename MassSpringDamper<S>::Motion& frame) {
  return S(S(oscillator.damping_n_s_per_mm * frame.velocity_mm_per_s) +
           S(oscillator.stiffness_n_per_mm * frame.position_mm));
}

/// m y'' + c y' + k y - f in N: 0 for every solution.
template <scalar S>
S residual(const MassSpringDamper<S>& oscillator,
           const typename MassSpringDamper<S>::Motion& motion,
           const S& acceleration_mm_per_s2,
           const S& load_n) {
  const S inertia = oscillator.mass_n_s2_per_mm * acceleration_mm_per_s2;
  return S(S(inertia + frame_load(oscillator, motion)) - load_n);
}

/// y_p of the ramp load: (B/k) t + A/k - c B/k^2 (E039).
template <scalar S>
typename MassSpringDamper<S>::Motion particular_solution(const MassSpringDamper<S>& oscillator,
                                                         const RampLoad<S>& load,
                                                         const S& time_s) {
  const S speed = load.rise_n_per_s / oscillator.stiffness_n_per_mm;
  const S drag = oscillator.damping_n_s_per_mm * speed;
  return {S(S(S(load.start_n - drag) / oscillator.stiffness_n_per_mm) + S(speed * time_s)), speed};
}

/// The particular solution as printed in eq. 9, for m = c = k = 1: A (t - 1) + B, with A and B
/// exchanged. Its residual is (A - B) (t - 1).
template <scalar S>
typename MassSpringDamper<S>::Motion printed_particular_solution(const RampLoad<S>& load,
                                                                 const S& time_s) {
  return {S(S(load.start_n * S(time_s - S(1))) + load.rise_n_per_s), load.start_n};
}

/// y_c: the free motion at a time after `start`. Exact for any damping; NaN for a time that is
/// negative or not finite.
template <scalar S>
typename MassSpringDamper<S>::Motion free_motion(const MassSpringDamper<S>& oscillator,
                                                 const typename MassSpringDamper<S>::Motion& start,
                                                 const S& time_s) {
  using R = detail::foam::wide_t<S>;
  const detail::foam::MassSpringDamperRates<S> rates(
      oscillator.mass_n_s2_per_mm, oscillator.damping_n_s_per_mm, oscillator.stiffness_n_per_mm);
  const detail::foam::FreeWave<R> wave = detail::foam::free_wave(rates, time_s);
  const R decay = R(rates.decay), natural_sq = R(rates.natural_sq);
  const R y = R(start.position_mm), v = R(start.velocity_mm_per_s);
  const R damped = decay * wave.lag;
  const R position = R(R(wave.wave + damped) * y) + R(wave.lag * v);
  const R velocity = R(R(wave.wave - damped) * v) - R(R(natural_sq * wave.lag) * y);
  return {S(position), S(velocity)};
}

/// The full solution y = y_c + y_p of eq. 8 for the ramp load, from any start. For a start at rest
/// and times far below a period the two parts nearly cancel; FirstOrderHold does not lose digits
/// there.
template <scalar S>
typename MassSpringDamper<S>::Motion ramp_response(
    const MassSpringDamper<S>& oscillator,
    const RampLoad<S>& load,
    const typename MassSpringDamper<S>::Motion& start,
    const S& time_s) {
  const auto at_start = particular_solution(oscillator, load, S(0));
  const auto forced = particular_solution(oscillator, load, time_s);
  const typename MassSpringDamper<S>::Motion difference{
      S(start.position_mm - at_start.position_mm),
      S(start.velocity_mm_per_s - at_start.velocity_mm_per_s)};
  const auto left = free_motion(oscillator, difference, time_s);
  return {S(forced.position_mm + left.position_mm),
          S(forced.velocity_mm_per_s + left.velocity_mm_per_s)};
}

/// Moves the oscillator step by step, exactly if the load is linear within a step, for any damping
/// and step length. Const: one object serves any number of oscillators, each with its own state.
/// O(1), no heap allocation.
template <scalar S = double>
class FirstOrderHold {
  using W = detail::foam::wide_t<S>;
  using Motion = typename MassSpringDamper<S>::Motion;

 public:
  /// A value: copy it to go back to this sample later.
  class State {
   public:
    Motion motion() const { return {S(position_), S(velocity_)}; }

   private:
    friend class FirstOrderHold;
    explicit State(const Motion& motion)
        : position_(W(motion.position_mm)), velocity_(W(motion.velocity_mm_per_s)) {}

    W position_;
    W velocity_;
  };

  /// For samples `step_s` apart. Refuses bad parameters (parameter_error), and a step so long that
  /// the oscillator still swings but no digits of its phase are left: some 10^12 periods.
  FirstOrderHold(const MassSpringDamper<S>& oscillator, const S& step_s)
      : oscillator_(checked(oscillator)),
        rates_(oscillator.mass_n_s2_per_mm,
               oscillator.damping_n_s_per_mm,
               oscillator.stiffness_n_per_mm) {
    const bool forward = is_finite(step_s) && value(step_s) > 0;
    expects(forward && coefficients(step_s, of_step_), "FirstOrderHold", "step_s", step_s,
            "finite, > 0 and within the digits of the phase");
  }

  const MassSpringDamper<S>& oscillator() const { return oscillator_; }
  State start(const Motion& motion = {}) const { return State(motion); }

  /// Returns the motion at the end of a step, from the load at its start and end in N. The load may
  /// jump between two steps. A load that is not finite gives NaN and leaves the state unchanged.
  Motion operator()(const S& before_n, const S& after_n, State& state) const {
    return advance(of_step_, before_n, after_n, state);
  }

  /// A step of another length, for example of a clock that jitters; its coefficients are
  /// recomputed. A step that the constructor would refuse gives NaN and leaves the state unchanged.
  Motion operator()(const S& before_n, const S& after_n, const S& step_s, State& state) const {
    Coefficients by;
    if (!is_finite(step_s) || !(value(step_s) > 0) || !coefficients(step_s, by)) {
      return no_motion();
    }
    return advance(by, before_n, after_n, state);
  }

 private:
  /// The coefficients of y = (kept + y_by_y) y + y_by_v v + y_by_before before + y_by_after after,
  /// and of v likewise. `kept` is 1 for short steps and 0 for long ones.
  struct Coefficients {
    W kept = W(0);  ///< 1 or 0
    W y_by_y = W(0), y_by_v = W(0), y_by_before = W(0), y_by_after = W(0);
    W v_by_y = W(0), v_by_v = W(0), v_by_before = W(0), v_by_after = W(0);
  };

  static const MassSpringDamper<S>& checked(const MassSpringDamper<S>& oscillator) {
    expects_valid(oscillator);
    return oscillator;
  }
  static Motion no_motion() { return {not_a_number<S>(), not_a_number<S>()}; }

  /// Returns false if the phase is lost or a coefficient is not finite.
  bool coefficients(const S& step_s, Coefficients& to) const {
    const detail::foam::StepAnswers<W> a = detail::foam::step_answers(rates_, step_s);
    const W damped = rates_.decay * a.lag;
    const W lost = rates_.natural_sq * a.raised;  // of a start at position 1
    const W slowed = lost + W(damped + damped);
    const bool short_step = value(slowed) < scalar_real_t<W>(1) / scalar_real_t<W>(2);
    const W mass = W(oscillator_.mass_n_s2_per_mm);
    const W y_by_after = W(a.ramped / a.step) / mass;
    const W v_by_after = W(a.raised / a.step) / mass;
    to.kept = W(short_step ? 1 : 0);
    to.y_by_y = W(short_step ? W(-lost) : W(a.wave + damped));
    to.y_by_v = a.lag;
    to.y_by_before = W(W(a.raised / mass) - y_by_after);
    to.y_by_after = y_by_after;
    to.v_by_y = W(-W(rates_.natural_sq * a.lag));
    to.v_by_v = W(short_step ? W(-slowed) : W(a.wave - damped));
    to.v_by_before = W(W(a.lag / mass) - v_by_after);
    to.v_by_after = v_by_after;
    return detail::foam::knows_phase(rates_, step_s) && is_finite(a.ramped) &&
           is_finite(to.v_by_before);
  }

  Motion advance(const Coefficients& by, const S& before_n, const S& after_n, State& state) const {
    if (!is_finite(before_n) || !is_finite(after_n)) {
      return no_motion();
    }
    const W before = W(before_n), after = W(after_n);
    const W y = state.position_, v = state.velocity_;
    const W y_loaded = W(by.y_by_before * before) + W(by.y_by_after * after);
    const W v_loaded = W(by.v_by_before * before) + W(by.v_by_after * after);
    const W y_change = W(W(by.y_by_y * y) + W(by.y_by_v * v)) + y_loaded;
    const W v_change = W(W(by.v_by_y * y) + W(by.v_by_v * v)) + v_loaded;
    state.position_ = W(by.kept * y) + y_change;
    state.velocity_ = W(by.kept * v) + v_change;
    return state.motion();
  }

  MassSpringDamper<S> oscillator_;
  detail::foam::MassSpringDamperRates<S> rates_;
  Coefficients of_step_;
};

/// y_p of any load, by the causal integral of eq. 10: (1/m) Int_0^t lag(t - u) f(u) du, where `lag`
/// is the oscillator's impulse response (2/sqrt(3) e^(-t/2) sin(sqrt(3)/2 t) for m = c = k = 1).
/// The load is taken as linear between `steps` + 1 samples, so that the error falls with the square
/// of the step. NaN for a time that is negative or not finite, and for steps <= 0.
template <scalar S, class Load>
typename MassSpringDamper<S>::Motion causal_response(const MassSpringDamper<S>& oscillator,
                                                     const Load& load,
                                                     const S& time_s,
                                                     int steps) {
  if (value(time_s) == 0 && steps > 0) {
    return {};
  }
  if (!(value(time_s) > 0) || !is_finite(time_s) || steps <= 0) {
    return {not_a_number<S>(), not_a_number<S>()};
  }
  const FirstOrderHold<S> hold(oscillator, S(time_s / S(steps)));
  auto state = hold.start();
  S before = load(S(0));
  for (int k = 1; k <= steps; ++k) {
    const S after = load(S(S(time_s * S(k)) / S(steps)));
    hold(before, after, state);
    before = after;
  }
  return state.motion();
}

}  // namespace v0
}  // namespace fingerpad
