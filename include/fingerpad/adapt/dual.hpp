// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A dual number: a value and its derivatives with respect to N parameters. With it as the scalar,
// every kernel also yields exact derivatives with respect to whatever the caller seeds (colours,
// calibration, camera), and with the covariance of a calibration the variance of a result due to
// calibration errors. adapt/eigen.hpp makes it a scalar of Eigen matrices.
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <limits>

#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v1 {

template <std::size_t N, class Real = double>
struct Dual {
  Real value = Real(0);
  std::array<Real, N> slopes = {};  ///< derivatives by each of the N parameters

  constexpr Dual() = default;
  constexpr Dual(const Real& constant) : value(constant) {}  // NOLINT: implicit, as numbers are
  constexpr Dual(const Real& at, const std::array<Real, N>& by) : value(at), slopes(by) {}

  /// Parameter k of the N, with derivative 1 by itself.
  static constexpr Dual parameter(const Real& at, std::size_t k) {
    Dual x(at);
    x.slopes[k] = Real(1);
    return x;
  }

  /// f(x, y) of value `at`, where df/dx is `by_x` and df/dy is `by_y`.
  static constexpr Dual chain(
      const Real& at, const Real& by_x, const Dual& x, const Real& by_y, const Dual& y) {
    Dual f(at);
    for (std::size_t k = 0; k < N; ++k) {
      f.slopes[k] = by_x * x.slopes[k] + by_y * y.slopes[k];
    }
    return f;
  }
  /// f(x) of value `at`, where df/dx is `slope`.
  static constexpr Dual chain(const Real& at, const Real& slope, const Dual& x) {
    return chain(at, slope, x, Real(0), Dual());
  }

  friend constexpr Dual operator+(const Dual& a) { return a; }
  friend constexpr Dual operator-(const Dual& a) { return chain(-a.value, Real(-1), a); }
  friend constexpr Dual operator+(const Dual& a, const Dual& b) {
    return chain(a.value + b.value, Real(1), a, Real(1), b);
  }
  friend constexpr Dual operator-(const Dual& a, const Dual& b) {
    return chain(a.value - b.value, Real(1), a, Real(-1), b);
  }
  friend constexpr Dual operator*(const Dual& a, const Dual& b) {
    return chain(a.value * b.value, b.value, a, a.value, b);
  }
  friend constexpr Dual operator/(const Dual& a, const Dual& b) {
    const Real quotient = a.value / b.value;
    return chain(quotient, Real(1) / b.value, a, -quotient / b.value, b);
  }
  constexpr Dual& operator+=(const Dual& b) { return *this = *this + b; }
  constexpr Dual& operator-=(const Dual& b) { return *this = *this - b; }
  constexpr Dual& operator*=(const Dual& b) { return *this = *this * b; }
  constexpr Dual& operator/=(const Dual& b) { return *this = *this / b; }
  friend constexpr bool operator==(const Dual& a, const Dual& b) { return a.value == b.value; }
  friend constexpr auto operator<=>(const Dual& a, const Dual& b) { return a.value <=> b.value; }

  // The functions that kernels use, found by argument-dependent look-up.
  friend Dual abs(const Dual& x) { return x.value < Real(0) ? -x : x; }
  friend Dual sqrt(const Dual& x) {
    const Real root = std::sqrt(x.value);
    return chain(root, Real(1) / (root + root), x);
  }
  friend Dual exp(const Dual& x) { return chain(std::exp(x.value), std::exp(x.value), x); }
  friend Dual log(const Dual& x) { return chain(std::log(x.value), Real(1) / x.value, x); }
  friend Dual pow(const Dual& x, const Dual& y) {
    const Real power = std::pow(x.value, y.value);
    return chain(power, y.value * std::pow(x.value, y.value - Real(1)), x,
                 x.value > Real(0) ? power * std::log(x.value) : Real(0), y);
  }
  friend Dual sin(const Dual& x) { return chain(std::sin(x.value), std::cos(x.value), x); }
  friend Dual cos(const Dual& x) { return chain(std::cos(x.value), -std::sin(x.value), x); }
  friend Dual tan(const Dual& x) {
    const Real tangent = std::tan(x.value);
    return chain(tangent, Real(1) + tangent * tangent, x);
  }
  friend Dual acos(const Dual& x) {
    return chain(std::acos(x.value), Real(-1) / std::sqrt(Real(1) - x.value * x.value), x);
  }
  friend Dual atan(const Dual& x) {
    return chain(std::atan(x.value), Real(1) / (Real(1) + x.value * x.value), x);
  }
  friend Dual atan2(const Dual& y, const Dual& x) {
    const Real square = x.value * x.value + y.value * y.value;
    return chain(std::atan2(y.value, x.value), x.value / square, y, -y.value / square, x);
  }
};

template <std::size_t N, class Real>
struct scalar_traits<Dual<N, Real>> {
  using real = Real;
  static constexpr real epsilon() { return (std::numeric_limits<Real>::epsilon)(); }
  static constexpr const real& value(const Dual<N, Real>& x) { return x.value; }
};

/// N parameters as dual numbers: slope k is 1 for parameter k and 0 for the others.
template <class Real, std::size_t N>
constexpr std::array<Dual<N, Real>, N> seeded(const std::array<Real, N>& parameters) {
  std::array<Dual<N, Real>, N> duals;
  for (std::size_t k = 0; k < N; ++k) {
    duals[k] = Dual<N, Real>::parameter(parameters[k], k);
  }
  return duals;
}

/// First-order variance J C J^T of a result, where C(i, j) is the N x N covariance of the seeded
/// parameters. O(N^2).
template <std::size_t N, class Real, class Covariance>
Real carried_variance(const Dual<N, Real>& result, const Covariance& covariance) {
  using At = decltype(covariance.rows());
  Real variance = Real(0);
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < N; ++j) {
      variance +=
          result.slopes[i] * covariance(static_cast<At>(i), static_cast<At>(j)) * result.slopes[j];
    }
  }
  return variance;
}

}  // namespace v1
}  // namespace fingerpad
