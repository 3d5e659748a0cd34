// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibration of the normal force by the divergence of the dots, with a force gauge as reference.
// The scatter of the samples about the curve includes the noise of their dots. It is subtracted
// here, because normal_force() adds the dot noise of each frame; otherwise it would count twice.
#include <algorithm>
#include <cmath>
#include <span>
#include <type_traits>
#include <vector>

#include "fingerpad/calibrate/force.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/dot_divergence.hpp"

namespace fingerpad {
inline namespace v0 {

/// Fits the curve for normal_force(curve, divergence) by least squares, like fit_normal_force.
/// forces_n[k] in N, >= 0, belongs to divergences[k]. Degree 1 for thick gels, 2 for thin ones.
/// Refuses what fit_normal_force refuses, and spans of different lengths (parameter_error).
template <int Degree = 1, scalar S = double>
NormalForceFit<PolynomialForce<Degree, S>> fit_divergence(
    std::type_identity_t<std::span<const DivergenceResult<S>>> divergences,
    std::type_identity_t<std::span<const S>> forces_n,
    const FitOptions& options = {}) {
  using std::sqrt;
  expects(divergences.size() == forces_n.size(), "fit_divergence", "forces_n.size()",
          static_cast<long long>(forces_n.size()), "as many as divergences");
  std::vector<ForceSample<S>> samples;
  for (std::size_t k = 0; k < forces_n.size(); ++k) {
    ForceSample<S> sample;
    sample.measure = divergences[k].area_mm2;
    sample.normal_force_n = forces_n[k];
    samples.push_back(sample);
  }
  auto fit = fit_normal_force<Degree, S>(samples, {}, options);
  S noise_n2 = S(0);
  for (const auto& residual : fit.residuals) {
    const DivergenceResult<S>& d = divergences[residual.sample];
    noise_n2 = S(noise_n2 + square(fit.curve.slope(d.area_mm2)) * d.variance_mm4);
  }
  const S left_n2 =
      S(square(fit.errors.residual_sd_n) - noise_n2 / S(static_cast<double>(fit.residuals.size())));
  fit.errors.residual_sd_n = S(0) < left_n2 ? S(sqrt(left_n2)) : S(0);
  return fit;
}

}  // namespace v0
}  // namespace fingerpad
