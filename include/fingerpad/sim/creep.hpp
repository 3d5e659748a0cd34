// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How foam gives way under a stress that lasts (paper, section 3): Kelvin and Voigt's element has
// delayed elasticity, as of a crosslinked polymer, Maxwell's gives way for ever, as of an uncured
// one; both in series have both (Burgers). Strains are linear in the stress; units MPa, s.
#include <cmath>

#include "fingerpad/core/expects.hpp"
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

/// Whether a time is one that can have passed.
template <scalar S>
bool can_pass(const S& time_s) {
  return value(time_s) >= 0 && is_finite(time_s);
}

template <scalar S>
void expects_element(const char* owner, const S& modulus_mpa, const S& viscosity_mpa_s) {
  expects(is_finite(modulus_mpa) && value(modulus_mpa) > 0, owner, "modulus_mpa", modulus_mpa,
          "finite and > 0");
  expects(is_finite(viscosity_mpa_s) && value(viscosity_mpa_s) > 0, owner, "viscosity_mpa_s",
          viscosity_mpa_s, "finite and > 0");
}

}  // namespace foam
}  // namespace detail

/// Spring and dashpot side by side. The paper prints no values.
template <scalar S = double>
struct KelvinVoigt {
  S modulus_mpa = S(1);      ///< E > 0
  S viscosity_mpa_s = S(1);  ///< eta > 0; eta / E is the time of the delay
};

/// Spring and dashpot one after the other.
template <scalar S = double>
struct Maxwell {
  S modulus_mpa = S(1);      ///< E > 0
  S viscosity_mpa_s = S(1);  ///< eta > 0; eta / E is the time in which stress relaxes
};

/// Both in series: "the composition model".
template <scalar S = double>
struct Burgers {
  Maxwell<S> maxwell = {};
  KelvinVoigt<S> kelvin_voigt = {};
};

/// Refuse what has no meaning (parameter_error).
template <scalar S>
void expects_valid(const KelvinVoigt<S>& element) {
  detail::foam::expects_element("KelvinVoigt", element.modulus_mpa, element.viscosity_mpa_s);
}
template <scalar S>
void expects_valid(const Maxwell<S>& element) {
  detail::foam::expects_element("Maxwell", element.modulus_mpa, element.viscosity_mpa_s);
}
template <scalar S>
void expects_valid(const Burgers<S>& foam) {
  expects_valid(foam.maxwell);
  expects_valid(foam.kelvin_voigt);
}

/// Creep: the strain of 1 MPa after it has acted for a time, 1/MPa. NaN for a time that is negative
/// or not finite.
template <scalar S>
S creep_compliance(const KelvinVoigt<S>& element, const S& time_s) {
  if (!detail::foam::can_pass(time_s)) {
    return not_a_number<S>();
  }
  const S delays = S(element.modulus_mpa * time_s) / element.viscosity_mpa_s;
  if (!is_finite(delays)) {
    return S(S(1) / element.modulus_mpa);
  }
  return S(detail::foam::decay_means(delays).first * S(time_s / element.viscosity_mpa_s));
}
template <scalar S>
S creep_compliance(const Maxwell<S>& element, const S& time_s) {
  return detail::foam::can_pass(time_s)
             ? S(S(S(1) / element.modulus_mpa) + S(time_s / element.viscosity_mpa_s))
             : not_a_number<S>();
}
template <scalar S>
S creep_compliance(const Burgers<S>& foam, const S& time_s) {
  return S(creep_compliance(foam.maxwell, time_s) + creep_compliance(foam.kelvin_voigt, time_s));
}

/// Recovery: the share of a delayed strain that is left a time after unloading.
template <scalar S>
S recovery(const KelvinVoigt<S>& element, const S& time_s) {
  using std::exp;
  return detail::foam::can_pass(time_s)
             ? S(exp(S(S(-S(element.modulus_mpa * time_s)) / element.viscosity_mpa_s)))
             : not_a_number<S>();
}

/// Relaxation: the stress of a strain of 1 that is held from time 0 on, MPa.
template <scalar S>
S relaxation_modulus(const Maxwell<S>& element, const S& time_s) {
  return S(element.modulus_mpa *
           recovery(KelvinVoigt<S>{element.modulus_mpa, element.viscosity_mpa_s}, time_s));
}

/// Strain under any history of stress, exact where the stress is linear from sample to sample.
/// Const, O(1), no memory from the heap. KelvinVoigt or Maxwell alone: make the other one stiff.
template <scalar S = double>
class Creep {
 public:
  /// A value: copy it to go back to this sample later.
  class State {
   public:
    S elastic() const { return elastic_; }  ///< gone as soon as the stress is
    S delayed() const { return delayed_; }  ///< goes away
    S viscous() const { return viscous_; }  ///< stays
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

  /// The strain at the end of a step, with the stress at both ends of it in MPa. A stress may jump
  /// between two steps. One that is not finite is no step: the answer is NaN, the state stays.
  S operator()(const S& before_mpa, const S& after_mpa, State& state) const {
    return advance(factors_, step_s_, before_mpa, after_mpa, state);
  }

  /// A step of another length; one that is not finite or <= 0 is none: NaN, the state stays.
  S operator()(const S& before_mpa, const S& after_mpa, const S& step_s, State& state) const {
    if (!is_finite(step_s) || !(value(step_s) > 0)) {
      return not_a_number<S>();
    }
    return advance(factors(step_s), step_s, before_mpa, after_mpa, state);
  }

 private:
  /// delayed += by_delayed delayed + ..., or delayed = ... over long steps.
  struct Factors {
    S kept = S(0);  ///< 1 or 0
    S by_delayed = S(0);
    S by_before = S(0);  ///< stress at the beginning
    S by_after = S(0);   ///< and at the end
  };

  Factors factors(const S& step_s) const {
    const KelvinVoigt<S>& element = foam_.kelvin_voigt;
    const S delays = S(element.modulus_mpa * step_s) / element.viscosity_mpa_s;
    if (!is_finite(delays)) {
      return {S(0), S(0), S(0), S(S(1) / element.modulus_mpa)};
    }
    const detail::foam::DecayMeans<S> means = detail::foam::decay_means(delays);
    const bool short_step = value(delays) <= 1;
    const S flow = step_s / element.viscosity_mpa_s;
    return {S(short_step ? 1 : 0),
            short_step ? S(-S(means.first * delays)) : recovery(element, step_s),
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
    state.elastic_ = after / foam_.maxwell.modulus_mpa;
    state.delayed_ = S(by.kept * state.delayed_) + change;
    state.viscous_ = state.viscous_ + S(mean * S(step_s / foam_.maxwell.viscosity_mpa_s));
    return state.strain();
  }

  Burgers<S> foam_;
  S step_s_;
  Factors factors_;
};

}  // namespace v0
}  // namespace fingerpad
