// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Number types of the tests besides float, double and long double: fifty digits as the reference,
// and a dual number that differs from the library's own.
#include <bit>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "fingerpad/core/scalar.hpp"

namespace test {

namespace mp = boost::multiprecision;
using Digits50 = mp::number<mp::cpp_bin_float<50>, mp::et_off>;

/// Whether two numbers are both NaN, or at most so many numbers of their type apart.
template <class S>
bool within_ulps(S a, S b, int ulps) {
  using Bits = std::conditional_t<sizeof(S) == 4, std::int32_t, std::int64_t>;
  if (a != a || b != b) {
    return a != a && b != b;
  }
  if (a == b || std::signbit(a) != std::signbit(b)) {
    return a == b;
  }
  const Bits apart = std::bit_cast<Bits>(a) - std::bit_cast<Bits>(b);
  return apart >= -ulps && apart <= ulps;
}

/// A number and its derivative with respect to one seed.
template <class Real>
struct Dual {
  Real v = Real(0);
  Real d = Real(0);

  Dual() = default;
  Dual(Real value) : v(value) {}  // NOLINT: implicit, as numbers are
  Dual(Real value, Real slope) : v(value), d(slope) {}

  friend Dual operator-(const Dual& a) { return {-a.v, -a.d}; }
  friend Dual operator+(const Dual& a, const Dual& b) { return {a.v + b.v, a.d + b.d}; }
  friend Dual operator-(const Dual& a, const Dual& b) { return {a.v - b.v, a.d - b.d}; }
  friend Dual operator*(const Dual& a, const Dual& b) { return {a.v * b.v, a.d * b.v + a.v * b.d}; }
  friend Dual operator/(const Dual& a, const Dual& b) {
    return {a.v / b.v, (a.d - a.v / b.v * b.d) / b.v};
  }
  Dual& operator+=(const Dual& b) { return *this = *this + b; }
  friend bool operator<(const Dual& a, const Dual& b) { return a.v < b.v; }
  friend bool operator>(const Dual& a, const Dual& b) { return a.v > b.v; }
  friend bool operator==(const Dual& a, const Dual& b) { return a.v == b.v; }
  friend Dual exp(const Dual& a) {
    using std::exp;
    const Real e = exp(a.v);
    return {e, e * a.d};
  }
  friend Dual sqrt(const Dual& a) {
    using std::sqrt;
    const Real r = sqrt(a.v);
    return {r, a.d / (r + r)};
  }
};

/// f'(x) by the dual number.
template <class Real, class F>
Real slope_by_dual(const F& f, Real x) {
  return f(Dual<Real>(x, Real(1))).d;
}

/// f'(x) by central differences. A step of about epsilon^(1/3) gives a precision of about
/// epsilon^(2/3).
template <class Real, class F>
Real slope_by_difference(const F& f, const Real& x, const Real& step) {
  return Real((f(Real(x + step)) - f(Real(x - step))) / (step + step));
}

/// |a - b| relative to |b|.
template <class Real>
Real relative_error(const Real& a, const Real& b) {
  using std::abs;
  return a == b ? Real(0) : Real(abs(Real(a - b)) / abs(b));
}

}  // namespace test

template <class Real>
struct fingerpad::scalar_traits<test::Dual<Real>> {
  using real = Real;
  static constexpr Real epsilon() { return (std::numeric_limits<Real>::epsilon)(); }
  static const Real& value(const test::Dual<Real>& x) { return x.v; }
};
