// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibration of the forces by look-up (force/look_up.hpp) from contacts measured with a force
// gauge. Least squares by the Gauss-Newton method with a QR factorisation of the Jacobian
// and, optionally, Huber's weights, with the covariance of the parameters and all residuals.
// Samples that do not determine a parameter, or that contradict each other, are refused by name
// (parameter_error). docs/calibrate/calibration.md describes how to take samples. The standard
// errors hold for samples with independent errors in the force. Errors in the measure or the
// displacement bias the fit toward smaller slopes, and samples of one load have common errors:
// leave_one_load_out estimates the error of forces outside the calibration.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
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
  for (std::size_t first = 0; first < samples.size(); ++first) {
    if (done[first]) {
      continue;
    }
    const int load = samples[first].load;
    std::vector<ForceSample<S>> rest;
    std::copy_if(samples.begin(), samples.end(), std::back_inserter(rest),
                 [&](const ForceSample<S>& sample) { return sample.load != load; });
    const auto model = fit(std::span<const ForceSample<S>>(rest));
    ++result.loads;
    for (std::size_t i = first; i < samples.size(); ++i) {
      if (samples[i].load == load) {
        done[i] = true;
        result.errors[i] = error_of(model, samples[i]);
      }
    }
  }
  S sum(0), sum_sq(0);
  for (const S& error : result.errors) {
    if (is_finite(error)) {
      const S size = value(error) < 0 ? -error : error;
      sum = sum + size;
      sum_sq = sum_sq + square(error);
      result.worst = value(size) <= value(result.worst) ? result.worst : size;
      ++result.samples;
    }
  }
  if (result.samples > 0) {
    const S count = S(static_cast<double>(result.samples));
    result.mean_abs = sum / count;
    result.rms = sqrt(sum_sq / count);
  }
  return result;
}

/// What fit_normal_force fits.
struct CurveOptions {
  int degree = 2;            ///< of the polynomial, in [1, 5]
  bool through_zero = true;  ///< no force without contact; the published curves lack this
  bool rising = true;        ///< the force never falls from 0 to the largest measure
  bool displaced = false;    ///< also the compensation for displacement
  bool rotated = false;      ///< also the compensation for rotation
};

/// Says which option has no meaning; "" if all have one.
inline std::string check(const CurveOptions& o) {
  return check("CurveOptions", {{"degree", o.degree, within(1, 5)}});
}

/// Normal force from area, depth or radius.
template <scalar S = double>
struct [[nodiscard]] NormalForceFit {
  const char* cause = cause::not_converged;  ///< likely mistake
  ForceCurve<S> curve = {};                  ///< with its errors, for NormalForce
  S per_mm_sq_sd = S(0);                     ///< standard errors of the compensation
  S per_rad_sq_sd = S(0);
  std::vector<ForceResidual<S>> residuals = {};
  S explained = S(0);  ///< share of the measured variance about the mean

  bool ok() const { return cause == nullptr; }
};

/// One half of a Shear: force from displacement, or moment from rotation.
template <scalar S = double>
struct [[nodiscard]] ShearFit {
  const char* cause = cause::not_converged;  ///< likely mistake
  ShearLaw<S> law = {};
  std::array<std::array<S, 5>, 5> covariance =
      detail::zero_matrix<S, 5>();  ///< of the coefficients and, last, the exponent
  S residual_sd = S(0);             ///< of a component of the force in N, or of the moment in N mm
  std::vector<ForceResidual<S>> residuals = {};  ///< for a force, x and y alternate
  S explained = S(0);
  S gauge_angle_rad = not_a_number<S>();     ///< of the gauge against the image, about the normal,
                                             ///< +x toward +y; NaN for a moment, and if the
                                             ///< displacements lie near one line
  S gauge_angle_sd_rad = not_a_number<S>();  ///< its standard error

  bool ok() const { return cause == nullptr; }
  S coefficient_sd(std::size_t k) const { return sd_of(covariance[k][k]); }
  S exponent_sd() const { return sd_of(covariance[4][4]); }  ///< 0 for a given exponent

