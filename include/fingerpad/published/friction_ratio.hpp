// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How near an object is to slipping, from the forces. Source: "Another Approach for Estimation of
// Slippage Degree" of the slides on slip. At a macroscopic slip the ratio of tangential to normal
// force is about the friction coefficient, mu0 = F0 / N0. It is stored, and from then on
//
//   F / N < F0 / N0   perfect contact or partial slip
//   F / N ~ F0 / N0   macroscopic slip
//
// Coulomb's law is a poor approximation for soft pads: mu0 is the ratio at the last slip, not a
// constant.
#include <cmath>
#include <cstdint>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

template <scalar S = double>
struct FrictionTest {
  S alarm_fraction = S(9) / S(10);  ///< alarm at F/N >= this share of F0/N0, in (0, 1]
  S min_normal_n = S(5) / S(100);   ///< N, > 0; no ratio below this normal force
};

/// Refuses what has no meaning (parameter_error).
template <scalar S>
void expects_valid(const FrictionTest<S>& test) {
  expects(value(test.alarm_fraction) > 0 && value(test.alarm_fraction) <= 1, "FrictionTest",
          "alarm_fraction", test.alarm_fraction, "in (0, 1]");
  expects(is_finite(test.min_normal_n) && value(test.min_normal_n) > 0, "FrictionTest",
          "min_normal_n", test.min_normal_n, "finite and > 0");
}

enum class FrictionStatus : std::uint8_t {
  held,             ///< F/N is below the alarm: perfect contact or partial slip
  near_slip,        ///< F/N is about that of the last slip
  sliding,          ///< reported by the caller; F/N is stored
  no_slip_yet,      ///< no F0/N0 to compare with
  no_contact,       ///< the normal force is too small
  negative_normal,  ///< at least min_normal_n, but negative: F_z of a wrench? Pass the force as a
                    ///< Point3, or WrenchResult::normal_force_n()
  no_force_known,   ///< a force is not finite
};

/// "held", "near slip", ...
constexpr const char* name_of(FrictionStatus status) {
  switch (status) {
    case FrictionStatus::held:
      return "held";
    case FrictionStatus::near_slip:
      return "near slip";
    case FrictionStatus::sliding:
      return "sliding";
    case FrictionStatus::no_slip_yet:
      return "no slip yet";
    case FrictionStatus::no_contact:
      return "no contact";
    case FrictionStatus::negative_normal:
      return "negative normal force: F_z of a wrench?";
    case FrictionStatus::no_force_known:
      return "no force known";
  }
  return "unknown";
}

template <scalar S = double>
struct [[nodiscard]] FrictionResult {
  FrictionStatus status = FrictionStatus::no_force_known;
  bool alarm = false;                      ///< near slip, or the caller reports sliding
  S ratio = not_a_number<S>();             ///< F / N; NaN: none
  S remembered_ratio = not_a_number<S>();  ///< F0 / N0; NaN: none yet
  S margin = not_a_number<S>();            ///< 1 - (F/N) / (F0/N0): 0 at slip; NaN where unknown

  /// Whether there is a ratio.
  bool ok() const { return is_finite(ratio); }
};

/// Compares F/N with the ratio at the last macroscopic slip. Const, O(1), allocates nothing.
template <scalar S = double>
class FrictionRatio {
 public:
  class State {
   public:
    bool has_slipped() const { return has_slipped_; }
    void reset() { *this = State(); }

   private:
    friend class FrictionRatio;
    State() = default;
    S ratio_ = not_a_number<S>();
    bool has_slipped_ = false;
  };

  /// Refuses bad parameters (parameter_error).
  explicit FrictionRatio(const FrictionTest<S>& test = {}) : test_(test) { expects_valid(test); }

  State start() const { return State(); }

  /// `normal_n` is positive in a press. `sliding`: the object slips as a whole in this frame, for
  /// example because the stick ratio is below a bound. The ratio of every sliding frame replaces
  /// the stored one; what remains is that of the last frame of the last slip.
  FrictionResult<S> operator()(const S& tangential_n,
                               const S& normal_n,
                               bool sliding,
                               State& state) const {
    FrictionResult<S> result{FrictionStatus::no_force_known, sliding, not_a_number<S>(),
                             state.ratio_, not_a_number<S>()};
    if (!is_plausible(tangential_n) || !is_plausible(normal_n)) {
      return result;
    }
    if (!(value(normal_n) >= value(test_.min_normal_n))) {
      const bool pulls = value(normal_n) <= -value(test_.min_normal_n);
      result.status = pulls ? FrictionStatus::negative_normal : FrictionStatus::no_contact;
      return result;
    }
    const S magnitude = value(tangential_n) < 0 ? S(-tangential_n) : tangential_n;
    const S ratio = magnitude / normal_n;
    if (!is_finite(ratio)) {
      return result;
    }
    result.ratio = ratio;
    if (sliding && ratio > S(1e-6)) {  // without a tangential force there is no friction ratio
      state.ratio_ = result.remembered_ratio = ratio;
      state.has_slipped_ = true;
    }
    judge(sliding, state, result);
    return result;
  }

  /// The same for the two components of the tangential force.
  FrictionResult<S> operator()(const Point2<S>& tangential_n,
                               const S& normal_n,
                               bool sliding,
                               State& state) const {
    using std::sqrt;
    const S sum_sq = square(tangential_n.x) + square(tangential_n.y);
    return (*this)(value(sum_sq) > 0 ? S(sqrt(sum_sq)) : sum_sq, normal_n, sliding, state);
  }

  /// The same for the force on the pad, as in WrenchResult: F_z < 0 in a press.
  FrictionResult<S> operator()(const Point3<S>& force_n, bool sliding, State& state) const {
    return (*this)(Point2<S>{force_n.x, force_n.y}, S(-force_n.z), sliding, state);
  }

 private:
  void judge(bool sliding, const State& state, FrictionResult<S>& result) const {
    if (!state.has_slipped_) {
      result.status = sliding ? FrictionStatus::sliding : FrictionStatus::no_slip_yet;
      return;
    }
    const S share = result.ratio / state.ratio_;
    result.margin = S(1) - share;
    const bool near_slip = value(share) >= value(test_.alarm_fraction);
    result.alarm = sliding || near_slip;
    result.status = sliding     ? FrictionStatus::sliding
                    : near_slip ? FrictionStatus::near_slip
                                : FrictionStatus::held;
  }

  FrictionTest<S> test_;
};

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
