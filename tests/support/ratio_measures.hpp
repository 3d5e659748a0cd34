// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Quality of a sequence of stick ratios. Source: Ito, Kim, Obinata, "Robust slippage degree
// estimation ...", backup slides, "Two measures for U":
//   S = sum of phi_i                              smaller the earlier the ratio falls
//   D = sum of phi_(i-1) - phi_i over its falls   "regarded as the level of estimation error"
// D includes the true fall: D = (phi_1 - phi_n) + sum of the rises (E038). The error is therefore
// D' = D - (phi_1 - phi_n), the sum of the rises. It is 0 for a ratio that only falls, but also for
// one that never changes, so D' is meaningful only together with S.
#include <cmath>
#include <limits>
#include <vector>

namespace test {

struct RatioMeasures {
  double sum = 0;        ///< S
  double decreases = 0;  ///< D
  double rises = 0;      ///< D', summed directly: exactly 0 without rises
  double steps = 0;      ///< number of finite ratios
};

/// Measures of the ratios of all frames in order. NaN (no contact) is no step, and the ratios
/// before and after it are not compared.
inline RatioMeasures measures_of(const std::vector<double>& ratios) {
  RatioMeasures m;
  double before = std::numeric_limits<double>::quiet_NaN();
  for (const double now : ratios) {
    if (std::isfinite(now)) {
      m.sum += now;
      m.decreases += now < before ? before - now : 0;
      m.rises += before < now ? now - before : 0;
      m.steps += 1;
    }
    before = now;
  }
  return m;
}

}  // namespace test
