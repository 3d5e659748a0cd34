// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What a oscillator does within a step of time h, for a load that is linear in it. All of it is
// entire in h, s and D (free_wave.hpp): by its Taylor series over a step so short that nothing
// cancels, which is then doubled as often as needed. So one formula serves any damping and any
// step, tiny or huge, and any number type: there is no function in it.
#include <cmath>
#include <limits>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/sim/two_word.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

// The motion of a damped oscillator without load. With s = c/2m and D = s^2 - k/m every such motion
// is e^{-st} [C1 C(D t^2) + C2 t S(D t^2)], where
//
//   C(x) = 1 + x/2! + x^2/4! + ... = cosh sqrt(x) = cos sqrt(-x)
//   S(x) = 1 + x/3! + x^2/5! + ... = sinh sqrt(x) / sqrt(x) = sin sqrt(-x) / sqrt(-x)
//
// have no branch at critical damping (D = 0). The phase sqrt(-D) t is carried in two words, and
// neither function is taken without its decay: nothing overflows, however long the time.

namespace foam {

/// s, D and k/m with the digits of `wide_t<S>`.
template <scalar S>
struct MassSpringDamperRates {
  using W = wide_t<S>;
  W decay;       ///< s, 1/s
  W natural_sq;  ///< k/m, 1/s^2
  W split;       ///< D, 1/s^2: < 0 swings, > 0 creeps

  MassSpringDamperRates(const S& mass, const S& damping, const S& stiffness)
      : decay(W(damping) / W(S(mass + mass))),
        natural_sq(W(stiffness) / W(mass)),
        split(W(decay * decay) - natural_sq) {}
};

/// e^{-st} C(D t^2) and e^{-st} t S(D t^2).
template <class R>
struct FreeWave {
  R wave;
  R lag;
};

/// C(x) and S(x) by their series, for |x| <= 1.
template <scalar R>
FreeWave<R> entire_pair(const R& x) {
  FreeWave<R> sum{R(1), R(1)};
  R even(1), odd(1);
  scalar_real_t<R> size(1);
  for (int n = 1; size > epsilon<R>(); ++n) {
    even = R(even * x) / R((2 * n - 1) * (2 * n));
    odd = R(odd * x) / R((2 * n) * (2 * n + 1));
    sum.wave = sum.wave + even;
    sum.lag = sum.lag + odd;
    size = size / scalar_real_t<R>((2 * n - 1) * (2 * n));
  }
  return sum;
}

/// D < 0, by sine and cosine of the phase.
template <scalar S, class R = narrow_t<wide_t<S>>>
FreeWave<R> swinging(const MassSpringDamperRates<S>& rates, const wide_t<S>& time) {
  using std::cos;
  using std::exp;
  using std::sin;
  using std::sqrt;
  using W = wide_t<S>;
  const W frequency = sqrt(W(-rates.split));
  const W phase = frequency * time;
  const R decayed = exp(W(-W(rates.decay * time)));
  const R in_phase = cos(phase), out_of_phase = sin(phase);
  return {R(decayed * in_phase), R(R(decayed * out_of_phase) / R(frequency))};
}

/// D > 0, by two decays; the slow one is (k/m) / (s + sqrt(D)), since s - sqrt(D) would cancel.
template <scalar S, class R = narrow_t<wide_t<S>>>
FreeWave<R> creeping(const MassSpringDamperRates<S>& rates, const wide_t<S>& time) {
  using std::exp;
  using std::sqrt;
  using W = wide_t<S>;
  const W root = sqrt(rates.split);
  const W slow = rates.natural_sq / W(rates.decay + root);
  const R slow_part = exp(W(-W(slow * time)));
  const R fast_share = exp(W(-W(W(root + root) * time)));
  const R half = slow_part / R(2);
  return {R(half * R(R(1) + fast_share)), R(R(half * R(R(1) - fast_share)) / R(root))};
}

template <scalar S, class R = narrow_t<wide_t<S>>>
FreeWave<R> free_wave(const MassSpringDamperRates<S>& rates, const S& time_s) {
  using std::exp;
  using W = wide_t<S>;
  if (!(value(time_s) >= 0) || !is_finite(time_s)) {
    return {not_a_number<R>(), not_a_number<R>()};
  }
  const W time = W(time_s);
  const W scaled = W(rates.split * time) * time;
  const scalar_real_t<W> x = value(scaled);
  if (x < -1) {
    return swinging(rates, time);
  }
  if (1 < x) {
    return creeping(rates, time);
  }
  const R decayed = exp(W(-W(rates.decay * time)));
  const FreeWave<R> pair = entire_pair(R(scaled));
  return {R(decayed * pair.wave), R(R(decayed * R(time)) * pair.lag)};
}

}  // namespace foam
}  // namespace detail

