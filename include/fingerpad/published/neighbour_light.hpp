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
inline namespace v1 {
namespace published {

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
  Index radius_px = 0;  ///< r; 0: at no radius two pixels of different depth have logarithms
  double m0_mm_per_rad = 0;
  double n_per_mm = 0;
  double sum_sq = 0;                        ///< S = sum (L - F)^2, the smallest of all radii
  std::array<double, 50> sum_sq_by_radius;  ///< of r = 1..50; NaN: no line

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
  best.sum_sq_by_radius.fill(not_a_number<double>());
  const auto l = as_view(depth_mm);
  const auto l_a = as_view(actual_mm);
  const auto l_0 = as_view(free_mm);
  if (!same_size(l, l_a) || !same_size(l, l_0)) {
    return best;
  }
  const std::vector<double> change = inclination_change(l, l_0, pitch_mm);
  for (Index r = 1; r <= 50; ++r) {
    // sums of x = l - l_0 and y = L - ln psi_sum, for the line y = ln m_0 + n x
    double count = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    for (Index i = 0; i < l.rows(); ++i) {
      for (Index j = 0; j < l.cols(); ++j) {
        const double here = static_cast<double>(l(i, j));
        const double risen = here - static_cast<double>(l_0(i, j));
        const double error = here - static_cast<double>(l_a(i, j));
        const double psi_sum = disc_sum(change, l.cols(), r, i, j);
        if (error > 0 && psi_sum > 0 && is_finite(risen)) {
          const double ratio = std::log(error) - std::log(psi_sum);
          count += 1;
          x += risen;
          y += ratio;
          xx += risen * risen;
          xy += risen * ratio;
          yy += ratio * ratio;
        }
      }
    }
    const double spread = xx - x * x / count;
    const double n = (xy - x * y / count) / spread, ln_m0 = (y - n * x) / count;
    const double sum_sq = std::fmax(yy - ln_m0 * y - n * xy, 0);
    if (spread > 1e-12 * xx) {
      best.sum_sq_by_radius[static_cast<std::size_t>(r - 1)] = sum_sq;
      if (!best.ok() || sum_sq < best.sum_sq) {
        best = {r, std::exp(ln_m0), n, sum_sq, best.sum_sq_by_radius};
      }
    }
  }
  return best;
}

}  // namespace published
}  // namespace v1
}  // namespace fingerpad
