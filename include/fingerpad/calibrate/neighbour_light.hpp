// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibration of the neighbouring light from frames with known true depth: r, m0 and n of
// neighbour_light.hpp by least squares,
//   min over r, m0, n of the sum over pixels of (l - l_true - m0 e^{n (l - l0)} psi_sum)^2.
// For given n and r it is linear in m0, so only n is searched, for every r. The published fit takes
// logarithms of l - l_true and psi_sum. These are often negative, and mostly noise if small (E011).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <type_traits>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/neighbour_light.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v1 {

template <scalar S = double>
struct [[nodiscard]] NeighbourLightFit {
  const char* cause = nullptr;  ///< likely mistake
  NeighbourLight<S> light = {};
  S rms_before_mm = S(0);  ///< of l - l_true
  S rms_after_mm = S(0);   ///< of the residual of the best fit
  S m0_sd = S(0);          ///< standard deviations for independent pixels: too small if the
  S n_sd = S(0);           ///< errors of neighbouring pixels are correlated
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

/// The best n: the best of a scan over [-1, 1] per mm, then Gauss-Newton steps to the zero of the
/// slope between its neighbours, which keep all digits. A step that leaves them is halved.
template <scalar S>
LightAtN<S> best_along_n(const std::vector<LightSample<S>>& samples) {
  constexpr int steps = 16;
  LightAtN<S> best = light_at(S(-1), samples);
  for (int k = 1; k <= steps; ++k) {
    const LightAtN<S> next = light_at(S(k) / S(steps / 2) - S(1), samples);
    best = next.left_sq < best.left_sq ? next : best;
  }
  const S step = S(1) / S(steps / 2);
  S from = (std::max)(best.n - step, S(-1)), to = (std::min)(best.n + step, S(1));
  S change = step;
  for (int k = 0; k < 60 && square(epsilon<S>()) < square(change); ++k) {
    (S(0) < best.slope ? from : to) = best.n;
    change = best.slope / (best.vv - square(best.uv) / best.uu);
    if (!(from <= best.n + change && best.n + change <= to)) {
      change = (from + to) / S(2) - best.n;
    }
    best = light_at(best.n + change, samples);
  }
  return best;
}

/// The pixels of all frames with their sums over the disc of `light`: of larger frames a hundred
/// rows and columns, as neighbours hardly differ. Refuses frames with fewer than 3 known pixels or
/// without a change of shape.
template <scalar S, class Reference, class Measured, class True>
std::vector<LightSample<S>> light_samples(const NeighbourLight<S>& light,
                                          const S& pitch_mm,
                                          const Reference& reference,
                                          const Measured& measured_mm,
                                          const True& true_mm) {
  const char* const owner = "fit_neighbour_light";
  NeighbourLightCompensation<S> compensation(light, pitch_mm, reference);
  const Index rows = compensation.rows(), cols = compensation.cols();
  const Index every = (std::max)(Index(1), (std::min)(rows, cols) / 100);
  std::vector<S> cells(static_cast<std::size_t>(rows * cols), S(0));
  const StridedView<S> psi_sum_rad(cells.data(), rows, cols, cols);
  std::vector<LightSample<S>> samples;
  double known = 0, psi_sq = 0;
  auto next_truth = std::begin(true_mm);
  for (const auto& frame : measured_mm) {
    const auto measured = as_view(frame);
    const auto truth = as_view(*next_truth++);
    expects(same_size(measured, reference) && same_size(truth, reference), owner, "rows of a frame",
            static_cast<long long>(measured.rows()), "of the same size as the reference");
    (void)compensation.inclination_sums(measured, psi_sum_rad);  // of any unit: the fit judges
    for (Index i = 0; i < rows; i += every) {
      for (Index j = 0; j < cols; j += every) {
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
/// containers of depth maps, with the reference and the pitch that the compensation will use.
/// `radii_px`: first and last radius tried, in [1, 1000]; n is searched in [-1, 1] per mm. Uses the
/// pixels where reference, measured and true depth are finite and less than 100 mm apart. Refuses
/// frames without a change of inclination, or with a change of depth too uniform to tell n from m0
/// (parameter_error). Not ok: a fit that removes less than a tenth of the error; m0 < 0, that is,
/// light is taken away, as when measured and true depths are exchanged; and a best n or radius at
/// an end of the search. Computed in S for any type of the frames. Allocates; O(radii (frames rows
/// cols + 30 pixels)).
template <scalar S = double, grid Reference, class Measured, class True>
NeighbourLightFit<S> fit_neighbour_light(const std::type_identity_t<S>& pitch_mm,
                                         const Reference& reference_mm,
                                         const Measured& measured_mm,
                                         const True& true_mm,
                                         const std::array<Index, 2>& radii_px = {1, 50},
                                         const std::type_identity_t<S>& pixel_aspect = S(1)) {
  using std::sqrt;
  const char* const owner = "fit_neighbour_light";
  const auto [first_px, last_px] = radii_px;
  require(owner, {{"pitch_mm", pitch_mm, within(1e-4, 10)},
                  {"first of radii_px", first_px, within(1, 1000)},
                  {"last of radii_px", last_px, within(static_cast<double>(first_px), 1000)}});
  expects(std::size(measured_mm) > 0 && std::size(measured_mm) == std::size(true_mm), owner,
          "number of frames", static_cast<long long>(std::size(measured_mm)),
          ">= 1 and that of the true depths");
  NeighbourLightFit<S> fit;
  detail::LightAtN<S> best;
  S count = S(0);
  const auto rms = [&](const S& sum_sq) { return S(0) < sum_sq ? sqrt(sum_sq / count) : S(0); };
  for (Index r = first_px; r <= last_px; ++r) {
    const NeighbourLight<S> disc = {r, S(0), S(0), pixel_aspect};
    const auto samples =
        detail::light_samples(disc, S(pitch_mm), as_view(reference_mm), measured_mm, true_mm);
    count = S(static_cast<double>(samples.size()));
    const detail::LightAtN<S> at = detail::best_along_n(samples);
    fit.rms_of_radius_mm.push_back(rms(at.left_sq));
    if (r == first_px || at.left_sq < best.left_sq) {
      best = at;
      fit.light = {r, at.m0, at.n, pixel_aspect};
    }
  }
  const S determinant = best.uu * best.vv - square(best.uv);
  const S share = determinant / (best.uu * best.vv);
  const S least = S((std::max)(scalar_real_t<S>(1e-9), scalar_real_t<S>(16) * epsilon<S>()));
  expects(least < share, owner, "independent share of n in the fit", share,
          "> 1e-9: depths must change by different amounts, and some error must be explained");
  fit.rms_before_mm = rms(best.error_sq);
  fit.rms_after_mm = rms(best.left_sq);
  const S variance = square(fit.rms_after_mm) * count / (count - S(2));
  fit.m0_sd = sqrt(variance * best.vv / determinant);
  fit.n_sd = sqrt(variance * best.uu / determinant);
  const bool at_end =
      square(S(0.998)) < square(best.n) || (fit.light.radius_px == last_px && last_px > first_px);
  fit.cause = S(0.9) * fit.rms_before_mm < fit.rms_after_mm
                  ? "neighbouring light removes less than a tenth of the error: "
                    "check frame, order and unit"
              : best.m0 < S(0) ? "neighbouring light would darken: "
                                 "measured and true depths may be exchanged"
              : at_end         ? cause::at_end_of_search
                               : nullptr;
  return fit;
}

}  // namespace v1
}  // namespace fingerpad
