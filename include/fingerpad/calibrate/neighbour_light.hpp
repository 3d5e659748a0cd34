// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How neighbouring light acts, from frames whose true depth is known: r, m0 and n of
// neighbour_light.hpp by the least squares
//   min over r, m0, n of the sum over pixels of (l - l_true - m0 e^{n (l - l0)} psi_sum)^2,
// linear in m0 for given n and r: a search along n for every r. The published fit takes logarithms
// of l - l_true and of psi_sum, which are often negative, and of noise where they are small (E011).
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/depth/detail/inclination_sums.hpp"
#include "fingerpad/depth/neighbour_light.hpp"

namespace fingerpad {
inline namespace v0 {

/// Where to look, and at how many pixels.
struct NeighbourLightSearch {
  Index smallest_radius_px = 1;
  Index largest_radius_px = 50;  ///< as published
  double smallest_n_per_mm = -1;
  double largest_n_per_mm = 1;
  Index every_px = 4;  ///< use each n-th row and column: neighbours say the same anyway
};

struct NeighbourLightFit {
  NeighbourLight<double> light;
  double rms_before_mm;  ///< of l - l_true
  double rms_after_mm;   ///< of what the best fit leaves
  double m0_sd;     ///< standard deviations as of independent pixels: too small where the errors
  double n_sd;      ///< of neighbouring pixels are alike
  bool n_at_limit;  ///< the best n is an end of the search
  Index pixels;     ///< that took part
  std::vector<double> rms_of_radius_mm;  ///< after the best m0 and n, smallest radius first
};

namespace detail {

/// One pixel of the fit.
struct LightSample {
  double error_mm;  ///< l - l_true
  double risen_mm;  ///< l - l0
  double psi_sum_rad;
};

/// The best m0 for one n, and what it leaves.
struct LightAtN {
  double n;
  double m0 = 0;
  double left_sq = 0;  ///< sum of squared residuals
  // of the Jacobian's columns u = e^{n dl} psi_sum and v = m0 dl u:
  double uu = 0, uv = 0, vv = 0;
};

inline LightAtN light_at(double n, const std::vector<LightSample>& samples) {
  LightAtN at{n};
  double eu = 0, ee = 0;
  for (const LightSample& s : samples) {
    const double u = std::exp(n * s.risen_mm) * s.psi_sum_rad;
    eu += s.error_mm * u;
    ee += s.error_mm * s.error_mm;
    at.uu += u * u;
    at.uv += s.risen_mm * u * u;
    at.vv += s.risen_mm * u * s.risen_mm * u;
  }
  at.m0 = at.uu > 0 ? eu / at.uu : 0;
  at.uv *= at.m0;
  at.vv *= at.m0 * at.m0;
  at.left_sq = ee - at.m0 * eu;
  return at;
}

/// Where the residual is orthogonal to v: half the slope of left_sq along n, less its sign.
inline double slope_along_n(const LightAtN& at, const std::vector<LightSample>& samples) {
  double slope = 0;
  for (const LightSample& s : samples) {
    const double u = std::exp(at.n * s.risen_mm) * s.psi_sum_rad;
    slope += (s.error_mm - at.m0 * u) * s.risen_mm * u;
  }
  return at.m0 * slope;
}

/// The best n: the lowest of a scan, then the zero of the slope beside it by bisection, which keeps
/// all digits where a search for the lowest value would keep half.
inline LightAtN best_along_n(const std::vector<LightSample>& samples, double low, double high) {
  constexpr int steps = 16;
  const auto at = [&](int k) { return low + (high - low) * k / steps; };
  int best = 0;
  double best_sq = light_at(low, samples).left_sq;
  for (int k = 1; k <= steps; ++k) {
    const double left_sq = light_at(at(k), samples).left_sq;
    if (left_sq < best_sq) {
      best = k;
      best_sq = left_sq;
    }
  }
  double from = at(best > 0 ? best - 1 : 0);
  double to = at(best < steps ? best + 1 : steps);
  for (int k = 0; k < 52 && from < to; ++k) {
    const double middle = (from + to) / 2;
    (slope_along_n(light_at(middle, samples), samples) > 0 ? from : to) = middle;
  }
  return light_at((from + to) / 2, samples);
}

}  // namespace detail

/// Fits r, m0 and n to frames `measured_mm` (smoothed, not compensated) of known depth `true_mm`,
/// with the reference and the pitch that the compensation will use, and its `Disc`. Pixels count
/// where reference, measured and true depth are finite. Refuses frames without a change of
/// inclination, or whose change of depth is too uniform to tell n from m0 (parameter_error).
/// Allocates; O(radii (frames rows cols + 70 pixels)).
template <class Disc = detail::SteppedDisc, grid Reference, grid Measured, grid True>
NeighbourLightFit fit_neighbour_light(double pitch_mm,
                                      const Reference& reference_mm,
                                      std::span<const Measured> measured_mm,
                                      std::span<const True> true_mm,
                                      const NeighbourLightSearch& search = {}) {
  const char* const owner = "fit_neighbour_light";
  expects(std::isfinite(pitch_mm) && pitch_mm > 0, owner, "pitch_mm", pitch_mm, "finite and > 0");
  expects(search.smallest_radius_px >= 1, owner, "smallest_radius_px",
          static_cast<long long>(search.smallest_radius_px), ">= 1");
  expects(search.largest_radius_px >= search.smallest_radius_px && search.largest_radius_px <= 1000,
          owner, "largest_radius_px", static_cast<long long>(search.largest_radius_px),
          "in [smallest_radius_px, 1000]");
  expects(search.smallest_n_per_mm < search.largest_n_per_mm, owner, "largest_n_per_mm",
          search.largest_n_per_mm, "> smallest_n_per_mm");
  expects(search.every_px >= 1, owner, "every_px", static_cast<long long>(search.every_px), ">= 1");
  expects(!measured_mm.empty() && measured_mm.size() == true_mm.size(), owner, "number of frames",
          static_cast<long long>(measured_mm.size()), ">= 1 and that of the true depths");
  for (std::size_t k = 0; k < measured_mm.size(); ++k) {
    expects(same_size(measured_mm[k], reference_mm) && same_size(true_mm[k], reference_mm), owner,
            "rows of a frame", static_cast<long long>(rows(measured_mm[k])),
            "of the same size as the reference");
  }

  const auto reference = as_view(reference_mm);
  NeighbourLightFit fit{};
  double best_sq = 0;
  detail::LightAtN best{};
  std::vector<detail::LightSample> samples;
  for (Index r = search.smallest_radius_px; r <= search.largest_radius_px; ++r) {
    const detail::InclinationSums<Disc, double> sums(r, pitch_mm, reference);
    auto workspace = sums.workspace();
    samples.clear();
    for (std::size_t k = 0; k < measured_mm.size(); ++k) {
      const auto measured = as_view(measured_mm[k]);
      const auto truth = as_view(true_mm[k]);
      sums.scan(measured, workspace);
      for (Index i = 0; i < sums.rows(); i += search.every_px) {
        sums.sum_row(i, workspace);
        for (Index j = 0; j < sums.cols(); j += search.every_px) {
          const double l = static_cast<double>(measured(i, j));
          const double error = l - static_cast<double>(truth(i, j));
          const double risen = l - static_cast<double>(reference(i, j));
          if (is_finite(error) && is_finite(risen)) {
            samples.push_back({error, risen, workspace.sum[static_cast<std::size_t>(j)]});
          }
        }
      }
    }
    double psi_sq = 0, before_sq = 0;
    for (const detail::LightSample& s : samples) {
      psi_sq += s.psi_sum_rad * s.psi_sum_rad;
      before_sq += s.error_mm * s.error_mm;
    }
    fit.pixels = static_cast<Index>(samples.size());
    expects(fit.pixels >= 3, owner, "pixels with a reference, measured and true depth",
            static_cast<long long>(fit.pixels), ">= 3");
    const double count = static_cast<double>(fit.pixels);
    const double psi_rms = std::sqrt(psi_sq / count);
    expects(psi_rms > 1e-9, owner, "rms of the inclination change summed over the disc", psi_rms,
            "> 1e-9 rad: the frames must differ in shape from the reference");
    const detail::LightAtN at =
        detail::best_along_n(samples, search.smallest_n_per_mm, search.largest_n_per_mm);
    fit.rms_of_radius_mm.push_back(std::sqrt((at.left_sq > 0 ? at.left_sq : 0) / count));
    if (r == search.smallest_radius_px || at.left_sq < best_sq) {
      best = at;
      best_sq = at.left_sq;
      fit.light.radius_px = r;
      fit.rms_before_mm = std::sqrt(before_sq / count);
    }
  }

  const double count = static_cast<double>(fit.pixels);
  const double determinant = best.uu * best.vv - best.uv * best.uv;
  expects(determinant > 1e-9 * best.uu * best.vv, owner, "independent share of n in the fit",
          determinant / (best.uu * best.vv),
          "> 1e-9: depths must change by different amounts, and some error must be explained");
  const double variance = (best_sq > 0 ? best_sq : 0) / (count - 2);
  fit.light.m0_mm_per_rad = best.m0;
  fit.light.n_per_mm = best.n;
  fit.rms_after_mm = std::sqrt((best_sq > 0 ? best_sq : 0) / count);
  fit.m0_sd = std::sqrt(variance * best.vv / determinant);
  fit.n_sd = std::sqrt(variance * best.uu / determinant);
  const double margin = (search.largest_n_per_mm - search.smallest_n_per_mm) / 1000;
  fit.n_at_limit =
      best.n < search.smallest_n_per_mm + margin || best.n > search.largest_n_per_mm - margin;
  return fit;
}

}  // namespace v0
}  // namespace fingerpad
