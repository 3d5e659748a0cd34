// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Normal force by look-up as printed: Ito, Kim, Obinata, "Acquisition of contact force and slippage
// using a vision-based tactile sensor with a fluid-type touchpad". Eqs. 18, 21 and 22 for the
// paper's own pad, by contact area and by contact depth, and the fit of eqs. 21 and 22 for other
// pads. docs/errata.md, E029 and E030.
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "fingerpad/calibrate/force.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/normal_force.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v0 {
namespace published {

/// gain F + per_unit |x| + offset_n: one of eqs. 21 and 22.
template <scalar S = double>
struct AffineForce {
  S gain = S(1);
  S per_unit = S(0);  ///< N/mm or N/rad
  S offset_n = S(0);

  S operator()(const S& plain_n, const S& size) const {
    return S(gain * plain_n + per_unit * size + offset_n);
  }
};

/// Eq. 21 for a displaced contact and eq. 22 for a rotated one. Neither equals the plain force at
/// zero motion, and the paper does not say how to combine them. Each is therefore blended in: its
/// weight grows from 0 to 1 over `blend_mm` or `blend_rad`, beyond which it is the printed
/// equation. With both motions, the two changes add.
template <scalar S = double>
struct Compensation {
  static constexpr bool reads_motion = true;

  AffineForce<S> displaced = {};
  AffineForce<S> rotated = {};
  S blend_mm = S(1);              ///< finite, > 0
  S blend_rad = S(17) / S(1000);  ///< about a degree; finite, > 0

  detail::ForceChange<S> operator()(const S& displacement_sq_mm2, const S& rotation_rad) const {
    using std::sqrt;
    // the square root has no derivative at 0
    const bool still = value(displacement_sq_mm2) == 0;
    const S length = still ? S(0) : S(sqrt(displacement_sq_mm2));
    const S angle = value(rotation_rad) < 0 ? S(-rotation_rad) : rotation_rad;
    const S d = detail::smooth_step(S(length / blend_mm));
    const S t = detail::smooth_step(S(angle / blend_rad));
    return {S(S(1) + d * (displaced.gain - S(1)) + t * (rotated.gain - S(1))),
            S(d * (displaced.per_unit * length + displaced.offset_n) +
              t * (rotated.per_unit * angle + rotated.offset_n))};
  }
};

/// Refuses what has no meaning (parameter_error).
template <scalar S>
void expects_valid(const Compensation<S>& compensation) {
  const auto check = [](const AffineForce<S>& force, const char* name) {
    expects(is_finite(force.gain), name, "gain", force.gain, "finite");
    expects(is_finite(force.per_unit), name, "per_unit", force.per_unit, "finite");
    expects(is_finite(force.offset_n), name, "offset_n", force.offset_n, "finite");
  };
  check(compensation.displaced, "published::Compensation: displaced");
  check(compensation.rotated, "published::Compensation: rotated");
  const char* const owner = "published::Compensation";
  expects(is_finite(compensation.blend_mm) && value(compensation.blend_mm) > 0, owner, "blend_mm",
          compensation.blend_mm, "finite and > 0");
  expects(is_finite(compensation.blend_rad) && value(compensation.blend_rad) > 0, owner,
          "blend_rad", compensation.blend_rad, "finite and > 0");
}

/// Eq. 18, valid over about 1 to 28 N, where both curves rise together. Without contact they give
/// 0.62 N (area) and 0.34 N (depth), which NormalForce fades out.
template <scalar S = double>
PolynomialForce<2, S> force_of_area() {
  return {{S(0.6242), S(0.0191), S(0.00008)}, S(18), S(478)};
}
template <scalar S = double>
PolynomialForce<2, S> force_of_depth() {
  return {{S(0.3435), S(0.5563), S(0.776)}, S(0.63), S(5.62)};
}

/// Eqs. 21 and 22. The displacement is in mm (the paper says m) and the angle in rad (the paper
/// uses degrees). Eqs. 19 and 20 give the same quantities with other numbers; by depth, these let
/// the force fall and turn negative: docs/errata.md, E029 and E030.
template <scalar S = double>
Compensation<S> compensation_by_area() {
  const S degrees_per_rad = S(57.295779513082320877);
  return {{S(0.748), S(-0.637), S(1.7)}, {S(1.2), S(S(0.00171) * degrees_per_rad), S(-1.8)}};
}
template <scalar S = double>
Compensation<S> compensation_by_depth() {
  const S degrees_per_rad = S(57.295779513082320877);
  return {{S(1.2), S(0.509), S(-3.5)}, {S(0.8), S(S(-0.00102) * degrees_per_rad), S(-0.0518)}};
}

template <scalar S = double>
using NormalForce = fingerpad::NormalForce<PolynomialForce<2, S>, Compensation<S>>;

/// The measure is the contact's area in mm^2.
template <scalar S = double>
NormalForce<S> normal_force_by_area() {
  return NormalForce<S>(force_of_area<S>(), compensation_by_area<S>());
}
/// The measure is the contact's depth in mm.
template <scalar S = double>
NormalForce<S> normal_force_by_depth() {
  return NormalForce<S>(force_of_depth<S>(), compensation_by_depth<S>());
}

/// Eq. 21 or 22 for a curve: F = gain F_plain + per_unit |x| + offset, with |x| the displacement in
/// mm or the angle in rad.
enum class AffineBy { displacement, rotation };
template <scalar S = double>
struct [[nodiscard]] AffineForceFit {
  const char* cause = cause::not_converged;  ///< likely mistake
  AffineForce<S> force = {};
  std::array<S, 3> standard_errors = detail::zeros<S, 3>();  ///< of gain, per_unit and offset_n
  std::array<std::array<S, 3>, 3> covariance = detail::zero_matrix<S, 3>();  ///< of these
  S residual_sd_n = S(0);
  std::vector<ForceResidual<S>> residuals = {};

  bool ok() const { return cause == nullptr; }
};

/// Least-squares fit to the samples with a measure > 0, a normal force and a finite motion. Refuses
/// what the fits of calibrate/force.hpp refuse (parameter_error). Allocates.
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
  result.cause = detail::cause_in(fit, nullptr, nullptr, options);
  return result;
}

}  // namespace published
}  // namespace v0
}  // namespace fingerpad
