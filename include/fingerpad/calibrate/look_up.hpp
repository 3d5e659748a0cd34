// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibration of the forces by look-up (force/look_up.hpp) from contacts measured with a force
// gauge: least squares by Gauss-Newton steps and, optionally, Huber's weights, with the covariance
// of the parameters and all residuals. Samples that do not determine a parameter, or that
// contradict each other, are refused by name (parameter_error). docs/calibrate/calibration.md
// describes how to take samples. The standard errors hold for samples with independent errors in
// the force. Errors in the measure or the displacement bias the fit toward smaller slopes, and
// samples of one load have common errors: leave_one_load_out estimates the error of forces outside
// the calibration.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/look_up.hpp"
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
  S mean_abs = not_a_number<S>();
  S worst = not_a_number<S>();  ///< largest absolute error
};

/// Leaves out one load after the other, calibrates with the rest, and predicts the samples left
/// out: model = fit(span of samples); error = error_of(model, sample). O(loads) fits; allocates.
/// Refuses what the fit refuses.
template <scalar S, class Fit, class ErrorOf>
CrossValidation<S> leave_one_load_out(std::span<const ForceSample<S>> samples,
                                      const Fit& fit,
                                      const ErrorOf& error_of) {
  CrossValidation<S> result;
  result.errors.assign(samples.size(), not_a_number<S>());
  std::vector<int> done;
  S sum(0);
  int predicted = 0;
  for (const ForceSample<S>& first : samples) {
    if (std::find(done.begin(), done.end(), first.load) != done.end()) {
      continue;
    }
    done.push_back(first.load);
    std::vector<ForceSample<S>> rest;
    std::copy_if(samples.begin(), samples.end(), std::back_inserter(rest),
                 [&](const ForceSample<S>& s) { return s.load != first.load; });
    const auto model = fit(std::span<const ForceSample<S>>(rest));
    ++result.loads;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const S error = samples[i].load == first.load ? error_of(model, samples[i]) : S(0);
      result.errors[i] = samples[i].load == first.load ? error : result.errors[i];
      if (samples[i].load == first.load && is_finite(error)) {
        const S size = value(error) < 0 ? -error : error;
        sum = sum + size;
        ++predicted;
        result.worst = value(size) <= value(result.worst) ? result.worst : size;
      }
    }
  }
  result.mean_abs = predicted > 0 ? sum / S(predicted) : result.mean_abs;
  return result;
}

/// What fit_normal_force fits: a polynomial that never falls from 0 to the largest measure.
struct CurveOptions {
  int degree = 2;            ///< of the polynomial, in [1, 3]
  bool through_zero = true;  ///< no force without contact; the published curves lack this
};

/// Says which option has no meaning; "" if all have one.
inline std::string check(const CurveOptions& o) {
  return check("CurveOptions", {{"degree", o.degree, within(1, 3)}});
}

/// Normal force from area, depth or radius.
template <scalar S = double>
struct [[nodiscard]] NormalForceFit {
  const char* cause = cause::not_converged;  ///< likely mistake
  ForceCurve<S> curve = {};                  ///< with its errors, for NormalForce
  std::vector<ForceResidual<S>> residuals = {};
  S explained = S(0);  ///< share of the measured variance about the mean

  bool ok() const { return cause == nullptr; }
};

/// One half of a Shear: force from displacement, or moment from rotation.
template <scalar S = double>
struct [[nodiscard]] ShearFit {
  const char* cause = cause::not_converged;  ///< likely mistake
  ShearLaw<S> law = {};                      ///< a straight line
  detail::SmallMatrix<S, 2> covariance =
      detail::zero_matrix<S, 2>();  ///< of the slope and the exponent; 0 for a given exponent
  S residual_sd = S(0);             ///< of a component of the force in N, or of the moment in N mm
  std::vector<ForceResidual<S>> residuals = {};  ///< for a force, x and y alternate
  S explained = S(0);
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
  ShearMap<S> map = {};                                        ///< K in N/mm; its moment is 0
  std::array<S, 3> x_standard_errors = detail::zeros<S, 3>();  ///< of x_by_x, x_by_y, offset_n.x
  std::array<S, 3> y_standard_errors = detail::zeros<S, 3>();  ///< of y_by_x, y_by_y, offset_n.y
  Point2<S> residual_sd_n = {S(0), S(0)};
  std::vector<ForceResidual<S>> residuals = {};  ///< all of x, then all of y

  bool ok() const { return cause == nullptr; }
};

