// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The look-up of the normal force as printed: Ito, Kim, Obinata, "Acquisition of contact force and
// slippage using a vision-based tactile sensor with a fluid-type touchpad", eqs. 18, 21 and 22, for
// the paper's own pad: by contact area and by contact depth; and the fit of eqs. 21 and 22 for
// another. docs/errata.md, E029 and E030.
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "fingerpad/calibrate/force.hpp"
#include "fingerpad/force/normal_force.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

template <scalar S = double>
using NormalForce = fingerpad::NormalForce<PolynomialForce<2, S>, PublishedCompensation<S>>;

/// The measure is the contact's area in mm^2.
template <scalar S = double>
NormalForce<S> normal_force_by_area() {
  return NormalForce<S>(published_force_of_area<S>(), published_compensation_by_area<S>());
}
/// The measure is the contact's depth in mm.
template <scalar S = double>
NormalForce<S> normal_force_by_depth() {
  return NormalForce<S>(published_force_of_depth<S>(), published_compensation_by_depth<S>());
}

/// Eq. 21 or 22 for a curve: F = gain F_plain + per_unit |x| + offset, with |x| the displacement in
/// mm or the angle in rad.
enum class AffineBy { displacement, rotation };
template <scalar S = double>
struct [[nodiscard]] AffineForceFit {
  FitStatus status = FitStatus::not_converged;
  AffineForce<S> force = {};
  std::array<S, 3> standard_errors = {};            ///< of gain, per_unit and offset_n
  std::array<std::array<S, 3>, 3> covariance = {};  ///< of these
  S residual_sd_n = S(0);
  std::vector<ForceResidual<S>> residuals = {};

  bool ok() const { return status == FitStatus::ok; }
};

/// By least squares. Uses the samples with a measure > 0, a normal force and a finite motion, and
/// refuses what the fits of calibrate/force.hpp refuse (parameter_error). Allocates.
template <class Curve, scalar S = typename Curve::number>
AffineForceFit<S> fit_affine_force(std::span<const ForceSample<S>> samples,
                                   const Curve& curve,
                                   AffineBy by,
                                   const FitOptions& options = {}) {
  using std::sqrt;
  using Fit = detail::ModelFit<S>;
  expects_valid(curve);
  const auto usable = detail::usable_samples(samples, [](const ForceSample<S>& s) {
    return is_finite(s.normal_force_n) && detail::has_finite_motion(s);
  });
  const Index n = static_cast<Index>(usable.samples.size());
  detail::LinearModel<S> model(n, 3);
  typename Fit::Vector forces(n);
  for (Index i = 0; i < n; ++i) {
    const ForceSample<S>& s = usable.samples[static_cast<std::size_t>(i)];
    const S sum_sq = square(s.displacement_mm.x) + square(s.displacement_mm.y);
    const S length = value(sum_sq) > 0 ? S(sqrt(sum_sq)) : S(0);
    const S angle = value(s.rotation_rad) < 0 ? S(-s.rotation_rad) : s.rotation_rad;
    forces(i) = s.normal_force_n;
    model.columns(i, 0) = curve.force_n(s.measure);
    model.columns(i, 1) = by == AffineBy::displacement ? length : angle;
    model.columns(i, 2) = S(1);
  }
  const char* const owner = "fit_affine_force";
  const Fit fit = detail::ModelFitter<S>(owner, {"gain", "per_unit", "offset_n"}, forces, model,
                                         options)(Fit::Vector::Zero(3));
  detail::expects_explained(fit, options, owner);
  AffineForceFit<S> result;
  result.force = {fit.parameters(0), fit.parameters(1), fit.parameters(2)};
  result.standard_errors = detail::standard_errors_of<S, 3>(fit);
  result.covariance = detail::covariance_of<S, 3>(fit);
  result.residual_sd_n = fit.residual_sd;
  detail::add_residuals(fit, forces, usable.places, result.residuals);
  result.status = detail::status_of(fit, FitStatus::ok, FitStatus::ok, options);
  return result;
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
