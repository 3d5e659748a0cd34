// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What a rider does within a step of time h, for a load that is linear in it. All of it is entire
// in h, s and D (free_wave.hpp): by its Taylor series over a step so short that nothing cancels,
// which is then doubled as often as needed. So one formula serves any damping and any step, tiny or
// huge, and any number type: there is no function in it.
#include <cmath>

#include "fingerpad/sim/detail/free_wave.hpp"
#include "fingerpad/sim/two_word.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
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
StepAnswers<W> short_step(const RiderRates<S>& rates, const W& step, scalar_real_t<W> size) {
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
StepAnswers<W> doubled(const RiderRates<S>& rates, const StepAnswers<W>& a) {
  const W kept = a.wave + W(rates.decay * a.lag);  // of a start at 1
  const W once_more = W(1) + kept;
  return {W(a.step + a.step), W(W(a.wave * a.wave) + W(rates.split * W(a.lag * a.lag))),
          W(W(a.wave + a.wave) * a.lag), W(W(once_more * a.raised) + W(a.lag * a.lag)),
          W(W(once_more * a.ramped) + W(W(a.step + a.lag) * a.raised))};
}

/// The fastest rate of a rider, 1/s: a bound for both its frequency and its decays.
template <scalar S>
scalar_real_t<wide_t<S>> fastest_rate(const RiderRates<S>& rates) {
  using std::sqrt;
  using Real = scalar_real_t<wide_t<S>>;
  const Real decay = value(rates.decay), natural_sq = value(rates.natural_sq);
  return Real(decay + decay + Real(sqrt(natural_sq)));
}

/// Whether a step is short enough for the digits of its phase, or so long that the phase does not
/// matter, as nothing is left of the motion.
template <scalar S>
bool knows_phase(const RiderRates<S>& rates, const S& step_s) {
  using W = wide_t<S>;
  using Real = scalar_real_t<W>;
  const Real step = value(W(step_s));
  const Real uncertain = Real(epsilon<W>() * fastest_rate(rates)) * step;
  const Real decays = Real(value(rates.decay)) * step;
  return uncertain < Real(1) / Real(1000) || Real(1000) * (Real(1) + uncertain) < decays;
}

/// For step_s > 0 and finite.
template <scalar S, class W = wide_t<S>>
StepAnswers<W> step_answers(const RiderRates<S>& rates, const S& step_s) {
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