namespace detail {

template <scalar S>
using FitVector = Eigen::Matrix<S, Eigen::Dynamic, 1>;
template <scalar S>
using FitMatrix = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
template <scalar S>
using PlaneVectors = Eigen::Matrix<S, Eigen::Dynamic, 2>;  ///< one each row

/// Fills values and Jacobian. One type, so that a fit is compiled once for all models.
template <scalar S>
using FitModel =
    std::function<void(const FitVector<S>& parameters, FitVector<S>& values, FitMatrix<S>& slopes)>;

template <scalar S>
struct FitProblem {
  const char* owner;
  std::vector<std::string> names;  ///< of the parameters, for refusals
  FitVector<S> measured;
  FitOptions options;
};

template <scalar S>
struct ModelFit {
  FitVector<S> parameters, residuals, weights;  ///< residuals: measured less model
  FitMatrix<S> covariance;
  S residual_sd = S(0), explained = S(0);
  S left_sq = S(0), worst_sq = S(0);  ///< weighted sum of squared residuals, the largest of them
  S robust_sd = S(0);                 ///< of the residuals, from their median magnitude
  S constant = S(0), by_constant = S(0);  ///< one more parameter, and how much of left_sq it takes
  bool converged = false;
};

/// Standard deviation of normal residuals from their median magnitude. A third of outliers changes
/// it little.
template <scalar S>
S robust_sd(const FitVector<S>& residuals, Index parameters) {
  using std::sqrt;
  FitVector<S> sizes = residuals.cwiseAbs();
  const auto n = static_cast<double>(sizes.size());
  S* const middle = sizes.data() + sizes.size() / 2;
  std::nth_element(sizes.data(), middle, sizes.data() + sizes.size());
  return S(1.4826) * *middle * sqrt(S(n / (n - static_cast<double>(parameters))));
}

/// Fits from `start`. The first step solves a model that is linear in its parameters. Refuses too
/// few samples, and a parameter whose slopes follow from those of the parameters before it.
template <scalar S>
ModelFit<S> fit_model(const FitProblem<S>& of,
                      const FitVector<S>& start,
                      const FitModel<S>& model) {
  using std::sqrt;
  constexpr int max_passes = 100;
  constexpr double huber_threshold = 1.345;  // in standard deviations of a sample
  require(of.options);
  const Index n = of.measured.size(), p = start.size();
  expects(n > p, of.owner, "usable samples", static_cast<long long>(n),
          ("> " + std::to_string(p) + ", the number of parameters").c_str());
  ModelFit<S> fit;
  fit.parameters = start;
  fit.weights = FitVector<S>::Constant(n, S(1));
  FitVector<S> values(n);
  FitMatrix<S> slopes(n, p);
  const auto inverse = [&](const FitVector<S>& weights) {  // of the normal equations
    const FitMatrix<S> a = slopes.transpose() * weights.asDiagonal() * slopes;
    const FitVector<S> scale = a.diagonal().cwiseSqrt().cwiseInverse();  // units do not matter
    const Eigen::LLT<FitMatrix<S>> factor(scale.asDiagonal() * a * scale.asDiagonal());
    for (Index k = 0; k < p; ++k) {  // the share of a column that those before it do not give
      const S share_sq = S(1) - factor.matrixLLT().row(k).head(k).squaredNorm();
      const std::string name =
          "information in the samples on " + of.names[static_cast<std::size_t>(k)];
      expects(is_finite(scale(k)) && S(1e-10) + S(64) * S(epsilon<S>()) < share_sq, of.owner,
              name.c_str(), share_sq, "> 1e-10: they are too few, too alike or tied to each other");
    }
    const FitMatrix<S> one = FitMatrix<S>::Identity(p, p);
    return FitMatrix<S>(scale.asDiagonal() * factor.solve(one) * scale.asDiagonal());
  };
  for (int pass = 0; pass < max_passes && !fit.converged; ++pass) {
    model(fit.parameters, values, slopes);
    fit.residuals = of.measured - values;
    if (of.options.robust && pass > 0) {
      const S limit = S(huber_threshold) * robust_sd(fit.residuals, p);
      for (Index i = 0; i < n; ++i) {
        const S size = fit.residuals(i) < S(0) ? -fit.residuals(i) : fit.residuals(i);
        fit.weights(i) = limit < size ? limit / size : S(1);
      }
    }
    const FitVector<S> down = slopes.transpose() * fit.weights.cwiseProduct(fit.residuals);
    const FitVector<S> step = inverse(fit.weights) * down;
    fit.parameters += step;
    const S least = square(S(64) * S(epsilon<S>())) * of.measured.squaredNorm();
    fit.converged = pass > 0 && !(least < step.dot(down));
  }
  model(fit.parameters, values, slopes);
  fit.residuals = of.measured - values;
  const FitVector<S>& w = fit.weights;
  const FitVector<S> squares = fit.residuals.cwiseAbs2();
  const S count = S(static_cast<double>(n)), freedom = S(static_cast<double>(n - p));
  const S total = w.sum(), mean = w.dot(of.measured) / total;
  fit.left_sq = w.dot(squares);
  fit.worst_sq = squares.maxCoeff();
  const S all_sq = w.dot((of.measured.array() - mean).square().matrix());
  fit.explained = S(0) < all_sq ? S(1) - fit.left_sq / all_sq : S(0);
  fit.robust_sd = robust_sd(fit.residuals, p);
  S variance = fit.left_sq / freedom;
  fit.residual_sd = of.options.robust ? fit.robust_sd : sqrt(variance);
  if (of.options.robust) {  // Huber 1981, section 7.6
    const auto inside = static_cast<double>((w.array() >= S(1)).count());
    const S share = S((std::max)(inside, 1.0)) / count;
    const S correction = S(1) + (count - freedom) / count * ((S(1) - share) / share);
    variance = square(correction / share) * w.cwiseAbs2().dot(squares) / freedom;
  }
  const FitVector<S> with = slopes.transpose() * w;
  const S free = total - with.dot(inverse(w) * with), residual = w.dot(fit.residuals);
  if (n >= p + 4 && total < S(1e9) * free) {
    fit.constant = residual / free;
    fit.by_constant = fit.constant * residual;
  }
  fit.covariance = variance * inverse(FitVector<S>::Constant(n, S(1)));
  const S sum = fit.covariance.sum() + fit.parameters.sum() + fit.residual_sd + total;
  expects(is_finite(sum), of.owner, "parameters and their variances", sum,
          "finite: a force is far too large");
  return fit;
}

/// Refuses a model that does not explain the samples.
template <scalar S>
void expects_explained(const FitProblem<S>& of,
                       const ModelFit<S>& fit,
                       const char* mistake = nullptr,
                       const std::string& details = "") {
  const bool agrees = !(fit.explained < S(of.options.min_explained)) && S(0) < fit.explained;
  std::string must = ">= min_explained: the samples are constant or contradict each other";
  must += mistake == nullptr ? "" : "; ";
  must += mistake == nullptr ? "" : mistake;
  must += details;
  expects(agrees, of.owner, "share of the measured variance that is explained", fit.explained,
          must.c_str());
}

/// The likely mistake; nullptr: none. Causes of wrong parameters come before causes of inexact
/// ones. An outlier is a sample more than ten standard deviations off that makes up most of the
/// residual.
template <scalar S>
const char* cause_in(const FitProblem<S>& of,
                     const ModelFit<S>& fit,
                     const char* units,
                     const char* mistake) {
  const bool is_most = fit.left_sq < S(2) * fit.worst_sq;
  const bool is_off = S(100) * square(fit.robust_sd) < fit.worst_sq && S(0) < fit.robust_sd;
  return units != nullptr     ? units
         : mistake != nullptr ? mistake
         : !fit.converged     ? cause::not_converged
         : !of.options.robust && is_most && is_off
             ? "a sample is far from the others: check its dots and its gauge reading, "
               "or fit robustly"
             : nullptr;
}

/// Indices of the samples that a fit can use.
template <scalar S, class Usable>
std::vector<std::size_t> usable_samples(std::span<const ForceSample<S>> given,
                                        const Usable& usable) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (is_finite(given[i].measure) && value(given[i].measure) > 0 && usable(given[i])) {
      places.push_back(i);
    }
  }
  return places;
}

