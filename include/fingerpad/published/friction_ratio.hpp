// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How near an object is to slipping, from the forces. Source: "Another Approach for Estimation of
// Slippage Degree" of the slides on slip. At a macroscopic slip mu_0 = F_0 / N_0 is stored. Then
//   F / N < mu_0   perfect contact or partial slip
//   F / N ~ mu_0   macroscopic slip
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {
namespace published {

/// The object is the state: copy it to return to a frame. O(1).
template <scalar S = double>
class FrictionRatio {
 public:
  /// 1 - (F / N) / mu_0 for the tangential force F >= 0 and the normal force N > 0 in a press: 0 at
  /// a macroscopic slip, negative beyond. `slips`: the object slips as a whole in this frame, which
  /// stores F / N. NaN before the first slip, and for forces that are negative or not finite.
  S operator()(const S& F_n, const S& N_n, bool slips) {
    const bool pressed = is_plausible(F_n) && is_plausible(N_n) && S(0) < N_n && !(F_n < S(0));
    const S ratio = pressed ? F_n / N_n : not_a_number<S>();
    if (slips && S(0) < ratio) {
      mu_0_ = ratio;
    }
    return S(1) - ratio / mu_0_;
  }
  /// F_0 / N_0 of the last slip; NaN before.
  const S& mu_0() const { return mu_0_; }

 private:
  S mu_0_ = not_a_number<S>();
};

}  // namespace published
}  // namespace v1
}  // namespace fingerpad
