// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The fit of the neighbouring light as printed: Ito, Kim, Obinata, "Shape sensing by vision-based
// tactile sensor" (slides), "Parameter identification of r, m_0, n": the least squares of
//   L = ln(l - l_a)   against   F = ln psi_sum + ln m_0 + n (l - l_0)
// for each radius r, the best of which is taken. Logarithms do not exist where an error or a sum is
// not positive: those pixels drop out, and the rest is biased toward large errors (E011).
// calibrate/neighbour_light.hpp fits the errors themselves.
#include <cmath>
#include <span>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// One pixel, for one radius.
struct LoggedLight {
  double error_mm;     ///< l - l_a: measured less actual depth
  double risen_mm;     ///< l - l_0: measured less that of the free pad
  double psi_sum_rad;  ///< of the disc
};

struct [[nodiscard]] LoggedFit {
  bool determined = false;  ///< two pixels or more with logarithms, of different depth
  double m0_mm_per_rad = 0;
  double n_per_mm = 0;
  double sum_sq = 0;  ///< S = sum (L - F)^2, by which radii are compared
  Index used = 0;     ///< pixels whose logarithms exist
  Index left_out = 0;

  bool ok() const { return determined; }
};

/// ln m_0 and n by least squares, in closed form. O(pixels), allocates nothing.
inline LoggedFit fit_by_logarithms(std::span<const LoggedLight> pixels) {
  LoggedFit fit;
  double x = 0, y = 0, xx = 0, xy = 0, yy = 0;  // of L - ln psi_sum = ln m_0 + n risen
  for (const LoggedLight& p : pixels) {
    if (!(p.error_mm > 0 && p.psi_sum_rad > 0 && is_finite(p.risen_mm))) {
      ++fit.left_out;
      continue;
    }
    const double ratio = std::log(p.error_mm) - std::log(p.psi_sum_rad);
    x += p.risen_mm;
    y += ratio;
    xx += p.risen_mm * p.risen_mm;
    xy += p.risen_mm * ratio;
    yy += ratio * ratio;
    ++fit.used;
  }
  const double count = static_cast<double>(fit.used);
  const double spread = xx - x * x / count;
  if (!(spread > 1e-12 * xx)) {
    return fit;
  }
  fit.determined = true;
  fit.n_per_mm = (xy - x * y / count) / spread;
  const double ln_m0 = (y - fit.n_per_mm * x) / count;
  fit.m0_mm_per_rad = std::exp(ln_m0);
  fit.sum_sq = yy - ln_m0 * y - fit.n_per_mm * xy;
  fit.sum_sq = fit.sum_sq > 0 ? fit.sum_sq : 0;
  return fit;
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
