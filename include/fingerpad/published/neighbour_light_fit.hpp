// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The fit of the neighbouring light as printed: Ito, Kim, Obinata, "Shape sensing by vision-based
// tactile sensor" (slides), "Parameter identification of r, m_0, n". It fits, by least squares,
//   F = ln psi_sum + ln m_0 + n (l - l_0)   to   L = ln(l - l_a)
// for each radius r and takes the best radius. Pixels whose error or sum is not positive have no
// logarithm and are left out, which biases the fit toward large errors (E011).
// calibrate/neighbour_light.hpp fits the errors themselves.
#include <cmath>
#include <span>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// Data of one pixel, for one radius.
struct LoggedLight {
  double error_mm;     ///< l - l_a: measured depth less actual depth
  double risen_mm;     ///< l - l_0: measured depth less that of the free pad
  double psi_sum_rad;  ///< sum over the disc of psi(t) - psi(t0)
};

struct [[nodiscard]] LoggedFit {
  bool determined = false;  ///< at least two pixels of different depth have logarithms
  double m0_mm_per_rad = 0;
  double n_per_mm = 0;
  double sum_sq = 0;  ///< S = sum (L - F)^2; the best radius has the smallest
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
