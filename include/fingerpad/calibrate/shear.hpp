// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibration of tangential force and moment by look-up: the fits. calibrate/force.hpp tells what
// they share.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/calibrate/detail/force_models.hpp"
#include "fingerpad/calibrate/force_samples.hpp"
#include "fingerpad/calibrate/model_fit.hpp"
#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/detail/zeros.hpp"
#include "fingerpad/force/shear_map.hpp"

namespace fingerpad {
inline namespace v0 {

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

namespace detail {

/// The search along the exponent, then all together.
template <int Degree, scalar S>
ShearFit<Degree, S> fit_shear_equations(const char* owner,
                                        const char* exponent_name,
                                        const std::vector<ShearEquation<S>>& equations,
                                        const ExponentSearch<S>& exponent,
                                        const FitOptions& options) {
  using std::exp;
  using std::sqrt;
  using Fit = ModelFit<S>;
  expects(exponent.steps >= 2, "ExponentSearch", "steps", static_cast<long long>(exponent.steps),
          ">= 2");
  expects(value(exponent.lowest) < value(exponent.highest), "ExponentSearch", "highest",
          exponent.highest, "> lowest");
  const ShearModel<Degree, S> model(equations, !exponent.search, exponent.given);
  typename Fit::Vector measured(static_cast<Index>(equations.size()));
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < equations.size(); ++i) {
    measured(static_cast<Index>(i)) = equations[i].measured;
    places.push_back(equations[i].sample);
  }
  std::vector<std::string> names;
  for (int k = 1; k <= Degree; ++k) {
    names.push_back("coefficient " + std::to_string(k));
  }
  if (exponent.search) {
    names.emplace_back(exponent_name);
  }
  const ModelFitter<S, ShearModel<Degree, S>> fitter(owner, names, measured, model, options);
  typename Fit::Vector start = Fit::Vector::Zero(model.size()), coefficients;
  if (exponent.search) {
    S least = not_a_number<S>();
    for (int k = 0; k <= exponent.steps; ++k) {
      const S at =
          exponent.lowest + S(S(exponent.highest - exponent.lowest) * S(S(k) / S(exponent.steps)));
      const S left = model.left_at(at, options.robust, coefficients);
      if (!(value(left) >= value(least)) && is_finite(left)) {
        least = left;
        start.head(Degree) = coefficients;
        start(Degree) = at;
      }
    }
  }
  const Fit fit = fitter(start, false);
  ShearFit<Degree, S> result;
  result.exponent = exponent.search ? S(fit.parameters(Degree)) : exponent.given;
  const bool inside = !exponent.search || (value(result.exponent) >= value(exponent.lowest) &&
                                           value(result.exponent) <= value(exponent.highest));
  expects(inside, owner, exponent_name, result.exponent,
          "within the search: the samples do not tell it");
  const auto errors = standard_errors_of<S, static_cast<std::size_t>(Degree)>(fit);
  S longest = S(0);
  for (const ShearEquation<S>& e : equations) {
    const S length = S(exp(S(result.exponent * e.log_measure))) * e.length;
    longest = value(length) > value(longest) ? length : longest;
  }
  for (std::size_t k = 0; k < errors.size(); ++k) {
    result.polynomial.coefficients[k] = fit.parameters(static_cast<Index>(k));
    result.standard_errors[k] = errors[k];
  }
  result.polynomial.to = longest;
  result.exponent_sd = exponent.search ? S(sqrt(fit.covariance(Degree, Degree))) : S(0);
  result.covariance = covariance_of<S, static_cast<std::size_t>(Degree) + 1>(fit);
  result.residual_sd = fit.residual_sd;
  add_residuals(fit, measured, places, result.residuals);
  result.explained = fit.explained;
  result.converged = fit.converged;
  return result;
}

}  // namespace detail

template <int Degree, scalar S>
ShearFit<Degree, S> fit_tangential_force(std::span<const ForceSample<S>> samples,
                                         const S& reference,
                                         const ExponentSearch<S>& exponent,
                                         const FitOptions& options) {
  using std::log;
  using std::sqrt;
  expects(is_finite(reference) && value(reference) > 0, "fit_tangential_force", "reference",
          reference, "finite and > 0");
  std::vector<detail::ShearEquation<S>> equations;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const ForceSample<S>& s = samples[i];
    if (is_finite(s.measure) && value(s.measure) > 0 && is_finite(s.tangential_force_n.x) &&
        is_finite(s.tangential_force_n.y) && detail::has_finite_motion(s)) {
      const S log_measure = log(S(s.measure / reference));
      const S length_sq = square(s.displacement_mm.x) + square(s.displacement_mm.y);
      const S length = value(length_sq) > 0 ? S(sqrt(length_sq)) : S(0);
      equations.push_back({log_measure, s.displacement_mm.x, length, s.tangential_force_n.x, i});
      equations.push_back({log_measure, s.displacement_mm.y, length, s.tangential_force_n.y, i});
    }
  }
  return detail::fit_shear_equations<Degree>("fit_tangential_force", "displacement_exponent",
                                             equations, exponent, options);
}

