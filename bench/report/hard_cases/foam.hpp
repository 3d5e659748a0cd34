// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The oscillator on foam and its loads; friction.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "fingerpad/sim/foam_contact.hpp"
#include "row.hpp"

namespace hard {

using fingerpad::MassSpringDamper;
using fingerpad::RampLoad;

/// Position at a time under a ramp load from rest, for m = c = k = 1: one exact step.
inline Digits50 from_rest(const RampLoad<Digits50>& load, const Digits50& time) {
  const fingerpad::FirstOrderHold<Digits50> hold({}, time);
  return hold(load(Digits50(0)), load(time), {}).position_mm;
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
  return row(
      "foam oscillator", "eq. 10 of a ramp load at t = 40, 100, 180, 700, 1420; relative",
      "the causal integral as steps, each exact for a ramp", []<class S>(S) {
        Forms f;
        for (const double time : {40.0, 100.0, 180.0, 700.0, 1420.0}) {
          const RampLoad<S> load{S(0.25), S(0.0625)};
          const MassSpringDamper<S> oscillator;
          const int steps = static_cast<int>(time * 20);
          const Digits50 exact = from_rest({Digits50(0.25), Digits50(0.0625)}, Digits50(time));
          f.naive.add_relative(printed_integrals(load, S(time), steps), exact);
          f.stable.add_relative(
              fingerpad::causal_response(oscillator, load, S(time), steps).position_mm, exact);
        }
        return f;
      });
}

inline Row short_step() {
  return row("foam oscillator", "a load on an oscillator at rest, after 1e-6 to 0.1; relative",
             "`FirstOrderHold`: e^G - 1 by its series", []<class S>(S) {
               Forms f;
               const MassSpringDamper<S> oscillator;
               for (const double time : sweep(1e-6, 0.1, 3)) {
                 const S t = S(time);
                 const Digits50 exact = from_rest({Digits50(1), Digits50(0)}, Digits50(t));
                 // y_c + y_p = 1 - e^{-t/2} (cos wt + sin wt / (2w))
                 const S w = std::sqrt(S(3)) / S(2);
                 const S left =
                     std::exp(-t / S(2)) * (std::cos(w * t) + std::sin(w * t) / (S(2) * w));
                 f.naive.add_relative(S(1) - left, exact);
                 const fingerpad::FirstOrderHold<S> hold(oscillator, t);
                 f.stable.add_relative(hold(S(1), S(1), {}).position_mm, exact);
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
