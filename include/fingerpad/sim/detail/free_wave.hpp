// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The motion of a damped oscillator without load. With s = c/2m and D = s^2 - k/m every such motion
// is e^{-st} [C1 C(D t^2) + C2 t S(D t^2)], where
//
//   C(x) = 1 + x/2! + x^2/4! + ... = cosh sqrt(x) = cos sqrt(-x)
//   S(x) = 1 + x/3! + x^2/5! + ... = sinh sqrt(x) / sqrt(x) = sin sqrt(-x) / sqrt(-x)
//
// have no branch at critical damping (D = 0). The phase sqrt(-D) t is carried in two words, and
// neither function is taken without its decay: nothing overflows, however long the time.
#include <cmath>
#include <limits>

#include "fingerpad/sim/two_word.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {
namespace foam {

/// s, D and k/m with the digits of `wide_t<S>`.
template <scalar S>
struct RiderRates {
  using W = wide_t<S>;
  W decay;       ///< s, 1/s
  W natural_sq;  ///< k/m, 1/s^2
  W split;       ///< D, 1/s^2: < 0 swings, > 0 creeps

  RiderRates(const S& mass, const S& damping, const S& stiffness)
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
FreeWave<R> swinging(const RiderRates<S>& rates, const wide_t<S>& time) {
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
FreeWave<R> creeping(const RiderRates<S>& rates, const wide_t<S>& time) {
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
FreeWave<R> free_wave(const RiderRates<S>& rates, const S& time_s) {
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
}  // namespace v0
}  // namespace fingerpad
