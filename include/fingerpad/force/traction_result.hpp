// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What a frame of the traction field says as a whole.
#include <cstdint>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

// What became of a frame of the traction field.

enum class TractionStatus : std::uint8_t {
  ok,
  no_contact,    ///< no dot is in contact: force and moment are 0; the maps are there
  incomplete,    ///< force and moment miss the share of some dots in contact or beside them, which
                 ///< have no load: they lie on the edge of the grid, or dots were not found
  bad_pressure,  ///< <= 0, above 10^6 MPa or NaN: nothing is known
  too_few_dots,  ///< no dot was found with all its neighbours: nothing is known
  no_balance,    ///< BalancedModulus: the free part is too small, or does not hold the pressure
  refused,       ///< a grid, state or workspace has another size: nothing was done
};

/// "ok", "no contact", ...
constexpr const char* name_of(TractionStatus status) {
  switch (status) {
    case TractionStatus::ok:
      return "ok";
    case TractionStatus::no_contact:
      return "no contact";
    case TractionStatus::incomplete:
      return "incomplete";
    case TractionStatus::bad_pressure:
      return "bad pressure";
    case TractionStatus::too_few_dots:
      return "too few dots";
    case TractionStatus::no_balance:
      return "no balance";
    case TractionStatus::refused:
      return "refused";
  }
  return "unknown";
}

namespace detail::traction {

// Where mu t (shear modulus times thickness of the stress-free membrane) comes from: given, or from
// the balance of the free part, where the membrane alone holds the pressure.
//
// There the mean of the normal loads is 0: with f the pull on a dot for mu t = 1 N/mm, A its area
// and n its normal, sum p = -mu t sum f . n / A. Least squares of mu t f + p A n would be biased:
// noise of the dots adds to f . f, and mu t comes out too small; f . n it leaves alone.

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
    holding_per_mm += other.holding_per_mm;
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

/// `force_n` and `moment_n_mm` are finite where there is a force (see has_force). Any other number
/// that is not known is NaN.
template <scalar S = double>
struct [[nodiscard]] TractionResult {
  TractionStatus status = TractionStatus::refused;
  Point3<S> force_n = detail::missing_point<S>();      ///< that the object exerts on the pad
  Point3<S> moment_n_mm = detail::missing_point<S>();  ///< about the origin
  S mu_t_n_per_mm = not_a_number<S>();                 ///< that was used
  ModulusBalance<S> balance = {};           ///< what the free part says of mu t, whichever was used
  S free_load_rms_mpa = not_a_number<S>();  ///< of the loads on the free part, where there are
                                            ///< none: the error of a single dot's load
  Index dots_in_contact = 0;
  Index dots_summed = 0;    ///< whose loads make the force
  Index dots_left_out = 0;  ///< in contact or in the ring around it, but without a load
  Index dots_bridged = 0;   ///< not found, but put between their neighbours for the sums
  Index dots_loaded = 0;    ///< that have a load in the maps, if there is a modulus
  Index cells_refused = 0;  ///< folded, or stretched beyond measure
  Index cells_slack = 0;    ///< with a tension below 0
  S smallest_tension_n_per_mm = not_a_number<S>();  ///< of all cells

  bool accepted() const { return status != TractionStatus::refused; }
  bool ok() const { return status == TractionStatus::ok; }
  bool has_force() const {
    return ok() || status == TractionStatus::no_contact || status == TractionStatus::incomplete;
  }
};

}  // namespace v0
}  // namespace fingerpad
