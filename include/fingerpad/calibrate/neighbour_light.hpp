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
#include <string>
#include <type_traits>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/neighbour_light.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

/// Range of the search, and which pixels are used. n is searched in [-1, 1] per mm.
struct NeighbourLightSearch {
  Index min_radius_px = 1;    ///< in [1, 1000]
  Index max_radius_px = 50;   ///< in [min_radius_px, 1000]; as published
  Index every_px = 4;         ///< uses each n-th row and column, >= 1: neighbours hardly differ
  double pixel_aspect = 1.0;  ///< height of a pixel over its width, as of the camera, in [0.1, 10]
};

inline std::string check(const NeighbourLightSearch& search) {
  const auto min_px = static_cast<double>(search.min_radius_px);
  return check("NeighbourLightSearch",
               {{"min_radius_px", search.min_radius_px, within(1, 1000)},
                {"max_radius_px", search.max_radius_px, within(min_px, 1000)},
                {"every_px", search.every_px, at_least(1)},
                {"pixel_aspect", search.pixel_aspect, within(0.1, 10)}});
}

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
};

/// The best m0 for one n, and its residual. With u = e^{n dl} psi_sum, the Jacobian's columns are u
/// and m0 v = m0 dl u.
template <scalar S>
struct LightAtN {
  S n = S(0), m0 = S(0);
  S error_sq = S(0), left_sq = S(0);  ///< sums of the squared errors before and after
  S slope = S(0);  ///< minus half that of left_sq along n: 0 where the residual is orthogonal to v
  S uu = S(0), uv = S(0), vv = S(0);  ///< of the Jacobian's columns
};

template <scalar S>
LightAtN<S> light_at(const S& n, const std::vector<LightSample<S>>& samples) {
  using std::exp;
  S eu = S(0), ev = S(0), ee = S(0), uu = S(0), uv = S(0), vv = S(0);
  for (const LightSample<S>& s : samples) {
    const S u = exp(n * s.risen_mm) * s.psi_sum_rad;
    const S v = s.risen_mm * u;
    eu += s.error_mm * u;
    ev += s.error_mm * v;
    ee += square(s.error_mm);
    uu += square(u);
    uv += u * v;
    vv += square(v);
  }
  const S m0 = S(0) < uu ? eu / uu : S(0);
  return {n, m0, ee, ee - m0 * eu, m0 * (ev - m0 * uv), uu, m0 * uv, square(m0) * vv};
}

/// The best n: a scan finds the lowest left_sq, then bisection finds the zero of the slope beside
/// it. Bisection on the slope keeps all digits; a search for the lowest value would keep half.
template <scalar S>
LightAtN<S> best_along_n(const std::vector<LightSample<S>>& samples) {
  constexpr int steps = 16;
  using R = scalar_real_t<S>;
  const auto at = [&](int k) { return light_at(S(R(2 * k - steps) / R(steps)), samples); };
  LightAtN<S> best = at(0);
  for (int k = 1; k <= steps; ++k) {
    const LightAtN<S> next = at(k);
    best = next.left_sq < best.left_sq ? next : best;
  }
  const R step = R(2) / R(steps);
  R from = (std::max)(R(value(best.n) - step), R(-1)),
    to = (std::min)(R(value(best.n) + step), R(1));
  for (int k = 0; k < 52 && from < to; ++k) {
    const R middle = (from + to) / R(2);
    (S(0) < light_at(S(middle), samples).slope ? from : to) = middle;
  }
  best = light_at(S((from + to) / R(2)), samples);
  if constexpr (!std::is_same_v<S, R>) {  // bisection has lost the derivatives: a Newton step
    const S beside = S(1e-4);
    const S fall =
        light_at(best.n - beside, samples).slope - light_at(best.n + beside, samples).slope;
    const S change = best.slope * (beside + beside) / fall;
    if (square(change) < square(beside)) {  // the slope has no zero at an end of the search
      best = light_at(best.n + change, samples);
    }
  }
  return best;
}