 private:
  static S sd_of(const S& variance) {  // the root of 0 has no slope
    using std::sqrt;
    return value(variance) > 0 ? sqrt(variance) : S(0);
  }
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

/// What is fitted: measured values, the names of the parameters for refusals, and the model, which
/// fills values and Jacobian. One type, so that the fit is compiled once for all models.
template <scalar S>
struct FitProblem {
  const char* owner;
  std::vector<std::string> names;
  FitVector<S> measured;
  std::function<void(const FitVector<S>& parameters, FitVector<S>& values, FitMatrix<S>& jacobian)>
      model;
  FitOptions options;
};

template <scalar S>
struct ModelFit {
  FitVector<S> parameters, residuals, weights;  ///< residuals: measured less model
  FitMatrix<S> covariance;
  S residual_sd = S(0), explained = S(0);
  S left_sq = S(0), worst_sq = S(0);  ///< weighted sum of squared residuals, the largest of them
  S robust_sd = S(0);                 ///< of the residuals, from their median magnitude
  bool converged = false;
};

/// Standard deviation of normal residuals from their median magnitude. A third of outliers changes
/// it little.
template <scalar S>
S robust_sd(const FitVector<S>& residuals, Index parameters) {
  using std::sqrt;
  std::vector<S> sizes;
  for (const S& residual : residuals) {
    sizes.push_back(residual < S(0) ? -residual : residual);
  }
  const auto middle = sizes.begin() + static_cast<Index>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  const auto count = static_cast<double>(sizes.size());
  return S(1.4826) * *middle * sqrt(S(count / (count - static_cast<double>(parameters))));
}

/// Of the Jacobian and a column of right sides, with rows times the roots of the weights.
template <scalar S>
Triangle<S> triangle_of(const FitMatrix<S>& jacobian,
                        const FitVector<S>& right,
                        const FitVector<S>& weights) {
  using std::sqrt;
  std::vector<S> rows;
  for (Index i = 0; i < jacobian.rows(); ++i) {
    const S root = sqrt(weights(i));
    for (Index k = 0; k < jacobian.cols(); ++k) {
      rows.push_back(root * jacobian(i, k));
    }
    rows.push_back(root * right(i));
  }
  return {std::move(rows), static_cast<std::size_t>(jacobian.cols() + 1)};
}

/// Residual, share explained, and covariance of a fit.
template <scalar S>
void judge(const FitProblem<S>& of, const FitMatrix<S>& jacobian, ModelFit<S>& fit) {
  using std::sqrt;
  const Index n = of.measured.size(), p = fit.parameters.size();
  const S count = S(static_cast<double>(n)), freedom = S(static_cast<double>(n - p));
  const S mean = fit.weights.dot(of.measured) / fit.weights.sum();
  S all_sq(0), bounded_sq(0), inside(0);
  for (Index i = 0; i < n; ++i) {
    const S w = fit.weights(i), residual_sq = square(fit.residuals(i));
    fit.left_sq += w * residual_sq;
    all_sq += w * square(of.measured(i) - mean);
    bounded_sq += square(w) * residual_sq;  // Huber's psi
    inside += w < S(1) ? S(0) : S(1);
    fit.worst_sq = fit.worst_sq < residual_sq ? residual_sq : fit.worst_sq;
  }
  fit.explained = S(0) < all_sq ? S(1) - fit.left_sq / all_sq : S(0);
  fit.robust_sd = robust_sd(fit.residuals, p);
  S variance = fit.left_sq / freedom;
  fit.residual_sd = of.options.robust ? fit.robust_sd : sqrt(variance);
  if (of.options.robust) {  // Huber 1981, section 7.6
    const S share = (inside < S(1) ? S(1) : inside) / count;
    const S correction = S(1) + (count - freedom) / count * ((S(1) - share) / share);
    variance = square(correction) * (bounded_sq / freedom) / square(share);
  }
  const FitVector<S> ones = FitVector<S>::Constant(n, S(1));
  const std::vector<S> by_unit =
      triangle_of<S>(jacobian, fit.residuals, ones).covariance(static_cast<std::size_t>(p));
  fit.covariance = variance * Eigen::Map<const FitMatrix<S>>(by_unit.data(), p, p);
}

/// Fits from `start`. The first step solves a model that is linear in its parameters. Refuses too
/// few samples, and a parameter of whose column less than `min_independence` is independent of the
/// columns before it.
template <scalar S>
ModelFit<S> fit_model(const FitProblem<S>& of,
                      const FitVector<S>& start,
                      double min_independence = 1e-5) {
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
  FitMatrix<S> jacobian(n, p);
  for (int pass = 0; pass < max_passes && !fit.converged; ++pass) {
    of.model(fit.parameters, values, jacobian);
    fit.residuals = of.measured - values;
    if (of.options.robust && pass > 0) {
      const S limit = S(huber_threshold) * robust_sd(fit.residuals, p);
      for (Index i = 0; i < n; ++i) {
        const S size = fit.residuals(i) < S(0) ? -fit.residuals(i) : fit.residuals(i);
        fit.weights(i) = limit < size ? limit / size : S(1);
      }
    }
    const Triangle<S> r = triangle_of<S>(jacobian, fit.residuals, fit.weights);
    const auto count = static_cast<std::size_t>(p);
    const std::vector<S> move = r.solve(count, count);
    S move_sq = S(0);
    for (std::size_t k = 0; k < count; ++k) {
      const S share = r.independent_share(k);
      const std::string name = "information in the samples on " + of.names[k];
      expects(S(min_independence) < share, of.owner, name.c_str(), share,
              "> 1e-5: they are too few, too alike or tied to each other");
      fit.parameters(static_cast<Index>(k)) += move[k];
      move_sq += square(move[k] * r(k, k) / share);
    }
    const S rounding_sq = square(S(64) * S(epsilon<S>())) * of.measured.squaredNorm();
    fit.converged = pass > 0 && !(rounding_sq < move_sq);
  }
  of.model(fit.parameters, values, jacobian);
  fit.residuals = of.measured - values;
  judge(of, jacobian, fit);
  const S sum = fit.covariance.sum() + fit.parameters.sum() + fit.residual_sd + fit.weights.sum();
  expects(is_finite(sum), of.owner, "parameters and their variances", sum,
          "finite: a force is far too large");
  return fit;
}

/// "; " and the likely cause, for refusals; for a rotated gauge with its angle and standard error.
template <scalar S>
std::string cause_of(const char* mistake, const std::array<S, 2>& angle) {
  const auto degrees = [](const S& rad) {
    return std::to_string(std::lround(57.29577951308232 * static_cast<double>(value(rad))));
  };
  const std::string likely = mistake == nullptr ? std::string() : std::string("; ") + mistake;
  return mistake != cause::gauge_rotated ? likely
         : is_finite(angle[1])           ? likely + " (rotated by " + degrees(angle[0]) + " +- " +
                                     degrees(angle[1]) + " degrees)"
                               : likely + " (displace in several directions to obtain the angle)";
}

/// Refuses a model that does not explain the samples.
template <scalar S>
void expects_explained(const FitProblem<S>& of,
                       const ModelFit<S>& fit,
                       const std::string& likely_cause = "") {
  const bool agrees = !(fit.explained < S(of.options.min_explained)) && S(0) < fit.explained;
  expects(agrees, of.owner, "share of the measured variance that is explained", fit.explained,
          (">= min_explained: the samples are constant or contradict each other" + likely_cause)
              .c_str());
}

/// The likely mistake; nullptr: none. Causes of wrong parameters come before causes of inexact
/// ones. An outlier is a sample more than ten standard deviations off that makes up most of the
/// residual.
template <scalar S>
const char* cause_in(const ModelFit<S>& fit,
                     const char* units,
                     const char* mistake,
                     const FitOptions& options) {
  if (units != nullptr || mistake != nullptr) {
    return units != nullptr ? units : mistake;
  }
  const bool is_most = fit.left_sq < S(2) * fit.worst_sq;
  const bool is_off = S(100) * square(fit.robust_sd) < fit.worst_sq && S(0) < fit.robust_sd;
  return !fit.converged ? cause::not_converged
         : !options.robust && is_most && is_off
             ? "a sample is far from the others: check its dots and its gauge reading, "
               "or fit robustly"
             : nullptr;
}

/// The samples that a fit can use, and their indices among the given ones.
template <scalar S>
struct UsableSamples {
  std::vector<ForceSample<S>> samples;
  std::vector<std::size_t> places;

