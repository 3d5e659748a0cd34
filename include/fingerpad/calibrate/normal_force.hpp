// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibration of the normal force by look-up: the fits. calibrate/force.hpp tells what they share.
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
#include "fingerpad/force/compensation.hpp"
#include "fingerpad/force/detail/zeros.hpp"
#include "fingerpad/force/force_curve.hpp"
#include "fingerpad/force/force_errors.hpp"

namespace fingerpad {
inline namespace v0 {

/// What a polynomial of the normal force must be, and what else is fitted with it.
struct NormalForceFitOptions {
  bool through_zero = true;  ///< no force without contact; the published curves do without
  bool rising = true;        ///< it never falls from 0 to the largest measure
  bool displaced = false;    ///< also the compensation for displacement
  bool rotated = false;      ///< also the one for rotation
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

namespace detail {

/// A polynomial with some of its columns: first without a compensation, then with it.
template <int Degree, scalar S>
ModelFit<S> fit_columns(const std::vector<ForceSample<S>>& samples,
                        const typename ModelFit<S>::Vector& forces,
                        const S& to,
                        const PolynomialTerms& terms,
                        const FitOptions& options) {
  using Vector = typename ModelFit<S>::Vector;
  const char* const owner = "fit_normal_force";
  const bool constant = terms.columns.front() == 0;
  const PolynomialModel<Degree, S> plain(samples, to, {terms.columns, false, false});
  const Index columns = static_cast<Index>(terms.columns.size());
  const ModelFit<S> first = ModelFitter<S, PolynomialModel<Degree, S>>(
      owner, plain.names(), forces, plain, options)(Vector::Zero(columns), constant);
  if (!terms.displaced && !terms.rotated) {
    return first;
  }
  const PolynomialModel<Degree, S> whole(samples, to, terms);
  Vector start = Vector::Zero(static_cast<Index>(whole.names().size()));
  start.head(columns) = first.parameters;
  return ModelFitter<S, PolynomialModel<Degree, S>>(owner, whole.names(), forces, whole, options)(
      start, constant);
}

template <scalar S>
bool rises(const ModelFit<S>& fit, const PolynomialTerms& terms) {
  for (std::size_t c = 0; c < terms.columns.size(); ++c) {
    if (terms.columns[c] > 0 && value(fit.parameters(static_cast<Index>(c))) < 0) {
      return false;
    }
  }
  return true;
}

/// Of all choices of columns without a falling one that with the least left: few enough to try.
template <int Degree, scalar S>
ModelFit<S> fit_rising(const std::vector<ForceSample<S>>& samples,
                       const typename ModelFit<S>::Vector& forces,
                       const S& to,
                       PolynomialTerms& terms,
                       const FitOptions& options) {
  const PolynomialTerms all = terms;
  FitOptions any = options;
  any.min_explained = 0;
  ModelFit<S> best;
  S least = not_a_number<S>();
  const unsigned choices = 1U << all.columns.size();
  for (unsigned choice = 1; choice + 1 < choices; ++choice) {
    PolynomialTerms some = all;
    some.columns.clear();
    for (std::size_t c = 0; c < all.columns.size(); ++c) {
      if (all.columns[c] == 0 || (choice >> c) % 2 == 1) {
        some.columns.push_back(all.columns[c]);
      }
    }
    if (some.columns.back() == 0) {
      continue;
    }
    ModelFit<S> fit = fit_columns<Degree>(samples, forces, to, some, any);
    S left = S(0);
    for (Index i = 0; i < fit.residuals.size(); ++i) {
      left += S(fit.weights(i) * square(fit.residuals(i)));
    }
    if (rises(fit, some) && !(value(left) >= value(least))) {
      least = left;
      best = std::move(fit);
      terms = some;
    }
  }
  expects(is_finite(least) && value(best.explained) >= value(S(options.min_explained)),
          "fit_normal_force", "share of the measured variance that a rising force explains",
          best.explained, ">= min_explained: the force falls while the contact grows");
  return best;
}

}  // namespace detail

template <int Degree, scalar S>
NormalForceFit<Degree, S> fit_normal_force(std::span<const ForceSample<S>> samples,
                                           const NormalForceFitOptions& options) {
  using Fit = detail::ModelFit<S>;
  const auto usable = detail::usable_samples(samples, [&](const ForceSample<S>& s) {
    const bool moved = options.displaced || options.rotated;
    return is_finite(s.normal_force_n) && (!moved || detail::has_finite_motion(s));
  });
  typename Fit::Vector forces(static_cast<Index>(usable.samples.size()));
  S from = not_a_number<S>(), to = not_a_number<S>();
  for (std::size_t i = 0; i < usable.samples.size(); ++i) {
    const ForceSample<S>& s = usable.samples[i];
    forces(static_cast<Index>(i)) = s.normal_force_n;
    from = value(s.measure) >= value(from) ? from : s.measure;
    to = value(s.measure) <= value(to) ? to : s.measure;
  }
  detail::PolynomialTerms terms{{}, options.displaced, options.rotated};
  for (std::size_t k = options.through_zero ? 1 : 0; k <= static_cast<std::size_t>(Degree); ++k) {
    terms.columns.push_back(k);
  }
  expects(!usable.samples.empty(), "fit_normal_force", "usable samples", 0LL,
          "> 0: with a measure > 0 and a finite normal force");

  expects(value(to) > value(from), "fit_normal_force", "largest measure", to, "> the smallest");

  NormalForceFit<Degree, S> result;
  Fit fit = detail::fit_columns<Degree>(usable.samples, forces, to, terms, options.fit);
  if (options.rising && !detail::rises(fit, terms)) {
    result.held_rising = true;
    fit = detail::fit_rising<Degree>(usable.samples, forces, to, terms, options.fit);
  }
  const detail::PolynomialModel<Degree, S> model(usable.samples, to, terms);
  const typename Fit::Matrix powers = model.to_powers();
  const Index columns = powers.cols();
  const typename Fit::Vector coefficients = powers * fit.parameters.head(columns);
  const typename Fit::Matrix covariance =
      powers * fit.covariance.topLeftCorner(columns, columns) * powers.transpose();
  for (std::size_t k = 0; k < result.curve.coefficients.size(); ++k) {
    result.curve.coefficients[k] = coefficients(static_cast<Index>(k));
    for (std::size_t l = 0; l < result.curve.coefficients.size(); ++l) {
      result.errors.covariance[k][l] = covariance(static_cast<Index>(k), static_cast<Index>(l));
    }
  }
  result.curve.from = from;
  result.curve.to = to;
  result.errors.residual_sd_n = fit.residual_sd;
  Index next = columns;
  using std::sqrt;
  if (options.displaced) {
    result.compensation.per_mm_sq = fit.parameters(next);
    result.per_mm_sq_sd = sqrt(fit.covariance(next, next));
    ++next;
  }
  if (options.rotated) {
    result.compensation.per_rad_sq = fit.parameters(next);
    result.per_rad_sq_sd = sqrt(fit.covariance(next, next));
  }
  detail::add_residuals(fit, forces, usable.places, result.residuals);
  result.explained = fit.explained;
  result.converged = fit.converged;
  return result;
}

namespace detail {

/// r = c f^gamma, parameters ln c and gamma.
template <scalar S>
struct PowerLawModel {
  typename ModelFit<S>::Vector log_forces;
  void fill(const typename ModelFit<S>::Vector& parameters,
            typename ModelFit<S>::Vector& values,
            typename ModelFit<S>::Matrix& jacobian) const {
    using std::exp;
    for (Index i = 0; i < values.size(); ++i) {
      values(i) = exp(S(parameters(0) + S(parameters(1) * log_forces(i))));
      jacobian(i, 0) = values(i);
      jacobian(i, 1) = values(i) * log_forces(i);
    }
  }
};

}  // namespace detail

template <class Curve, scalar S>
AffineForceFit<S> fit_affine_force(std::span<const ForceSample<S>> samples,
                                   const Curve& curve,
                                   AffineBy by,
                                   const FitOptions& options) {
  using std::sqrt;
  using Fit = detail::ModelFit<S>;
  expects_valid(curve);
  const auto usable = detail::usable_samples(samples, [](const ForceSample<S>& s) {
    return is_finite(s.normal_force_n) && detail::has_finite_motion(s);
  });
  const Index n = static_cast<Index>(usable.samples.size());
  detail::LinearModel<S> model{typename Fit::Matrix(n, 3)};
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
  const Fit fit = detail::ModelFitter<S, detail::LinearModel<S>>(
      "fit_affine_force", {"gain", "per_unit", "offset_n"}, forces, model, options)(
      Fit::Vector::Zero(3), true);
  AffineForceFit<S> result;
  result.force = {fit.parameters(0), fit.parameters(1), fit.parameters(2)};
  result.standard_errors = detail::standard_errors_of<S, 3>(fit);
  result.covariance = detail::covariance_of<S, 3>(fit);
  result.residual_sd_n = fit.residual_sd;
  detail::add_residuals(fit, forces, usable.places, result.residuals);
  return result;
}

template <scalar S>
PowerLawFit<S> fit_power_law(std::span<const ForceSample<S>> samples, const FitOptions& options) {
  using std::exp;
  using std::log;
  using std::sqrt;
  using Fit = detail::ModelFit<S>;
  const auto usable = detail::usable_samples(samples, [](const ForceSample<S>& s) {
    return is_finite(s.normal_force_n) && value(s.normal_force_n) > 0;
  });
  const Index n = static_cast<Index>(usable.samples.size());
  detail::PowerLawModel<S> model{typename Fit::Vector(n)};
  detail::LinearModel<S> logarithms{typename Fit::Matrix(n, 2)};
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
  const Fit start = detail::ModelFitter<S, detail::LinearModel<S>>(
      owner, names, log_radii, logarithms, options)(Fit::Vector::Zero(2), true);
  const Fit fit = detail::ModelFitter<S, detail::PowerLawModel<S>>(owner, names, radii, model,
                                                                   options)(start.parameters, true);
  expects(value(fit.parameters(1)) > 0 && value(fit.parameters(1)) <= 2, owner, "exponent",
          S(fit.parameters(1)), "in (0, 2]: the radius must grow with the force");
  PowerLawFit<S> result;
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
  result.residual_sd_mm = fit.residual_sd;
  result.explained = fit.explained;
  result.converged = fit.converged;
  return result;
}

}  // namespace v0
}  // namespace fingerpad
