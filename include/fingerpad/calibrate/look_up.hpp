// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Calibration of the forces by look-up (force/look_up.hpp) from contacts measured with a force
// gauge: least squares, with the covariance of the parameters. Samples that do not determine a
// parameter are refused by name (parameter_error); those that contradict each other or the model
// give a fit with a cause. docs/calibrate/calibration.md describes how to take samples. The
// standard errors hold for samples with independent errors in the force. Errors in the measure or
// the displacement bias the fit toward smaller slopes, and samples of one load have common errors:
// leave_one_load_out estimates the error of forces outside the calibration.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <optional>
#include <set>
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
inline namespace v1 {

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

/// Sizes of the errors of predictions for samples left out of the calibration.
template <scalar S = double>
struct CrossValidation {
  S mean_abs = not_a_number<S>();  ///< NaN: no prediction
  S worst = not_a_number<S>();     ///< the largest
};

/// Leaves out one load after the other, calibrates with the rest, and predicts the samples left
/// out: model = fit(span of samples); error = error_of(model, sample), NaN: none. O(loads) fits;
/// allocates. Refuses what the fit refuses.
template <scalar S, class Fit, class ErrorOf>
CrossValidation<S> leave_one_load_out(std::span<const ForceSample<S>> samples,
                                      const Fit& fit,
                                      const ErrorOf& error_of) {
  std::set<int> loads;
  for (const ForceSample<S>& s : samples) {
    loads.insert(s.load);
  }
  CrossValidation<S> result;
  S sum(0), predicted(0);
  for (const int load : loads) {
    std::vector<ForceSample<S>> rest;
    std::copy_if(samples.begin(), samples.end(), std::back_inserter(rest),
                 [load](const ForceSample<S>& s) { return s.load != load; });
    const auto model = fit(std::span<const ForceSample<S>>(rest));
    for (const ForceSample<S>& s : samples) {
      const S error = s.load == load ? error_of(model, s) : not_a_number<S>();
      const S size = value(error) < 0 ? -error : error;
      if (is_finite(size)) {
        sum = sum + size;
        predicted = predicted + S(1);
        result.worst = value(size) <= value(result.worst) ? result.worst : size;
      }
    }
  }
  result.mean_abs = sum / predicted;
  return result;
}

/// Normal force from area, depth or radius.
template <scalar S = double>
struct [[nodiscard]] NormalForceFit {
  const char* cause = cause::not_converged;  ///< likely mistake
  ForceCurve<S> curve = {};                  ///< with its errors, for NormalForce
  S explained = S(0);                        ///< share of the measured variance about the mean

  bool ok() const { return cause == nullptr; }
};

/// One half of a Shear: force from displacement, or moment from rotation.
template <scalar S = double>
struct [[nodiscard]] ShearFit {
  const char* cause = cause::not_converged;  ///< likely mistake
  ShearLaw<S> law = {};
  detail::SmallMatrix<S, 2> covariance =
      detail::zero_matrix<S, 2>();  ///< of the slope and the exponent; 0 for a given exponent
  S residual_sd = S(0);             ///< of a component of the force in N, or of the moment in N mm
  S explained = S(0);
  S gauge_angle_rad = not_a_number<S>();     ///< of the gauge against the image, about the normal,
                                             ///< +x toward +y; NaN for a moment, and if the
                                             ///< displacements lie near one line
  S gauge_angle_sd_rad = not_a_number<S>();  ///< its standard error

  bool ok() const { return cause == nullptr; }
};

namespace detail {

template <scalar S>
using FitVector = Eigen::Matrix<S, Eigen::Dynamic, 1>;
template <scalar S>
using FitMatrix = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
template <scalar S>
using PlaneVectors = Eigen::Matrix<S, Eigen::Dynamic, 2>;  ///< one each row

template <scalar S>
struct LinearFit {
  FitVector<S> parameters, residuals;  ///< residuals: measured less model
  FitMatrix<S> covariance;
  S residual_sd = S(0), explained = S(0);
  S left_sq = S(0);                       ///< sum of squared residuals
  S constant = S(0), by_constant = S(0);  ///< one more parameter, and how much of left_sq it takes
  bool outlier = false;                   ///< a sample is ten sd off and most of left_sq
};

/// Least squares of `measured` = columns * parameters. Refuses too few samples, and a parameter
/// whose column follows from those before it, by its name.
template <scalar S>
LinearFit<S> fit_linear(const char* owner,
                        const std::vector<std::string>& names,
                        const FitVector<S>& measured,
                        const FitMatrix<S>& columns) {
  using std::sqrt;
  const Index n = measured.size(), p = columns.cols();
  expects(n > p, owner, "usable samples", static_cast<long long>(n),
          ("> " + std::to_string(p) + ", the number of parameters").c_str());
  const FitVector<S> scale = columns.colwise().norm().cwiseInverse();  // units do not matter
  const FitMatrix<S> a = columns * scale.asDiagonal();
  const Eigen::LLT<FitMatrix<S>> factor(a.transpose() * a);
  for (Index k = 0; k < p; ++k) {  // the share of a column that those before it do not give
    const S share_sq = S(1) - factor.matrixLLT().row(k).head(k).squaredNorm();
    const std::string name = "information in the samples on " + names[static_cast<std::size_t>(k)];
    expects(is_finite(scale(k)) && S(1e-10) + S(64) * S(epsilon<S>()) < share_sq, owner,
            name.c_str(), share_sq, "> 1e-10: they are too few, too alike or tied to each other");
  }
  LinearFit<S> fit;
  fit.parameters = FitVector<S>::Zero(p);
  fit.residuals = measured;
  for (int pass = 0; pass < 3; ++pass) {  // the later ones take away roundoff
    fit.parameters += scale.asDiagonal() * factor.solve(a.transpose() * fit.residuals);
    fit.residuals = measured - columns * fit.parameters;
  }
  const S all_sq = (measured.array() - measured.mean()).matrix().squaredNorm();
  fit.left_sq = fit.residuals.squaredNorm();
  fit.explained = S(0) < all_sq ? S(1) - fit.left_sq / all_sq : S(0);
  FitVector<S> sizes = fit.residuals.cwiseAbs();
  std::nth_element(sizes.data(), sizes.data() + n / 2, sizes.data() + n);
  const S freedom = S(static_cast<double>(n - p)), count = S(static_cast<double>(n));
  const S usual_sq = square(S(1.4826) * sizes(n / 2)) * count / freedom;  // of normal residuals
  const S worst_sq = fit.residuals.cwiseAbs2().maxCoeff();
  fit.outlier = S(0) < usual_sq && S(100) * usual_sq < worst_sq && fit.left_sq < S(2) * worst_sq;
  const S variance = fit.left_sq / freedom;
  fit.residual_sd = sqrt(variance);
  fit.covariance = variance * (scale.asDiagonal() * factor.solve(FitMatrix<S>::Identity(p, p)) *
                               scale.asDiagonal());
  const FitVector<S> with = a.colwise().sum();
  const S free = count - with.dot(factor.solve(with));
  if (n >= p + 4 && count < S(1e9) * free) {
    fit.constant = fit.residuals.sum() / free;
    fit.by_constant = fit.constant * fit.residuals.sum();
  }
  const S sum = fit.covariance.sum() + fit.parameters.sum() + fit.residual_sd;
  expects(is_finite(sum), owner, "parameters and their variances", sum,
          "finite: a force is far too large");
  return fit;
}

/// The likely mistake; nullptr: none. Causes of wrong parameters come before causes of inexact
/// ones.
template <scalar S>
const char* cause_in(const LinearFit<S>& fit, const char* units, const char* mistake) {
  return units != nullptr     ? units
         : mistake != nullptr ? mistake
         : !(S(9) / S(10) <= fit.explained)
             ? "less than 0.9 of the measured variance is explained: the samples are constant or "
               "contradict each other"
         : fit.outlier ? "a sample is far from the others: check its dots and its gauge reading"
                       : nullptr;
}

/// The largest finite magnitude of a quantity.
template <scalar S, class Of>
double largest(std::span<const ForceSample<S>> samples, const Of& quantity) {
  double most = 0;
  for (const ForceSample<S>& s : samples) {
    const double size = std::abs(static_cast<double>(value(quantity(s))));
    most = size > most && is_finite(size) ? size : most;
  }
  return most;
}
/// Of bounds that hold for every fingertip: a quantity beyond them is in another unit.
constexpr bool is_between(double least, double x, double most) {
  return least <= x && x <= most;
}
/// Nothing smaller than 0.05 mm is visible, and no pad is larger. 300 N: 0.2 MPa on a pad of 40 mm.
template <scalar S>
const char* unit_mistake(std::span<const ForceSample<S>> samples, double force, double least_n) {
  const double measure = largest(samples, [](const auto& s) { return s.measure; });
  return !is_between(0.05, measure, 1e4)
             ? "no measure reaches 0.05, or one exceeds 10000: give areas in mm^2, depths and "
               "radii in mm"
         : !is_between(least_n, force, 300)
             ? "no force reaches 0.05 (along the pad 0.01), or one exceeds 300: give forces in N"
             : nullptr;
}

/// The samples that have a measure and what else a fit needs.
template <scalar S, class Usable>
std::vector<ForceSample<S>> usable_samples(std::span<const ForceSample<S>> given,
                                           const Usable& usable) {
  std::vector<ForceSample<S>> some;
  std::copy_if(given.begin(), given.end(), std::back_inserter(some), [&](const ForceSample<S>& s) {
    return is_finite(s.measure) && value(s.measure) > 0 && usable(s);
  });
  return some;
}

/// Whether a constant that explains `by_constant` of a sum of squared residuals, and has the square
/// `constant_sq`, shows that the gauge was not tared: it explains more than half, and exceeds a
/// tenth of the largest force.
template <scalar S>
bool is_offset(const S& by_constant, const S& left_sq, const S& constant_sq, const S& largest_sq) {
  return left_sq < S(2) * by_constant && largest_sq < S(100) * constant_sq;
}

}  // namespace detail

/// Normal force from area, depth or radius by a polynomial. One that falls somewhere between 0 and
/// the largest measure loses its lowest power, if it falls at 0, or else its highest; a force that
/// falls is refused. Degree in [1, 3]. `through_zero`: no force without contact; the published
/// curves lack this. Uses the samples with a measure > 0 and a normal force. Allocates; O(samples).
template <scalar S = double>
NormalForceFit<S> fit_normal_force(std::span<const ForceSample<S>> samples,
                                   int degree = 2,
                                   bool through_zero = true) {
  const char* const owner = "fit_normal_force";
  require(owner, {{"degree", degree, within(1, 3)}});
  const auto some = detail::usable_samples(
      samples, [](const ForceSample<S>& s) { return is_finite(s.normal_force_n); });
  expects(!some.empty(), owner, "usable samples", 0LL,
          "> 0: with a measure > 0 and a finite normal force");
  const Index n = static_cast<Index>(some.size()), first = through_zero ? 1 : 0;
  detail::FitVector<S> t(n), measured(n);  // t: measure over the largest
  for (Index i = 0; i < n; ++i) {
    t(i) = some[static_cast<std::size_t>(i)].measure;
    measured(i) = some[static_cast<std::size_t>(i)].normal_force_n;
  }
  NormalForceFit<S> result;
  ForceCurve<S>& curve = result.curve;
  curve.from = t.minCoeff();
  curve.to = t.maxCoeff();
  expects(curve.from < curve.to, owner, "largest measure", curve.to, "> the smallest");
  t /= curve.to;
  detail::LinearFit<S> fit;
  std::vector<std::size_t> powers(static_cast<std::size_t>(degree + 1 - first));
  std::iota(powers.begin(), powers.end(), static_cast<std::size_t>(first));
  for (S lowest(-1); value(lowest) < 0;) {
    const Index terms = static_cast<Index>(powers.size());
    detail::FitMatrix<S> columns = detail::FitMatrix<S>::Constant(n, terms, S(1));
    detail::FitVector<S> scale = detail::FitVector<S>::Constant(terms, S(1));  // of the measure
    std::vector<std::string> names;
    for (Index k = 0; k < terms; ++k) {
      const std::size_t power = powers[static_cast<std::size_t>(k)];
      for (std::size_t i = 0; i < power; ++i) {
        columns.col(k).array() *= t.array();
        scale(k) = scale(k) / curve.to;
      }
      names.push_back(power == 0 ? "the constant" : "measure^" + std::to_string(power));
    }
    fit = detail::fit_linear<S>(owner, names, measured, columns);
    curve.coefficients = detail::zeros<S, 4>();
    curve.covariance = detail::zero_matrix<S, 4>();
    for (Index i = 0; i < terms; ++i) {
      const std::size_t row = powers[static_cast<std::size_t>(i)];
      curve.coefficients[row] = scale(i) * fit.parameters(i);
      for (Index j = 0; j < terms; ++j) {
        const std::size_t col = powers[static_cast<std::size_t>(j)];
        curve.covariance[row][col] = scale(i) * scale(j) * fit.covariance(i, j);
      }
    }
    lowest = curve.lowest_slope(S(0));
    const bool falls = value(lowest) < 0, falls_first = value(curve.slope(S(0))) < 0;
    expects(!falls || terms > 2 - first, owner, "slope of the force over the measure", lowest,
            ">= 0: the force falls while the contact grows");
    if (falls) {
      powers.erase(falls_first ? powers.begin() + 1 - first : powers.end() - 1);
    }
  }
  curve.residual_sd_n = fit.residual_sd;
  result.explained = fit.explained;
  const bool offset =
      through_zero && detail::is_offset<S>(fit.by_constant, fit.left_sq, square(fit.constant),
                                           measured.cwiseAbs2().maxCoeff());
  const double force = detail::largest(samples, [](const auto& s) { return s.normal_force_n; });
  result.cause = detail::cause_in(fit, detail::unit_mistake(samples, force, 0.05),
                                  offset ? cause::gauge_not_tared : nullptr);
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

/// By which angle a rotated gauge is rotated, for refusals.
template <scalar S>
std::string angle_text(const char* mistake, const std::array<S, 2>& angle) {
  const auto degrees = [](const S& rad) {
    return std::to_string(std::lround(57.29577951308232 * static_cast<double>(value(rad))));
  };
  return mistake == cause::gauge_rotated && is_finite(angle[1])
             ? " (rotated by " + degrees(angle[0]) + " +- " + degrees(angle[1]) + " degrees)"
             : "";
}

/// Axes with which no fit can succeed: a reflection or a rotation with a scale explains more than
/// half of the forces, but not one by less than 45 degrees. nullptr: none.
template <scalar S>
const char* axes_mistake(const PlaneVectors<S>& d, const PlaneVectors<S>& forces) {
  const Eigen::Matrix<S, 2, 2> sums = d.transpose() * forces;
  const S along = sums.trace(), across = sums(0, 1) - sums(1, 0);
  const S half = d.squaredNorm() * forces.squaredNorm() / S(2);
  const bool rotated = half < square(along) + square(across);
  const bool mirrored = half < square(sums(0, 0) - sums(1, 1)) + square(sums(0, 1) + sums(1, 0));
  return rotated && square(along) < square(across) ? cause::gauge_rotated
         : rotated && along < S(0)
             ? "the forces point against the displacements: check the sign of each axis"
         : mirrored && !rotated
             ? "the forces mirror the displacements: check whether x and y are exchanged or one is "
               "reversed"
             : nullptr;
}

/// What explains more than half of the residual `left`: a constant, or a rotation of the gauge that
/// exceeds a tenth of the force along the displacement. nullptr: neither.
template <scalar S>
const char* gauge_mistake(const PlaneVectors<S>& d,
                          const PlaneVectors<S>& forces,
                          const PlaneVectors<S>& left) {
  const Eigen::Matrix<S, 2, 2> sums = d.transpose() * forces;
  const S along = sums.trace(), across = sums(0, 1) - sums(1, 0), left_sq = left.squaredNorm();
  const S count = S(static_cast<double>(d.rows()));
  const S by_constant = left.colwise().sum().squaredNorm() / count;
  const S largest_sq = forces.rowwise().squaredNorm().maxCoeff();
  const bool explains = left_sq * d.squaredNorm() < S(2) * square(across);
  return is_offset<S>(by_constant, left_sq, by_constant / count, largest_sq)
             ? cause::gauge_not_tared
         : explains && square(along) < S(100) * square(across) ? cause::gauge_rotated
                                                               : nullptr;
}

/// y = c u x, u = (measure / reference)^T, for each component of each sample: a search for T from
/// -2 to 6 unless it is given, then fits of c and of a change of T. `moved` and `caused` are x and
/// y of a sample.
template <scalar S, class Moved, class Caused>
ShearFit<S> fit_shear(const char* owner,
                      const char* exponent_name,
                      Index components,
                      std::span<const ForceSample<S>> samples,
                      const S& reference,
                      const std::optional<S>& exponent,
                      const char* units,
                      const Moved& moved,
                      const Caused& caused) {
  using std::exp;
  using std::log;
  using std::sqrt;
  require(owner, {{"reference", reference, positive},
                  {exponent_name, exponent.value_or(S(0)), finite_number}});
  const auto some = usable_samples(samples, [&](const ForceSample<S>& s) {
    return is_finite(moved(s)) && is_finite(caused(s));
  });
  const Index n = static_cast<Index>(some.size());
  PlaneVectors<S> x(n, 2), y(n, 2);
  FitVector<S> log_ratio(n);
  for (Index i = 0; i < n; ++i) {
    const ForceSample<S>& s = some[static_cast<std::size_t>(i)];
    x.row(i) << moved(s).x, moved(s).y;
    y.row(i) << caused(s).x, caused(s).y;
    log_ratio(i) = log(s.measure / reference);
  }
  const auto in_rows = [&](const PlaneVectors<S>& v) {  // x and y of a sample one after the other
    const FitMatrix<S> across = v.leftCols(components).transpose();
    return FitVector<S>(across.reshaped());
  };
  const auto normalised = [&](const S& power) {
    PlaneVectors<S> d = x;
    for (Index i = 0; i < n; ++i) {
      d.row(i) *= exp(power * log_ratio(i));
    }
    return d;
  };
  const PlaneVectors<S> plain = normalised(exponent.value_or(S(0)));
  const char* const axes = axes_mistake<S>(plain, y);
  const std::string must =
      std::string("such that the forces follow the displacements; ") +
      (axes == nullptr ? "" : axes + angle_text(axes, gauge_angle<S>(plain, y)));
  expects(axes == nullptr, owner, "usable samples", static_cast<long long>(n), must.c_str());
  const FitVector<S> measured = in_rows(y);
  ShearFit<S> result;
  S& power = result.law.exponent;
  power = exponent.value_or(S(0));
  S least = not_a_number<S>();
  for (int k = 0; !exponent && k <= 80; ++k) {
    const S tried = S(-2) + S(k) / S(10);
    const FitVector<S> v = in_rows(normalised(tried));
    const FitVector<S> left = measured - v.dot(measured) / v.squaredNorm() * v;
    if (is_finite(left.squaredNorm()) && !(value(left.squaredNorm()) >= value(least))) {
      least = left.squaredNorm();
      power = tried;
    }
  }
  LinearFit<S> fit;
  bool settled = false;
  for (int pass = 0; pass < 100 && !settled; ++pass) {
    const PlaneVectors<S> d = normalised(power);
    FitMatrix<S> columns(measured.size(), exponent ? 1 : 2);
    columns.col(0) = in_rows(d);
    if (!exponent) {
      columns.col(1) = in_rows(log_ratio.asDiagonal() * d);
    }
    fit = fit_linear<S>(owner, {"slope", exponent_name}, measured, columns);
    const S step = exponent ? S(0) : fit.parameters(1) / fit.parameters(0);
    power = is_finite(step) ? power + step : not_a_number<S>();  // no force at all
    settled = !(square(S(1e-3)) * epsilon<S>() < square(step));
  }
  result.law.slope = fit.parameters(0);
  expects(exponent || (S(-2) <= power && power <= S(6)), owner, exponent_name, power,
          "in [-2, 6]: the samples do not determine it");
  const PlaneVectors<S> d = normalised(power);
  result.law.to = sqrt(d.rowwise().squaredNorm().maxCoeff());
  expects(is_finite(result.law.to), owner, "largest displacement or rotation", result.law.to,
          "finite");
  const S& c = result.law.slope;
  result.covariance[0][0] = fit.covariance(0, 0);
  if (!exponent) {
    result.covariance[0][1] = result.covariance[1][0] = fit.covariance(0, 1) / c;
    result.covariance[1][1] = fit.covariance(1, 1) / square(c);
  }
  result.residual_sd = fit.residual_sd;
  result.explained = fit.explained;
  const auto angle = gauge_angle<S>(d, y);
  result.gauge_angle_rad = angle[0];  // NaN for a moment
  result.gauge_angle_sd_rad = angle[1];
  result.cause = cause_in(fit, units, gauge_mistake<S>(d, y, y - c * d));
  result.cause = result.cause == nullptr && !settled ? cause::not_converged : result.cause;
  return result;
}

}  // namespace detail

/// Tangential force in proportion to the displacement and a power of (measure / reference). The
/// exponent is fitted if it is not given. Uses the samples with a measure > 0, a tangential force
/// and a displacement. Allocates; O(80 samples).
template <scalar S = double>
ShearFit<S> fit_tangential_force(std::span<const ForceSample<S>> samples,
                                 const std::type_identity_t<S>& reference,
                                 const std::optional<std::type_identity_t<S>>& exponent = {}) {
  using Sample = ForceSample<S>;
  const auto longest = [&](Point2<S> Sample::*vector) {
    return detail::largest(samples, [&](const Sample& s) { return norm(s.*vector); });
  };
  const char* const units =
      detail::unit_mistake(samples, longest(&Sample::tangential_force_n), 0.01);
  const bool mm = detail::is_between(0.01, longest(&Sample::displacement_mm), 100);
  return detail::fit_shear<S>(
      "fit_tangential_force", "displacement_exponent", 2, samples, reference, exponent,
      units != nullptr || mm
          ? units
          : "no displacement reaches 0.01, or one exceeds 100: give displacements in mm",
      [](const Sample& s) { return s.displacement_mm; },
      [](const Sample& s) { return s.tangential_force_n; });
}

/// Moment from rotation, in the same way.
template <scalar S = double>
ShearFit<S> fit_moment(std::span<const ForceSample<S>> samples,
                       const std::type_identity_t<S>& reference,
                       const std::optional<std::type_identity_t<S>>& exponent = {}) {
  using Sample = ForceSample<S>;
  const double force = detail::largest(samples, [](const Sample& s) { return s.normal_force_n; });
  const double moment = detail::largest(samples, [](const Sample& s) { return s.moment_n_mm; });
  const double turned = detail::largest(samples, [](const Sample& s) { return s.rotation_rad; });
  const char* const units = detail::unit_mistake(samples, 1, 0.01);
  const bool lever = moment >= 0.05 * force && (moment <= 100 * force || force <= 0);
  return detail::fit_shear<S>(
      "fit_moment", "rotation_exponent", 1, samples, reference, exponent,
      units != nullptr || (turned <= 1.6 && lever) ? units
      : turned > 1.6 ? "a rotation exceeds a right angle: give rotations in rad"
                     : "moments are below 0.05 mm or above 100 mm times the normal force: give "
                       "moments in N mm",
      [](const Sample& s) {
        return Point2<S>{s.rotation_rad, S(0)};
      },
      [](const Sample& s) {
        return Point2<S>{s.moment_n_mm, S(0)};
      });
}

}  // namespace v1
}  // namespace fingerpad
