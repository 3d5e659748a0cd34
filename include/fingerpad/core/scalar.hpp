// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Vocabulary: what a number is, and the version of the library. Every kernel is written once for
// any `scalar`: float, double, long double, a multiprecision number, or a dual number that carries
// derivatives. Rules for code on scalars: call mathematics unqualified after `using std::exp;`,
// write constants as S(2) or from scalar_traits, and branch on value(x).
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <type_traits>

#if !defined(_MSVC_LANG) && __cplusplus < 202002L
#error "fingerpad needs C++20: compile with -std=c++20"
#include "compile_with_-std=c++20"  // no such file: compilation ends here
#endif
#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
#error "fingerpad marks missing data by NaN: compile without -ffast-math or -ffinite-math-only"
#endif
#if defined(__ASSOCIATIVE_MATH__)  // defined by GCC 12, not by clang
#error "fingerpad needs a fixed order of sums: compile without -ffast-math or -fassociative-math"
#endif

#define FINGERPAD_VERSION_MAJOR 0
#define FINGERPAD_VERSION_MINOR 2
#define FINGERPAD_VERSION_PATCH 0
#define FINGERPAD_VERSION \
  (FINGERPAD_VERSION_MAJOR * 10000 + FINGERPAD_VERSION_MINOR * 100 + FINGERPAD_VERSION_PATCH)

namespace fingerpad {
inline namespace v1 {

/// A count or a place. Signed, as Eigen::Index: strides may be negative and differences need no
/// cast.
using Index = std::ptrdiff_t;

/// What the library needs to know about a number type beyond its arithmetic; specialise it for your
/// own type.
///   real       the plain number in which thresholds are stated
///   epsilon()  relative spacing of `real`
///   value(x)   x as a `real`, without derivatives, for branches
/// The primary template serves every type with its own std::numeric_limits. A dual number has none
/// (the unspecialised one silently returns 0), so it needs its own traits: see adapt/dual.hpp.
template <class S>
struct scalar_traits {
  static_assert(std::numeric_limits<S>::is_specialized,
                "this number type has no std::numeric_limits: specialise fingerpad::scalar_traits");
  using real = S;
  static constexpr real epsilon() { return (std::numeric_limits<S>::epsilon)(); }
  static constexpr const real& value(const S& x) { return x; }
};

/// A number that behaves as a real one: copyable, built from an int and a double, ordered, and
/// closed under + - * /: the result is an S and not an expression.
/// Models: float, double, long double, boost::multiprecision::number with et_off, Dual.
template <class S>
concept scalar = std::copyable<S> && !std::integral<S> && std::constructible_from<S, double> &&
                 std::constructible_from<S, int> && requires(const S a, const S b) {
  { a + b } -> std::same_as<S>;
  { a - b } -> std::same_as<S>;
  { a* b } -> std::same_as<S>;
  { a / b } -> std::same_as<S>;
  { -a } -> std::same_as<S>;
  { a < b } -> std::convertible_to<bool>;
};

template <class S>
using scalar_real_t = typename scalar_traits<S>::real;

/// x without its derivatives, as the plain number on which branches are taken. Its type is `auto`,
/// because a compiler may look at it before it asks whether S is a scalar.
template <scalar S>
constexpr auto value(const S& x) {
  return scalar_traits<S>::value(x);
}

/// Relative spacing of the real type behind S. Rounding thresholds are multiples of it.
template <scalar S>
constexpr scalar_real_t<S> epsilon() {
  return scalar_traits<S>::epsilon();
}

/// NaN, which marks a missing value.
template <scalar S>
constexpr S not_a_number() {
  return S((std::numeric_limits<scalar_real_t<S>>::quiet_NaN)());
}

/// False for NaN and for both infinities.
template <scalar S>
constexpr bool is_finite(const S& x) {
  const scalar_real_t<S> v = value(x);
  return v - v == scalar_real_t<S>(0);
}

/// Whether x can be a measurement: below a million in magnitude, whatever its unit (mm, px, N, N
/// mm, MPa, rad). Squares and products of such numbers are finite in every scalar. False for NaN
/// and for both infinities.
template <scalar S>
constexpr bool is_plausible(const S& x) {
  const scalar_real_t<S> bound(1000000);
  return -bound < value(x) && value(x) < bound;
}

template <scalar S>
constexpr S square(const S& x) {
  return x * x;
}

}  // namespace v1
}  // namespace fingerpad
