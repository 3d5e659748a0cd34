// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibration of the forces by look-up, from contacts measured with a force gauge: the curves and
// compensations of normal_force.hpp and the maps of shear.hpp. Least squares by QR, optionally with
// Huber's weights, with the covariance of the parameters and the residuals of each fit. Samples
// that do not determine a parameter, or that contradict each other, are refused by name
// (parameter_error). docs/calibrate/calibration.md describes how to take samples. The standard
// errors hold for samples with independent errors in the force. Errors in the measure or the
// displacement bias the fit toward smaller slopes, and samples of one load have common errors:
// leave_one_load_out estimates the error of forces outside the calibration.
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "fingerpad/calibrate/detail/force_checks.hpp"
#include "fingerpad/calibrate/detail/model_fit.hpp"
#include "fingerpad/calibrate/detail/normal_force_fit.hpp"
#include "fingerpad/calibrate/detail/shear_fit.hpp"
#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/force_curve.hpp"
#include "fingerpad/force/normal_force.hpp"
#include "fingerpad/force/shear.hpp"
#include "fingerpad/math/detail/small_matrices.hpp"

namespace fingerpad {
inline namespace v0 {

/// One measurement. NaN: not measured; a fit leaves out samples that lack a value it needs.
template <scalar S = double>
struct ForceSample {
  S measure = not_a_number<S>();  ///< area in mm^2, depth in mm or radius in mm, > 0
  Point2<S> displacement_mm = {S(0), S(0)};
  S rotation_rad = S(0);
  S normal_force_n = not_a_number<S>();  ///< positive in a press, >= 0
  Point2<S> tangential_force_n = {not_a_number<S>(), not_a_number<S>()};
  S moment_n_mm = not_a_number<S>();  ///< about the contact's normal, through its middle
  int load = 0;  ///< number of the load; leave_one_load_out leaves out its samples together
};

/// Fitted and measured value of one sample, for example for a plot.
template <scalar S = double>
struct ForceResidual {
  std::size_t sample;  ///< index among the given samples
  S measured;          ///< N, or N mm
  S fitted;
  S weight;  ///< 1; less for an outlier
};

/// Errors of predictions for samples left out of the calibration.
template <scalar S = double>
struct CrossValidation {
  std::vector<S> errors;  ///< predicted less measured, for each sample; NaN: no prediction
  int loads = 0;          ///< number of loads left out in turn
  Index samples = 0;      ///< with a prediction
  S mean_abs = not_a_number<S>();
  S rms = not_a_number<S>();
  S worst = not_a_number<S>();  ///< largest absolute error
};

/// Leaves out one load after the other, calibrates with the rest, and predicts the samples left
/// out: model = fit(span of samples); error = error_of(model, sample). O(loads) fits; allocates.
/// Refuses what the fit refuses.
template <scalar S, class Fit, class ErrorOf>
CrossValidation<S> leave_one_load_out(std::span<const ForceSample<S>> samples,
                                      const Fit& fit,
                                      const ErrorOf& error_of) {
  using std::sqrt;
  CrossValidation<S> result;
  result.errors.assign(samples.size(), not_a_number<S>());
  std::vector<bool> done(samples.size(), false);
  std::vector<ForceSample<S>> rest;
  for (std::size_t first = 0; first < samples.size(); ++first) {
    if (done[first]) {
      continue;
    }
    rest.clear();
    for (const ForceSample<S>& sample : samples) {
      if (sample.load != samples[first].load) {
        rest.push_back(sample);
      }
    }
    const auto model = fit(std::span<const ForceSample<S>>(rest));
    ++result.loads;
    for (std::size_t i = first; i < samples.size(); ++i) {
      if (samples[i].load == samples[first].load) {
        done[i] = true;
        result.errors[i] = error_of(model, samples[i]);
      }
    }
  }
  S sum = S(0), sum_sq = S(0);
  for (const S& error : result.errors) {
    if (is_finite(error)) {
      const S size = value(error) < 0 ? S(-error) : error;
      sum = sum + size;
      sum_sq = sum_sq + square(error);
      result.worst = value(size) <= value(result.worst) ? result.worst : size;
      ++result.samples;
    }
  }
  if (result.samples > 0) {
    result.mean_abs = sum / S(static_cast<double>(result.samples));
    result.rms = sqrt(S(sum_sq / S(static_cast<double>(result.samples))));
  }
  return result;
}

/// Normal force from area, depth or radius.
template <class Curve = PolynomialForce<2>>
struct [[nodiscard]] NormalForceFit {
  using S = typename Curve::number;

  const char* cause = cause::not_converged;  ///< likely mistake
  Curve curve = {};
  CurveErrors<Curve::parameters, S> errors = {};  ///< for NormalForce
  ScaledCompensation<S> compensation = {};        ///< 0 if not fitted
  S per_mm_sq_sd = S(0);                          ///< standard errors
  S per_rad_sq_sd = S(0);
  std::vector<ForceResidual<S>> residuals = {};
  S explained = S(0);             ///< share of the measured variance about the mean
  S largest_residual_sds = S(0);  ///< in robust standard deviations
  bool held_rising = false;  ///< without `rising` the curve would fall somewhere; the covariance
                             ///< is then that of the free parameters

  bool ok() const { return cause == nullptr; }
};

/// One half of a Shear: force from displacement, or moment from rotation.
template <int Degree = 1, scalar S = double>
struct [[nodiscard]] ShearFit {
  static constexpr std::size_t size = static_cast<std::size_t>(Degree);

  const char* cause = cause::not_converged;  ///< likely mistake
  detail::OddPolynomial<Degree, S> polynomial = {};
  S exponent = S(0);
  std::array<S, size> standard_errors = detail::zeros<S, size>();
  S exponent_sd = S(0);  ///< 0 for a given exponent
  std::array<std::array<S, size + 1>, size + 1> covariance =
      detail::zero_matrix<S, size + 1>();  ///< of the coefficients and, last, the exponent
  S residual_sd = S(0);  ///< of a component of the force in N, or of the moment in N mm
  std::vector<ForceResidual<S>> residuals = {};  ///< for a force, x and y alternate
  S explained = S(0);
  S largest_residual_sds = S(0);
  S gauge_angle_rad = not_a_number<S>();     ///< of the gauge against the image, about the normal,
                                             ///< +x toward +y; NaN for a moment, and if the
                                             ///< displacements lie near one line
  S gauge_angle_sd_rad = not_a_number<S>();  ///< its standard error

  bool ok() const { return cause == nullptr; }
};

/// A linear map of both components with offsets.
template <scalar S = double>
struct [[nodiscard]] LinearShearFit {
  const char* cause = cause::not_converged;                    ///< likely mistake
  LinearShear<S> map = {};                                     ///< its moment is 0
  std::array<S, 3> x_standard_errors = detail::zeros<S, 3>();  ///< of x_by_x, x_by_y, offset_n.x
  std::array<S, 3> y_standard_errors = detail::zeros<S, 3>();  ///< of y_by_x, y_by_y, offset_n.y
  Point2<S> residual_sd_n = {S(0), S(0)};
  std::vector<ForceResidual<S>> residuals = {};  ///< all of x, then all of y
  S largest_residual_sds = S(0);

  bool ok() const { return cause == nullptr; }
};

/// What fit_normal_force fits.
struct CurveOptions {
  bool through_zero = true;  ///< no force without contact; the published curves lack this
  bool rising = true;        ///< the force never falls from 0 to the largest measure
  bool displaced = false;    ///< also the compensation for displacement
  bool rotated = false;      ///< also the compensation for rotation
};

/// Normal force from area or depth: least-squares fit of F = P(measure) (1 + a |d|^2 + b theta^2)
/// with a polynomial P of degree `Degree`. Uses the samples with a measure > 0 and a normal force.
/// Allocates; O(passes samples Degree^2).
template <int Degree = 2, scalar S = double>
NormalForceFit<PolynomialForce<Degree, S>> fit_normal_force(std::span<const ForceSample<S>> samples,
                                                            const CurveOptions& curve = {},
                                                            const FitOptions& options = {}) {
  using Fit = detail::ModelFit<S>;
  const char* const owner = "fit_normal_force";
  const bool moved = curve.displaced || curve.rotated;
  const auto usable = detail::usable_samples(samples, [&](const ForceSample<S>& s) {
    return is_finite(s.normal_force_n) && (!moved || detail::has_finite_motion(s));
  });
  expects(!usable.samples.empty(), owner, "usable samples", 0LL,
          "> 0: with a measure > 0 and a finite normal force");
  typename Fit::Vector forces(static_cast<Index>(usable.samples.size()));
  std::vector<detail::PressedContact<S>> contacts;
  S from = usable.samples.front().measure, to = from;
  for (const ForceSample<S>& s : usable.samples) {
    forces(static_cast<Index>(contacts.size())) = s.normal_force_n;
    contacts.push_back({s.measure, squared_norm(s.displacement_mm), square(s.rotation_rad)});
    from = value(s.measure) < value(from) ? s.measure : from;
    to = value(s.measure) > value(to) ? s.measure : to;
  }
  expects(value(to) > value(from), owner, "largest measure", to, "> the smallest");
  detail::PolynomialTerms terms{{}, curve.displaced, curve.rotated};
  for (std::size_t k = curve.through_zero ? 1 : 0; k <= static_cast<std::size_t>(Degree); ++k) {
    terms.columns.push_back(k);
  }
  Fit fit = detail::fit_columns<Degree>(contacts, forces, to, terms, options);
  const bool held = curve.rising && !detail::rises(fit, terms);
  const char* const mistake =
      curve.through_zero && !held
          ? detail::offset_in<Degree>(contacts, forces, to, terms, options, fit)
          : nullptr;
  if (held) {
    fit = detail::fit_rising<Degree>(contacts, forces, to, terms, options);
  } else {
    detail::expects_explained(fit, options, owner, detail::cause_of(mistake).c_str());
  }
  auto result = detail::polynomial_of<NormalForceFit<PolynomialForce<Degree, S>>>(
      fit, detail::PolynomialModel<Degree, S>(contacts, to, terms), terms);
  result.curve.from = from;
  result.curve.to = to;
  result.held_rising = held;
  result.errors.residual_sd_n = fit.residual_sd;
  detail::add_residuals(fit, forces, usable.places, result.residuals);
  result.explained = fit.explained;
  result.largest_residual_sds = fit.worst_sds;
  const char* const units = detail::unit_mistake(
      usable.samples, {.normal = true, .displacement = curve.displaced, .rotation = curve.rotated});
  result.cause = detail::cause_in(fit, units, mistake, options);
  return result;
}

/// Elastic pads: least-squares fit of r = c f^gamma, in r. The measure of a sample is the radius.
/// The reported residuals are those of the force, from the inverse.
template <scalar S = double>
NormalForceFit<PowerLawForce<S>> fit_power_law(std::span<const ForceSample<S>> samples,
                                               const FitOptions& options = {}) {
  using std::exp;
  using std::log;
  using std::sqrt;
  using Fit = detail::ModelFit<S>;
  const auto usable = detail::usable_samples(samples, [](const ForceSample<S>& s) {
    return is_finite(s.normal_force_n) && value(s.normal_force_n) > 0;
  });
  const Index n = static_cast<Index>(usable.samples.size());
  detail::PowerLawModel<S> model(n);
  detail::LinearModel<S> logarithms(n, 2);
  typename Fit::Vector radii(n), log_radii(n);
  for (Index i = 0; i < n; ++i) {
    const ForceSample<S>& s = usable.samples[static_cast<std::size_t>(i)];
    radii(i) = s.measure;
    log_radii(i) = log(s.measure);
    model.log_forces(i) = log(s.normal_force_n);
    logarithms.columns(i, 0) = S(1);
    logarithms.columns(i, 1) = model.log_forces(i);
  }
  const char* const owner = "fit_power_law";
  const std::vector<std::string> names{"coefficient_mm", "exponent"};
  const Fit start =
      detail::ModelFitter<S>(owner, names, log_radii, logarithms, options)(Fit::Vector::Zero(2));
  detail::expects_explained(start, options, owner);
  const Fit fit = detail::ModelFitter<S>(owner, names, radii, model, options)(start.parameters);
  detail::expects_explained(fit, options, owner);
  expects(value(fit.parameters(1)) > 0 && value(fit.parameters(1)) <= 2, owner, "exponent",
          S(fit.parameters(1)), "in (0, 2]: the radius must grow with the force");
  NormalForceFit<PowerLawForce<S>> result;
  result.curve.coefficient_mm = exp(fit.parameters(0));
  result.curve.exponent = fit.parameters(1);
  const S c = result.curve.coefficient_mm;  // the covariance of c from that of ln c
  result.errors.covariance = {{{S(square(c) * fit.covariance(0, 0)), S(c * fit.covariance(0, 1))},
                               {S(c * fit.covariance(1, 0)), fit.covariance(1, 1)}}};
  result.curve.from = result.curve.to = usable.samples.front().measure;
  S left_sq = S(0), weights = S(0);
  for (Index i = 0; i < n; ++i) {
    const ForceSample<S>& s = usable.samples[static_cast<std::size_t>(i)];
    const S fitted = result.curve.force_n(s.measure);
    result.residuals.push_back(
        {usable.places[static_cast<std::size_t>(i)], s.normal_force_n, fitted, fit.weights(i)});
    left_sq += S(fit.weights(i) * square(S(s.normal_force_n - fitted)));
    weights += fit.weights(i);
    result.curve.from = value(s.measure) < value(result.curve.from) ? s.measure : result.curve.from;
    result.curve.to = value(s.measure) > value(result.curve.to) ? s.measure : result.curve.to;
  }
  result.errors.residual_sd_n = sqrt(S(left_sq / S(weights - S(2))));
  expects(is_finite(result.errors.residual_sd_n), owner, "residual_sd_n",
          result.errors.residual_sd_n, "finite: the samples contradict each other");
  result.explained = fit.explained;
  result.largest_residual_sds = fit.worst_sds;
  const char* const units = detail::unit_mistake(usable.samples, {.normal = true});
  result.cause = detail::cause_in(fit, units, nullptr, options);
  return result;
}

/// Tangential force from displacement, normalised by a power of (measure / reference). The exponent
/// is fitted if it is not given. Uses the samples with a measure > 0, a tangential force and a
/// finite motion. Allocates; O(80 samples Degree^2).
template <int Degree = 1, scalar S = double>
ShearFit<Degree, S> fit_tangential_force(
    std::span<const ForceSample<S>> samples,
    const std::type_identity_t<S>& reference,
    const std::optional<std::type_identity_t<S>>& exponent = {},
    const FitOptions& options = {}) {
  using std::log;
  using std::sqrt;
  const char* const owner = "fit_tangential_force";
  detail::expects_reference<S>(reference, owner);
  const auto usable = detail::usable_samples(samples, [](const ForceSample<S>& s) {
    return is_finite(s.tangential_force_n) && detail::has_finite_motion(s);
  });
  std::vector<detail::ShearEquation<S>> equations;
  for (std::size_t i = 0; i < usable.samples.size(); ++i) {
    const ForceSample<S>& s = usable.samples[i];
    const Point2<S>& d = s.displacement_mm;
    const S log_measure = log(S(s.measure / reference));
    const S length_sq = squared_norm(d);
    const S length = value(length_sq) > 0 ? S(sqrt(length_sq)) : S(0);
    equations.push_back({log_measure, d.x, length, s.tangential_force_n.x, usable.places[i]});
    equations.push_back({log_measure, d.y, length, s.tangential_force_n.y, usable.places[i]});
  }
  return detail::fit_shear<ShearFit<Degree, S>>(owner, "displacement_exponent", 2, usable.samples,
                                                equations, exponent, options);
}

/// Moment from rotation, in the same way.
template <int Degree = 1, scalar S = double>
ShearFit<Degree, S> fit_moment(std::span<const ForceSample<S>> samples,
                               const std::type_identity_t<S>& reference,
                               const std::optional<std::type_identity_t<S>>& exponent = {},
                               const FitOptions& options = {}) {
  using std::log;
  const char* const owner = "fit_moment";
  detail::expects_reference<S>(reference, owner);
  const auto usable = detail::usable_samples(samples, [](const ForceSample<S>& s) {
    return is_finite(s.moment_n_mm) && is_finite(s.rotation_rad);
  });
  std::vector<detail::ShearEquation<S>> equations;
  for (std::size_t i = 0; i < usable.samples.size(); ++i) {
    const ForceSample<S>& s = usable.samples[i];
    const S angle = value(s.rotation_rad) < 0 ? S(-s.rotation_rad) : s.rotation_rad;
    equations.push_back(
        {S(log(S(s.measure / reference))), s.rotation_rad, angle, s.moment_n_mm, usable.places[i]});
  }
  return detail::fit_shear<ShearFit<Degree, S>>(owner, "rotation_exponent", 1, usable.samples,
                                                equations, exponent, options);
}

/// A linear map of both components with offsets, for axes other than those of the image. The
/// normalisation is given; the moment is not fitted.
template <scalar S = double>
LinearShearFit<S> fit_linear_shear(std::span<const ForceSample<S>> samples,
                                   const ShearNormalisation<S>& normalisation,
                                   const FitOptions& options = {}) {
  using std::exp;
  using std::log;
  using Fit = detail::ModelFit<S>;
  expects_valid(normalisation);
  const auto usable = detail::usable_samples(samples, [](const ForceSample<S>& s) {
    return is_finite(s.tangential_force_n) && is_finite(s.displacement_mm);
  });
  const Index n = static_cast<Index>(usable.samples.size());
  detail::LinearModel<S> model(n, 3);
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
  const char* const owner = "fit_linear_shear";
  const auto fit = [&](const std::vector<std::string>& names, const auto& measured) {
    const Fit found =
        detail::ModelFitter<S>(owner, names, measured, model, options)(Fit::Vector::Zero(3));
    detail::expects_explained(found, options, owner);
    return found;
  };
  const Fit of_x = fit({"x_by_x", "x_by_y", "offset_n.x"}, x);
  const Fit of_y = fit({"y_by_x", "y_by_y", "offset_n.y"}, y);
  LinearShearFit<S> result;
  result.map.x_by_x = of_x.parameters(0);
  result.map.x_by_y = of_x.parameters(1);
  result.map.y_by_x = of_y.parameters(0);
  result.map.y_by_y = of_y.parameters(1);
  result.map.offset_n = {of_x.parameters(2), of_y.parameters(2)};
  result.map.moment_n_mm_per_rad = S(0);
  using std::sqrt;
  S longest_sq = S(0);
  for (Index i = 0; i < n; ++i) {
    const S length_sq = S(square(model.columns(i, 0)) + square(model.columns(i, 1)));
    longest_sq = value(length_sq) > value(longest_sq) ? length_sq : longest_sq;
  }
  result.map.to = value(longest_sq) > 0 ? S(sqrt(longest_sq)) : not_a_number<S>();
  result.x_standard_errors = detail::standard_errors_of<S, 3>(of_x);
  result.y_standard_errors = detail::standard_errors_of<S, 3>(of_y);
  result.residual_sd_n = {of_x.residual_sd, of_y.residual_sd};
  detail::add_residuals(of_x, x, usable.places, result.residuals);
  detail::add_residuals(of_y, y, usable.places, result.residuals);
  const Fit& worse = value(of_x.worst_sds) > value(of_y.worst_sds) ? of_x : of_y;
  result.largest_residual_sds = worse.worst_sds;
  result.cause =
      !of_x.converged || !of_y.converged
          ? cause::not_converged
          : detail::cause_in(
                worse,
                detail::unit_mistake(usable.samples, {.tangential = true, .displacement = true}),
                nullptr, options);
  return result;
}

}  // namespace v0
}  // namespace fingerpad
