// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Least squares by the Gauss-Newton method, with a QR factorisation of the scaled Jacobian and,
// optionally, Huber's weights. The first step solves a model that is linear in its parameters, and
// the second one refines it. No normal equations are formed.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/math/detail/householder_qr.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

template <scalar S>
struct ModelFit {
  using Matrix = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<S, Eigen::Dynamic, 1>;

  Vector parameters;
  Matrix covariance;
  Vector residuals;  ///< measured less model, of each equation
  Vector weights;    ///< 1, or less for an outlier
  S residual_sd = S(0);
  S explained = S(0);  ///< share of the measured variance about the mean
  S left_sq = S(0);    ///< weighted sum of squared residuals
  S worst_sq = S(0);   ///< largest squared residual
  S worst_sds = S(0);  ///< largest residual in robust standard deviations
  bool converged = false;
};

/// A model to be fitted. It is a base class so that the fitter is compiled once for all models.
template <scalar S>
class FitModel {
 public:
  using Matrix = typename ModelFit<S>::Matrix;
  using Vector = typename ModelFit<S>::Vector;
  /// Values and Jacobian for these parameters.
  virtual void fill(const Vector& parameters, Vector& values, Matrix& jacobian) const = 0;

 protected:
  ~FitModel() = default;
};

/// y = a p with given columns.
template <scalar S>
class LinearModel final : public FitModel<S> {
 public:
  using typename FitModel<S>::Matrix;
  using typename FitModel<S>::Vector;
  explicit LinearModel(Index rows, Index cols) : columns(rows, cols) {}
  void fill(const Vector& parameters, Vector& values, Matrix& jacobian) const override {
    values = columns.lazyProduct(parameters);
    jacobian = columns;
  }

  Matrix columns;
};

