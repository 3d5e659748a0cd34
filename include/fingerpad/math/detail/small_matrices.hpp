// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Matrices of a few columns, for every scalar: solution and variances of normal equations
// (equilibrated Cholesky). Eigen's factorisations are blocked, which gains nothing here and takes
// several times as long to compile.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

template <scalar S, std::size_t N>
using SmallMatrix = std::array<std::array<S, N>, N>;

/// Zeros: empty braces leave a number of some types undefined.
template <scalar S, std::size_t N>
constexpr std::array<S, N> zeros() {
  std::array<S, N> all;
  all.fill(S(0));
  return all;
}
template <scalar S, std::size_t N>
constexpr SmallMatrix<S, N> zero_matrix() {
  SmallMatrix<S, N> all;
  all.fill(zeros<S, N>());
  return all;
}

/// Cholesky factor of normal equations A^T A, scaled to a unit diagonal so that units do not
/// matter. `good` is false if a diagonal element is not positive and finite, or if a column of A is
/// nearly a combination of those before it: the rest is at most `least` of its squared length.
template <scalar S, std::size_t N>
class NormalEquations {
 public:
  explicit NormalEquations(const SmallMatrix<S, N>& a, double least = 1e-9) {
    using std::sqrt;
    for (std::size_t i = 0; i < N; ++i) {
      good = good && value(a[i][i]) > 0 && is_finite(a[i][i]);
      scale_[i] = good ? S(1) / sqrt(a[i][i]) : S(0);
    }
    for (std::size_t j = 0; j < N && good; ++j) {
      S pivot = S(1);
      for (std::size_t k = 0; k < j; ++k) {
        pivot = pivot - factor_[j][k] * factor_[j][k];
      }
      good = value(pivot) > scalar_real_t<S>(least);
      factor_[j][j] = good ? sqrt(pivot) : S(1);
      for (std::size_t i = j + 1; i < N; ++i) {
        S sum = a[i][j] * scale_[i] * scale_[j];
        for (std::size_t k = 0; k < j; ++k) {
          sum = sum - factor_[i][k] * factor_[j][k];
        }
        factor_[i][j] = sum / factor_[j][j];
      }
    }
  }

  std::array<S, N> solve(std::array<S, N> b) const {
    for (std::size_t i = 0; i < N; ++i) {
      S sum = b[i] * scale_[i];
      for (std::size_t k = 0; k < i; ++k) {
        sum = sum - factor_[i][k] * b[k];
      }
      b[i] = sum / factor_[i][i];
    }
    for (std::size_t i = N; i-- > 0;) {
      S sum = b[i];
      for (std::size_t k = i + 1; k < N; ++k) {
        sum = sum - factor_[k][i] * b[k];
      }
      b[i] = sum / factor_[i][i];
    }
    for (std::size_t i = 0; i < N; ++i) {
      b[i] = b[i] * scale_[i];
    }
    return b;
  }

  /// h^T (A^T A)^-1 h: the variance of h^T x if each equation has variance 1.
  S variance(const std::array<S, N>& h) const {
    const std::array<S, N> x = solve(h);
    S sum = S(0);
    for (std::size_t i = 0; i < N; ++i) {
      sum = sum + x[i] * h[i];
    }
    return sum;
  }

  /// (A^T A)^-1: the covariance of x if each equation has variance 1.
  SmallMatrix<S, N> inverse() const {
    SmallMatrix<S, N> columns{};
    for (std::size_t i = 0; i < N; ++i) {
      std::array<S, N> unit = zeros<S, N>();
      unit[i] = S(1);
      columns[i] = solve(unit);
    }
    return columns;
  }

  bool good = true;

 private:
  SmallMatrix<S, N> factor_ = zero_matrix<S, N>();
  std::array<S, N> scale_ = zeros<S, N>();
};

/// The sums of all products of N terms, from which least squares of a term in the first M take
/// their normal equations.
template <scalar S, std::size_t N>
struct ProductSums {
  SmallMatrix<S, N> sum = zero_matrix<S, N>();

  void add(const std::array<S, N>& term) {
    for (std::size_t a = 0; a < N; ++a) {
      for (std::size_t b = 0; b < N; ++b) {
        sum[a][b] = sum[a][b] + term[a] * term[b];
      }
    }
  }
  const S& operator()(std::size_t a, std::size_t b) const { return sum[a][b]; }
  template <std::size_t M>
  std::array<S, M> column(std::size_t b) const {
    std::array<S, M> all = zeros<S, M>();
    for (std::size_t a = 0; a < M; ++a) {
      all[a] = (*this)(a, b);
    }
    return all;
  }
  template <std::size_t M>
  SmallMatrix<S, M> corner() const {
    SmallMatrix<S, M> all;
    for (std::size_t b = 0; b < M; ++b) {
      all[b] = column<M>(b);
    }
    return all;
  }
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