// The oscillator on the contact (paper, eqs. 3-8) and its motion in closed form:
//
//   m y'' + c (y' - y_ie') + k (y - y_ie) = f(t)
//
// Published are m = c = k = 1. Units: mm, N, s, so that masses are in N s^2/mm = 1000 kg.

/// A mass on a spring and a dashpot, with the values of the paper.
template <scalar S = double>
struct MassSpringDamper {
  S mass_n_s2_per_mm = S(1);    ///< m > 0; 0.001 is 1 kg
  S damping_n_s_per_mm = S(1);  ///< c >= 0
  S stiffness_n_per_mm = S(1);  ///< k > 0: without a spring there is no place to come to rest at
};

/// Refuses what has no meaning (parameter_error).
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

/// c / (2 sqrt(m k)): below 1 the oscillator swings, above it creeps back.
template <scalar S>
S damping_ratio(const MassSpringDamper<S>& oscillator) {
  using std::sqrt;
  const S product = oscillator.mass_n_s2_per_mm * oscillator.stiffness_n_per_mm;
  const S root = sqrt(product);
  return S(oscillator.damping_n_s_per_mm / S(root + root));
}

/// Where the oscillator is and how fast it goes.
template <scalar S = double>
struct Motion {
  S position_mm = S(0);
  S velocity_mm_per_s = S(0);
};

/// f(t) = A + B t, the load of eq. 8.
template <scalar S = double>
struct RampLoad {
  S start_n = S(0);       ///< A
  S rise_n_per_s = S(0);  ///< B

  S operator()(const S& time_s) const { return S(start_n + S(rise_n_per_s * time_s)); }
};

/// What a moving frame, at y_ie with the speed y_ie', adds to the load: c y_ie' + k y_ie.
template <scalar S>
S frame_load(const MassSpringDamper<S>& oscillator, const Motion<S>& frame) {
  return S(S(oscillator.damping_n_s_per_mm * frame.velocity_mm_per_s) +
           S(oscillator.stiffness_n_per_mm * frame.position_mm));
}

/// m y'' + c y' + k y - f in N: 0 for every solution.
template <scalar S>
S residual(const MassSpringDamper<S>& oscillator,
           const Motion<S>& motion,
           const S& acceleration_mm_per_s2,
           const S& load_n) {
  const S inertia = oscillator.mass_n_s2_per_mm * acceleration_mm_per_s2;
  return S(S(inertia + frame_load(oscillator, motion)) - load_n);
}

/// y_p of the ramp load: (B/k) t + A/k - c B/k^2 (E039).
template <scalar S>
Motion<S> particular_solution(const MassSpringDamper<S>& oscillator,
                              const RampLoad<S>& load,
                              const S& time_s) {
  const S speed = load.rise_n_per_s / oscillator.stiffness_n_per_mm;
  const S drag = oscillator.damping_n_s_per_mm * speed;
  return {S(S(S(load.start_n - drag) / oscillator.stiffness_n_per_mm) + S(speed * time_s)), speed};
}

/// The particular solution as printed in eq. 9, for m = c = k = 1: A (t - 1) + B, with A and B
/// exchanged. Its residual is (A - B) (t - 1).
template <scalar S>
Motion<S> printed_particular_solution(const RampLoad<S>& load, const S& time_s) {
  return {S(S(load.start_n * S(time_s - S(1))) + load.rise_n_per_s), load.start_n};
}

