// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Neighbouring light as printed: Ito, Kim, Obinata, "Shape sensing by vision-based tactile sensor"
// (slides), compensation for approximation error and "Parameter identification of r, m_0, n".
//   l' = max(l - m psi_sum, 0),   m = m_0 exp(n (l - l_0)),   psi = atan|grad l|
// with psi_sum = sum over the disc of radius r of psi - psi_0, by a plain double loop. Symbols in
// the order that their units require (E008-E010). The fit takes, for each radius r = 1..50,
//   F = ln psi_sum + ln m_0 + n (l - l_0)   to   L = ln(l - l_a)
// by least squares, and then the best radius. Pixels whose error or sum is not positive have no
// logarithm and are left out, which biases the fit toward large errors (E011).
// depth/neighbour_light.hpp and calibrate/neighbour_light.hpp are the defaults.
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

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

/// psi at pixel (i, j) in rad, by central differences; NaN at the image's border and where a depth
/// is missing.
template <grid Depth>
double inclination(const Depth& depth_mm, double pitch_mm, Index i, Index j) {
  const auto l = as_view(depth_mm);
  if (i < 1 || j < 1 || i + 1 >= l.rows() || j + 1 >= l.cols()) {
    return not_a_number<double>();
  }
  const double down = static_cast<double>(l(i + 1, j)) - static_cast<double>(l(i - 1, j));
  const double right = static_cast<double>(l(i, j + 1)) - static_cast<double>(l(i, j - 1));
  return std::atan(std::hypot(right, down) / (2 * pitch_mm));
}

/// psi - psi_0 of every pixel in rad, row by row; 0 where it is not known.
template <grid Depth, grid Reference>
std::vector<double> inclination_change(const Depth& depth_mm,
                                       const Reference& free_mm,
                                       double pitch_mm) {
  std::vector<double> change;
  for (Index i = 0; i < rows(depth_mm); ++i) {
    for (Index j = 0; j < cols(depth_mm); ++j) {
      const double x = inclination(depth_mm, pitch_mm, i, j) - inclination(free_mm, pitch_mm, i, j);
      change.push_back(is_finite(x) ? x : 0);
    }
  }
  return change;
}

/// psi_sum at pixel (i, j) in rad. O(r^2).
inline double disc_sum(std::span<const double> change, Index cols, Index r, Index i, Index j) {
  const Index rows = static_cast<Index>(change.size()) / cols;
  double sum = 0;
  for (Index y = -r; y <= r; ++y) {
    for (Index x = -r; x <= r; ++x) {
      const bool is_in_image = i + y >= 0 && i + y < rows && j + x >= 0 && j + x < cols;
      if (x * x + y * y <= r * r && is_in_image) {
        sum += change[static_cast<std::size_t>((i + y) * cols + j + x)];
      }
    }
  }
  return sum;
}

/// l' of a pixel in mm; the published r is 30 px.
inline double without_neighbour_light(double depth_mm,
                                      double free_mm,
                                      double psi_sum_rad,
                                      double m0_mm_per_rad = 0.000886,
                                      double n_per_mm = 0.224) {
  const double m = m0_mm_per_rad * std::exp(n_per_mm * (depth_mm - free_mm));
  return std::fmax(depth_mm - m * psi_sum_rad, 0);
}

struct [[nodiscard]] IdentifiedLight {
  Index radius_px = 0;                 ///< r; 0: no radius has a fit
  LoggedFit fit = {};                  ///< m_0, n and S at this radius
  std::array<double, 50> sum_sq = {};  ///< S of each radius, 1 px first; NaN: no fit

  bool ok() const { return radius_px > 0; }
};

/// r, m_0 and n from a measured and an actual depth map and that of the free pad, of one size; none
/// if the sizes differ. O(pixels r^2) for every radius; allocates.
template <grid Depth, grid Actual, grid Reference>
IdentifiedLight identify_neighbour_light(const Depth& depth_mm,
                                         const Actual& actual_mm,
                                         const Reference& free_mm,
                                         double pitch_mm) {
  IdentifiedLight best;
  const auto l = as_view(depth_mm);
  const auto actual = as_view(actual_mm);
  const auto free = as_view(free_mm);
  if (!same_size(l, actual) || !same_size(l, free)) {
    return best;
  }
  const std::vector<double> change = inclination_change(l, free, pitch_mm);
  for (Index r = 1; r <= 50; ++r) {
    std::vector<LoggedLight> pixels;
    for (Index i = 0; i < l.rows(); ++i) {
      for (Index j = 0; j < l.cols(); ++j) {
        const double here = static_cast<double>(l(i, j));
        pixels.push_back({here - static_cast<double>(actual(i, j)),
                          here - static_cast<double>(free(i, j)),
                          disc_sum(change, l.cols(), r, i, j)});
      }
    }
    const LoggedFit fit = fit_by_logarithms(pixels);
    best.sum_sq[static_cast<std::size_t>(r - 1)] = fit.ok() ? fit.sum_sq : not_a_number<double>();
    if (fit.ok() && (!best.ok() || fit.sum_sq < best.fit.sum_sq)) {
      best.radius_px = r;
      best.fit = fit;
    }
  }
  return best;
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
