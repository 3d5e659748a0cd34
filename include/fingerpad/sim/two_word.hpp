// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Twice the digits of a number, as the sum of two of them. A phase of 10^4 rad is known to 10^-12
// rad only if it is carried with more digits than a double has. Sums after Knuth, products by one
// fused multiply-add; Dekker, "A floating-point technique for extending the available precision".
#include <cmath>
#include <concepts>
#include <limits>
#include <type_traits>

#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {
namespace foam {

/// hi + lo, where hi is the sum rounded. Of an overflow lo is 0. exp, sin, cos answer in one word.
template <std::floating_point S>
struct TwoWord {
  S hi = S(0);
  S lo = S(0);

  TwoWord() = default;
  template <class T>
    requires std::is_arithmetic_v<T>
  constexpr explicit TwoWord(T x) : hi(static_cast<S>(x)) {}
  constexpr TwoWord(S high, S low) : hi(high), lo(low) {}

  constexpr explicit operator S() const { return hi; }

  friend TwoWord operator-(const TwoWord& a) { return {-a.hi, -a.lo}; }
  friend TwoWord operator+(const TwoWord& a, const TwoWord& b) {
    const TwoWord heads = sum(a.hi, b.hi);
    return renormed(heads.hi, heads.lo + (a.lo + b.lo));
  }
  friend TwoWord operator-(const TwoWord& a, const TwoWord& b) { return a + (-b); }
  friend TwoWord operator*(const TwoWord& a, const TwoWord& b) {
    const TwoWord heads = product(a.hi, b.hi);
    return is_finite(heads.hi) ? renormed(heads.hi, heads.lo + (a.hi * b.lo + a.lo * b.hi)) : heads;
  }
  friend TwoWord operator/(const TwoWord& a, const TwoWord& b) {
    const S quotient = a.hi / b.hi;
    if (!is_finite(quotient) || !is_finite(b.hi)) {
      return TwoWord(quotient);
    }
    const TwoWord left = a - TwoWord(quotient) * b;
    return renormed(quotient, left.hi / b.hi);
  }
  friend bool operator<(const TwoWord& a, const TwoWord& b) {
    return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo);
  }
  friend bool operator==(const TwoWord& a, const TwoWord& b) {
    return a.hi == b.hi && a.lo == b.lo;
  }

  friend TwoWord sqrt(const TwoWord& a) {
    const S root = std::sqrt(a.hi);
    if (!(root > S(0)) || !is_finite(root)) {
      return TwoWord(root);
    }
    const TwoWord left = a - product(root, root);
    return renormed(root, left.hi / (root + root));
  }
  friend S exp(const TwoWord& a) {
    const S power = std::exp(a.hi);
    return is_finite(power) ? power + power * a.lo : power;
  }
  friend S sin(const TwoWord& a) {
    return std::sin(a.hi) * std::cos(a.lo) + std::cos(a.hi) * std::sin(a.lo);
  }
  friend S cos(const TwoWord& a) {
    return std::cos(a.hi) * std::cos(a.lo) - std::sin(a.hi) * std::sin(a.lo);
  }

 private:
  static TwoWord sum(S a, S b) {
    const S s = a + b;
    const S from_b = s - a;
    return {s, is_finite(s) ? (a - (s - from_b)) + (b - from_b) : S(0)};
  }
  static TwoWord product(S a, S b) {
    const S p = rounded_product(a, b);
    return {p, is_finite(p) ? std::fma(a, b, -p) : S(0)};
  }
  /// Where products can be fused into sums the compiler may do so with a * b, and a rounding that
  /// lo already holds would be taken twice; it leaves this one alone.
  static S rounded_product(S a, S b) {
#if defined(FP_FAST_FMA)
    return std::fma(a, b, S(0));
#else
    return a * b;
#endif
  }
  /// For |low| far below |high|.
  static TwoWord renormed(S high, S low) {
    const S s = high + low;
    return {s, is_finite(s) ? low - (s - high) : S(0)};
  }
};

/// The number to compute in where one of S has too few digits; S itself where it is not a built-in
/// one (of many digits, or with derivatives).
template <class S>
struct wide {
  using type = S;
};
template <>
struct wide<float> {
  using type = double;
};
template <>
struct wide<double> {
  using type = TwoWord<double>;
};
template <>
struct wide<long double> {
  using type = TwoWord<long double>;
};
template <class S>
using wide_t = typename wide<S>::type;

/// In which functions of a wide number answer.
template <class W>
struct narrow {
  using type = W;
};
template <class S>
struct narrow<TwoWord<S>> {
  using type = S;
};
template <class W>
using narrow_t = typename narrow<W>::type;

}  // namespace foam
}  // namespace detail

template <class S>
struct scalar_traits<detail::foam::TwoWord<S>> {
  using real = S;
  static constexpr real epsilon() {
    const S one_word = (std::numeric_limits<S>::epsilon)();
    return one_word * one_word;
  }
  static constexpr const real& value(const detail::foam::TwoWord<S>& x) { return x.hi; }
};

}  // namespace v0
}  // namespace fingerpad
