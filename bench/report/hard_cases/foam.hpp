// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The oscillator on foam, its steps and its loads; creep; friction.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "fingerpad/sim/foam_contact.hpp"
#include "row.hpp"

namespace hard {

using fingerpad::MassSpringDamper;
using fingerpad::RampLoad;
template <class S>
using Motion = typename MassSpringDamper<S>::Motion;

template <class To, class From>
MassSpringDamper<To> as(const MassSpringDamper<From>& r) {
  return {To(r.mass_n_s2_per_mm), To(r.damping_n_s_per_mm), To(r.stiffness_n_per_mm)};
}

/// Position after a start at 0 with speed 1: e^{-st} sin(wt)/w, or two decaying exponentials.
template <class S>
S textbook_position(const MassSpringDamper<S>& oscillator, const S& t) {
  using std::exp;
  using std::sin;
  using std::sqrt;
  const S s = oscillator.damping_n_s_per_mm / (S(2) * oscillator.mass_n_s2_per_mm);
  const S split = s * s - oscillator.stiffness_n_per_mm / oscillator.mass_n_s2_per_mm;
  if (split > S(0)) {
    const S root = sqrt(split);
    const S slow = exp(S((root - s) * t)), fast = exp(S(-(root + s) * t));
    return S((slow - fast) / (S(2) * root));
  }
  const S w = sqrt(S(-split));
  return S(exp(S(-s * t)) * sin(S(w * t)) / w);
}

/// The textbook formula in 50 digits; at exactly critical damping, its limit.
template <class S>
Digits50 exact_position(const MassSpringDamper<S>& oscillator, const S& t) {
  const MassSpringDamper<Digits50> r = as<Digits50>(oscillator);
  const Digits50 s = r.damping_n_s_per_mm / (2 * r.mass_n_s2_per_mm), at(t);
  const bool critical = s * s == r.stiffness_n_per_mm / r.mass_n_s2_per_mm;
  return critical ? Digits50(at * exp(Digits50(-s * at))) : textbook_position(r, at);
}

template <class S>
void add_position(Forms& f,
                  const MassSpringDamper<S>& oscillator,
                  const S& t,
                  const Digits50& size) {
  const Digits50 exact = exact_position(oscillator, t);
  f.naive.add(textbook_position(oscillator, t), exact, size);
  f.stable.add(fingerpad::free_motion(oscillator, {S(0), S(1)}, t).position_mm, exact, size);
}

inline Row critical_damping() {
  return row("foam oscillator",
             "damping ratio 1 -+ 1e-15 to 0.1 and 1 itself, t = 0.01 to 10; relative",
             "e^(-st) t S(D t^2) with an entire S", []<class S>(S) {
               Forms f;
               for (const double t : sweep(0.01, 10, 3)) {
                 const auto add = [&](double ratio) {
                   const MassSpringDamper<S> oscillator{S(1), S(2 * ratio), S(1)};
                   const Digits50 exact = exact_position(oscillator, S(t));
                   add_position(f, oscillator, S(t), exact);
                 };
                 add(1);
                 for (const double off : sweep(1e-15, 0.1, 10)) {
                   add(1 - off);
                   add(1 + off);
                 }
               }
               return f;
             });
}

inline Row strong_damping() {
  return row("foam oscillator", "damping ratio 10 to 1e6, in the slow decay; relative",
             "(k/m) / (s + sqrt(D)) for s - sqrt(D)", []<class S>(S) {
               Forms f;
               for (const double ratio : sweep(10, 1e6, 3)) {
                 const MassSpringDamper<S> oscillator{S(1), S(2 * ratio), S(1)};
                 for (const double share : {0.1, 1.0, 5.0}) {
                   const S t = S(2 * ratio * share);
                   const Digits50 exact = exact_position(oscillator, t);
                   add_position(f, oscillator, t, exact);
                 }
               }
               return f;
             });
}

inline Row long_swing() {
  return row("foam oscillator", "no damping, k/m = 7.8, times to 1e4; of the amplitude",
             "the phase sqrt(-D) t in the next wider number", []<class S>(S) {
               Forms f;
               const MassSpringDamper<S> oscillator{S(0.37), S(0), S(2.9)};
               const Digits50 size = sqrt(Digits50(oscillator.mass_n_s2_per_mm) /
                                          Digits50(oscillator.stiffness_n_per_mm));
               for (const double t : sweep(1, 1e4, 1.1)) {
                 add_position(f, oscillator, S(t), size);
               }
               return f;
             });
}

/// Both integrals of eq. 10 by the trapezoidal rule, for m = c = k = 1; the integrand grows as
/// e^{t/2}.
template <class S>
S printed_integrals(const RampLoad<S>& load, const S& t, int steps) {
  const S w = std::sqrt(S(3)) / S(2), h = t / S(steps);
  S with_cosine = S(0), with_sine = S(0);
  for (int k = 0; k <= steps; ++k) {
    const S u = h * S(k);
    const S grown = std::exp(u / S(2)) * load(u) * (k == 0 || k == steps ? h / S(2) : h);
    with_cosine += std::cos(w * u) * grown;
    with_sine += std::sin(w * u) * grown;
  }
  return std::exp(-t / S(2)) / w * (std::sin(w * t) * with_cosine - std::cos(w * t) * with_sine);
}

inline Row long_times() {
  return row("foam oscillator", "eq. 10 of a ramp load at t = 40, 100, 180, 700, 1420; relative",
             "the causal integral as steps, each exact for a ramp", []<class S>(S) {
               Forms f;
               for (const double time : {40.0, 100.0, 180.0, 700.0, 1420.0}) {
                 const RampLoad<S> load{S(0.25), S(0.0625)};
                 const MassSpringDamper<S> oscillator;
                 const int steps = static_cast<int>(time * 20);
                 // y_p and the remainder of y_c
                 const Digits50 exact = fingerpad::ramp_response(MassSpringDamper<Digits50>(),
                                                                 {Digits50(0.25), Digits50(0.0625)},
                                                                 Motion<Digits50>(), Digits50(time))
                                            .position_mm;
                 f.naive.add_relative(printed_integrals(load, S(time), steps), exact);
                 f.stable.add_relative(
                     fingerpad::causal_response(oscillator, load, S(time), steps).position_mm,
                     exact);
               }
               return f;
             });
}

inline Row many_steps() {
  return row("foam oscillator", "80000 steps of 1/8 without damping; of the amplitude",
             "`FirstOrderHold`: only what a step adds is rounded, in the next wider number",
             []<class S>(S) {
               Forms f;
               const MassSpringDamper<S> oscillator{S(0.37), S(0), S(2.9)};
               const Digits50 rate = sqrt(Digits50(oscillator.stiffness_n_per_mm) /
                                          Digits50(oscillator.mass_n_s2_per_mm));
               const Digits50 phase = rate / 8;
               // the exact coefficients of a step, rounded once each
               const S c = static_cast<S>(cos(phase));
               const S y_by_v = static_cast<S>(Digits50(sin(phase) / rate));
               const S v_by_y = static_cast<S>(Digits50(-sin(phase) * rate));
               const fingerpad::FirstOrderHold<S> hold(oscillator, S(0.125));
               auto state = hold.start({S(1), S(0)});
               S y = S(1), v = S(0);
               for (int n = 1; n <= 80000; ++n) {
                 const S y_next = c * y + y_by_v * v;
                 v = v_by_y * y + c * v;
                 y = y_next;
                 const S held = hold(S(0), S(0), state).position_mm;
                 if (n % 1000 == 0) {
                   const Digits50 exact = cos(Digits50(phase * n));
                   f.naive.add_absolute(y, exact);
                   f.stable.add_absolute(held, exact);
                 }
               }
               return f;
             });
}

inline Row short_step() {
  return row("foam oscillator", "a load on an oscillator at rest, after 1e-6 to 0.1; relative",
             "`FirstOrderHold`: Taylor series of a short step, doubled", []<class S>(S) {
               Forms f;
               const MassSpringDamper<S> oscillator;
               for (const double time : sweep(1e-6, 0.1, 3)) {
                 const S t = S(time);
                 const Digits50 exact = fingerpad::ramp_response(MassSpringDamper<Digits50>(),
                                                                 {Digits50(1), Digits50(0)},
                                                                 Motion<Digits50>(), Digits50(t))
                                            .position_mm;
                 // y_c + y_p = 1 - e^{-t/2} (cos wt + sin wt / (2w))
                 const S w = std::sqrt(S(3)) / S(2);
                 const S left =
                     std::exp(-t / S(2)) * (std::cos(w * t) + std::sin(w * t) / (S(2) * w));
                 f.naive.add_relative(S(1) - left, exact);
                 const fingerpad::FirstOrderHold<S> hold(oscillator, t);
                 auto state = hold.start();
                 f.stable.add_relative(hold(S(1), S(1), state).position_mm, exact);
               }
               return f;
             });
}

inline Row short_creep() {
  return row("foam creep", "(x - 1 + e^-x) / x^2, the step's share of a rising stress; relative",
             "alternating series below 1", []<class S>(S) {
               Forms f;
               for (const double at : sweep(1e-9, 30, 2)) {
                 const S x = S(at);
                 const Digits50 e(x);
                 const Digits50 exact = (e - 1 + exp(Digits50(-e))) / (e * e);
                 f.naive.add_relative((x - S(1) + std::exp(-x)) / (x * x), exact);
                 f.stable.add_relative(fingerpad::detail::foam::decay_means(x).second, exact);
               }
               return f;
             });
}

inline Row no_load() {
  return row("friction", "K N^(beta - 1) N where the load goes to 0 and below; N",
             "the force K N^beta, 0 where nothing presses", []<class S>(S) {
               Forms f;
               const fingerpad::PolymerFriction<S> friction;
               for (const double load : {-1.0, -1e-9, 0.0, 1e-30, 1e-9, 1e-3, 1.0, 30.0}) {
                 const S n = S(load);
                 const S coefficient = friction.factor * std::pow(n, friction.exponent - S(1));
                 const Digits50 power =
                     n > 0 ? Digits50(exp(Digits50(Digits50(friction.exponent) * log(Digits50(n)))))
                           : Digits50(0);
                 f.naive.add_absolute(coefficient * n, power);
                 f.stable.add_absolute(fingerpad::friction_force(friction, n), power);
               }
               return f;
             });
}

}  // namespace hard
