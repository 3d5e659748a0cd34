// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Creep of foam under a lasting stress (paper, section 3). The Kelvin-Voigt element has delayed
// elasticity, like a crosslinked polymer; the Maxwell element flows without limit, like an uncured
// one; the Burgers model has both in series. Strains are linear in the stress; units MPa, s.
#include <cmath>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {
namespace foam {

/// (1 - e^-x) / x and (x - 1 + e^-x) / x^2, for x >= 0, without cancellation.
template <class S>
struct DecayMeans {
  S first;
  S second;
};

template <scalar S>
DecayMeans<S> decay_means(const S& x) {
  using std::exp;
  if (value(x) > 1) {
    const S first = S(S(1) - S(exp(S(-x)))) / x;
    return {first, S(S(S(1) - first) / x)};
  }
  DecayMeans<S> sum{S(1), S(S(1) / S(2))};
  S first(1), second = sum.second;
  scalar_real_t<S> size(1);
  for (int n = 2; size > epsilon<S>(); ++n) {
    first = S(S(-first) * x) / S(n);
    second = S(S(-second) * x) / S(n + 1);
    sum.first = sum.first + first;
    sum.second = sum.second + second;
    size = size / scalar_real_t<S>(n);
  }
  return sum;
}

/// Whether a time is finite and >= 0.
template <scalar S>
bool can_pass(const S& time_s) {
  return value(time_s) >= 0 && is_finite(time_s);
}

}  // namespace foam
}  // namespace detail

/// The paper's "composition model": a Maxwell element in series with a Kelvin-Voigt element. To
/// leave one of them out, make its modulus and viscosity infinite. The paper prints no values.
template <scalar S = double>
struct Burgers {
  S maxwell_modulus_mpa = S(1);           ///< E > 0: instantaneous elasticity
  S maxwell_viscosity_mpa_s = S(1);       ///< eta > 0: viscous flow; relaxation time eta / E
  S kelvin_voigt_modulus_mpa = S(1);      ///< E > 0: delayed elasticity
  S kelvin_voigt_viscosity_mpa_s = S(1);  ///< eta > 0; retardation time eta / E
};

/// Refuses values out of range (parameter_error).
template <scalar S>
void expects_valid(const Burgers<S>& foam) {
  const auto expect_positive = [](const S& given, const char* name) {
    expects(value(given) > 0, "Burgers", name, given, "> 0; infinite: rigid");
  };
  expect_positive(foam.maxwell_modulus_mpa, "maxwell_modulus_mpa");
  expect_positive(foam.maxwell_viscosity_mpa_s, "maxwell_viscosity_mpa_s");
  expect_positive(foam.kelvin_voigt_modulus_mpa, "kelvin_voigt_modulus_mpa");
  expect_positive(foam.kelvin_voigt_viscosity_mpa_s, "kelvin_voigt_viscosity_mpa_s");
}

/// Creep compliance, 1/MPa: the strain per MPa after a constant stress has acted for a time. NaN
/// for a time that is negative or not finite.
template <scalar S>
S creep_compliance(const Burgers<S>& foam, const S& time_s) {
  if (!detail::foam::can_pass(time_s)) {
    return not_a_number<S>();
  }
  const S delays = S(foam.kelvin_voigt_modulus_mpa * time_s) / foam.kelvin_voigt_viscosity_mpa_s;
  const S delayed = is_finite(delays) ? S(detail::foam::decay_means(delays).first *
                                          S(time_s / foam.kelvin_voigt_viscosity_mpa_s))
                                      : S(S(1) / foam.kelvin_voigt_modulus_mpa);
  const S at_once = S(1) / foam.maxwell_modulus_mpa;
  return S(S(at_once + delayed) + S(time_s / foam.maxwell_viscosity_mpa_s));
}

/// Recovery: the share of the delayed strain that is left at a time after unloading. NaN for a time
/// that is negative or not finite.
template <scalar S>
S recovery(const Burgers<S>& foam, const S& time_s) {
  using std::exp;
  return detail::foam::can_pass(time_s) ? S(exp(S(S(-S(foam.kelvin_voigt_modulus_mpa * time_s)) /
                                                  foam.kelvin_voigt_viscosity_mpa_s)))
                                        : not_a_number<S>();
}

