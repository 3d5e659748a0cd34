// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The motion of a mass-spring-damper: without load at any time, and over one step with a load that
// is linear in time. With s = c/2m and D = s^2 - k/m every motion without load is
// e^{-st} [C1 C(D t^2) + C2 t S(D t^2)], where
//
//   C(x) = 1 + x/2! + x^2/4! + ... = cosh sqrt(x) = cos sqrt(-x)
//   S(x) = 1 + x/3! + x^2/5! + ... = sinh sqrt(x) / sqrt(x) = sin sqrt(-x) / sqrt(-x)
//
// have no branch at critical damping (D = 0). Each function is computed together with its decay, so
// that nothing overflows for long times. A step is the Taylor series of a step so short that
// nothing cancels, doubled as often as needed: one formula for any damping, any step and any number
// type.
#include <cmath>

#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {
namespace foam {

/// The type in which S is computed: the next wider built-in type, since a phase of 10^4 rad loses
/// four digits. Other scalars are computed in themselves.
template <class S>
struct wide {
  using type = S;
};
template <>
struct wide<float> {
  using type = double;
};
template <>
struct wide<double> {
  using type = long double;
};
template <class S>
using wide_t = typename wide<S>::type;

/// s, D and k/m.
template <scalar S>
struct MassSpringDamperRates {
  using W = wide_t<S>;
  W decay;       ///< s, 1/s
  W natural_sq;  ///< k/m, 1/s^2
  W split;       ///< D, 1/s^2: < 0 underdamped, > 0 overdamped

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
template <scalar S, class R = wide_t<S>>
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

/// D > 0, by two exponential decays. The slow rate is (k/m) / (s + sqrt(D)), since s - sqrt(D)
/// would cancel.
template <scalar S, class R = wide_t<S>>
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

template <scalar S, class R = wide_t<S>>
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

/// Responses after a step, for m = 1.
template <scalar W>
struct StepAnswers {
  W step;    ///< h, s
  W wave;    ///< e^{-sh} C(D h^2)
  W lag;     ///< e^{-sh} h S(D h^2), the response to a start with speed 1
  W raised;  ///< to a load of 1, from rest: the integral of lag
  W ramped;  ///< to a load that rises by 1 per s, from rest: the integral of raised
};

/// For (2 s + sqrt(k/m)) h <= `size` <= 1/2. With g = lag, g'' = -2 s g' - (k/m) g gives the
/// derivatives at 0 one after another.
template <scalar S, class W>
StepAnswers<W> short_step(const MassSpringDamperRates<S>& rates,
                          const W& step,
                          scalar_real_t<W> size) {
  const W drag = W(rates.decay + rates.decay) * step;
  const W spring = W(rates.natural_sq * step) * step;
  W derivative(0), next(step);  // the n-th of g, times h^n
  W share(1);                   // 1 / n!
  StepAnswers<W> sum{step, W(0), W(0), W(0), W(0)};
  scalar_real_t<W> bound(1);  // size^n / n!; the n-th term is at most this / size * step
  for (int n = 0; n < 2 || bound > epsilon<W>() * size; ++n) {
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

/// The responses after twice the time.
template <scalar S, class W>
StepAnswers<W> doubled(const MassSpringDamperRates<S>& rates, const StepAnswers<W>& a) {
  const W kept = a.wave + W(rates.decay * a.lag);  // of a start at position 1
  const W once_more = W(1) + kept;
  return {W(a.step + a.step), W(W(a.wave * a.wave) + W(rates.split * W(a.lag * a.lag))),
          W(W(a.wave + a.wave) * a.lag), W(W(once_more * a.raised) + W(a.lag * a.lag)),
          W(W(once_more * a.ramped) + W(W(a.step + a.lag) * a.raised))};
}

/// The fastest rate of an oscillator, 1/s: a bound for both its frequency and its decays.
template <scalar S>
scalar_real_t<wide_t<S>> fastest_rate(const MassSpringDamperRates<S>& rates) {
  using std::sqrt;
  using Real = scalar_real_t<wide_t<S>>;
  const Real decay = value(rates.decay), natural_sq = value(rates.natural_sq);
  return Real(decay + decay + Real(sqrt(natural_sq)));
}

/// Whether a step is short enough to know digits of its phase, or so long that nothing is left of
/// the motion and the phase does not matter.
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
