// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibration of the neighbouring light from frames with known true depth: r, m0 and n of
// neighbour_light.hpp by least squares,
//   min over r, m0, n of the sum over pixels of (l - l_true - m0 e^{n (l - l0)} psi_sum)^2.
// For given n and r it is linear in m0, so only n is searched, for every r. The published fit takes
// logarithms of l - l_true and psi_sum. These are often negative, and mostly noise if small (E011).
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/neighbour_light.hpp"

namespace fingerpad {
inline namespace v0 {

/// Range of the search, and which pixels are used. n is searched in [-1, 1] per mm.
struct NeighbourLightSearch {
  Index min_radius_px = 1;
  Index max_radius_px = 50;  ///< as published
  Index every_px = 4;        ///< uses each n-th row and column: neighbours hardly differ
};

template <scalar S = double>
struct [[nodiscard]] NeighbourLightFit {
  const char* cause = cause::not_converged;  ///< likely mistake
  NeighbourLight<S> light = {};
  S rms_before_mm = S(0);  ///< of l - l_true
  S rms_after_mm = S(0);   ///< of the residual of the best fit
  S m0_sd = S(0);          ///< standard deviations for independent pixels: too small if the
  S n_sd = S(0);           ///< errors of neighbouring pixels are correlated
  Index pixels = 0;        ///< used
  std::vector<S> rms_of_radius_mm = {};  ///< with the best m0 and n, smallest radius first

  bool ok() const { return cause == nullptr; }
};

namespace detail {

/// One pixel of the fit.
template <scalar S>
struct LightSample {
  S error_mm;  ///< l - l_true
  S risen_mm;  ///< l - l0
  S psi_sum_rad;

  /// Factor of m0: e^{n dl} psi_sum.
  S per_m0(const S& n) const {
    using std::exp;
    return S(S(exp(S(n * risen_mm))) * psi_sum_rad);
  }
};

/// The best m0 for one n, and its residual.
template <scalar S>
struct LightAtN {
  S n = S(0);
  S m0 = S(0);
  S left_sq = S(0);  ///< sum of squared residuals
  // of the Jacobian's columns u = e^{n dl} psi_sum and v = m0 dl u:
  S uu = S(0), uv = S(0), vv = S(0);
};

template <scalar S>
LightAtN<S> light_at(const S& n, const std::vector<LightSample<S>>& samples) {
  LightAtN<S> at;
  at.n = n;
  S eu = S(0), ee = S(0);
  for (const LightSample<S>& s : samples) {
    const S u = s.per_m0(n);
    const S v = s.risen_mm * u;
    eu += S(s.error_mm * u);
    ee += square(s.error_mm);
    at.uu += square(u);
    at.uv += S(v * u);
    at.vv += square(v);
  }
  at.m0 = S(0) < at.uu ? S(eu / at.uu) : S(0);
  at.uv = S(at.uv * at.m0);
  at.vv = S(at.vv * square(at.m0));
  at.left_sq = S(ee - at.m0 * eu);
  return at;
}

/// Minus half the slope of left_sq along n. It is 0 where the residual is orthogonal to v.
template <scalar S>
S slope_along_n(const S& n, const std::vector<LightSample<S>>& samples) {
  const S m0 = light_at(n, samples).m0;
  S slope = S(0);
  for (const LightSample<S>& s : samples) {
    const S u = s.per_m0(n);
    slope += S(S(s.error_mm - S(m0 * u)) * S(s.risen_mm * u));
  }
  return S(m0 * slope);
}

/// The best n: a scan finds the lowest left_sq, then bisection finds the zero of the slope beside
/// it. Bisection on the slope keeps all digits; a search for the lowest value would keep half. For
/// dual numbers a last Newton step gives the derivatives, because bisection works on values.
template <scalar S>
LightAtN<S> best_along_n(const std::vector<LightSample<S>>& samples) {
  constexpr int steps = 16;
  using R = scalar_real_t<S>;
  const auto at = [&](int k) { return R(-1) + R(2 * k) / R(steps); };
  int best = 0;
  S best_sq = light_at(S(at(0)), samples).left_sq;
  for (int k = 1; k <= steps; ++k) {
    const S left_sq = light_at(S(at(k)), samples).left_sq;
    if (left_sq < best_sq) {
      best = k;
      best_sq = left_sq;
    }
  }
  R from = at(best > 0 ? best - 1 : 0);
  R to = at(best < steps ? best + 1 : steps);
  for (int k = 0; k < 52 && from < to; ++k) {
    const R middle = (from + to) / R(2);
    (S(0) < slope_along_n(S(middle), samples) ? from : to) = middle;
  }
  const S n = S(R((from + to) / R(2)));
  if constexpr (std::is_same_v<S, R>) {
    return light_at(n, samples);
  }
  const S beside = S(1e-4);
  const S fall = slope_along_n(S(n - beside), samples) - slope_along_n(S(n + beside), samples);
  const S step = slope_along_n(n, samples) * S(beside + beside) / fall;
  // the slope has no zero at an end of the search
  return light_at(square(step) < square(beside) ? S(n + step) : n, samples);
}

/// Refuses a bad search or pitch, and frames of different numbers or sizes.
template <scalar S, class Reference, class Measured, class True>
void expects_valid(const NeighbourLightSearch& search,
                   const S& pitch_mm,
                   const Reference& reference_mm,
                   std::span<const Measured> measured_mm,
                   std::span<const True> true_mm) {
  const char* const owner = "fit_neighbour_light";
  const double pitch = static_cast<double>(value(pitch_mm));
  expects(pitch >= 1e-4 && pitch <= 10, owner, "pitch_mm", pitch_mm,
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

/// The pixels of all frames with the sums over a disc of this radius. Refuses frames with fewer
/// than 3 known pixels or without a change of shape.
template <scalar S, class Reference, class Measured, class True>
std::vector<LightSample<S>> light_samples(Index radius_px,
                                          Index every_px,
                                          const S& pitch_mm,
                                          const Reference& reference,
                                          std::span<const Measured> measured_mm,
                                          std::span<const True> true_mm) {
  using std::sqrt;
  NeighbourLightCompensation<S> light({radius_px, S(0), S(0)}, pitch_mm, reference);
  std::vector<S> cells(static_cast<std::size_t>(light.rows() * light.cols()), S(0));
  const StridedView<S> psi_sum_rad(cells.data(), light.rows(), light.cols(), light.cols());
  std::vector<LightSample<S>> samples;
  S psi_sq = S(0);
  double known = 0;
  for (std::size_t k = 0; k < measured_mm.size(); ++k) {
    const auto measured = as_view(measured_mm[k]);
    const auto truth = as_view(true_mm[k]);
    (void)light.inclination_sums(measured, psi_sum_rad);  // of any unit: the fit judges
    for (Index i = 0; i < light.rows(); i += every_px) {
      for (Index j = 0; j < light.cols(); j += every_px) {
        const S l = S(measured(i, j));
        const S error = l - S(truth(i, j));
        const S risen = l - S(reference(i, j));
        known += is_finite(error) && is_finite(risen) ? 1 : 0;
        const S most_sq = S(1e4);  // more than 100 mm is not a depth of a fingertip
        if (square(error) < most_sq && square(risen) < most_sq) {
          samples.push_back({error, risen, psi_sum_rad(i, j)});
          psi_sq += square(samples.back().psi_sum_rad);
        }
      }
    }
  }
  const char* const owner = "fit_neighbour_light";
  expects(samples.size() >= 3, owner, "pixels with a reference, measured and true depth",
          static_cast<long long>(samples.size()), ">= 3");
  const double share = static_cast<double>(samples.size()) / known;
  expects(share > 0.9, owner, "share of pixels whose depths are less than 100 mm apart", share,
          "> 0.9: depths in mm");
  const S psi_rms = sqrt(S(psi_sq / S(static_cast<double>(samples.size()))));
  expects(static_cast<double>(value(psi_rms)) > 1e-9, owner,
          "rms of the inclination change summed over the disc", psi_rms,
          "> 1e-9 rad: the frames must differ in shape from the reference");
  return samples;
}

}  // namespace detail

/// Fits r, m0 and n to frames `measured_mm` (smoothed, not compensated) of known depth `true_mm`,
/// with the reference and the pitch that the compensation will use. Uses the pixels where
/// reference, measured and true depth are finite and less than 100 mm apart. Refuses frames without
/// a change of inclination, or with a change of depth too uniform to tell n from m0
/// (parameter_error). Not ok: a fit that removes less than a tenth of the error; m0 < 0, that is,
/// light is taken away, as when measured and true depths are exchanged; and a best n or radius at
/// an end of the search. Computed in S for any type of the frames. Allocates; O(radii (frames rows
/// cols + 70 pixels)).
template <scalar S = double, grid Reference, grid Measured, grid True>
NeighbourLightFit<S> fit_neighbour_light(const std::type_identity_t<S>& pitch_mm,
                                         const Reference& reference_mm,
                                         std::span<const Measured> measured_mm,
                                         std::span<const True> true_mm,
                                         const NeighbourLightSearch& search = {}) {
  using std::sqrt;
  detail::expects_valid(search, pitch_mm, reference_mm, measured_mm, true_mm);
  NeighbourLightFit<S> fit;
  detail::LightAtN<S> best;
  S count = S(0);
  const auto rms = [&](const S& sum_sq) {
    return S(0) < sum_sq ? S(sqrt(S(sum_sq / count))) : S(0);
  };
  for (Index r = search.min_radius_px; r <= search.max_radius_px; ++r) {
    const auto samples = detail::light_samples<S>(r, search.every_px, pitch_mm,
                                                  as_view(reference_mm), measured_mm, true_mm);
    count = S(static_cast<double>(samples.size()));
    fit.pixels = static_cast<Index>(samples.size());
    const detail::LightAtN<S> at = detail::best_along_n(samples);
    fit.rms_of_radius_mm.push_back(rms(at.left_sq));
    if (r == search.min_radius_px || at.left_sq < best.left_sq) {
      best = at;
      fit.light = {r, at.m0, at.n};
      S before_sq = S(0);
      for (const detail::LightSample<S>& s : samples) {
        before_sq += square(s.error_mm);
      }
      fit.rms_before_mm = rms(before_sq);
    }
  }
  const S determinant = best.uu * best.vv - square(best.uv);
  const S share = determinant / (best.uu * best.vv);
  const S least = S((std::max)(scalar_real_t<S>(1e-9), scalar_real_t<S>(16) * epsilon<S>()));
  expects(least < share, "fit_neighbour_light", "independent share of n in the fit", share,
          "> 1e-9: depths must change by different amounts, and some error must be explained");
  fit.rms_after_mm = rms(best.left_sq);
  const S variance = square(fit.rms_after_mm) * count / (count - S(2));
  fit.m0_sd = sqrt(S(variance * best.vv / determinant));
  fit.n_sd = sqrt(S(variance * best.uu / determinant));
  const bool at_end =
      square(S(0.998)) < square(best.n) ||
      (fit.light.radius_px == search.max_radius_px && search.max_radius_px > search.min_radius_px);
  fit.cause = S(0.9) * fit.rms_before_mm < fit.rms_after_mm
                  ? "neighbouring light removes less than a tenth of the error: "
                    "check frame, order and unit"
              : best.m0 < S(0) ? "neighbouring light would darken: "
                                 "measured and true depths may be exchanged"
              : at_end         ? cause::at_end_of_search
                               : nullptr;
  return fit;
}

}  // namespace v0
}  // namespace fingerpad
