// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Models of the normal force curves, and their fits. See calibrate/force.hpp.
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/calibrate/detail/model_fit.hpp"
#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

// The model is a polynomial of the measure, times a factor for displacement and rotation. The
// polynomial is a combination of sums of Bernstein polynomials over [0, to],
//   G_k(t) = sum over j >= k of B_j(t), t = measure / to.
// Their columns are well conditioned, and only G_0 = 1 is not 0 at 0. A polynomial whose
// coefficients from G_1 on are not negative never falls (for degree 2 also the reverse).

/// Coefficients of t^0, t^1, ... in each G_k; integers.
template <int Degree>
constexpr auto rising_basis() {
  constexpr std::size_t size = static_cast<std::size_t>(Degree) + 1;
  const auto choose = [](int n, int k) {
    int product = 1;
    for (int i = 1; i <= k; ++i) {
      product = product * (n - k + i) / i;
    }
    return product;
  };
  std::array<std::array<int, size>, size> basis{};
  for (int k = 0; k <= Degree; ++k) {
    for (int j = k; j <= Degree; ++j) {  // B_j = C(n, j) t^j (1 - t)^(n - j)
      for (int i = 0; i <= Degree - j; ++i) {
        const int sign = i % 2 == 0 ? 1 : -1;
        basis[static_cast<std::size_t>(k)][static_cast<std::size_t>(j + i)] +=
            sign * choose(Degree, j) * choose(Degree - j, i);
      }
    }
  }
  return basis;
}

/// The quantities of a contact on which the normal force depends.
template <scalar S>
struct PressedContact {
  S measure;
  S displacement_sq;
  S rotation_sq;
};

/// The terms that are fitted.
struct PolynomialTerms {
  std::vector<std::size_t> columns;  ///< of the basis
  bool displaced = false;            ///< per_mm_sq
  bool rotated = false;              ///< per_rad_sq
};

template <int Degree, scalar S>
class PolynomialModel final : public FitModel<S> {
 public:
  using typename FitModel<S>::Matrix;
  using typename FitModel<S>::Vector;
  static constexpr std::size_t size = static_cast<std::size_t>(Degree) + 1;

  PolynomialModel(const std::vector<PressedContact<S>>& samples, const S& to, PolynomialTerms terms)
      : samples_(samples), to_(to), terms_(std::move(terms)) {}

  void fill(const Vector& parameters, Vector& values, Matrix& jacobian) const override {
    const Index columns = static_cast<Index>(terms_.columns.size());
    for (Index i = 0; i < values.size(); ++i) {
      const PressedContact<S>& sample = samples_[static_cast<std::size_t>(i)];
      Index next = columns;
      S factor = S(1);
      if (terms_.displaced) {
        factor += S(parameters(next++) * sample.displacement_sq);
      }
      if (terms_.rotated) {
        factor += S(parameters(next) * sample.rotation_sq);
      }
      S plain = S(0);
      const S t = sample.measure / to_;
      for (Index c = 0; c < columns; ++c) {
        const S g = at(terms_.columns[static_cast<std::size_t>(c)], t);
        plain += S(parameters(c) * g);
        jacobian(i, c) = g * factor;
      }
      values(i) = plain * factor;
      next = columns;
      if (terms_.displaced) {
        jacobian(i, next++) = plain * sample.displacement_sq;
      }
      if (terms_.rotated) {
        jacobian(i, next) = plain * sample.rotation_sq;
      }
    }
  }

  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const std::size_t column : terms_.columns) {
      names.push_back(column == 0 ? "the constant" : "measure^" + std::to_string(column));
    }
    if (terms_.displaced) {
      names.emplace_back("per_mm_sq");
    }
    if (terms_.rotated) {
      names.emplace_back("per_rad_sq");
    }
    return names;
  }

  /// Matrix from the coefficients of the fitted columns to those of the powers of the measure: size
  /// x columns.
  Matrix to_powers() const {
    Matrix powers(static_cast<Index>(size), static_cast<Index>(terms_.columns.size()));
    for (std::size_t c = 0; c < terms_.columns.size(); ++c) {
      S scale = S(1);
      for (std::size_t k = 0; k < size; ++k) {
        powers(static_cast<Index>(k), static_cast<Index>(c)) =
            S(basis[terms_.columns[c]][k]) / scale;
        scale = scale * to_;
      }
    }
    return powers;
  }

 private:
  static constexpr auto basis = rising_basis<Degree>();

  static S at(std::size_t column, const S& t) {
    S sum = S(basis[column][size - 1]);
    for (std::size_t k = size - 1; k-- > 0;) {
      sum = S(sum * t) + S(basis[column][k]);
    }
    return sum;
  }

  const std::vector<PressedContact<S>>& samples_;
  S to_;
  PolynomialTerms terms_;
};

/// r = c f^gamma, parameters ln c and gamma.
template <scalar S>
class PowerLawModel final : public FitModel<S> {
 public:
  using typename FitModel<S>::Matrix;
  using typename FitModel<S>::Vector;
  explicit PowerLawModel(Index size) : log_forces(size) {}
  void fill(const Vector& parameters, Vector& values, Matrix& jacobian) const override {
    using std::exp;
    for (Index i = 0; i < values.size(); ++i) {
      values(i) = exp(S(parameters(0) + S(parameters(1) * log_forces(i))));
      jacobian(i, 0) = values(i);
      jacobian(i, 1) = values(i) * log_forces(i);
    }
  }

