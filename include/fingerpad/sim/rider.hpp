// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The rider on the contact (paper, eqs. 3-8) and its motion in closed form:
//
//   m y'' + c (y' - y_ie') + k (y - y_ie) = f(t)
//
// Published are m = c = k = 1. Units: mm, N, s, so that masses are in N s^2/mm = 1000 kg.
#include "fingerpad/sim/detail/free_wave.hpp"
#include "fingerpad/sim/two_word.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// A mass on a spring and a dashpot, with the values of the paper.
template <scalar S = double>
struct Rider {
  S mass_n_s2_per_mm = S(1);    ///< m > 0; 0.001 is 1 kg
  S damping_n_s_per_mm = S(1);  ///< c >= 0
  S stiffness_n_per_mm = S(1);  ///< k > 0: without a spring there is no place to come to rest at
};

/// Refuses what has no meaning (parameter_error).
template <scalar S>
void expects_valid(const Rider<S>& rider) {
  const auto check = [](bool good, const char* name, const S& given, const char* range) {
    expects(good && is_finite(given), "Rider", name, given, range);
  };
  check(value(rider.mass_n_s2_per_mm) > 0, "mass_n_s2_per_mm", rider.mass_n_s2_per_mm,
        "finite and > 0");
  check(value(rider.damping_n_s_per_mm) >= 0, "damping_n_s_per_mm", rider.damping_n_s_per_mm,
        "finite and >= 0");
  check(value(rider.stiffness_n_per_mm) > 0, "stiffness_n_per_mm", rider.stiffness_n_per_mm,
        "finite and > 0");
}

/// c / (2 sqrt(m k)): below 1 the rider swings, above it creeps back.
template <scalar S>
S damping_ratio(const Rider<S>& rider) {
  using std::sqrt;
  const S product = rider.mass_n_s2_per_mm * rider.stiffness_n_per_mm;
  const S root = sqrt(product);
  return S(rider.damping_n_s_per_mm / S(root + root));
}

/// Where the rider is and how fast it goes.
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
S frame_load(const Rider<S>& rider, const Motion<S>& frame) {
  return S(S(rider.damping_n_s_per_mm * frame.velocity_mm_per_s) +
           S(rider.stiffness_n_per_mm * frame.position_mm));
}

/// m y'' + c y' + k y - f in N: 0 for every solution.
template <scalar S>
S residual(const Rider<S>& rider,
           const Motion<S>& motion,
           const S& acceleration_mm_per_s2,
           const S& load_n) {
  const S inertia = rider.mass_n_s2_per_mm * acceleration_mm_per_s2;
  return S(S(inertia + frame_load(rider, motion)) - load_n);
}

/// y_p of the ramp load: (B/k) t + A/k - c B/k^2 (E039).
template <scalar S>
Motion<S> particular_solution(const Rider<S>& rider, const RampLoad<S>& load, const S& time_s) {
  const S speed = load.rise_n_per_s / rider.stiffness_n_per_mm;
  const S drag = rider.damping_n_s_per_mm * speed;
  return {S(S(S(load.start_n - drag) / rider.stiffness_n_per_mm) + S(speed * time_s)), speed};
}

/// The particular solution as printed in eq. 9, for m = c = k = 1: A (t - 1) + B, with A and B
/// exchanged. Its residual is (A - B) (t - 1).
template <scalar S>
Motion<S> printed_particular_solution(const RampLoad<S>& load, const S& time_s) {
  return {S(S(load.start_n * S(time_s - S(1))) + load.rise_n_per_s), load.start_n};
}

/// y_c: the rider left alone, a time after `start`. Exact for any damping; a time that is negative
/// or no number gives NaN.
template <scalar S>
Motion<S> free_motion(const Rider<S>& rider, const Motion<S>& start, const S& time_s) {
  using R = detail::foam::narrow_t<detail::foam::wide_t<S>>;
  const detail::foam::RiderRates<S> rates(rider.mass_n_s2_per_mm, rider.damping_n_s_per_mm,
                                          rider.stiffness_n_per_mm);
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
Motion<S> ramp_response(const Rider<S>& rider,
                        const RampLoad<S>& load,
                        const Motion<S>& start,
                        const S& time_s) {
  const Motion<S> at_start = particular_solution(rider, load, S(0));
  const Motion<S> forced = particular_solution(rider, load, time_s);
  const Motion<S> difference{S(start.position_mm - at_start.position_mm),
                             S(start.velocity_mm_per_s - at_start.velocity_mm_per_s)};
  const Motion<S> left = free_motion(rider, difference, time_s);
  return {S(forced.position_mm + left.position_mm),
          S(forced.velocity_mm_per_s + left.velocity_mm_per_s)};
}

}  // namespace v0
}  // namespace fingerpad
