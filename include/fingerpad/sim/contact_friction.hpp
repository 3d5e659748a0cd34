// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Friction and contact area of polymers as powers of the load (Howell and Mazur; Lincoln), and
// Hertz's contact of a sphere.
//
// The paper writes F = (K N^(beta-1)) N and calls the bracket the coefficient of friction. As the
// load goes to 0, this coefficient is unbounded but the force goes to 0. Computations here
// therefore use the force.
#include <cmath>
#include <concepts>
#include <numbers>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {
namespace foam {

/// x^exponent for x > 0, else 0 with derivative 0; NaN for NaN.
template <scalar S>
S positive_power(const S& x, const S& exponent) {
  using std::exp;
  using std::log;
  using std::pow;
  if (value(x) <= 0) {
    return S(0);
  }
  if constexpr (std::floating_point<S>) {
    return pow(x, exponent);
  } else {
    const S logarithm = log(x);
    return S(exp(S(exponent * logarithm)));
  }
}

/// The cube root of x for x > 0, else 0 with derivative 0; NaN for NaN.
template <scalar S>
S positive_cube_root(const S& x) {
  if constexpr (std::floating_point<S>) {
    return x <= 0 ? S(0) : std::cbrt(x);
  } else {
    return positive_power(x, S(S(1) / S(3)));
  }
}

}  // namespace foam
}  // namespace detail

/// F = K N^beta.
template <scalar S = double>
struct PolymerFriction {
  S factor = S(1);           ///< K > 0, N^(1 - beta); 1 as in eq. 8
  S exponent = S(2) / S(3);  ///< beta, in (0, 1]: 2/3 for rubber-like solids, 1 is Coulomb's law
};

/// Refuses values out of range (parameter_error).
template <scalar S>
void expects_valid(const PolymerFriction<S>& friction) {
  expects(is_finite(friction.factor) && value(friction.factor) > 0, "PolymerFriction", "factor",
          friction.factor, "finite and > 0");
  expects(value(friction.exponent) > 0 && value(friction.exponent) <= 1, "PolymerFriction",
          "exponent", friction.exponent, "in (0, 1]");
}

/// The maximum friction force under a normal load, N; 0 for loads <= 0.
template <scalar S>
S friction_force(const PolymerFriction<S>& friction, const S& normal_n) {
  return S(friction.factor * detail::foam::positive_power(normal_n, friction.exponent));
}

/// 1/mu = N^(1 - beta) / K, the factor of eqs. 5 and 7. It is finite for every load; only its
/// inverse mu is unbounded.
template <scalar S>
S inverse_friction_coefficient(const PolymerFriction<S>& friction, const S& normal_n) {
  const S exponent = S(1) - friction.exponent;
  return S(detail::foam::positive_power(normal_n, exponent) / friction.factor);
}

/// A sphere on an elastic half-space. The paper prints no values.
template <scalar S = double>
struct HertzContact {
  S radius_mm = S(10);                   ///< R > 0
  S reduced_modulus_mpa = S(1) / S(10);  ///< E* > 0: E / (1 - nu^2) if only one body deforms
};

/// Refuses values out of range (parameter_error).
template <scalar S>
void expects_valid(const HertzContact<S>& hertz) {
  expects(is_finite(hertz.radius_mm) && value(hertz.radius_mm) > 0, "HertzContact", "radius_mm",
          hertz.radius_mm, "finite and > 0");
  expects(is_finite(hertz.reduced_modulus_mpa) && value(hertz.reduced_modulus_mpa) > 0,
          "HertzContact", "reduced_modulus_mpa", hertz.reduced_modulus_mpa, "finite and > 0");
}

/// Indentation of the sphere, mm: (9 N^2 / (16 R E*^2))^(1/3); 0 for loads <= 0.
template <scalar S>
S hertz_depth(const HertzContact<S>& hertz, const S& normal_n) {
  using detail::foam::positive_cube_root;
  if (value(normal_n) <= 0) {
    return S(0);
  }
  const S load = S(S(3) * normal_n) / S(S(4) * hertz.reduced_modulus_mpa);
  return positive_cube_root(S(S(load * load) / hertz.radius_mm));
}

/// A = pi R depth, mm^2: proportional to N^(2/3), and 0 for loads <= 0.
template <scalar S>
S contact_area(const HertzContact<S>& hertz, const S& normal_n) {
  const S pi = S(std::numbers::pi_v<long double>);
  return S(S(pi * hertz.radius_mm) * hertz_depth(hertz, normal_n));
}

/// N / A in MPa, computed as proportional to N^(1/3), so that it is 0 and not 0/0 for loads <= 0.
template <scalar S>
S contact_stress(const HertzContact<S>& hertz, const S& normal_n) {
  return S(detail::foam::positive_cube_root(normal_n) / contact_area(hertz, S(1)));
}

/// k_s, the stiffness about a mean load: dN/d(depth) = (6 R E*^2 N)^(1/3), N/mm.
template <scalar S>
S hertz_stiffness(const HertzContact<S>& hertz, const S& mean_normal_n) {
  const S modulus_sq = square(hertz.reduced_modulus_mpa);
  const S product = S(S(S(6) * hertz.radius_mm) * modulus_sq) * mean_normal_n;
  return detail::foam::positive_cube_root(product);
}

}  // namespace v0
}  // namespace fingerpad