template <int Degree, scalar S>
ShearFit<Degree, S> fit_moment(std::span<const ForceSample<S>> samples,
                               const S& reference,
                               const ExponentSearch<S>& exponent,
                               const FitOptions& options) {
  using std::log;
  expects(is_finite(reference) && value(reference) > 0, "fit_moment", "reference", reference,
          "finite and > 0");
  std::vector<detail::ShearEquation<S>> equations;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const ForceSample<S>& s = samples[i];
    if (is_finite(s.measure) && value(s.measure) > 0 && is_finite(s.moment_n_mm) &&
        is_finite(s.rotation_rad)) {
      const S angle = value(s.rotation_rad) < 0 ? S(-s.rotation_rad) : s.rotation_rad;
      equations.push_back(
          {S(log(S(s.measure / reference))), s.rotation_rad, angle, s.moment_n_mm, i});
    }
  }
  return detail::fit_shear_equations<Degree>("fit_moment", "rotation_exponent", equations, exponent,
                                             options);
}

template <scalar S>
LinearShearFit<S> fit_linear_shear(std::span<const ForceSample<S>> samples,
                                   const ShearNormalisation<S>& normalisation,
                                   const FitOptions& options) {
  using std::exp;
  using std::log;
  using Fit = detail::ModelFit<S>;
  expects_valid(normalisation);
  const auto usable = detail::usable_samples(samples, [](const ForceSample<S>& s) {
    return is_finite(s.tangential_force_n.x) && is_finite(s.tangential_force_n.y) &&
           is_finite(s.displacement_mm.x) && is_finite(s.displacement_mm.y);
  });
  const Index n = static_cast<Index>(usable.samples.size());
  detail::LinearModel<S> model{typename Fit::Matrix(n, 3)};
  typename Fit::Vector x(n), y(n);
  for (Index i = 0; i < n; ++i) {
    const ForceSample<S>& s = usable.samples[static_cast<std::size_t>(i)];
    const S log_measure = log(S(s.measure / normalisation.reference));
    const S factor = exp(S(normalisation.displacement_exponent * log_measure));
    model.columns(i, 0) = factor * s.displacement_mm.x;
    model.columns(i, 1) = factor * s.displacement_mm.y;
    model.columns(i, 2) = S(1);
    x(i) = s.tangential_force_n.x;
    y(i) = s.tangential_force_n.y;
  }
  using Fitter = detail::ModelFitter<S, detail::LinearModel<S>>;
  const char* const owner = "fit_linear_shear";
  const Fit of_x = Fitter(owner, {"x_by_x", "x_by_y", "offset_n.x"}, x, model, options)(
      Fit::Vector::Zero(3), true);
  const Fit of_y = Fitter(owner, {"y_by_x", "y_by_y", "offset_n.y"}, y, model, options)(
      Fit::Vector::Zero(3), true);
  LinearShearFit<S> result;
  result.map.x_by_x = of_x.parameters(0);
  result.map.x_by_y = of_x.parameters(1);
  result.map.y_by_x = of_y.parameters(0);
  result.map.y_by_y = of_y.parameters(1);
  result.map.offset_n = {of_x.parameters(2), of_y.parameters(2)};
  result.map.moment_n_mm_per_rad = S(0);
  result.x_standard_errors = detail::standard_errors_of<S, 3>(of_x);
  result.y_standard_errors = detail::standard_errors_of<S, 3>(of_y);
  result.x_covariance = detail::covariance_of<S, 3>(of_x);
  result.y_covariance = detail::covariance_of<S, 3>(of_y);
  result.residual_sd_n = {of_x.residual_sd, of_y.residual_sd};
  detail::add_residuals(of_x, x, usable.places, result.residuals);
  detail::add_residuals(of_y, y, usable.places, result.residuals);
  return result;
}

}  // namespace v0
}  // namespace fingerpad
