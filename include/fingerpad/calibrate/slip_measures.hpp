// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How good a sequence of stick ratios is. Source: "Two measures for U" of 003:
//   S = sum of phi_i                            the earlier the ratio falls, the smaller
//   D = sum of phi_(i-1) - phi_i where it falls "regarded as the level of estimation error"
// D contains the fall that there is to measure: D = (phi_1 - phi_n) + sum of the rises (E038). The
// error is what is left without it, D' = D - (phi_1 - phi_n), the sum of the rises: 0 for a ratio
// that only falls. A ratio that never changes has D' = 0 too, so D' says nothing without S.
#include <span>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

struct RatioMeasures {
  double sum = 0;        ///< S
  double decreases = 0;  ///< D
  double rises = 0;      ///< D'; added up as such, so it is >= 0 and exact where it is 0
  Index steps = 0;       ///< ratios that are numbers

  double sum_per_step() const { return per_step(sum); }
  double decreases_per_step() const { return per_step(decreases); }
  double rises_per_step() const { return per_step(rises); }

 private:
  double per_step(double of) const {
    return steps > 0 ? of / static_cast<double>(steps) : not_a_number<double>();
  }
};

/// Of the ratios of all frames in turn. A frame whose answer was kept counts as a step with the
/// last ratio: it adds to S, as slip that is not yet known is late, and nothing to D and D'. NaN
/// (no contact) is no step, and what comes after it is not compared with what was before. O(steps).
template <scalar S>
RatioMeasures measures_of(std::span<const S> ratios) {
  RatioMeasures m;
  double before = not_a_number<double>();
  for (const S& ratio : ratios) {
    const double now = static_cast<double>(value(ratio));
    if (is_finite(now)) {
      m.sum += now;
      m.decreases += now < before ? before - now : 0;
      m.rises += before < now ? now - before : 0;
      ++m.steps;
    }
    before = now;
  }
  return m;
}

}  // namespace v0
}  // namespace fingerpad