  template <class Usable>
  UsableSamples(std::span<const ForceSample<S>> given, const Usable& usable) {
    for (std::size_t i = 0; i < given.size(); ++i) {
      if (is_finite(given[i].measure) && value(given[i].measure) > 0 && usable(given[i])) {
        samples.push_back(given[i]);
        places.push_back(i);
      }
    }
  }
};

template <scalar S>
void add_residuals(const FitVector<S>& measured,
                   const ModelFit<S>& fit,
                   const std::vector<std::size_t>& places,
                   std::vector<ForceResidual<S>>& residuals) {
  for (Index i = 0; i < measured.size(); ++i) {
    residuals.push_back({places[static_cast<std::size_t>(i)], measured(i),
                         measured(i) - fit.residuals(i), fit.weights(i)});
  }
}

/// Quantities whose units are checked.
struct UnitsLookedAt {
  bool normal = false, tangential = false, displacement = false, rotation = false, moment = false;
};

/// Detects a quantity in a wrong unit. The bounds hold for every fingertip. A contact of 0.05 mm or
/// 0.05 mm^2 is not visible, and none is larger than 10000 mm^2 or displaced by 100 mm. A
/// calibration exceeds 0.05 N of normal and 0.01 N of tangential force, and 300 N are more than the
/// force of 0.2 MPa on a pad of 40 mm. A moment has a lever between 0.05 and 100 mm.
template <scalar S>
const char* unit_mistake(const std::vector<ForceSample<S>>& samples, const UnitsLookedAt& at) {
  double measure = 0, displacement = 0, rotation = 0, force = 0, aside = 0, moment = 0;
  const auto raise = [](double& largest, const S& x) {
    const double size = std::abs(static_cast<double>(value(x)));
    largest = size > largest && is_finite(size) ? size : largest;
  };
  for (const ForceSample<S>& s : samples) {
    raise(measure, s.measure);
    raise(displacement, s.displacement_mm.x);
    raise(displacement, s.displacement_mm.y);
    raise(rotation, s.rotation_rad);
    raise(force, s.normal_force_n);
    raise(aside, s.tangential_force_n.x);
    raise(aside, s.tangential_force_n.y);
    raise(moment, s.moment_n_mm);
  }
  const bool lever = moment >= 0.05 * force && (moment <= 100 * force || force <= 0);
  struct Line {
    bool wrong;
    const char* text;
  };
  for (const Line& line :
       {Line{measure < 0.05 || measure > 1e4,
             "no measure reaches 0.05, or one exceeds 10000: give areas in mm^2, depths and radii "
             "in mm"},
        Line{(at.normal && (force < 0.05 || force > 300)) ||
                 (at.tangential && (aside < 0.01 || aside > 300)),
             "no force reaches 0.05 (along the pad 0.01), or one exceeds 300: give forces in N"},
        Line{at.displacement && (displacement < 0.01 || displacement > 100),
             "no displacement reaches 0.01, or one exceeds 100: give displacements in mm"},
        Line{at.rotation && rotation > 1.6,
             "a rotation exceeds a right angle: give rotations in rad"},
        Line{at.moment && !lever,
             "moments are below 0.05 mm or above 100 mm times the normal force: "
             "give moments in N mm"}}) {
    if (line.wrong) {
      return line.text;
    }
  }
  return nullptr;
}

/// Whether a constant that explains `by_constant` of a sum of squared residuals, and has the square
/// `constant_sq`, shows that the gauge was not tared: it explains more than half, and exceeds a
/// tenth of the largest force.
template <scalar S>
bool is_offset(const S& by_constant, const S& left_sq, const S& constant_sq, const S& largest_sq) {
  return left_sq < S(2) * by_constant && largest_sq < S(100) * constant_sq;
}

/// Coefficient of t^i in G_k, the sum over j >= k of the Bernstein polynomials B_j(t) of degree n.
/// The G_k are well conditioned over [0, 1], only G_0 = 1 is not 0 at 0, and a polynomial whose
/// coefficients from G_1 on are not negative never falls (for degree 2 also the reverse).
constexpr int rising_term(int n, int k, int i) {
  const auto choose = [](int of, int some) {
    int product = 1;
    for (int j = 1; j <= some; ++j) {
      product = product * (of - some + j) / j;
    }
    return product;
  };
  return k == 0  ? (i == 0 ? 1 : 0)
         : i < k ? 0
                 : ((i - k) % 2 == 0 ? 1 : -1) * choose(n, i) * choose(i - 1, k - 1);
}

/// The model P (1 + a x + b y ...) with P a combination of `columns` and x, y, ... in `moves`.
template <scalar S>
auto product_model(const FitMatrix<S>& columns, const FitMatrix<S>& moves) {
  return [=](const FitVector<S>& p, FitVector<S>& values, FitMatrix<S>& jacobian) {
    const Index m = columns.cols();
    for (Index i = 0; i < values.size(); ++i) {
      S plain(0), factor(1);
      for (Index k = 0; k < m; ++k) {
        plain += p(k) * columns(i, k);
      }
      for (Index k = 0; k < moves.cols(); ++k) {
        factor += p(m + k) * moves(i, k);
        jacobian(i, m + k) = plain * moves(i, k);
      }
      values(i) = plain * factor;
      for (Index k = 0; k < m; ++k) {
        jacobian(i, k) = columns(i, k) * factor;
      }
    }
  };
}

/// Polynomials of the measure, as combinations of some of the G_k(measure / to), times the factor
/// of displacement and rotation.
template <scalar S>
struct CurveFitter {
  FitVector<S> forces;
  FitMatrix<S> terms;  ///< coefficients of t^0, t^1, ... in each G_k
  FitMatrix<S> basis;  ///< G_0, G_1, ... of each sample
  FitMatrix<S> moves;  ///< |d|^2, theta^2 of each sample
  FitOptions options;
  std::vector<std::string> move_names = {};

