// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The contact of an object with a foam finger, to make test signals and to explain the rules of
// pre-slip. Source: "Pre-slip sensing using tactile sensor" (2007), section 3, eqs. 1-10; published
// and corrected forms in docs/errata.md, E039-E041.
//
//   F = K N^beta                                 friction of a polymer
//   m y'' + c (y' - y_ie') + k (y - y_ie) = f    mass-spring-damper                          (4)
//   f = (c_a H + k_a (H t - x_ie)) / mu          both suspensions carry the same force       (7)
//   1/mu = y^(1 - beta) / K,  y = z^2 / 2p       the load N is set equal to the deformation  (8)
//   f = cbrt(C + D sin(a t)) (A + B t)           while lifting                              (10)
//
// The paper uses m = c = k = 1. Units: mm, N, s, so that masses are in N s^2/mm = 1000 kg. The
// paper writes F = (K N^(beta-1)) N and calls the bracket the coefficient of friction mu; as the
// load goes to 0 it has no bound, but the force goes to 0.
#include <Eigen/Core>
#include <cmath>
#include <string>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {
/// x^exponent for x > 0, else 0; NaN for NaN.
template <scalar S>
S positive_power(const S& x, const S& exponent) {
  using std::pow;
  return value(x) <= 0 ? S(0) : pow(x, exponent);
}
}  // namespace detail

/// F = K N^beta.
template <scalar S = double>
struct PolymerFriction {
  S factor = S(1);           ///< K > 0, N^(1 - beta); 1 as in eq. 8
  S exponent = S(2) / S(3);  ///< beta, in (0, 1]: 2/3 for rubber-like solids, 1 is Coulomb's law
};

/// The largest force of friction under a normal load, N; 0 for loads <= 0.
template <scalar S>
S friction_force(const PolymerFriction<S>& friction, const S& normal_n) {
  return friction.factor * detail::positive_power(normal_n, friction.exponent);
}

/// 1/mu = N^(1 - beta) / K, the factor of eqs. 5 and 7; finite for every load.
template <scalar S>
S inverse_friction_coefficient(const PolymerFriction<S>& friction, const S& normal_n) {
  return detail::positive_power(normal_n, S(1) - friction.exponent) / friction.factor;
}

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

template <scalar S>
std::string check(const MassSpringDamper<S>& o) {
  return check("MassSpringDamper", {{"mass_n_s2_per_mm", o.mass_n_s2_per_mm, positive},
                                    {"damping_n_s_per_mm", o.damping_n_s_per_mm, not_negative},
                                    {"stiffness_n_per_mm", o.stiffness_n_per_mm, positive}});
}

/// The load that a frame that moves at y_ie with the speed y_ie' adds: c y_ie' + k y_ie.
template <scalar S>
S frame_load(const MassSpringDamper<S>& oscillator,
             const typename MassSpringDamper<S>::Motion& frame) {
  return oscillator.damping_n_s_per_mm * frame.velocity_mm_per_s +
         oscillator.stiffness_n_per_mm * frame.position_mm;
}

/// f(t) = A + B t, the load of eq. 8.
template <scalar S = double>
struct RampLoad {
  S start_n = S(0);       ///< A
  S rise_n_per_s = S(0);  ///< B

  S operator()(const S& time_s) const { return start_n + rise_n_per_s * time_s; }
};

/// y_p of the ramp load, which the motion approaches: (B/k) t + A/k - c B/k^2. Printed in eq. 9,
/// for m = c = k = 1: A (t - 1) + B, with A and B exchanged (E039).
template <scalar S>
typename MassSpringDamper<S>::Motion particular_solution(const MassSpringDamper<S>& oscillator,
                                                         const RampLoad<S>& load,
                                                         const S& time_s) {
  const S speed = load.rise_n_per_s / oscillator.stiffness_n_per_mm;
  const S drag = oscillator.damping_n_s_per_mm * speed;
  return {(load.start_n - drag) / oscillator.stiffness_n_per_mm + speed * time_s, speed};
}

/// Moves the mass over one step in which the load is linear in time: exact for any damping and any
/// length of the step. The constructor takes exp(G) of the motion together with its load,
///   d/dtau [y, v/w, f/k, df/k] = G [y, v/w, f/k, df/k],   tau = t/h from 0 to 1,  w = sqrt(k/m).
/// O(1), no heap allocation.
template <scalar S = double>
class FirstOrderHold {
  using Motion = typename MassSpringDamper<S>::Motion;
  using Matrix = Eigen::Matrix<S, 4, 4>;