/// Of values of which each sample has `components`.
template <scalar S>
void add_residuals(const FitProblem<S>& of,
                   const ModelFit<S>& fit,
                   const std::vector<std::size_t>& places,
                   Index components,
                   std::vector<ForceResidual<S>>& residuals) {
  for (Index i = 0; i < of.measured.size(); ++i) {
    residuals.push_back({places[static_cast<std::size_t>(i / components)], of.measured(i),
                         of.measured(i) - fit.residuals(i), fit.weights(i)});
  }
}

enum class Calibrated { normal_force, tangential_force, moment };

/// Detects a quantity in a wrong unit. The bounds hold for every fingertip. A contact of 0.05 mm or
/// 0.05 mm^2 is not visible, and none is larger than 10000 mm^2 or displaced by 100 mm. A
/// calibration exceeds 0.05 N of normal and 0.01 N of tangential force, and 300 N are more than the
/// force of 0.2 MPa on a pad of 40 mm. A moment has a lever between 0.05 and 100 mm.
template <scalar S>
const char* unit_mistake(std::span<const ForceSample<S>> samples,
                         const std::vector<std::size_t>& places,
                         Calibrated what) {
  const auto largest = [&](const auto& x_of) {
    double most = 0;
    for (const std::size_t place : places) {
      const double size = std::abs(static_cast<double>(value(x_of(samples[place]))));
      most = size > most && is_finite(size) ? size : most;
    }
    return most;
  };
  const auto longer = [](const Point2<S>& p) { return square(p.x) < square(p.y) ? p.y : p.x; };
  using Sample = ForceSample<S>;
  const double measure = largest([](const Sample& s) { return s.measure; });
  const double force = largest([](const Sample& s) { return s.normal_force_n; });
  const double aside = largest([&](const Sample& s) { return longer(s.tangential_force_n); });
  const double moved = largest([&](const Sample& s) { return longer(s.displacement_mm); });
  const double turned = largest([](const Sample& s) { return s.rotation_rad; });
  const double moment = largest([](const Sample& s) { return s.moment_n_mm; });
  const bool along = what == Calibrated::tangential_force, turns = what == Calibrated::moment;
  const bool lever = moment >= 0.05 * force && (moment <= 100 * force || force <= 0);
  return measure < 0.05 || measure > 1e4
             ? "no measure reaches 0.05, or one exceeds 10000: give areas in mm^2, depths and "
               "radii in mm"
         : (along ? aside < 0.01 || aside > 300 : !turns && (force < 0.05 || force > 300))
             ? "no force reaches 0.05 (along the pad 0.01), or one exceeds 300: give forces in N"
         : along && (moved < 0.01 || moved > 100)
             ? "no displacement reaches 0.01, or one exceeds 100: give displacements in mm"
         : turns && turned > 1.6 ? "a rotation exceeds a right angle: give rotations in rad"
         : turns && !lever       ? "moments are below 0.05 mm or above 100 mm times the normal "
                                   "force: give moments in N mm"
                                 : nullptr;
}

