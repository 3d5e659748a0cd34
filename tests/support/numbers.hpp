// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Number types of the tests besides float, double and long double: fifty digits as the reference,
// and a number with one derivative that is not the library's own Dual.
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
struct Tangent {
  Real v = Real(0);
  Real d = Real(0);

  Tangent() = default;
  Tangent(Real value) : v(value) {}  // NOLINT: implicit, as numbers are
  Tangent(Real value, Real slope) : v(value), d(slope) {}

  friend Tangent operator-(const Tangent& a) { return {-a.v, -a.d}; }
  friend Tangent operator+(const Tangent& a, const Tangent& b) { return {a.v + b.v, a.d + b.d}; }
  friend Tangent operator-(const Tangent& a, const Tangent& b) { return {a.v - b.v, a.d - b.d}; }
  friend Tangent operator*(const Tangent& a, const Tangent& b) {
    return {a.v * b.v, a.d * b.v + a.v * b.d};
  }
  friend Tangent operator/(const Tangent& a, const Tangent& b) {
    return {a.v / b.v, (a.d - a.v / b.v * b.d) / b.v};
  }
  Tangent& operator+=(const Tangent& b) { return *this = *this + b; }
  friend bool operator<(const Tangent& a, const Tangent& b) { return a.v < b.v; }
  friend bool operator>(const Tangent& a, const Tangent& b) { return a.v > b.v; }
  friend bool operator==(const Tangent& a, const Tangent& b) { return a.v == b.v; }
  friend Tangent exp(const Tangent& a) {
    using std::exp;
    const Real e = exp(a.v);
    return {e, e * a.d};
  }
  friend Tangent sqrt(const Tangent& a) {
    using std::sqrt;
    const Real r = sqrt(a.v);
    return {r, a.d / (r + r)};
  }
};

/// f'(x) by the dual number.
template <class Real, class F>
Real slope_by_tangent(const F& f, Real x) {
  return f(Tangent<Real>(x, Real(1))).d;
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
struct fingerpad::scalar_traits<test::Tangent<Real>> {
  using real = Real;
  static constexpr Real epsilon() { return (std::numeric_limits<Real>::epsilon)(); }
  static const Real& value(const test::Tangent<Real>& x) { return x.v; }
};