  CurveFitter(const std::vector<ForceSample<S>>& samples,
              const S& to,
              const CurveOptions& curve,
              const FitOptions& fit_options)
      : options(fit_options) {
    const Index n = static_cast<Index>(samples.size());
    const int size = curve.degree + 1;
    forces.resize(n);
    terms.resize(size, size);
    for (int k = 0; k < size * size; ++k) {
      terms(k % size, k / size) = S(rising_term(curve.degree, k / size, k % size));
    }
    FitMatrix<S> powers = FitMatrix<S>::Constant(n, size, S(1));
    moves.resize(n, (curve.displaced ? 1 : 0) + (curve.rotated ? 1 : 0));
    for (Index i = 0; i < n; ++i) {
      const ForceSample<S>& s = samples[static_cast<std::size_t>(i)];
      forces(i) = s.normal_force_n;
      for (int k = 1; k < size; ++k) {
        powers(i, k) = powers(i, k - 1) * (s.measure / to);
      }
      if (curve.displaced) {
        moves(i, 0) = squared_norm(s.displacement_mm);
      }
      if (curve.rotated) {
        moves(i, moves.cols() - 1) = square(s.rotation_rad);
      }
    }
    basis = powers.lazyProduct(terms);
    if (curve.displaced) {
      move_names.emplace_back("per_mm_sq");
    }
    if (curve.rotated) {
      move_names.emplace_back("per_rad_sq");
    }
  }

  FitProblem<S> problem(const std::vector<int>& columns, bool moved) const {
    std::vector<std::string> names;
    for (const int k : columns) {
      names.push_back(k == 0 ? "the constant" : "measure^" + std::to_string(k));
    }
    names.insert(names.end(), move_names.begin(), move_names.end());
    const FitMatrix<S> with = moved ? moves : FitMatrix<S>(forces.size(), 0);
    return {"fit_normal_force", names, forces, product_model<S>(basis(Eigen::all, columns), with),
            options};
  }

  /// First without the factor, then with it.
  ModelFit<S> operator()(const std::vector<int>& columns) const {
    const Index m = static_cast<Index>(columns.size());
    FitVector<S> start = FitVector<S>::Zero(m);
    const ModelFit<S> plain = fit_model(problem(columns, false), start);
    start = FitVector<S>::Zero(m + moves.cols());
    start.head(m) = plain.parameters;
    return moves.cols() == 0 ? plain : fit_model(problem(columns, true), start);
  }

