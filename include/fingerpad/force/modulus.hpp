// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Where mu t (shear modulus times thickness of the stress-free membrane) comes from: given, or from
// the balance of the free part, where the membrane alone holds the pressure.
//
// There the mean of the normal loads is 0: with f the pull on a dot for mu t = 1 N/mm, A its area
// and n its normal, sum p = -mu t sum f . n / A. Least squares of mu t f + p A n would be biased:
// noise of the dots adds to f . f, and mu t comes out too small; f . n it leaves alone.
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail::traction {
/// A pressure (MPa) or mu t (N/mm) there can be. Squares of larger ones might overflow.
template <scalar S>
bool is_measure(const S& x) {
  return value(x) > 0 && !(S(1e6) < x);  // false for NaN
}
}  // namespace detail::traction

/// The two sides of the balance. Add up those of several frames, of the free pad say.
template <scalar S = double>
struct ModulusBalance {
  Index dots = 0;           ///< of the free part
  S pressing_mpa = S(0);    ///< sum p
  S holding_per_mm = S(0);  ///< -sum f . n / A, MPa for mu t = 1 N/mm

  /// NaN where the membrane does not hold the pressure.
  S mu_t_n_per_mm() const {
    return value(holding_per_mm) > 0 && value(pressing_mpa) > 0 ? S(pressing_mpa / holding_per_mm)
                                                                : not_a_number<S>();
  }
  ModulusBalance& operator+=(const ModulusBalance& other) {
    dots += other.dots;
    pressing_mpa = pressing_mpa + other.pressing_mpa;
    holding_per_mm = holding_per_mm + other.holding_per_mm;
    return *this;
  }
};

/// A modulus that is known: measured on the material, or the sum of the `balance` of free frames.
template <scalar S = double>
struct GivenModulus {
  S mu_t_n_per_mm = not_a_number<S>();  ///< in (0, 10^6]; there is no default

  S operator()(const ModulusBalance<S>&) const { return mu_t_n_per_mm; }
};
template <scalar S>
GivenModulus(S) -> GivenModulus<S>;
template <scalar S>
void expects_valid(const GivenModulus<S>& modulus) {
  expects(detail::traction::is_measure(modulus.mu_t_n_per_mm), "GivenModulus", "mu_t_n_per_mm",
          modulus.mu_t_n_per_mm, "in (0, 1e6]");
}

/// From the free part of each frame.
struct BalancedModulus {
  Index min_dots = 40;  ///< >= 1: of the free part; noise of mu t goes with its inverse root

  template <scalar S>
  S operator()(const ModulusBalance<S>& balance) const {
    return balance.dots < min_dots ? not_a_number<S>() : balance.mu_t_n_per_mm();
  }
};
inline void expects_valid(const BalancedModulus& modulus) {
  expects(modulus.min_dots >= 1, "BalancedModulus", "min_dots",
          static_cast<long long>(modulus.min_dots), ">= 1");
}

}  // namespace v0
}  // namespace fingerpad