/// The pixels of all frames with their sums over the disc of `light`. Refuses frames with fewer
/// than 3 known pixels or without a change of shape.
template <scalar S, class Reference, class Measured, class True>
std::vector<LightSample<S>> light_samples(const NeighbourLight<S>& light,
                                          Index every_px,
                                          const S& pitch_mm,
                                          const Reference& reference,
                                          std::span<const Measured> measured_mm,
                                          std::span<const True> true_mm) {
  const char* const owner = "fit_neighbour_light";
  NeighbourLightCompensation<S> compensation(light, pitch_mm, reference);
  const Index rows = compensation.rows(), cols = compensation.cols();
  std::vector<S> cells(static_cast<std::size_t>(rows * cols), S(0));
  const StridedView<S> psi_sum_rad(cells.data(), rows, cols, cols);
  std::vector<LightSample<S>> samples;
  double known = 0, psi_sq = 0;
  for (std::size_t k = 0; k < measured_mm.size(); ++k) {
    const auto measured = as_view(measured_mm[k]);
    const auto truth = as_view(true_mm[k]);
    expects(same_size(measured, reference) && same_size(truth, reference), owner, "rows of a frame",
            static_cast<long long>(measured.rows()), "of the same size as the reference");
    (void)compensation.inclination_sums(measured, psi_sum_rad);  // of any unit: the fit judges
    for (Index i = 0; i < rows; i += every_px) {
      for (Index j = 0; j < cols; j += every_px) {
        const S l = S(measured(i, j));
        const S error = l - S(truth(i, j)), risen = l - S(reference(i, j));
        known += is_finite(error) && is_finite(risen) ? 1 : 0;
        if (is_depth(error) && is_depth(risen)) {
          samples.push_back({error, risen, psi_sum_rad(i, j)});
          psi_sq += static_cast<double>(square(value(psi_sum_rad(i, j))));
        }
      }
    }
  }
  const auto count = static_cast<double>(samples.size());
  expects(count >= 3, owner, "pixels with a reference, measured and true depth", count, ">= 3");
  expects(count > 0.9 * known, owner, "share of pixels whose depths are less than 100 mm apart",
          count / known, "> 0.9: depths in mm");
  expects(psi_sq > 1e-18 * count, owner, "rms of the inclination change summed over the disc",
          std::sqrt(psi_sq / count),
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
  const char* const owner = "fit_neighbour_light";
  require(search);
  require(owner, {{"pitch_mm", pitch_mm, within(1e-4, 10)}});
  expects(!measured_mm.empty() && measured_mm.size() == true_mm.size(), owner, "number of frames",
          static_cast<long long>(measured_mm.size()), ">= 1 and that of the true depths");
  NeighbourLightFit<S> fit;
  detail::LightAtN<S> best;
  S count = S(0);
  const auto rms = [&](const S& sum_sq) { return S(0) < sum_sq ? sqrt(sum_sq / count) : S(0); };
  for (Index r = search.min_radius_px; r <= search.max_radius_px; ++r) {
    const NeighbourLight<S> disc = {r, S(0), S(0), S(search.pixel_aspect)};
    const auto samples = detail::light_samples(disc, search.every_px, S(pitch_mm),
                                               as_view(reference_mm), measured_mm, true_mm);
    count = S(static_cast<double>(samples.size()));
    fit.pixels = static_cast<Index>(samples.size());
    const detail::LightAtN<S> at = detail::best_along_n(samples);
    fit.rms_of_radius_mm.push_back(rms(at.left_sq));
    if (r == search.min_radius_px || at.left_sq < best.left_sq) {
      best = at;
      fit.light = {r, at.m0, at.n, disc.pixel_aspect};
      fit.rms_before_mm = rms(at.error_sq);
    }
  }
  const S determinant = best.uu * best.vv - square(best.uv);
  const S share = determinant / (best.uu * best.vv);
  const S least = S((std::max)(scalar_real_t<S>(1e-9), scalar_real_t<S>(16) * epsilon<S>()));
  expects(least < share, owner, "independent share of n in the fit", share,
          "> 1e-9: depths must change by different amounts, and some error must be explained");
  fit.rms_after_mm = rms(best.left_sq);
  const S variance = square(fit.rms_after_mm) * count / (count - S(2));
  fit.m0_sd = sqrt(variance * best.vv / determinant);
  fit.n_sd = sqrt(variance * best.uu / determinant);
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