/// Standard deviation of normal residuals from their median magnitude. A third of outliers changes
/// it little.
template <class Vector>
typename Vector::Scalar robust_sd(const Vector& residuals, Index parameters) {
  using S = typename Vector::Scalar;
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

/// One fit: measured values, a model, and the names of its parameters for refusals.
template <scalar S>
class ModelFitter {
  using Fit = ModelFit<S>;
  using Matrix = typename Fit::Matrix;
  using Vector = typename Fit::Vector;

 public:
  ModelFitter(const char* owner,
              std::vector<std::string> names,
              const Vector& measured,
              const FitModel<S>& model,
              const FitOptions& options,
              double min_independence = 1e-5)
      : owner_(owner),
        names_(std::move(names)),
        measured_(measured),
        model_(model),
        options_(options),
        min_independence_(min_independence) {
    require(options);
    const Index count = static_cast<Index>(names_.size());
    expects(measured.size() > count, owner, "usable samples",
            static_cast<long long>(measured.size()),
            ("> " + std::to_string(count) + ", the number of parameters").c_str());
  }

  Fit operator()(const Vector& start) const {
    Fit fit;
    fit.parameters = start;
    fit.weights = Vector::Constant(measured_.size(), S(1));
    Vector values(measured_.size());
    Matrix jacobian(measured_.size(), start.size());
    for (int pass = 0; pass < max_passes && !fit.converged; ++pass) {
      model_.fill(fit.parameters, values, jacobian);
      fit.residuals = measured_ - values;
      reweigh(pass, fit);
      fit.converged = step(jacobian, pass, fit);
    }
    model_.fill(fit.parameters, values, jacobian);
    fit.residuals = measured_ - values;
    judge(jacobian, fit);
    return fit;
  }

 private:
  static constexpr int max_passes = 100;
  static constexpr double huber_threshold = 1.345;  // in standard deviations of a sample

  /// Huber's weights, from the second pass on.
  void reweigh(int pass, Fit& fit) const {
    if (!options_.robust || pass == 0) {
      return;
    }
    const S limit = S(huber_threshold) * robust_sd(fit.residuals, fit.parameters.size());
    for (Index i = 0; i < fit.residuals.size(); ++i) {
      const S size = fit.residuals(i) < S(0) ? S(-fit.residuals(i)) : fit.residuals(i);
      fit.weights(i) = limit < size ? limit / size : S(1);
    }
  }

  /// The weighted Jacobian with columns scaled to length 1. `lengths` are the original ones.
  Matrix scaled(const Matrix& jacobian, const Vector& weights, Vector& lengths) const {
    using std::sqrt;
    Matrix a = jacobian;
    for (Index i = 0; i < a.rows(); ++i) {
      a.row(i) *= sqrt(weights(i));
    }
    lengths.resize(a.cols());
    for (Index k = 0; k < a.cols(); ++k) {
      const S length_sq = a.col(k).squaredNorm();
      lengths(k) = S(0) < length_sq ? sqrt(length_sq) : S(1);
      a.col(k) /= lengths(k);
    }
    return a;
  }

  /// One step; true if it is below roundoff.
  bool step(const Matrix& jacobian, int pass, Fit& fit) const {
    using std::sqrt;
    Vector lengths;
    const Matrix a = scaled(jacobian, fit.weights, lengths);
    const HouseholderQr<S> qr(a);
    refuse_undetermined(qr);
    Vector right = fit.residuals;
    for (Index i = 0; i < right.size(); ++i) {
      right(i) *= sqrt(fit.weights(i));
    }
    const Vector move = qr.solve(right);
    for (Index k = 0; k < move.size(); ++k) {
      fit.parameters(k) += move(k) / lengths(k);
    }
    const S tiny_sq = square(S(64) * S(epsilon<S>()));
    return pass > 0 && !(tiny_sq * S(measured_.squaredNorm()) < S(move.squaredNorm()));
  }

  /// Refuses a parameter that depends on those before it. The diagonal of R is the independent
  /// share of its column.
  void refuse_undetermined(const HouseholderQr<S>& qr) const {
    for (Index k = 0; k < static_cast<Index>(names_.size()); ++k) {
      const S share = qr.diagonal(k) < S(0) ? S(-qr.diagonal(k)) : S(qr.diagonal(k));
      const std::string name =
          "information in the samples on " + names_[static_cast<std::size_t>(k)];
      expects(S(min_independence_) < share, owner_, name.c_str(), share,
              "> 1e-5: they are too few, too alike or tied to each other");
    }
  }

  void judge(const Matrix& jacobian, Fit& fit) const {
    using std::sqrt;
    const Index n = measured_.size(), p = fit.parameters.size();
    const S count = S(static_cast<double>(n)), freedom = S(static_cast<double>(n - p));
    const S mean = fit.weights.dot(measured_) / fit.weights.sum();
    S all_sq = S(0), bounded_sq = S(0), inside = S(0);
    for (Index i = 0; i < n; ++i) {
      const S w = fit.weights(i), residual_sq = square(S(fit.residuals(i)));
      fit.left_sq += w * residual_sq;
      all_sq += w * square(measured_(i) - mean);
      bounded_sq += square(w) * residual_sq;  // Huber's psi
      inside += w < S(1) ? S(0) : S(1);
      fit.worst_sq = (std::max)(fit.worst_sq, residual_sq);
    }
    fit.explained = S(0) < all_sq ? S(1) - fit.left_sq / all_sq : S(0);
    const S usual = robust_sd(fit.residuals, p);
    fit.worst_sds = S(0) < usual ? sqrt(fit.worst_sq) / usual : S(0);
    S variance = fit.left_sq / freedom;
    fit.residual_sd = options_.robust ? usual : S(sqrt(variance));
    if (options_.robust) {  // Huber 1981, section 7.6
      const S share = (std::max)(inside, S(1)) / count;
      const S correction = S(1) + (count - freedom) / count * ((S(1) - share) / share);
      variance = square(correction) * (bounded_sq / freedom) / square(share);
    }
    Vector lengths;
    const Matrix a = scaled(jacobian, Vector::Constant(n, S(1)), lengths);
    Matrix inverse = HouseholderQr<S>(a).inverse_of_r();
    for (Index k = 0; k < p; ++k) {
      inverse.row(k) /= lengths(k);
    }
    fit.covariance = variance * inverse.lazyProduct(inverse.transpose());
    const S sum = fit.covariance.trace();
    expects(is_finite(sum), owner_, "variance of the parameters", sum,
            "finite: a force is far too large");
  }

  const char* owner_;
  std::vector<std::string> names_;
  const Vector& measured_;
  const FitModel<S>& model_;
  FitOptions options_;
  double min_independence_;  // of a parameter; below it the samples say nothing on it
};

/// Refuses a model that does not explain the samples; `cause` is the likely cause.
template <scalar S>
void expects_explained(const ModelFit<S>& fit,
                       const FitOptions& options,
                       const char* owner,
                       const char* cause = "") {
  const bool agrees = !(fit.explained < S(options.min_explained)) && S(0) < fit.explained;
  const std::string range =
      std::string(">= min_explained: the samples are constant or contradict each other") + cause;
  expects(agrees, owner, "share of the measured variance that is explained", fit.explained,
          range.c_str());
}

template <scalar S, std::size_t N>
std::array<S, N> standard_errors_of(const ModelFit<S>& fit) {
  using std::sqrt;
  std::array<S, N> errors;
  for (std::size_t k = 0; k < N; ++k) {
    const Index i = static_cast<Index>(k);
    errors[k] = S(0) < fit.covariance(i, i) ? S(sqrt(fit.covariance(i, i))) : S(0);
  }
  return errors;
}

/// The covariance of the first N parameters; 0 for parameters not fitted.
template <scalar S, std::size_t N>
std::array<std::array<S, N>, N> covariance_of(const ModelFit<S>& fit) {
  std::array<std::array<S, N>, N> covariance;
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < N; ++j) {
      const Index row = static_cast<Index>(i), col = static_cast<Index>(j);
      const bool fitted = row < fit.covariance.rows() && col < fit.covariance.cols();
      covariance[i][j] = fitted ? S(fit.covariance(row, col)) : S(0);
    }
  }
  return covariance;
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