/// Whether a constant that explains `by_constant` of a sum of squared residuals, and has the square
/// `constant_sq`, shows that the gauge was not tared: it explains more than half, and exceeds a
/// tenth of the largest force.
template <scalar S>
bool is_offset(const S& by_constant, const S& left_sq, const S& constant_sq, const S& largest_sq) {
  return left_sq < S(2) * by_constant && largest_sq < S(100) * constant_sq;
}

/// Coefficients of 1, t, t^2, t^3 in G_k, the sum over j >= k of the Bernstein polynomials B_j(t),
/// for degrees 1 to 3. A polynomial whose factors of G_1, G_2, ... are not negative never falls in
/// [0, 1] (for degree 2 also the reverse).
inline constexpr int rising_terms[3][4][4] = {
    {{1}, {0, 1}}, {{1}, {0, 2, -1}, {0, 0, 1}}, {{1}, {0, 3, -3, 1}, {0, 0, 3, -2}, {0, 0, 0, 1}}};

/// Values P b for fixed columns P.
template <scalar S>
auto linear_model(const FitMatrix<S>& columns) {
  return [&columns](const FitVector<S>& b, FitVector<S>& values, FitMatrix<S>& slopes) {
    slopes = columns;
    values = columns * b;
  };
}

}  // namespace detail