  Vector log_forces;
};

/// Fits a polynomial of some columns: first without a compensation, then with it.
template <int Degree, scalar S>
ModelFit<S> fit_columns(const std::vector<PressedContact<S>>& samples,
                        const typename ModelFit<S>::Vector& forces,
                        const S& to,
                        const PolynomialTerms& terms,
                        const FitOptions& options) {
  using Vector = typename ModelFit<S>::Vector;
  const char* const owner = "fit_normal_force";
  const PolynomialModel<Degree, S> plain(samples, to, {terms.columns, false, false});
  const Index columns = static_cast<Index>(terms.columns.size());
  const ModelFit<S> first =
      ModelFitter<S>(owner, plain.names(), forces, plain, options)(Vector::Zero(columns));
  if (!terms.displaced && !terms.rotated) {
    return first;
  }
  const PolynomialModel<Degree, S> whole(samples, to, terms);
  Vector start = Vector::Zero(static_cast<Index>(whole.names().size()));
  start.head(columns) = first.parameters;
  return ModelFitter<S>(owner, whole.names(), forces, whole, options)(start);
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

/// The best fit that never falls. Tries all subsets of columns, which are few, and takes the one
/// with the smallest residual.
template <int Degree, scalar S>
ModelFit<S> fit_rising(const std::vector<PressedContact<S>>& samples,
                       const typename ModelFit<S>::Vector& forces,
                       const S& to,
                       PolynomialTerms& terms,
                       const FitOptions& options) {
  const PolynomialTerms all = terms;
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
    ModelFit<S> fit = fit_columns<Degree>(samples, forces, to, some, options);
    if (rises(fit, some) && !(value(fit.left_sq) >= value(least))) {
      least = fit.left_sq;
      best = std::move(fit);
      terms = some;
    }
  }
  expects(is_finite(least) && value(best.explained) >= value(S(options.min_explained)),
          "fit_normal_force", "share of the measured variance that a rising force explains",
          best.explained,
          ">= min_explained: the force falls while the contact grows, or is not that of these "
          "contacts");
  return best;
}

/// Detects a gauge that was not tared: a constant would explain more than half of the residual of
/// the curve through 0, and exceeds a tenth of the largest force.
template <int Degree, scalar S>
const char* offset_in(const std::vector<PressedContact<S>>& samples,
                      const typename ModelFit<S>::Vector& forces,
                      const S& to,
                      const PolynomialTerms& terms,
                      const FitOptions& options,
                      const ModelFit<S>& through_zero) {
  PolynomialTerms with = terms;
  with.columns.insert(with.columns.begin(), 0);
  if (forces.size() < static_cast<Index>(with.columns.size()) + 3) {
    return nullptr;
  }
  const PolynomialModel<Degree, S> model(samples, to, with);
  typename ModelFit<S>::Vector start(through_zero.parameters.size() + 1);
  start << S(0), through_zero.parameters;
  const ModelFit<S> fit = ModelFitter<S>("fit_normal_force", model.names(), forces, model, options,
                                         static_cast<double>(epsilon<S>()))(start);
  S largest_sq = S(0);
  for (Index i = 0; i < forces.size(); ++i) {
    const S force_sq = square(forces(i));
    largest_sq = value(force_sq) > value(largest_sq) ? force_sq : largest_sq;
  }
  const bool explains = value(S(S(2) * fit.left_sq)) < value(through_zero.left_sq);
  const bool matters = value(S(S(100) * square(fit.parameters(0)))) > value(largest_sq);
  return explains && matters ? cause::gauge_not_tared : nullptr;
}

/// Converts a fit to a result: the curve, and the compensation for displacement and rotation.
template <class Result, int Degree, scalar S>
Result polynomial_of(const ModelFit<S>& fit,
                     const PolynomialModel<Degree, S>& model,
                     const PolynomialTerms& terms) {
  using std::sqrt;
  using Matrix = typename ModelFit<S>::Matrix;
  Result result;
  const Matrix powers = model.to_powers();
  const Index columns = powers.cols();
  const Matrix half = powers.lazyProduct(fit.covariance.topLeftCorner(columns, columns));
  const Matrix covariance = half.lazyProduct(powers.transpose());
  for (std::size_t k = 0; k < result.curve.coefficients.size(); ++k) {
    const Index row = static_cast<Index>(k);
    result.curve.coefficients[k] = powers.row(row).dot(fit.parameters.head(columns));
    for (std::size_t l = 0; l < result.curve.coefficients.size(); ++l) {
      result.errors.covariance[k][l] = covariance(row, static_cast<Index>(l));
    }
  }
  Index next = columns;
  if (terms.displaced) {
    result.compensation.per_mm_sq = fit.parameters(next);
    result.per_mm_sq_sd = sqrt(fit.covariance(next, next));
    ++next;
  }
  if (terms.rotated) {
    result.compensation.per_rad_sq = fit.parameters(next);
    result.per_rad_sq_sd = sqrt(fit.covariance(next, next));
  }
  return result;
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
