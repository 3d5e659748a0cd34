// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A force or moment as an odd polynomial of something displaced or rotated, normalised by a power
// of the contact's measure: y = sum over k of c_k (u |x|)^(k-1) u x, u = (measure / reference)^T.
// The exponent T is found by a search along it, then together with the coefficients.
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "fingerpad/calibrate/force_samples.hpp"
#include "fingerpad/calibrate/model_fit.hpp"
#include "fingerpad/core/dots.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/force/force_curve.hpp"
#include "fingerpad/math/detail/householder_qr.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

// The normal force as a model that is fitted: a polynomial of the measure, times what displacement
// and rotation change. The polynomial is written in sums of Bernstein's polynomials over [0, to],
//   G_k(t) = sum over j >= k of B_j(t), t = measure / to,
// in which columns are well told apart, G_0 = 1 alone is not 0 at 0, and a polynomial whose
// coefficients from the first on are not negative never falls (for degree 2 also the reverse).

/// Coefficient of t^power in G_k; whole numbers.
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

/// What takes part in the fit.
struct PolynomialTerms {
  std::vector<std::size_t> columns;  ///< of the basis
  bool displaced = false;            ///< per_mm_sq
  bool rotated = false;              ///< per_rad_sq
};

template <int Degree, scalar S>
class PolynomialModel {
 public:
  using Matrix = typename ModelFit<S>::Matrix;
  using Vector = typename ModelFit<S>::Vector;
  static constexpr std::size_t size = static_cast<std::size_t>(Degree) + 1;

  PolynomialModel(const std::vector<ForceSample<S>>& samples, const S& to, PolynomialTerms terms)
      : samples_(samples), to_(to), terms_(std::move(terms)) {}

  void fill(const Vector& parameters, Vector& values, Matrix& jacobian) const {
    const Index columns = static_cast<Index>(terms_.columns.size());
    for (Index i = 0; i < values.size(); ++i) {
      const ForceSample<S>& sample = samples_[static_cast<std::size_t>(i)];
      const S displaced_sq = square(sample.displacement_mm.x) + square(sample.displacement_mm.y);
      const S turned_sq = square(sample.rotation_rad);
      Index next = columns;
      S factor = S(1);
      if (terms_.displaced) {
        factor += S(parameters(next++) * displaced_sq);
      }
      if (terms_.rotated) {
        factor += S(parameters(next) * turned_sq);
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
        jacobian(i, next++) = plain * displaced_sq;
      }
      if (terms_.rotated) {
        jacobian(i, next) = plain * turned_sq;
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

  /// Powers of the measure from the columns that took part: size x columns.
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

  const PolynomialTerms& terms() const { return terms_; }

 private:
  static constexpr auto basis = rising_basis<Degree>();

  static S at(std::size_t column, const S& t) {
    S sum = S(basis[column][size - 1]);
    for (std::size_t k = size - 1; k-- > 0;) {
      sum = S(sum * t) + S(basis[column][k]);
    }
    return sum;
  }

  const std::vector<ForceSample<S>>& samples_;
  S to_;
  PolynomialTerms terms_;
};

/// One equation: a component of x and of y, and the length of the whole x.
template <scalar S>
struct ShearEquation {
  S log_measure;  ///< log(measure / reference)
  S component;
  S length;
  S measured;
  std::size_t sample;
};

template <int Degree, scalar S>
class ShearModel {
 public:
  using Matrix = typename ModelFit<S>::Matrix;
  using Vector = typename ModelFit<S>::Vector;

  /// With the exponent as the last parameter, unless it is `given`.
  ShearModel(const std::vector<ShearEquation<S>>& equations, bool given, const S& exponent)
      : equations_(equations), given_(given), exponent_(exponent) {}

  Index size() const { return Degree + (given_ ? 0 : 1); }

  void fill(const Vector& parameters, Vector& values, Matrix& jacobian) const {
    const S exponent = given_ ? exponent_ : S(parameters(Degree));
    for (Index i = 0; i < values.size(); ++i) {
      const ShearEquation<S>& e = equations_[static_cast<std::size_t>(i)];
      S value = S(0), by_log = S(0);
      for (Index k = 0; k < Degree; ++k) {
        const S term = column(e, exponent, k);
        value += S(parameters(k) * term);
        by_log += S(S(static_cast<int>(k) + 1) * S(parameters(k) * term));
        jacobian(i, k) = term;
      }
      values(i) = value;
      if (!given_) {
        jacobian(i, Degree) = by_log * e.log_measure;
      }
    }
  }

  /// The best coefficients for an exponent, and what they leave: the sum of squares or, if robust,
  /// of sizes.
  S left_at(const S& exponent, bool robust, Vector& coefficients) const {
    const Index n = static_cast<Index>(equations_.size());
    Matrix a(n, Degree);
    Vector b(n);
    for (Index i = 0; i < n; ++i) {
      const ShearEquation<S>& e = equations_[static_cast<std::size_t>(i)];
      b(i) = e.measured;
      for (Index k = 0; k < Degree; ++k) {
        a(i, k) = column(e, exponent, k);
      }
    }
    coefficients = HouseholderQr<S>(a).solve(b);
    const Vector left = b - a.lazyProduct(coefficients);
    return robust ? S(left.cwiseAbs().sum()) : S(left.squaredNorm());
  }

 private:
  static S column(const ShearEquation<S>& e, const S& exponent, Index k) {
    using std::exp;
    const S factor = exp(S(exponent * e.log_measure));
    S term = factor * e.component;
    for (Index i = 0; i < k; ++i) {
      term = term * S(factor * e.length);
    }
    return term;
  }

  const std::vector<ShearEquation<S>>& equations_;
  bool given_;
  S exponent_;
};

}  // namespace detail

}  // namespace v0
}  // namespace fingerpad
