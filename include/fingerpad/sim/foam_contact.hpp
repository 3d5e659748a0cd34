// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The contact of an object with a foam finger, to make test signals and to explain the rules of
// pre-slip. Source: "Pre-slip sensing using tactile sensor" (2007), section 3, eqs. 1-10; published
// and corrected forms in docs/errata.md, E039-E041.
//
//   F = K N^beta, A = A_1 N^(2/3)            friction and contact area  contact_friction.hpp
//   m y'' + c (y' - y_ie') + k (y - y_ie)    oscillator, closed form         oscillator.hpp,
//   free_wave.hpp
//     = f(t)                                 step by step               FirstOrderHold, below
//   f = A + B t, cbrt(C + D sin at)(A + B t) loads in slip, in a lift   slip_load.hpp
//   Kelvin-Voigt, Maxwell, both in series    creep                      creep.hpp
//
// (in detail/foam/). docs/sim/foam_contact.md has what the model can tell and what it cannot.
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/sim/contact_friction.hpp"
#include "fingerpad/sim/creep.hpp"
#include "fingerpad/sim/mass_spring_damper.hpp"
#include "fingerpad/sim/slip_load.hpp"
#include "fingerpad/sim/two_word.hpp"

namespace fingerpad {
inline namespace v0 {

/// How FirstOrderHold keeps the motion from step to step. One word rounds it in every step, and the
/// roundings add up where a oscillator does not forget them: half an epsilon for each step, at
/// most. Two words round it only where it is read. Numbers that are not built-in have one word.
struct OneWord {
  template <scalar S>
  using number = S;
};
struct TwoWords {
  template <scalar S>
  using number = detail::foam::wide_t<S>;
};

/// The oscillator step by step, exact where the load is linear within a step, whatever the damping
/// and the step. Const: one serves any number of oscillators, each with a state of its own. O(1),
/// no memory from the heap.
template <scalar S = double, class Words = TwoWords>
class FirstOrderHold {
  using W = typename Words::template number<S>;

 public:
  /// A value: copy it to go back to this sample later.
  class State {
   public:
    Motion<S> motion() const { return {S(position_), S(velocity_)}; }

   private:
    friend class FirstOrderHold;
    explicit State(const Motion<S>& motion)
        : position_(W(motion.position_mm)), velocity_(W(motion.velocity_mm_per_s)) {}

    W position_;
    W velocity_;
  };

  /// For samples `step_s` apart. Refuses bad parameters (parameter_error), and a step so long that
  /// a oscillator still swings but no digit of its phase is left: some 10^27 periods in double,
  /// 10^12 in float.
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
  State start(const Motion<S>& motion = {}) const { return State(motion); }

  /// The motion at the end of a step, with the load at both ends of it in N. A load may jump
  /// between two steps. One that is not finite is no step: the answer is NaN, the state stays.
  Motion<S> operator()(const S& before_n, const S& after_n, State& state) const {
    return advance(of_step_, before_n, after_n, state);
  }

  /// A step of another length, as of a clock that jitters; its coefficients are computed anew. A
  /// step that the constructor would refuse is none: NaN, the state stays.
  Motion<S> operator()(const S& before_n, const S& after_n, const S& step_s, State& state) const {
    Coefficients by;
    if (!is_finite(step_s) || !(value(step_s) > 0) || !coefficients(step_s, by)) {
      return no_motion();
    }
    return advance(by, before_n, after_n, state);
  }

 private:
  /// y += y_by_y y + y_by_v v + ..., or y = ... where hardly anything is left of it.
  struct Coefficients {
    W kept = W(0);  ///< 1 or 0
    W y_by_y = W(0), y_by_v = W(0), y_by_before = W(0), y_by_after = W(0);
    W v_by_y = W(0), v_by_v = W(0), v_by_before = W(0), v_by_after = W(0);
  };

  static const MassSpringDamper<S>& checked(const MassSpringDamper<S>& oscillator) {
    expects_valid(oscillator);
    return oscillator;
  }
  static Motion<S> no_motion() { return {not_a_number<S>(), not_a_number<S>()}; }

  /// False where the phase is lost.
  bool coefficients(const S& step_s, Coefficients& to) const {
    using Wide = detail::foam::wide_t<S>;
    const detail::foam::StepAnswers<Wide> a = detail::foam::step_answers(rates_, step_s);
    const Wide damped = rates_.decay * a.lag;
    const Wide lost = rates_.natural_sq * a.raised;  // of a start at 1
    const Wide slowed = lost + Wide(damped + damped);
    const bool short_step = value(slowed) < scalar_real_t<Wide>(1) / scalar_real_t<Wide>(2);
    const Wide mass = Wide(oscillator_.mass_n_s2_per_mm);
    const Wide y_by_after = Wide(a.ramped / a.step) / mass;
    const Wide v_by_after = Wide(a.raised / a.step) / mass;
    to.kept = W(short_step ? 1 : 0);
    to.y_by_y = W(short_step ? Wide(-lost) : Wide(a.wave + damped));
    to.y_by_v = W(a.lag);
    to.y_by_before = W(Wide(Wide(a.raised / mass) - y_by_after));
    to.y_by_after = W(y_by_after);
    to.v_by_y = W(Wide(-Wide(rates_.natural_sq * a.lag)));
    to.v_by_v = W(short_step ? Wide(-slowed) : Wide(a.wave - damped));
    to.v_by_before = W(Wide(Wide(a.lag / mass) - v_by_after));
    to.v_by_after = W(v_by_after);
    return detail::foam::knows_phase(rates_, step_s) && is_finite(a.ramped) &&
           is_finite(to.v_by_before);
  }

  Motion<S> advance(const Coefficients& by,
                    const S& before_n,
                    const S& after_n,
                    State& state) const {
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

/// y_p of any load, by the causal integral of eq. 10: (1/m) Int_0^t lag(t - u) f(u) du, with `lag`
/// the oscillator's answer to a push (2/sqrt(3) e^(-t/2) sin(sqrt(3)/2 t) for m = c = k = 1). The
/// load is taken as linear between `steps` + 1 samples of it, so the error falls with the square of
/// the step. NaN for a time that is negative or not finite, and for no steps.
template <class Words = TwoWords, scalar S, class Load>
Motion<S> causal_response(const MassSpringDamper<S>& oscillator,
                          const Load& load,
                          const S& time_s,
                          int steps) {
  if (value(time_s) == 0 && steps > 0) {
    return {};
  }
  if (!(value(time_s) > 0) || !is_finite(time_s) || steps <= 0) {
    return {not_a_number<S>(), not_a_number<S>()};
  }
  const FirstOrderHold<S, Words> hold(oscillator, S(time_s / S(steps)));
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