/// Relaxation modulus of the Maxwell element alone, MPa: the stress under a strain of 1 that is
/// held from time 0 on. NaN for a time that is negative or not finite.
template <scalar S>
S relaxation_modulus(const Burgers<S>& foam, const S& time_s) {
  using std::exp;
  return detail::foam::can_pass(time_s)
             ? S(foam.maxwell_modulus_mpa *
                 S(exp(S(S(-S(foam.maxwell_modulus_mpa * time_s)) / foam.maxwell_viscosity_mpa_s))))
             : not_a_number<S>();
}

/// Strain under any history of stress, exact if the stress is linear from sample to sample. Const,
/// O(1), no heap allocation.
template <scalar S = double>
class Creep {
 public:
  /// A value: copy it to go back to this sample later.
  class State {
   public:
    S elastic() const { return elastic_; }  ///< vanishes with the stress
    S delayed() const { return delayed_; }  ///< recovers with delay
    S viscous() const { return viscous_; }  ///< remains
    S strain() const { return S(S(elastic_ + delayed_) + viscous_); }

   private:
    friend class Creep;
    S elastic_ = S(0);
    S delayed_ = S(0);
    S viscous_ = S(0);
  };

  /// For samples `step_s` apart. Refuses bad parameters (parameter_error).
  Creep(const Burgers<S>& foam, const S& step_s) : foam_(foam), step_s_(step_s) {
    expects_valid(foam);
    expects(is_finite(step_s) && value(step_s) > 0, "Creep", "step_s", step_s, "finite and > 0");
    factors_ = factors(step_s);
  }

  const Burgers<S>& foam() const { return foam_; }
  State start() const { return State(); }

  /// Returns the strain at the end of a step, from the stress at its start and end in MPa. The
  /// stress may jump between two steps. A stress that is not finite gives NaN and leaves the state
  /// unchanged.
  S operator()(const S& before_mpa, const S& after_mpa, State& state) const {
    return advance(factors_, step_s_, before_mpa, after_mpa, state);
  }

  /// A step of another length. A length that is not finite or <= 0 gives NaN and leaves the state
  /// unchanged.
  S operator()(const S& before_mpa, const S& after_mpa, const S& step_s, State& state) const {
    if (!is_finite(step_s) || !(value(step_s) > 0)) {
      return not_a_number<S>();
    }
    return advance(factors(step_s), step_s, before_mpa, after_mpa, state);
  }

 private:
  /// The coefficients of delayed = (kept + by_delayed) delayed + by_before before + by_after after.
  /// `kept` is 1 for short steps and 0 for long ones.
  struct Factors {
    S kept = S(0);  ///< 1 or 0
    S by_delayed = S(0);
    S by_before = S(0);  ///< of the stress at the start
    S by_after = S(0);   ///< and at the end
  };

  Factors factors(const S& step_s) const {
    const S viscosity = foam_.kelvin_voigt_viscosity_mpa_s;
    const S delays = S(foam_.kelvin_voigt_modulus_mpa * step_s) / viscosity;
    if (!is_finite(delays)) {
      return {S(0), S(0), S(0), S(S(1) / foam_.kelvin_voigt_modulus_mpa)};
    }
    const detail::foam::DecayMeans<S> means = detail::foam::decay_means(delays);
    const bool short_step = value(delays) <= 1;
    const S flow = step_s / viscosity;
    return {S(short_step ? 1 : 0),
            short_step ? S(-S(means.first * delays)) : recovery(foam_, step_s),
            S(flow * S(means.first - means.second)), S(flow * means.second)};
  }

  S advance(
      const Factors& by, const S& step_s, const S& before, const S& after, State& state) const {
    if (!is_finite(before) || !is_finite(after)) {
      return not_a_number<S>();
    }
    const S given = S(by.by_before * before) + S(by.by_after * after);
    const S change = S(by.by_delayed * state.delayed_) + given;
    const S mean = S(before + after) / S(2);
    state.elastic_ = after / foam_.maxwell_modulus_mpa;
    state.delayed_ = S(by.kept * state.delayed_) + change;
    state.viscous_ = state.viscous_ + S(mean * S(step_s / foam_.maxwell_viscosity_mpa_s));
    return state.strain();
  }

  Burgers<S> foam_;
  S step_s_;
  Factors factors_;
};

}  // namespace v0
}  // namespace fingerpad