  /// Whether a constant explains most of the residual of a curve through 0.
  bool has_offset(std::vector<int> columns, const ModelFit<S>& through_zero) const {
    columns.insert(columns.begin(), 0);
    if (forces.size() < static_cast<Index>(columns.size()) + 3) {
      return false;
    }
    FitVector<S> start(through_zero.parameters.size() + 1);
    start << S(0), through_zero.parameters;
    const ModelFit<S> fit =
        fit_model(problem(columns, true), start, static_cast<double>(epsilon<S>()));
    return is_offset(S(through_zero.left_sq - fit.left_sq), through_zero.left_sq,
                     square(fit.parameters(0)), S(forces.cwiseAbs2().maxCoeff()));
  }
};

/// The column, beyond the constant, with the most negative coefficient; columns.size(): none, the
/// curve never falls.
template <scalar S>
std::size_t falling(const ModelFit<S>& fit, const std::vector<int>& columns) {
  std::size_t worst = columns.size();
  S least(0);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const S coefficient = fit.parameters(static_cast<Index>(c));
    if (columns[c] > 0 && coefficient < least) {
      least = coefficient;
      worst = c;
    }
  }
  return worst;
}

}  // namespace detail

/// Normal force from area, depth or radius: least-squares fit of P(measure) (1 + a |d|^2 +
/// b theta^2) with a polynomial P. Uses the samples with a measure > 0 and a normal force.
/// Allocates; O(passes samples degree^2).
template <scalar S = double>
NormalForceFit<S> fit_normal_force(std::span<const ForceSample<S>> samples,
                                   const CurveOptions& curve = {},
                                   const FitOptions& options = {}) {
  const char* const owner = "fit_normal_force";
  require(curve);
  const bool moved = curve.displaced || curve.rotated;
  const detail::UsableSamples<S> usable(samples, [&](const ForceSample<S>& s) {
    return is_finite(s.normal_force_n) &&
           (!moved || (is_finite(s.displacement_mm) && is_finite(s.rotation_rad)));
  });
  expects(!usable.samples.empty(), owner, "usable samples", 0LL,
          "> 0: with a measure > 0 and a finite normal force");
  NormalForceFit<S> result;
  result.curve.from = result.curve.to = usable.samples.front().measure;
  for (const ForceSample<S>& s : usable.samples) {
    result.curve.from = s.measure < result.curve.from ? s.measure : result.curve.from;
    result.curve.to = result.curve.to < s.measure ? s.measure : result.curve.to;
  }
  expects(result.curve.from < result.curve.to, owner, "largest measure", result.curve.to,
          "> the smallest");
  const detail::CurveFitter<S> fitter(usable.samples, result.curve.to, curve, options);
  std::vector<int> columns;
  for (int k = curve.through_zero ? 1 : 0; k <= curve.degree; ++k) {
    columns.push_back(k);
  }
  detail::ModelFit<S> fit = fitter(columns);
  const char* mistake = nullptr;
  if (curve.rising && detail::falling(fit, columns) < columns.size()) {
    // without the columns that fall
    for (std::size_t c = 0; (c = detail::falling(fit, columns)) < columns.size();) {
      columns.erase(columns.begin() + static_cast<std::ptrdiff_t>(c));
      const bool rises = !columns.empty() && columns.back() > 0;
      fit = rises ? fitter(columns) : detail::ModelFit<S>();
      expects(rises && !(fit.explained < S(options.min_explained)), owner,
              "share of the measured variance that a rising force explains", fit.explained,
              ">= min_explained: the force falls while the contact grows, or is not that of these "
              "contacts");
    }
  } else {
    mistake =
        curve.through_zero && fitter.has_offset(columns, fit) ? cause::gauge_not_tared : nullptr;
    detail::expects_explained(fitter.problem(columns, moved), fit,
                              detail::cause_of<S>(mistake, {}));
  }
  const Index m = static_cast<Index>(columns.size());
  detail::FitMatrix<S> powers = fitter.terms(Eigen::all, columns);  // of measure / to
  S scale(1);
  for (Index i = 0; i < powers.rows(); ++i) {
    powers.row(i) /= scale;
    scale = scale * result.curve.to;
  }
  const detail::FitVector<S> coefficients = powers.lazyProduct(fit.parameters.head(m));
  const detail::FitMatrix<S> half = powers.lazyProduct(fit.covariance.topLeftCorner(m, m));
  for (Index i = 0; i < powers.rows(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    result.curve.coefficients[row] = coefficients(i);
    for (Index j = 0; j < powers.rows(); ++j) {
      result.curve.covariance[row][static_cast<std::size_t>(j)] = half.row(i).dot(powers.row(j));
    }
  }
  using std::sqrt;
  if (curve.displaced) {
    result.curve.per_mm_sq = fit.parameters(m);
    result.per_mm_sq_sd = sqrt(fit.covariance(m, m));
  }
  if (curve.rotated) {
    const Index last = fit.parameters.size() - 1;
    result.curve.per_rad_sq = fit.parameters(last);
    result.per_rad_sq_sd = sqrt(fit.covariance(last, last));
  }
  result.curve.residual_sd_n = fit.residual_sd;
  detail::add_residuals(fitter.forces, fit, usable.places, result.residuals);
  result.explained = fit.explained;
  const char* const units = detail::unit_mistake(
      usable.samples, {.normal = true, .displacement = curve.displaced, .rotation = curve.rotated});
  result.cause = detail::cause_in(fit, units, mistake, options);
  return result;
}

namespace detail {

/// A displacement and the force that it should cause; of a rotation and a moment the second
/// component does not count.
template <scalar S>
struct ShearPair {
  S log_measure;  ///< log(measure / reference)
  Point2<S> moved;
  Point2<S> caused;
  std::size_t sample;

  S length() const {
    using std::sqrt;
    const S length_sq = squared_norm(moved);
    return value(length_sq) > 0 ? sqrt(length_sq) : S(0);
  }
};

/// y = sum over k of c_k (u |x|)^(k-1) u x, u = (measure / reference)^T, for each component of each
/// sample. Parameters c_1, ... and, last, the exponent T unless it is given.
template <scalar S>
auto shear_model(const std::vector<ShearPair<S>>& pairs,
                 Index components,
                 Index degree,
                 const std::optional<S>& given) {
  return [=](const FitVector<S>& p, FitVector<S>& values, FitMatrix<S>& jacobian) {
    using std::exp;
    const S exponent = given ? *given : p(degree);
    for (Index i = 0; i < values.size(); ++i) {
      const ShearPair<S>& pair = pairs[static_cast<std::size_t>(i / components)];
      const S u = exp(exponent * pair.log_measure), further = u * pair.length();
      S term = u * (i % components == 0 ? pair.moved.x : pair.moved.y), by_log(0);
      values(i) = S(0);
      for (Index k = 0; k < degree; ++k) {
        jacobian(i, k) = term;
        values(i) += p(k) * term;
        by_log += S(static_cast<int>(k) + 1) * p(k) * term;
        term = term * further;
      }
      if (!given) {
        jacobian(i, degree) = by_log * pair.log_measure;
      }
    }
  };
}

/// A search for the exponent from -2 to 6, then a fit of all parameters together.
template <scalar S>
ModelFit<S> fit_with_exponent(const FitProblem<S>& of, Index degree, bool given) {
  const Index n = of.measured.size();
  FitVector<S> start = FitVector<S>::Zero(degree + (given ? 0 : 1)), values(n);
  FitMatrix<S> jacobian(n, start.size());
  S least = not_a_number<S>();
  for (int k = 0; !given && n > start.size() && k <= 80; ++k) {
    FitVector<S> at = FitVector<S>::Zero(degree + 1);
    at(degree) = S(-2) + S(k) / S(10);
    of.model(at, values, jacobian);
    const FitMatrix<S> a = jacobian.leftCols(degree);
    const auto count = static_cast<std::size_t>(degree);
    const std::vector<S> best =
        triangle_of<S>(a, of.measured, FitVector<S>::Constant(n, S(1))).solve(count, count);
    std::copy(best.begin(), best.end(), at.begin());
    const FitVector<S> left = of.measured - a.lazyProduct(at.head(degree));
    const S size = of.options.robust ? left.cwiseAbs().sum() : left.squaredNorm();
    if (is_finite(size) && !(value(size) >= value(least))) {
      least = size;
      start = at;
    }
  }
  const ModelFit<S> fit = fit_model(of, start);
  if (!given) {
    const S exponent = fit.parameters(degree);
    expects(S(-2) <= exponent && exponent <= S(6), of.owner, of.names.back().c_str(), exponent,
            "in [-2, 6]: the samples do not determine it");
  }
  return fit;
}

/// A force, the normalised displacement that should cause it, and the residual of the force.
template <scalar S>
struct PlaneForce {
  Point2<S> d, force, left;
};
template <scalar S>
std::vector<PlaneForce<S>> plane_forces(const std::vector<ShearPair<S>>& pairs,
                                        const S& exponent,
                                        Index components,
                                        const FitVector<S>& left) {
  using std::exp;
  std::vector<PlaneForce<S>> forces;
  for (const ShearPair<S>& pair : pairs) {
    const Index at = static_cast<Index>(forces.size()) * components;
    forces.push_back({exp(exponent * pair.log_measure) * pair.moved,
                      pair.caused,
                      {left(at), components > 1 ? left(at + 1) : S(0)}});
  }
  return forces;
}

/// Sums over all samples that relate the directions of forces and displacements.
template <scalar S>
struct ForceDirections {
  S dd = S(0), ff = S(0), along = S(0), across = S(0), mirrored_x = S(0), mirrored_y = S(0);

  explicit ForceDirections(const std::vector<PlaneForce<S>>& samples) {
    for (const auto& [d, f, left] : samples) {
      dd = dd + squared_norm(d);
      ff = ff + squared_norm(f);
      along = along + dot(d, f);
      across = across + d.x * f.y - d.y * f.x;
      mirrored_x = mirrored_x + d.x * f.x - d.y * f.y;
      mirrored_y = mirrored_y + d.x * f.y + d.y * f.x;
    }
  }
  /// Whether a rotation, or a reflection, with a scale explains more than half of the forces.
  bool rotated() const { return ff < S(2) * (square(along) + square(across)) / dd; }
  bool mirrored() const { return ff < S(2) * (square(mirrored_x) + square(mirrored_y)) / dd; }
};

/// The rotation from the least-squares linear map A of normalised displacements to forces. The
/// stiffness of an elastic pad is symmetric (Betti), so an antisymmetric part of A is a rotation.
/// Displacements along one line do not distinguish it from an anisotropic pad, and near one line
/// the nonlinearity of the pad outweighs it. There is no angle if the determinant of sum d d^T is
/// below a fifth of that for displacements even in all directions. Returns the angle of the gauge
/// against the image and its standard error, for samples with independent errors.
template <scalar S>
std::array<S, 2> gauge_angle(const std::vector<PlaneForce<S>>& samples) {
  using std::atan2;
  using std::sqrt;
  S xx(0), xy(0), yy(0);                             // of d d^T
  Point2<S> f_x = {S(0), S(0)}, f_y = {S(0), S(0)};  // sums of x f and y f
  for (const auto& [d, force, left] : samples) {
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
    f_x += d.x * force;
    f_y += d.y * force;
  }
  const S determinant = xx * yy - xy * xy, trace = xx + yy;
  constexpr int min_samples = 3;
  if (samples.size() < min_samples || !(square(trace) < S(20) * determinant)) {
    return {not_a_number<S>(), not_a_number<S>()};
  }
  const Point2<S> by_x = S(1) / determinant * (yy * f_x - xy * f_y);  // columns of A
  const Point2<S> by_y = S(1) / determinant * (xx * f_y - xy * f_x);
  const S along = by_x.x + by_y.y, across = by_x.y - by_y.x;
  S left_sq(0);
  for (const auto& [d, force, left] : samples) {
    left_sq += squared_norm(force - d.x * by_x - d.y * by_y);
  }
  const S variance = left_sq / S(2.0 * static_cast<double>(samples.size()) - 4);
  return {atan2(across, along),
          sqrt(variance * trace / determinant / (square(along) + square(across)))};
}

/// Detects axes with which no fit can succeed: mirrored, or rotated by more than 45 degrees.
template <scalar S>
const char* wrong_axes(const std::vector<PlaneForce<S>>& samples) {
  const ForceDirections<S> sums(samples);
  return sums.mirrored() && !sums.rotated()
             ? "the forces mirror the displacements: check whether x and y are exchanged or "
               "one is reversed"
         : sums.rotated() && square(sums.along) < square(sums.across) ? cause::gauge_rotated
                                                                      : nullptr;
}

/// The likely mistake behind the residual of a fit; nullptr: none detected. A rotation counts as
/// one if it explains more than half of it and exceeds a tenth of the force along the displacement.
template <scalar S>
const char* mistake_in(const std::vector<PlaneForce<S>>& samples) {
  const ForceDirections<S> sums(samples);
  if (sums.along < S(0) && sums.rotated()) {
    return "the forces point against the displacements: check the sign of each axis";
  }
  S left_sq(0), largest_sq(0);
  Point2<S> sum = {S(0), S(0)};
  for (const auto& [d, force, left] : samples) {
    sum += left;
    left_sq += squared_norm(left);
    largest_sq = largest_sq < squared_norm(force) ? squared_norm(force) : largest_sq;
  }
  const S count = S(static_cast<double>(samples.size())), by_constant = squared_norm(sum) / count;
  if (is_offset(by_constant, left_sq, by_constant / count, largest_sq)) {
    return cause::gauge_not_tared;
  }
  const bool explains = left_sq < S(2) * square(sums.across) / sums.dd;
  const bool matters = square(sums.along) < S(100) * square(sums.across);
  return explains && matters ? cause::gauge_rotated : nullptr;
}

/// Checks, fit and result, common to force and moment. `pair(sample)` is what moved and what it
/// caused.
template <scalar S, class Usable, class Pair>
ShearFit<S> fit_shear(const char* owner,
                      const char* exponent_name,
                      Index components,
                      std::span<const ForceSample<S>> given,
                      const S& reference,
                      const std::optional<S>& exponent,
                      const FitOptions& options,
                      int degree,
                      const Usable& is_usable,
                      const Pair& pair_of) {
  using std::exp;
  using std::log;
  const bool is_moment = components == 1;
  require(owner, {{"reference", reference, positive},
                  {"degree", degree, within(1, 4)},
                  {exponent_name, exponent.value_or(S(0)), finite_number}});
  const UsableSamples<S> usable(given, is_usable);
  FitProblem<S> of{owner, {}, {}, {}, options};
  of.measured.resize(static_cast<Index>(usable.samples.size()) * components);
  std::vector<ShearPair<S>> pairs;
  std::vector<std::size_t> places;  // of each equation
  for (const ForceSample<S>& s : usable.samples) {
    const auto [moved, caused] = pair_of(s);
    const std::size_t place = usable.places[pairs.size()];
    pairs.push_back({log(s.measure / reference), moved, caused, place});
    for (Index k = 0; k < components; ++k) {
      of.measured(static_cast<Index>(places.size())) = k == 0 ? caused.x : caused.y;
      places.push_back(place);
    }
  }
  of.model = shear_model<S>(pairs, components, degree, exponent);
  for (int k = 1; k <= degree; ++k) {
    of.names.push_back("coefficient " + std::to_string(k));
  }
  of.names.emplace_back(exponent_name);
  const auto forces = plane_forces(pairs, exponent.value_or(S(0)), components, of.measured);
  const char* const axes = wrong_axes(forces);
  expects(axes == nullptr, owner, "usable samples", static_cast<long long>(pairs.size()),
          ("such that the forces follow the displacements" + cause_of(axes, gauge_angle(forces)))
              .c_str());
  const ModelFit<S> fit = fit_with_exponent<S>(of, degree, exponent.has_value());
  ShearFit<S> result;
  result.law.exponent = exponent ? *exponent : fit.parameters(degree);
  result.law.to = S(0);
  for (const ShearPair<S>& pair : pairs) {
    const S length = exp(result.law.exponent * pair.log_measure) * pair.length();
    result.law.to = result.law.to < length ? length : result.law.to;
  }
  expects(is_finite(result.law.to), owner, "largest displacement or rotation", result.law.to,
          "finite");
  const auto place = [&](Index k) { return static_cast<std::size_t>(k < degree ? k : 4); };
  for (Index i = 0; i < fit.parameters.size(); ++i) {
    if (i < degree) {
      result.law.coefficients[place(i)] = fit.parameters(i);
    }
    for (Index j = 0; j < fit.parameters.size(); ++j) {
      result.covariance[place(i)][place(j)] = fit.covariance(i, j);
    }
  }
  result.residual_sd = fit.residual_sd;
  add_residuals(of.measured, fit, places, result.residuals);
  result.explained = fit.explained;
  const auto left = plane_forces(pairs, result.law.exponent, components, fit.residuals);
  const auto angle = gauge_angle(left);
  result.gauge_angle_rad = angle[0];  // NaN for a moment
  result.gauge_angle_sd_rad = angle[1];
  const char* const mistake = mistake_in(left);
  expects_explained(of, fit, cause_of(mistake, angle));
  const char* const units = unit_mistake(usable.samples, {.tangential = !is_moment,
                                                          .displacement = !is_moment,
                                                          .rotation = is_moment,
                                                          .moment = is_moment});
  result.cause = cause_in(fit, units, mistake, options);
  return result;
}

}  // namespace detail

/// Tangential force from displacement, normalised by a power of (measure / reference). The exponent
/// is fitted if it is not given. Uses the samples with a measure > 0, a tangential force and a
/// finite motion. Allocates; O(80 samples degree^2).
template <scalar S = double>
ShearFit<S> fit_tangential_force(std::span<const ForceSample<S>> samples,
                                 const std::type_identity_t<S>& reference,
                                 const std::optional<std::type_identity_t<S>>& exponent = {},
                                 const FitOptions& options = {},
                                 int degree = 1) {
  return detail::fit_shear<S>(
      "fit_tangential_force", "displacement_exponent", 2, samples, reference, exponent, options,
      degree,
      [](const ForceSample<S>& s) {
        return is_finite(s.tangential_force_n) && is_finite(s.displacement_mm) &&
               is_finite(s.rotation_rad);
      },
      [](const ForceSample<S>& s) { return std::pair(s.displacement_mm, s.tangential_force_n); });
}

/// Moment from rotation, in the same way.
template <scalar S = double>
ShearFit<S> fit_moment(std::span<const ForceSample<S>> samples,
                       const std::type_identity_t<S>& reference,
                       const std::optional<std::type_identity_t<S>>& exponent = {},
                       const FitOptions& options = {},
                       int degree = 1) {
  return detail::fit_shear<S>(
      "fit_moment", "rotation_exponent", 1, samples, reference, exponent, options, degree,
      [](const ForceSample<S>& s) { return is_finite(s.moment_n_mm) && is_finite(s.rotation_rad); },
      [](const ForceSample<S>& s) {
        return std::pair(Point2<S>{s.rotation_rad, S(0)}, Point2<S>{s.moment_n_mm, S(0)});
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
  const detail::UsableSamples<S> usable(samples, [](const ForceSample<S>& s) {
    return is_finite(s.tangential_force_n) && is_finite(s.displacement_mm);
  });
  const Index n = static_cast<Index>(usable.samples.size());
  detail::FitMatrix<S> columns(n, 3);
  detail::FitVector<S> x(n), y(n);
  S longest_sq(0);
  for (Index i = 0; i < n; ++i) {
    const ForceSample<S>& s = usable.samples[static_cast<std::size_t>(i)];
    const Point2<S> d = shear_factor(s.measure, reference, exponent) * s.displacement_mm;
    columns.row(i) << d.x, d.y, S(1);
    x(i) = s.tangential_force_n.x;
    y(i) = s.tangential_force_n.y;
    longest_sq = longest_sq < squared_norm(d) ? squared_norm(d) : longest_sq;
  }
  expects(is_finite(longest_sq), owner, "largest displacement", longest_sq, "finite");
  LinearShearFit<S> result;
  result.cause = nullptr;
  const char* const units =
      detail::unit_mistake(usable.samples, {.tangential = true, .displacement = true});
  const auto fit_of = [&](const std::vector<std::string>& names, const detail::FitVector<S>& force,
                          std::array<S, 3>& standard_errors) {
    const detail::FitProblem<S> of{owner, names, force,
                                   detail::product_model<S>(columns, detail::FitMatrix<S>(n, 0)),
                                   options};
    const detail::ModelFit<S> fit = detail::fit_model<S>(of, detail::FitVector<S>::Zero(3));
    detail::expects_explained(of, fit);
    detail::add_residuals(force, fit, usable.places, result.residuals);
    for (Index k = 0; k < 3; ++k) {
      standard_errors[static_cast<std::size_t>(k)] = sqrt(fit.covariance(k, k));
    }
    const char* const found = detail::cause_in(fit, units, nullptr, options);
    result.cause = result.cause == nullptr ? found : result.cause;
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
