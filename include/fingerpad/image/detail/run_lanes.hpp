// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// One formula along a run of cells whose memory goes on past its end by at least a vector: whole
// vectors only. A kernel is written once for V, which is a vector of S, or S itself where there
// are none.
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/row_lanes.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

template <class S>
using run_vector = typename RowVector<S, row_lanes<S>>::type;

/// A run is worked through by so many cells at a time.
template <class S>
inline constexpr Index run_step = row_lanes<S>;

/// By so many cells a kernel on `run_vector<S>` may read and write past the end of a run.
template <class S>
inline constexpr Index run_overhang = row_lanes<S> - 1;

/// Where `condition` a, else b.
template <scalar S>
S choose(bool condition, const S& a, const S& b) {
  return condition ? a : b;
}

/// Where `condition` a, else 0.
template <scalar S>
S only_where(bool condition, const S& a) {
  return condition ? a : S(0);
}

template <scalar S>
S sum_of_lanes(const S& v) {
  return v;
}
template <scalar S>
S largest_lane(const S& v) {
  return v;
}
#if defined(FINGERPAD_HAS_VECTORS)
template <class V, class M>
  requires(!scalar<V>)
[[gnu::always_inline]] inline V only_where(M mask, const V& a) {
  return V(M(a) & mask);
}
template <class S, class V>
  requires(!scalar<V>)
S sum_of_lanes(const V& v) {
  S sum = v[0];
  for (int i = 1; i < lanes_in<V, S>; ++i) {
    sum += v[i];
  }
  return sum;
}
template <class S, class V>
  requires(!scalar<V>)
S largest_lane(const V& v) {
  S largest = v[0];
  for (int i = 1; i < lanes_in<V, S>; ++i) {
    largest = largest < v[i] ? v[i] : largest;
  }
  return largest;
}
#endif

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