/// y_c: the oscillator left alone, a time after `start`. Exact for any damping; a time that is
/// negative or no number gives NaN.
template <scalar S>
Motion<S> free_motion(const MassSpringDamper<S>& oscillator,
                      const Motion<S>& start,
                      const S& time_s) {
  using R = detail::foam::narrow_t<detail::foam::wide_t<S>>;
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

/// The full solution y = y_c + y_p of eq. 8 for the ramp load, from any start. For times far below
/// a period and a start at rest both parts nearly cancel: FirstOrderHold has no such loss.
template <scalar S>
Motion<S> ramp_response(const MassSpringDamper<S>& oscillator,
                        const RampLoad<S>& load,
                        const Motion<S>& start,
                        const S& time_s) {
  const Motion<S> at_start = particular_solution(oscillator, load, S(0));
  const Motion<S> forced = particular_solution(oscillator, load, time_s);
  const Motion<S> difference{S(start.position_mm - at_start.position_mm),
                             S(start.velocity_mm_per_s - at_start.velocity_mm_per_s)};
  const Motion<S> left = free_motion(oscillator, difference, time_s);
  return {S(forced.position_mm + left.position_mm),
          S(forced.velocity_mm_per_s + left.velocity_mm_per_s)};
}

namespace detail {
namespace foam {

/// Answers after a step, for m = 1.
template <scalar W>
struct StepAnswers {
  W step;    ///< h, s
  W wave;    ///< e^{-sh} C(D h^2)
  W lag;     ///< e^{-sh} h S(D h^2), the answer to a start with speed 1
  W raised;  ///< to a load of 1, from rest: the integral of lag
  W ramped;  ///< to a load that rises by 1 per s, from rest: the integral of that
};

/// For (2 s + sqrt(k/m)) h <= `size` <= 1/2. With g = lag, g'' = -2 s g' - (k/m) g gives one
/// derivative at 0 after another.
template <scalar S, class W>
StepAnswers<W> short_step(const MassSpringDamperRates<S>& rates,
                          const W& step,
                          scalar_real_t<W> size) {
  const W drag = W(rates.decay + rates.decay) * step;
  const W spring = W(rates.natural_sq * step) * step;
  W derivative(0), next(step);  // the n-th of g, times h^n
  W share(1);                   // 1 / n!
  StepAnswers<W> sum{step, W(0), W(0), W(0), W(0)};
  scalar_real_t<W> bound(1);
  for (int n = 0; bound > epsilon<W>(); ++n) {
    const W term = derivative * share;
    const W once = term / W(n + 1);
    sum.lag = sum.lag + term;
    sum.raised = sum.raised + once;
    sum.ramped = sum.ramped + W(once / W(n + 2));
    const W after = W(-W(drag * next)) - W(spring * derivative);
    derivative = next;
    next = after;
    share = share / W(n + 1);
    bound = bound * size / scalar_real_t<W>(n + 1);
  }
  sum.raised = sum.raised * step;
  sum.ramped = W(sum.ramped * step) * step;
  sum.wave = W(W(1) - W(rates.natural_sq * sum.raised)) - W(rates.decay * sum.lag);
  return sum;
}

/// The answers after twice the time.
template <scalar S, class W>
StepAnswers<W> doubled(const MassSpringDamperRates<S>& rates, const StepAnswers<W>& a) {
  const W kept = a.wave + W(rates.decay * a.lag);  // of a start at 1
  const W once_more = W(1) + kept;
  return {W(a.step + a.step), W(W(a.wave * a.wave) + W(rates.split * W(a.lag * a.lag))),
          W(W(a.wave + a.wave) * a.lag), W(W(once_more * a.raised) + W(a.lag * a.lag)),
          W(W(once_more * a.ramped) + W(W(a.step + a.lag) * a.raised))};
}

/// The fastest rate of a oscillator, 1/s: a bound for both its frequency and its decays.
template <scalar S>
scalar_real_t<wide_t<S>> fastest_rate(const MassSpringDamperRates<S>& rates) {
  using std::sqrt;
  using Real = scalar_real_t<wide_t<S>>;
  const Real decay = value(rates.decay), natural_sq = value(rates.natural_sq);
  return Real(decay + decay + Real(sqrt(natural_sq)));
}

/// Whether a step is short enough for the digits of its phase, or so long that the phase does not
/// matter, as nothing is left of the motion.
template <scalar S>
bool knows_phase(const MassSpringDamperRates<S>& rates, const S& step_s) {
  using W = wide_t<S>;
  using Real = scalar_real_t<W>;
  const Real step = value(W(step_s));
  const Real uncertain = Real(epsilon<W>() * fastest_rate(rates)) * step;
  const Real decays = Real(value(rates.decay)) * step;
  return uncertain < Real(1) / Real(1000) || Real(1000) * (Real(1) + uncertain) < decays;
}

/// For step_s > 0 and finite.
template <scalar S, class W = wide_t<S>>
StepAnswers<W> step_answers(const MassSpringDamperRates<S>& rates, const S& step_s) {
  using Real = scalar_real_t<W>;
  const Real rate = fastest_rate(rates);
  W step = W(step_s);
  int doublings = 0;
  for (; Real(rate * value(step)) > Real(1) / Real(2); ++doublings) {
    step = step / W(2);
  }
  StepAnswers<W> answers = short_step(rates, step, Real(rate * value(step)));
  for (int k = 0; k < doublings; ++k) {
    answers = doubled(rates, answers);
  }
  return answers;
}

}  // namespace foam
}  // namespace detail

}  // namespace v0
}  // namespace fingerpad
