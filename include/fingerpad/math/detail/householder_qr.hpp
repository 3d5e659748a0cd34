// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Least squares by Householder reflections, for every scalar. Eigen's factorisation is blocked,
// which gains nothing for a dozen columns and takes several times as long to compile.
#include <Eigen/Core>
#include <cmath>
#include <utility>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// A = Q R, with at least as many rows as columns.
template <scalar S>
class HouseholderQr {
 public:
  using Matrix = Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<S, Eigen::Dynamic, 1>;

  explicit HouseholderQr(Matrix a) : a_(std::move(a)), factor_(a_.cols()) {
    for (Index k = 0; k < a_.cols(); ++k) {
      factor_(k) = reflect(k);
      for (Index j = k + 1; j < a_.cols(); ++j) {
        apply(k, a_, j);
      }
    }
  }

  /// R(k, k): up to its sign, the length of the part of column k that is orthogonal to the columns
  /// before it.
  const S& diagonal(Index k) const { return a_(k, k); }

  /// Replaces each column of b by Q^T b.
  template <class Columns>
  void apply_transposed(Columns& b) const {
    for (Index j = 0; j < b.cols(); ++j) {
      for (Index k = 0; k < a_.cols(); ++k) {
        apply(k, b, j);
      }
    }
  }

  /// The x that minimises |A x - b|.
  Vector solve(Vector b) const {
    apply_transposed(b);
    Vector x = b.head(a_.cols());
    back_substitute(x, 0);
    return x;
  }

  /// R^-1, upper triangular: the covariance of x is R^-1 R^-T.
  Matrix inverse_of_r() const {
    Matrix inverse = Matrix::Identity(a_.cols(), a_.cols());
    for (Index j = 0; j < a_.cols(); ++j) {
      back_substitute(inverse, j);
    }
    return inverse;
  }

 private:
  /// Replaces column k from the diagonal down by its reflection vector v. R(k, k) takes the place
  /// of the leading 1. Returns the factor 2 / |v|^2.
  S reflect(Index k) {
    using std::sqrt;
    S below_sq = S(0);
    for (Index i = k + 1; i < a_.rows(); ++i) {
      below_sq += square(a_(i, k));
    }
    const S head = a_(k, k);
    if (!(below_sq > S(0))) {
      return S(0);
    }
    const S length = sqrt(square(head) + below_sq);
    const S r = head > S(0) ? -length : length;
    const S lead = head - r;  // no cancellation: r has the opposite sign
    for (Index i = k + 1; i < a_.rows(); ++i) {
      a_(i, k) = a_(i, k) / lead;
    }
    a_(k, k) = r;
    return -lead / r;
  }

  template <class Columns>
  void apply(Index k, Columns& b, Index j) const {
    S sum = b(k, j);
    for (Index i = k + 1; i < a_.rows(); ++i) {
      sum += a_(i, k) * b(i, j);
    }
    sum = factor_(k) * sum;
    b(k, j) -= sum;
    for (Index i = k + 1; i < a_.rows(); ++i) {
      b(i, j) -= sum * a_(i, k);
    }
  }

  template <class Columns>
  void back_substitute(Columns& x, Index j) const {
    for (Index i = a_.cols() - 1; i >= 0; --i) {
      S left = x(i, j);
      for (Index k = i + 1; k < a_.cols(); ++k) {
        left -= a_(i, k) * x(k, j);
      }
      x(i, j) = left / a_(i, i);
    }
  }

  Matrix a_;       // R on and above the diagonal, the reflection vectors below
  Vector factor_;  // 0: column k needs no reflection
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
