// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Two powers of each number of a row, which share one logarithm. For float and double vector code
// in double: x^t = exp(t log x), with log from the odd series of (m - 1)/(m + 1) for m within
// [1/sqrt 2, sqrt 2], and exp from its series within half a doubling. Every other scalar uses its
// own functions.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

#if defined(FINGERPAD_HAS_VECTORS)
/// A whole number in a double as an integer lane, and back, by the place where a double's last bit
/// counts 1: without AVX-512 there is no instruction for it.
constexpr double whole_shift = 6755399441055744.0;  // 1.5 * 2^52

/// log x for normal x > 0; relative error 1e-15 but near 1, where it is absolute.
template <class V>
[[gnu::always_inline]] inline V log_of(const V& x) {
  using Bits = lanes<std::int64_t, static_cast<int>(sizeof(V) / 8)>;
  const Bits root_half = Bits{} + std::int64_t{0x3FE6A09E667F3BCD};
  const Bits doublings = (Bits(x) - root_half) >> 52;
  const V m = V(Bits(x) - (doublings << 52));
  const V exponent = V(doublings + Bits(V{} + whole_shift)) - whole_shift;
  const V t = (m - 1.0) / (m + 1.0);
  const V u = t * t;
  V p = V{} + 2.0 / 21;
  p = p * u + 2.0 / 19;
  p = p * u + 2.0 / 17;
  p = p * u + 2.0 / 15;
  p = p * u + 2.0 / 13;
  p = p * u + 2.0 / 11;
  p = p * u + 2.0 / 9;
  p = p * u + 2.0 / 7;
  p = p * u + 2.0 / 5;
  p = p * u + 2.0 / 3;
  p = p * u + 2.0;
  return exponent * 0.69314718055994530942 + t * p;
}

/// exp y, with y held within [-700, 700]; relative error 1e-15 and what y itself is off by.
template <class V>
[[gnu::always_inline]] inline V exp_of(const V& y) {
  using Bits = lanes<std::int64_t, static_cast<int>(sizeof(V) / 8)>;
  const V low = V{} - 700.0, high = V{} + 700.0;
  const V above = choose(Bits(y > low), y, low);
  const V held = choose(Bits(above < high), above, high);
  const V shifted = held * 1.44269504088896340736 + whole_shift;
  const V doublings = shifted - whole_shift;
  const V f = (held - doublings * 0.693147180369123816490) - doublings * 1.90821492927058770002e-10;
  V p = V{} + 1.0 / 479001600;
  p = p * f + 1.0 / 39916800;
  p = p * f + 1.0 / 3628800;
  p = p * f + 1.0 / 362880;
  p = p * f + 1.0 / 40320;
  p = p * f + 1.0 / 5040;
  p = p * f + 1.0 / 720;
  p = p * f + 1.0 / 120;
  p = p * f + 1.0 / 24;
  p = p * f + 1.0 / 6;
  p = p * f + 0.5;
  p = p * f + 1.0;
  p = p * f + 1.0;
  return V(Bits(p) + (Bits(shifted) << 52));
}

/// Powers of Bytes / 8 numbers; 0 for those that are not > 0, and none beyond exp(700).
template <int Bytes, class S>
[[gnu::always_inline]] inline void power_lanes(
    const S* x, double factor, double s, double t, S* power_s, S* power_t) {
  constexpr int n = Bytes / 8;
  using V = lanes<double, n>;
  using Bits = lanes<std::int64_t, n>;
  const V number = convert<double, n>(load<S, n>(x));
  const V given = number * factor;
  const V least = V{} + 1e-290, zero{};
  const Bits positive = Bits(number > zero);
  const V log_x = log_of<V>(choose(Bits(given > least), given, least));
  store(power_s, convert<S, n>(choose(positive, exp_of<V>(log_x * s), zero)));
  store(power_t, convert<S, n>(choose(positive, exp_of<V>(log_x * t), zero)));
}
#endif

/// power_s[i] = (x[i] factor)^s and power_t[i] likewise, 0 where x[i] is not > 0, for i < n.
template <scalar S>
void power_rows(
    const S* x, std::size_t n, const S& factor, const S& s, const S& t, S* power_s, S* power_t) {
  using std::exp;
  using std::log;
  std::size_t i = 0;
#if defined(FINGERPAD_HAS_VECTORS)
  if constexpr (std::is_same_v<S, double> || std::is_same_v<S, float>) {
    constexpr std::size_t step = native_vector_bytes / 8;
    for (; i + step <= n; i += step) {
      power_lanes<native_vector_bytes>(x + i, static_cast<double>(factor), static_cast<double>(s),
                                       static_cast<double>(t), power_s + i, power_t + i);
    }
  }
#endif
  for (; i < n; ++i) {
    const bool positive = value(x[i]) > 0;
    const S given = positive ? S(x[i] * factor) : S(1);
    const S log_x = log(given);
    power_s[i] = positive ? S(exp(S(s * log_x))) : S(0);
    power_t[i] = positive ? S(exp(S(t * log_x))) : S(0);
  }
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