/// Normal force from area, depth or radius by a polynomial. One that falls somewhere between 0 and
/// the largest measure is replaced by one that does not. Uses the samples with a measure > 0 and a
/// normal force. Allocates; O(passes samples degree^2).
template <scalar S = double>
NormalForceFit<S> fit_normal_force(std::span<const ForceSample<S>> samples,
                                   const CurveOptions& curve = {},
                                   const FitOptions& options = {}) {
  const char* const owner = "fit_normal_force";
  require(curve);
  const auto places = detail::usable_samples(
      samples, [](const ForceSample<S>& s) { return is_finite(s.normal_force_n); });
  expects(!places.empty(), owner, "usable samples", 0LL,
          "> 0: with a measure > 0 and a finite normal force");
  const Index n = static_cast<Index>(places.size()), size = curve.degree + 1;
  detail::FitProblem<S> of{owner, {}, detail::FitVector<S>(n), options};
  detail::FitVector<S> t(n);  // measure over the largest
  for (Index i = 0; i < n; ++i) {
    t(i) = samples[places[static_cast<std::size_t>(i)]].measure;
    of.measured(i) = samples[places[static_cast<std::size_t>(i)]].normal_force_n;
  }
  NormalForceFit<S> result;
  const S to = t.maxCoeff();
  result.curve.from = t.minCoeff();
  result.curve.to = to;
  expects(result.curve.from < to, owner, "largest measure", to, "> the smallest");
  t /= to;
  detail::FitMatrix<S> powers(n, size), terms(size, size);
  for (Index k = 0; k < size; ++k) {
    powers.col(k) = k == 0 ? detail::FitVector<S>::Constant(n, S(1))
                           : detail::FitVector<S>(powers.col(k - 1).cwiseProduct(t));
    for (Index i = 0; i < size; ++i) {
      terms(i, k) = S(detail::rising_terms[curve.degree - 1][k][i]);
    }
  }
  std::vector<Index> used;
  for (Index k = curve.through_zero ? 1 : 0; k < size; ++k) {
    used.push_back(k);
  }
  const auto fitted = [&] {
    of.names.clear();
    for (const Index k : used) {
      of.names.push_back(k == 0 ? "the constant" : "measure^" + std::to_string(k));
    }
    const detail::FitMatrix<S> columns = powers * terms(Eigen::all, used);
    return detail::fit_model<S>(of, detail::FitVector<S>::Zero(columns.cols()),
                                detail::linear_model(columns));
  };
  detail::ModelFit<S> fit = fitted();
  bool falls = false;
  for (Index lowest = 0;;) {  // without the terms that fall
    const Index first = used.front() == 0 ? 1 : 0, others = fit.parameters.size() - first;
    if (!(fit.parameters.tail(others).minCoeff(&lowest) < S(0))) {
      break;
    }
    falls = true;
    used.erase(used.begin() + first + lowest);
    fit = others > 1 ? fitted() : detail::ModelFit<S>();
    expects(others > 1 && !(fit.explained < S(options.min_explained)), owner,
            "share of the measured variance that a rising force explains", fit.explained,
            ">= min_explained: the force falls while the contact grows, or is not that of these "
            "contacts");
  }
  const bool offset = !falls && curve.through_zero &&
                      detail::is_offset<S>(fit.by_constant, fit.left_sq, square(fit.constant),
                                           of.measured.cwiseAbs2().maxCoeff());
  const char* const mistake = offset ? cause::gauge_not_tared : nullptr;
  if (!falls) {
    detail::expects_explained(of, fit, mistake);
  }
  detail::FitMatrix<S> scaled = terms(Eigen::all, used);  // of measure / to, then of the measure
  S scale(1);
  for (Index i = 0; i < size; ++i) {
    scaled.row(i) /= scale;
    scale = scale * to;
  }
  const detail::FitVector<S> coefficients = scaled * fit.parameters;
  const detail::FitMatrix<S> covariance = scaled * fit.covariance * scaled.transpose();
  for (Index i = 0; i < size; ++i) {
    result.curve.coefficients[static_cast<std::size_t>(i)] = coefficients(i);
    for (Index j = 0; j < size; ++j) {
      result.curve.covariance[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
          covariance(i, j);
    }
  }
  result.curve.residual_sd_n = fit.residual_sd;
  result.explained = fit.explained;
  detail::add_residuals(of, fit, places, 1, result.residuals);
  const char* const units = detail::unit_mistake(samples, places, detail::Calibrated::normal_force);
  result.cause = detail::cause_in(of, fit, units, mistake);
  return result;
}

namespace detail {

/// The rotation from the least-squares linear map A of normalised displacements to forces. The
/// stiffness of an elastic pad is symmetric (Betti), so an antisymmetric part of A is a rotation.
/// Displacements along one line do not distinguish it from an anisotropic pad, and near one line
/// the nonlinearity of the pad outweighs it. There is no angle if the determinant of sum d d^T is
/// below a fifth of that for displacements even in all directions. Returns the angle of the gauge
/// against the image and its standard error, for samples with independent errors.
template <scalar S>
std::array<S, 2> gauge_angle(const PlaneVectors<S>& d, const PlaneVectors<S>& forces) {
  using std::atan2;
  using std::sqrt;
  const Eigen::Matrix<S, 2, 2> dd = d.transpose() * d;
  const S determinant = dd.determinant(), trace = dd.trace();
  if (d.rows() < 3 || !(square(trace) < S(20) * determinant)) {
    return {not_a_number<S>(), not_a_number<S>()};
  }
  const Eigen::Matrix<S, 2, 2> a = dd.inverse() * (d.transpose() * forces);  // transposed
  const S along = a.trace(), across = a(0, 1) - a(1, 0);
  const S freedom = S(2.0 * static_cast<double>(d.rows()) - 4);
  const S variance = (forces - d * a).squaredNorm() / freedom;
  return {atan2(across, along),
          sqrt(variance * trace / determinant / (square(along) + square(across)))};
}

/// The likely mistake behind the forces and the residual of their fit; nullptr: none detected.
/// A rotation or a reflection with a scale that explains more than half of the forces shows axes
/// with which no fit can succeed; without `left`, the residual, only they are looked for. A smaller
/// rotation counts if it explains more than half of the residual and exceeds a tenth of the force
/// along the displacement.
template <scalar S>
const char* mistake_in(const PlaneVectors<S>& d,
                       const PlaneVectors<S>& forces,
                       const PlaneVectors<S>* left = nullptr) {
  const Eigen::Matrix<S, 2, 2> sums = d.transpose() * forces;
  const S along = sums.trace(), across = sums(0, 1) - sums(1, 0), dd = d.squaredNorm();
  const S half = dd * forces.squaredNorm() / S(2);
  const bool rotated = half < square(along) + square(across);
  const bool mirrored = half < square(sums(0, 0) - sums(1, 1)) + square(sums(0, 1) + sums(1, 0));
  if (mirrored && !rotated) {
    return "the forces mirror the displacements: check whether x and y are exchanged or one is "
           "reversed";
  }
  if (rotated && square(along) < square(across)) {
    return cause::gauge_rotated;
  }
  if (left == nullptr) {
    return nullptr;
  }
  const S count = S(static_cast<double>(d.rows())), left_sq = left->squaredNorm();
  const S by_constant = left->colwise().sum().squaredNorm() / count;
  const S largest_sq = forces.rowwise().squaredNorm().maxCoeff();
  const bool explains = left_sq * dd < S(2) * square(across);
  return rotated && along < S(0)
             ? "the forces point against the displacements: check the sign of each axis"
         : is_offset<S>(by_constant, left_sq, by_constant / count, largest_sq)
             ? cause::gauge_not_tared
         : explains && square(along) < S(100) * square(across) ? cause::gauge_rotated
                                                               : nullptr;
}

/// By which angle a rotated gauge is rotated, for refusals.
template <scalar S>
std::string angle_text(const char* mistake, const std::array<S, 2>& angle) {
  const auto degrees = [](const S& rad) {
    return std::to_string(std::lround(57.29577951308232 * static_cast<double>(value(rad))));
  };
  return mistake != cause::gauge_rotated ? ""
         : is_finite(angle[1])
             ? " (rotated by " + degrees(angle[0]) + " +- " + degrees(angle[1]) + " degrees)"
             : " (displace in several directions to obtain the angle)";
}

/// y = c u x, u = (measure / reference)^T, for each component of each sample: a search for T from
/// -2 to 6 unless it is given, then a fit of c and T together. `moved` and `caused` are x and y of
/// a sample.
template <scalar S, class Usable, class Moved, class Caused>
ShearFit<S> fit_shear(FitProblem<S> of,
                      Calibrated what,
                      std::span<const ForceSample<S>> samples,
                      const S& reference,
                      const std::optional<S>& exponent,
                      const Usable& usable,
                      const Moved& moved,
                      const Caused& caused) {
  using std::exp;
  using std::log;
  using std::sqrt;
  require(of.owner, {{"reference", reference, positive},
                     {of.names[1].c_str(), exponent.value_or(S(0)), finite_number}});
  const auto places = usable_samples(samples, usable);
  const Index n = static_cast<Index>(places.size());
  const Index components = what == Calibrated::moment ? 1 : 2;
  PlaneVectors<S> x(n, 2), y(n, 2);
  FitVector<S> log_ratio(n);
  for (Index i = 0; i < n; ++i) {
    const ForceSample<S>& s = samples[places[static_cast<std::size_t>(i)]];
    const Point2<S> from = moved(s), to = caused(s);
    x.row(i) << from.x, from.y;
    y.row(i) << to.x, to.y;
    log_ratio(i) = log(s.measure / reference);
  }
  const auto in_rows = [&](const PlaneVectors<S>& v) {  // x and y of a sample one after the other
    const FitMatrix<S> across = v.leftCols(components).transpose();
    return FitVector<S>(across.reshaped());
  };
  const auto normalised = [&](const S& power) {
    PlaneVectors<S> d = x;
    for (Index i = 0; i < n; ++i) {
      d.row(i) *= S(exp(power * log_ratio(i)));
    }
    return d;
  };
  const bool fits_exponent = !exponent;
  const auto model = [&](const FitVector<S>& p, FitVector<S>& values, FitMatrix<S>& slopes) {
    const PlaneVectors<S> d = normalised(fits_exponent ? p(1) : *exponent);
    slopes.col(0) = in_rows(d);
    values = p(0) * slopes.col(0);
    if (fits_exponent) {
      slopes.col(1) = p(0) * in_rows(log_ratio.asDiagonal() * d);
    }
  };
  of.measured = in_rows(y);
  const PlaneVectors<S> plain = normalised(exponent.value_or(S(0)));
  const char* const axes = mistake_in<S>(plain, y);
  std::string must = "such that the forces follow the displacements; ";
  must += axes == nullptr ? "" : axes + angle_text(axes, gauge_angle<S>(plain, y));
  expects(axes == nullptr, of.owner, "usable samples", static_cast<long long>(n), must.c_str());
  FitVector<S> start = FitVector<S>::Zero(fits_exponent ? 2 : 1);
  S least = not_a_number<S>();
  for (int k = 0; fits_exponent && k <= 80; ++k) {
    const S power = S(-2) + S(k) / S(10);
    const FitVector<S> v = in_rows(normalised(power));
    const S factor = v.dot(of.measured) / v.squaredNorm();
    const FitVector<S> left = of.measured - factor * v;
    const S size = of.options.robust ? left.cwiseAbs().sum() : left.squaredNorm();
    if (is_finite(size) && !(value(size) >= value(least))) {
      least = size;
      start << factor, power;
    }
  }
  const ModelFit<S> fit = fit_model<S>(of, start, model);
  ShearFit<S> result;
  result.law.coefficients[0] = fit.parameters(0);
  result.law.exponent = fits_exponent ? fit.parameters(1) : *exponent;
  expects(!fits_exponent || (S(-2) <= result.law.exponent && result.law.exponent <= S(6)), of.owner,
          of.names[1].c_str(), result.law.exponent, "in [-2, 6]: the samples do not determine it");
  const PlaneVectors<S> d = normalised(result.law.exponent);
  result.law.to = sqrt(S(d.rowwise().squaredNorm().maxCoeff()));
  expects(is_finite(result.law.to), of.owner, "largest displacement or rotation", result.law.to,
          "finite");
  for (Index i = 0; i < fit.covariance.size(); ++i) {
    const auto row = static_cast<std::size_t>(i / start.size());
    result.covariance[row][static_cast<std::size_t>(i % start.size())] = fit.covariance(i);
  }
  result.residual_sd = fit.residual_sd;
  result.explained = fit.explained;
  add_residuals(of, fit, places, components, result.residuals);
  const auto angle = gauge_angle<S>(d, y);
  result.gauge_angle_rad = angle[0];  // NaN for a moment
  result.gauge_angle_sd_rad = angle[1];
  PlaneVectors<S> left = y;
  for (Index i = 0; i < fit.residuals.size(); ++i) {
    left(i / components, i % components) = fit.residuals(i);
  }
  const char* const mistake = mistake_in<S>(d, y, &left);
  expects_explained(of, fit, mistake, angle_text(mistake, angle));
  result.cause = cause_in(of, fit, unit_mistake(samples, places, what), mistake);
  return result;
}

}  // namespace detail

/// Tangential force in proportion to the displacement and a power of (measure / reference). The
/// exponent is fitted if it is not given. Uses the samples with a measure > 0, a tangential force
/// and a finite motion. Allocates; O(80 samples).
template <scalar S = double>
ShearFit<S> fit_tangential_force(std::span<const ForceSample<S>> samples,
                                 const std::type_identity_t<S>& reference,
                                 const std::optional<std::type_identity_t<S>>& exponent = {},
                                 const FitOptions& options = {}) {
  using Sample = ForceSample<S>;
  return detail::fit_shear<S>(
      {"fit_tangential_force", {"coefficient 1", "displacement_exponent"}, {}, options},
      detail::Calibrated::tangential_force, samples, reference, exponent,
      [](const Sample& s) {
        return is_finite(s.tangential_force_n) && is_finite(s.displacement_mm) &&
               is_finite(s.rotation_rad);
      },
      [](const Sample& s) { return s.displacement_mm; },
      [](const Sample& s) { return s.tangential_force_n; });
}

/// Moment from rotation, in the same way.
template <scalar S = double>
ShearFit<S> fit_moment(std::span<const ForceSample<S>> samples,
                       const std::type_identity_t<S>& reference,
                       const std::optional<std::type_identity_t<S>>& exponent = {},
                       const FitOptions& options = {}) {
  using Sample = ForceSample<S>;
  return detail::fit_shear<S>(
      {"fit_moment", {"coefficient 1", "rotation_exponent"}, {}, options},
      detail::Calibrated::moment, samples, reference, exponent,
      [](const Sample& s) { return is_finite(s.moment_n_mm) && is_finite(s.rotation_rad); },
      [](const Sample& s) {
        return Point2<S>{s.rotation_rad, S(0)};
      },
      [](const Sample& s) {
        return Point2<S>{s.moment_n_mm, S(0)};
      });
}

/// A linear map of both components with offsets, for axes other than those of the image. Reference
/// and exponent of the normalisation are given; the moment is not fitted.
template <scalar S = double>
LinearShearFit<S> fit_linear_shear(std::span<const ForceSample<S>> samples,
                                   const std::type_identity_t<S>& reference = S(1),
                                   const std::type_identity_t<S>& exponent = S(0),
                                   const FitOptions& options = {}) {
  using std::sqrt;
  const char* const owner = "fit_linear_shear";
  require(owner, {{"reference", reference, positive}, {"exponent", exponent, finite_number}});
  const auto places = detail::usable_samples(samples, [](const ForceSample<S>& s) {
    return is_finite(s.tangential_force_n) && is_finite(s.displacement_mm);
  });
  const Index n = static_cast<Index>(places.size());
  detail::FitMatrix<S> columns = detail::FitMatrix<S>::Constant(n, 3, S(1));
  detail::FitVector<S> x(n), y(n);
  S longest_sq(0);
  for (Index i = 0; i < n; ++i) {
    const ForceSample<S>& s = samples[places[static_cast<std::size_t>(i)]];
    const Point2<S> d = shear_factor(s.measure, reference, exponent) * s.displacement_mm;
    columns.row(i).head(2) << d.x, d.y;
    x(i) = s.tangential_force_n.x;
    y(i) = s.tangential_force_n.y;
    longest_sq = longest_sq < squared_norm(d) ? squared_norm(d) : longest_sq;
  }
  expects(is_finite(longest_sq), owner, "largest displacement", longest_sq, "finite");
  LinearShearFit<S> result;
  result.cause = detail::unit_mistake(samples, places, detail::Calibrated::tangential_force);
  const auto fit_of = [&](const std::vector<std::string>& names, const detail::FitVector<S>& force,
                          std::array<S, 3>& standard_errors) {
    const detail::FitProblem<S> of{owner, names, force, options};
    const auto fit =
        detail::fit_model<S>(of, detail::FitVector<S>::Zero(3), detail::linear_model(columns));
    detail::expects_explained(of, fit);
    detail::add_residuals(of, fit, places, 1, result.residuals);
    for (Index k = 0; k < 3; ++k) {
      standard_errors[static_cast<std::size_t>(k)] = sqrt(fit.covariance(k, k));
    }
    result.cause = detail::cause_in(of, fit, result.cause, nullptr);
    return fit;
  };
  const auto of_x = fit_of({"x_by_x", "x_by_y", "offset_n.x"}, x, result.x_standard_errors);
  const auto of_y = fit_of({"y_by_x", "y_by_y", "offset_n.y"}, y, result.y_standard_errors);
  result.map.reference = reference;
  result.map.force = {{S(1), S(0), S(0), S(0)}, exponent, sqrt(longest_sq)};
  result.map.moment.coefficients[0] = S(0);
  result.map.x_by_x = of_x.parameters(0);
  result.map.x_by_y = of_x.parameters(1);
  result.map.y_by_x = of_y.parameters(0);
  result.map.y_by_y = of_y.parameters(1);
  result.map.offset_n = {of_x.parameters(2), of_y.parameters(2)};
  result.residual_sd_n = {of_x.residual_sd, of_y.residual_sd};
  return result;
}

}  // namespace v0
}  // namespace fingerpad