 public:
  /// For steps of `step_s`. Refuses bad parameters (parameter_error).
  FirstOrderHold(const MassSpringDamper<S>& oscillator, const S& step_s)
      : stiffness_(oscillator.stiffness_n_per_mm) {
    using std::sqrt;
    require(oscillator);
    require("FirstOrderHold", {{"step_s", step_s, {.min = 0, .max = 1e100, .above_min = true}}});
    frequency_ = sqrt(oscillator.stiffness_n_per_mm / oscillator.mass_n_s2_per_mm);
    const S phase = frequency_ * step_s;
    Matrix g = Matrix::Constant(S(0));
    g(0, 1) = g(1, 2) = phase;
    g(1, 0) = -phase;
    g(1, 1) = -oscillator.damping_n_s_per_mm / oscillator.mass_n_s2_per_mm * step_s;
    g(2, 3) = S(1);
    change_ = exponential_less_one(g, value(S(2) * phase - g(1, 1)) + 1);
  }

  /// The motion at the end of a step, from the motion at its start and the loads at both ends in N.
  Motion operator()(const S& before_n, const S& after_n, const Motion& start) const {
    const Eigen::Matrix<S, 4, 1> at = {start.position_mm, start.velocity_mm_per_s / frequency_,
                                       before_n / stiffness_, (after_n - before_n) / stiffness_};
    const Eigen::Matrix<S, 4, 1> change = change_ * at;
    return {start.position_mm + change(0), start.velocity_mm_per_s + frequency_ * change(1)};
  }

 private:
  /// e^G - 1, by the series of G / 2^n, whose size is at most 1/2, doubled n times. What a short
  /// step changes is not the difference of numbers near 1.
  static Matrix exponential_less_one(Matrix g, scalar_real_t<S> size) {
    int doublings = 0;
    for (; size > scalar_real_t<S>(1) / 2; ++doublings) {
      size = size / 2;
      g = g / S(2);
    }
    Matrix term = g, sum = g;
    scalar_real_t<S> bound = size;
    for (int n = 2; bound > epsilon<S>() * size; ++n) {
      term = (term * g).eval() / S(n);
      sum += term;
      bound = bound * size / scalar_real_t<S>(n);
    }
    for (; doublings > 0; --doublings) {
      sum = S(2) * sum + (sum * sum).eval();
    }
    return sum;
  }

  S stiffness_;
  S frequency_;
  Matrix change_;
};

/// y_p of any load, by the causal integral of eq. 10, (1/m) Int_0^t lag(t - u) f(u) du with the
/// impulse response `lag` of the oscillator (E041). The load is taken as linear between `steps` + 1
/// samples, so the error falls with the square of the step. `time_s` is positive.
template <scalar S, class Load>
typename MassSpringDamper<S>::Motion causal_response(const MassSpringDamper<S>& oscillator,
                                                     const Load& load,
                                                     const S& time_s,
                                                     int steps) {
  const FirstOrderHold<S> hold(oscillator, time_s / S(steps));
  typename MassSpringDamper<S>::Motion motion;
  S before_n = load(S(0));
  for (int k = 1; k <= steps; ++k) {
    const S after_n = load(time_s * S(k) / S(steps));
    motion = hold(before_n, after_n, motion);
    before_n = after_n;
  }
  return motion;
}

/// A + B t of eq. 8, for a deformation y = z^2 / 2p in mm that counts as a load of y N, from the
/// drag without friction of eq. 7, start_n = c_a H - k_a x_ie and rise_n_per_s = k_a H. The printed
/// factor z^(2/3) holds for 2p = 1 and K = 1.
template <scalar S>
RampLoad<S> slip_load(const RampLoad<S>& drag,
                      const PolymerFriction<S>& friction,
                      const S& deformation_mm) {
  const S factor = inverse_friction_coefficient(friction, deformation_mm);
  return {drag.start_n * factor, drag.rise_n_per_s * factor};
}

/// cbrt(C + D sin(a t)) (A + B t), the load while lifting, for friction with the exponent 2/3: C is
/// z^2 / (2p K^3), D is 1 mm / K^3, A + B t is the drag without friction of slip_load().
template <scalar S = double>
struct LiftLoad {
  S middle = S(2);               ///< C; where C + D sin(a t) < 0, nothing is pressed and drags
  S swing = S(1);                ///< D
  S frequency_rad_per_s = S(1);  ///< a
  RampLoad<S> drag = {S(1), S(1)};

  S operator()(const S& time_s) const {
    using std::sin;
    const S pressed = middle + swing * sin(frequency_rad_per_s * time_s);
    return detail::positive_power(pressed, S(1) / S(3)) * drag(time_s);
  }
};

}  // namespace v1
}  // namespace fingerpad
