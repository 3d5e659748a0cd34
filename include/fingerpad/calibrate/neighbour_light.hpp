// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How neighbouring light acts, from frames whose true depth is known: r, m0 and n of
// neighbour_light.hpp by the least squares
//   min over r, m0, n of the sum over pixels of (l - l_true - m0 e^{n (l - l0)} psi_sum)^2,
// linear in m0 for given n and r: a search along n for every r. The published fit takes logarithms
// of l - l_true and of psi_sum, which are often negative, and of noise where they are small (E011).
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/depth/detail/inclination_sums.hpp"
#include "fingerpad/depth/neighbour_light.hpp"

namespace fingerpad {
inline namespace v0 {

/// Where to look, and at how many pixels. n is looked for in [-1, 1] per mm.
struct NeighbourLightSearch {
  Index min_radius_px = 1;
  Index max_radius_px = 50;  ///< as published
  Index every_px = 4;        ///< use each n-th row and column: neighbours say the same anyway
};

struct [[nodiscard]] NeighbourLightFit {
  FitStatus status = FitStatus::not_converged;
  NeighbourLight<double> light = {};
  double rms_before_mm = 0;  ///< of l - l_true
  double rms_after_mm = 0;   ///< of what the best fit leaves
  double m0_sd = 0;  ///< standard deviations as of independent pixels: too small where the errors
  double n_sd = 0;   ///< of neighbouring pixels are alike
  Index pixels = 0;  ///< that took part
  std::vector<double> rms_of_radius_mm = {};  ///< after the best m0 and n, smallest radius first

  bool ok() const { return status == FitStatus::ok; }
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
inline LightAtN best_along_n(const std::vector<LightSample>& samples) {
  constexpr int steps = 16;
  constexpr double low = -1, high = 1;
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

/// Refuses frames that do not belong together.
template <class Reference, class Measured, class True>
void expects_valid(const NeighbourLightSearch& search,
                   double pitch_mm,
                   const Reference& reference_mm,
                   std::span<const Measured> measured_mm,
                   std::span<const True> true_mm) {
  const char* const owner = "fit_neighbour_light";
  expects(pitch_mm >= 1e-4 && pitch_mm <= 10, owner, "pitch_mm", pitch_mm,
          "in [0.0001, 10]: mm between pixels");
  expects(search.min_radius_px >= 1, owner, "min_radius_px",
          static_cast<long long>(search.min_radius_px), ">= 1");
  expects(search.max_radius_px >= search.min_radius_px && search.max_radius_px <= 1000, owner,
          "max_radius_px", static_cast<long long>(search.max_radius_px),
          "in [min_radius_px, 1000]");
  expects(search.every_px >= 1, owner, "every_px", static_cast<long long>(search.every_px), ">= 1");
  expects(!measured_mm.empty() && measured_mm.size() == true_mm.size(), owner, "number of frames",
          static_cast<long long>(measured_mm.size()), ">= 1 and that of the true depths");
  for (std::size_t k = 0; k < measured_mm.size(); ++k) {
    expects(same_size(measured_mm[k], reference_mm) && same_size(true_mm[k], reference_mm), owner,
            "rows of a frame", static_cast<long long>(rows(measured_mm[k])),
            "of the same size as the reference");
  }
}

/// The pixels of all frames with the sums over a disc of this radius. Refuses frames that do not
/// tell.
template <class Reference, class Measured, class True>
std::vector<LightSample> light_samples(Index radius_px,
                                       Index every_px,
                                       double pitch_mm,
                                       const Reference& reference,
                                       std::span<const Measured> measured_mm,
                                       std::span<const True> true_mm) {
  const InclinationSums<SteppedDisc, double> sums(radius_px, pitch_mm, reference);
  auto workspace = sums.workspace();
  std::vector<LightSample> samples;
  double psi_sq = 0;
  for (std::size_t k = 0; k < measured_mm.size(); ++k) {
    const auto measured = as_view(measured_mm[k]);
    const auto truth = as_view(true_mm[k]);
    sums.scan(measured, workspace);
    for (Index i = 0; i < sums.rows(); i += every_px) {
      sums.sum_row(i, workspace);
      for (Index j = 0; j < sums.cols(); j += every_px) {
        const double l = static_cast<double>(measured(i, j));
        const double error = l - static_cast<double>(truth(i, j));
        const double risen = l - static_cast<double>(reference(i, j));
        constexpr double most_mm = 100;  // what is more is no depth of a fingertip
        if (std::abs(error) < most_mm && std::abs(risen) < most_mm) {
          samples.push_back({error, risen, workspace.sum[static_cast<std::size_t>(j)]});
          psi_sq += square(samples.back().psi_sum_rad);
        }
      }
    }
  }
  const char* const owner = "fit_neighbour_light";
  expects(samples.size() >= 3, owner, "pixels with a reference, measured and true depth",
          static_cast<long long>(samples.size()), ">= 3");
  const double psi_rms = std::sqrt(psi_sq / static_cast<double>(samples.size()));
  expects(psi_rms > 1e-9, owner, "rms of the inclination change summed over the disc", psi_rms,
          "> 1e-9 rad: the frames must differ in shape from the reference");
  return samples;
}

}  // namespace detail

/// Fits r, m0 and n to frames `measured_mm` (smoothed, not compensated) of known depth `true_mm`,
/// with the reference and the pitch that the compensation will use. Pixels count where reference,
/// measured and true depth are finite and less than 100 mm apart. Refuses frames without a change
/// of inclination, or whose change of depth is too uniform to tell n from m0 (parameter_error). Not
/// ok: a fit that takes off less than a tenth of the error, light that is taken away instead of
/// added (m0 < 0, as of measured and true depths exchanged), and a best n or radius at an end of
/// the search. Allocates; O(radii (frames rows cols + 70 pixels)).
template <grid Reference, grid Measured, grid True>
NeighbourLightFit fit_neighbour_light(double pitch_mm,
                                      const Reference& reference_mm,
                                      std::span<const Measured> measured_mm,
                                      std::span<const True> true_mm,
                                      const NeighbourLightSearch& search = {}) {
  detail::expects_valid(search, pitch_mm, reference_mm, measured_mm, true_mm);
  NeighbourLightFit fit;
  detail::LightAtN best{};
  double count = 0;
  const auto rms = [&](double sum_sq) { return std::sqrt((std::max)(sum_sq, 0.0) / count); };
  for (Index r = search.min_radius_px; r <= search.max_radius_px; ++r) {
    const auto samples = detail::light_samples(r, search.every_px, pitch_mm, as_view(reference_mm),
                                               measured_mm, true_mm);
    count = static_cast<double>(samples.size());
    const detail::LightAtN at = detail::best_along_n(samples);
    fit.rms_of_radius_mm.push_back(rms(at.left_sq));
    if (r == search.min_radius_px || at.left_sq < best.left_sq) {
      best = at;
      fit.light = {r, at.m0, at.n};
      double before_sq = 0;
      for (const detail::LightSample& s : samples) {
        before_sq += square(s.error_mm);
      }
      fit.rms_before_mm = rms(before_sq);
    }
  }
  const double determinant = best.uu * best.vv - best.uv * best.uv;
  expects(determinant > 1e-9 * best.uu * best.vv, "fit_neighbour_light",
          "independent share of n in the fit", determinant / (best.uu * best.vv),
          "> 1e-9: depths must change by different amounts, and some error must be explained");
  fit.pixels = static_cast<Index>(count);
  fit.rms_after_mm = rms(best.left_sq);
  const double variance = square(fit.rms_after_mm) * count / (count - 2);
  fit.m0_sd = std::sqrt(variance * best.vv / determinant);
  fit.n_sd = std::sqrt(variance * best.uu / determinant);
  const bool at_end = std::abs(best.n) > 0.998 || (fit.light.radius_px == search.max_radius_px &&
                                                   search.max_radius_px > search.min_radius_px);
  fit.status = fit.rms_after_mm > 0.9 * fit.rms_before_mm ? FitStatus::light_unexplained
               : best.m0 < 0                              ? FitStatus::light_taken_away
               : at_end                                   ? FitStatus::at_end_of_search
                                                          : FitStatus::ok;
  return fit;
}

}  // namespace v0
}  // namespace fingerpad
