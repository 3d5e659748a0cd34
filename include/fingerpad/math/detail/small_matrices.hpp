// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Matrices of a few columns, for every scalar: solution and variances of normal equations
// (equilibrated Cholesky), and least squares of many rows by Householder reflections. Eigen's
// factorisations are blocked, which gains nothing here and takes several times as long to compile.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

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
#pragma GCC unroll 8
    for (std::size_t a = 0; a < N; ++a) {
#pragma GCC unroll 8
      for (std::size_t b = a; b < N; ++b) {
        sum[a][b] = sum[a][b] + term[a] * term[b];
      }
    }
  }
  const S& operator()(std::size_t a, std::size_t b) const {
    return a < b ? sum[a][b] : sum[b][a];
  }
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

/// R of the QR factorisation of a matrix of few columns, by Householder reflections: least squares
/// with all digits, where sums of products keep half of them.
template <scalar S>
class Triangle {
 public:
  Triangle() = default;
  /// Of a matrix given row by row.
  Triangle(std::vector<S> rows, std::size_t cols) : cols_(cols), a_(std::move(rows)) {
    using std::sqrt;
    a_.resize((std::max)(a_.size(), cols * cols), S(0));
    const std::size_t count = a_.size() / cols;
    std::vector<S> along(cols);
    for (std::size_t k = 0; k < cols; ++k) {
      S below_sq = S(0);
      for (std::size_t i = k + 1; i < count; ++i) {
        below_sq += square(at(i, k));
      }
      if (!(S(0) < below_sq)) {
        continue;
      }
      const S head = at(k, k), length = sqrt(square(head) + below_sq);
      const S lead = head > S(0) ? head + length : head - length;  // no cancellation
      at(k, k) = lead;  // column k is now v, and the others become a - 2 v (v . a) / (v . v)
      std::fill(along.begin(), along.end(), S(0));
      for (std::size_t i = k; i < count; ++i) {
        for (std::size_t j = k + 1; j < cols; ++j) {
          along[j] += at(i, k) * at(i, j);
        }
      }
      for (S& x : along) {
        x *= S(2) / (square(lead) + below_sq);
      }
      for (std::size_t i = k; i < count; ++i) {
        for (std::size_t j = k + 1; j < cols; ++j) {
          at(i, j) -= at(i, k) * along[j];
        }
      }
      at(k, k) = head - lead;
    }
  }

  /// R(i, j) for i <= j.
  const S& operator()(std::size_t i, std::size_t j) const { return a_[i * cols_ + j]; }

  /// The share of the length of column j that is orthogonal to the columns before it; 0 for a
  /// column of zeros.
  S independent_share(std::size_t j) const {
    using std::sqrt;
    S length_sq = S(0);
    for (std::size_t i = 0; i <= j; ++i) {
      length_sq += square((*this)(i, j));
    }
    return S(0) < length_sq ? sqrt(square((*this)(j, j)) / length_sq) : S(0);
  }

  /// The factors of the first `count` columns whose sum is nearest to column b.
  std::vector<S> solve(std::size_t count, std::size_t b) const {
    std::vector<S> x(count);
    for (std::size_t i = count; i-- > 0;) {
      S left = (*this)(i, b);
      for (std::size_t k = i + 1; k < count; ++k) {
        left -= (*this)(i, k) * x[k];
      }
      x[i] = left / (*this)(i, i);
    }
    return x;
  }

  /// The covariance of these factors if each row has variance 1, row by row: R^-1 R^-T.
  std::vector<S> covariance(std::size_t count) const {
    std::vector<S> all(count * count, S(0)), x(count);
    for (std::size_t j = 0; j < count; ++j) {  // x: column j of R^-1
      for (std::size_t i = j + 1; i-- > 0;) {
        S left = S(i == j ? 1 : 0);
        for (std::size_t k = i + 1; k <= j; ++k) {
          left -= (*this)(i, k) * x[k];
        }
        x[i] = left / (*this)(i, i);
      }
      for (std::size_t i = 0; i <= j; ++i) {
        for (std::size_t k = 0; k <= j; ++k) {
          all[i * count + k] += x[i] * x[k];
        }
      }
    }
    return all;
  }

 private:
  S& at(std::size_t i, std::size_t j) { return a_[i * cols_ + j]; }

  std::size_t cols_ = 0;
  std::vector<S> a_;  // R on and above the diagonal
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
