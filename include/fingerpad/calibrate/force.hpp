// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibration of the forces by look-up, from contacts that a force gauge measured beside the
// camera: the curves and compensations of normal_force.hpp and the maps of shear.hpp. Least squares
// by QR, on demand with Huber's weights; with each parameter its covariance, with each fit what it
// leaves. Samples that do not determine a parameter are refused with its name (parameter_error), as
// are samples that contradict each other. docs/calibrate/calibration.md tells how to take samples.
//
// The standard errors hold for samples with independent errors in the force. Errors in the measure
// or the displacement bias the fit toward smaller slopes, and samples of one load have common
// errors: leave_one_load_out tells what to expect of forces that were not calibrated.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "fingerpad/force/compensation.hpp"
#include "fingerpad/force/force_curve.hpp"
#include "fingerpad/force/force_errors.hpp"
#include "fingerpad/calibrate/force_samples.hpp"
#include "fingerpad/calibrate/model_fit.hpp"
#include "fingerpad/calibrate/detail/polynomial_model.hpp"
#include "fingerpad/force/shear_map.hpp"
#include "fingerpad/calibrate/detail/shear_model.hpp"
#include "fingerpad/force/detail/zeros.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {

/// What a polynomial of the normal force must be, and what else is fitted with it.
struct NormalForceFitOptions {
  bool through_zero = true;  ///< no force without contact; the published curves do without
  bool rising = true;        ///< it never falls from 0 to the largest measure
  bool displaced = false;    ///< also the compensation for displacement
  bool turned = false;       ///< also the one for rotation
  FitOptions fit = {};
};

template <int Degree = 2, scalar S = double>
struct NormalForceFit {
  PolynomialForce<Degree, S> curve;
  CurveErrors<PolynomialForce<Degree, S>::parameters, S> errors;
  ScaledCompensation<S> compensation;  ///< 0 where it was not asked for
  S per_mm_sq_sd = S(0);               ///< standard errors
  S per_rad_sq_sd = S(0);
  std::vector<ForceResidual<S>> residuals;
  S explained = S(0);        ///< share of the measured variance
  bool held_rising = false;  ///< without `rising` it would have fallen somewhere; the covariance is
                             ///< then that of the parameters that were left free
  bool converged = false;    ///< false: Huber's weights still moved in the last pass
};

/// Normal force from area or depth: least squares for F = P(measure) (1 + a |d|^2 + b theta^2) with
/// a polynomial P of this degree. Uses the samples with a measure > 0 and a normal force.
/// Allocates; O(passes samples Degree^2).
template <int Degree = 2, scalar S = double>
NormalForceFit<Degree, S> fit_normal_force(std::span<const ForceSample<S>> samples,
                                           const NormalForceFitOptions& options = {});

/// Eq. 21 or 22 for a curve: F = gain F_plain + per_unit |x| + offset by least squares, with |x|
/// the displacement in mm or the angle in rad.
enum class AffineBy { displacement, rotation };
template <scalar S = double>
struct AffineForceFit {
  AffineForce<S> force;
  std::array<S, 3> standard_errors;            ///< of gain, per_unit and offset_n
  std::array<std::array<S, 3>, 3> covariance;  ///< of these
  S residual_sd_n = S(0);
  std::vector<ForceResidual<S>> residuals;
};
template <class Curve, scalar S = typename Curve::number>
AffineForceFit<S> fit_affine_force(std::span<const ForceSample<S>> samples,
                                   const Curve& curve,
                                   AffineBy by,
                                   const FitOptions& options = {});

/// Elastic pads: r = c f^gamma by least squares in r; the measure of a sample is the radius.
template <scalar S = double>
struct PowerLawFit {
  PowerLawForce<S> curve;
  CurveErrors<2, S> errors;                 ///< its residual_sd_n is that of forces by the inverse
  S residual_sd_mm = S(0);                  ///< of radii
  std::vector<ForceResidual<S>> residuals;  ///< of forces by the inverse
  S explained = S(0);
  bool converged = false;
};
template <scalar S = double>
PowerLawFit<S> fit_power_law(std::span<const ForceSample<S>> samples,
                             const FitOptions& options = {});

/// Where an exponent of the normalisation is looked for.
template <scalar S = double>
struct ExponentSearch {
  bool search = true;  ///< false: `given` is kept
  S given = S(0);
  S lowest = S(-2);
  S highest = S(6);
  int steps = 80;  ///< of the first search, >= 2
};

/// One half of a Shear: force from displacement, or moment from rotation.
template <int Degree = 1, scalar S = double>
struct ShearFit {
  OddPolynomial<Degree, S> polynomial;
  S exponent = S(0);
  std::array<S, static_cast<std::size_t>(Degree)> standard_errors =
      detail::zeros<S, static_cast<std::size_t>(Degree)>();
  S exponent_sd = S(0);  ///< 0 if it was given
  std::array<std::array<S, static_cast<std::size_t>(Degree) + 1>,
             static_cast<std::size_t>(Degree) + 1>
      covariance = {};   ///< of the coefficients and, last, the exponent
  S residual_sd = S(0);  ///< of a component of the force in N, or of the moment in N mm
  std::vector<ForceResidual<S>> residuals;  ///< of a force x and y in turn
  S explained = S(0);
  bool converged = false;
};

/// Tangential force from displacement, and moment from rotation, both normalised by
/// (measure / reference) to an exponent. Use the samples with a measure > 0 that have both.
template <int Degree = 1, scalar S = double>
ShearFit<Degree, S> fit_tangential_force(std::span<const ForceSample<S>> samples,
                                         const S& reference,
                                         const ExponentSearch<S>& exponent = {},
                                         const FitOptions& options = {});
template <int Degree = 1, scalar S = double>
ShearFit<Degree, S> fit_moment(std::span<const ForceSample<S>> samples,
                               const S& reference,
                               const ExponentSearch<S>& exponent = {},
                               const FitOptions& options = {});

/// A linear map of both components with offsets, for axes that are not those of the image. The
/// normalisation is given; the moment is not fitted.
template <scalar S = double>
struct LinearShearFit {
  LinearShear<S> map;                            ///< its moment is 0
  std::array<S, 3> x_standard_errors;            ///< of x_by_x, x_by_y, offset_n.x
  std::array<S, 3> y_standard_errors;            ///< of y_by_x, y_by_y, offset_n.y
  std::array<std::array<S, 3>, 3> x_covariance;  ///< of these
  std::array<std::array<S, 3>, 3> y_covariance;
  Point2<S> residual_sd_n;
  std::vector<ForceResidual<S>> residuals;  ///< all of x, then all of y
};
template <scalar S = double>
LinearShearFit<S> fit_linear_shear(std::span<const ForceSample<S>> samples,
                                   const ShearNormalisation<S>& normalisation,
                                   const FitOptions& options = {});

}  // namespace v0
}  // namespace fingerpad

#include "fingerpad/calibrate/normal_force_fits.hpp"
#include "fingerpad/calibrate/shear_fits.hpp"
