// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A force or moment as an odd polynomial of something displaced or turned, normalised by a power of
// the contact's measure: y = sum over k of c_k (u |x|)^(k-1) u x, u = (measure / reference)^T. The
// exponent T is found by a search along it, then together with the coefficients.
#include <Eigen/QR>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "fingerpad/calibrate/model_fit.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

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
    coefficients = Eigen::HouseholderQR<Matrix>(a).solve(b);
    const Vector left = b - a * coefficients;
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
