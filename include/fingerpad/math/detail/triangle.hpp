// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Least squares of many rows and a few columns by Householder reflections, for every scalar.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {
namespace detail {

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
