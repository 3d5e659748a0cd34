// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// One formula, applied along a row: by vectors where the scalar is float or double and the compiler
// has them, else one by one. Every cell is computed alike, whichever way it is reached.
#include <concepts>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/image/detail/lanes.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// The number of S in a vector of VectorBytes; 1 where there are no vectors of S.
template <class S, int VectorBytes = native_vector_bytes>
inline constexpr int row_lanes = 1;
template <class S, int VectorBytes>
  requires(VectorBytes > 0 && (std::same_as<S, float> || std::same_as<S, double>))
inline constexpr int row_lanes<S, VectorBytes> = VectorBytes / static_cast<int>(sizeof(S));

/// A vector of N numbers S, or S itself.
template <class S, int N>
struct RowVector;
template <class S>
struct RowVector<S, 1> {
  using type = S;
};

/// x in every lane; x itself without lanes (empty braces leave some dual numbers undefined).
template <class V, class S>
[[gnu::always_inline]] inline V every_lane(const S& x) {
  if constexpr (scalar<V>) {
    return V(x);
  } else {
    return V{} + x;
  }
}

/// Cells from[0], from[1], ... as one V of S.
template <class V, class S, class T>
  requires(std::same_as<V, S>)
V load_cells(const T* from) {
  return static_cast<S>(*from);
}

/// The cells of v, truncated to T where T is an integer, to to[0], to[1], ...
template <class S, class V, class T>
  requires(std::same_as<V, S>)
void store_cells(T* to, const V& v) {
  if constexpr (std::integral<T>) {
    *to = static_cast<T>(value(v));
  } else {
    *to = static_cast<T>(v);
  }
}

template <class V, class S>
inline constexpr int lanes_in = static_cast<int>(sizeof(V) / sizeof(S));

#if defined(FINGERPAD_HAS_VECTORS)
template <class S, int N>
  requires(N > 1)
struct RowVector<S, N> {
  using type = lanes<S, N>;
};

/// Integers that widen or narrow by a factor of two at a time, for which machines have
/// instructions and GCC 12 uses them.
template <class T> concept narrow_integer = std::unsigned_integral<T> && sizeof(T) <= 2;

template <class V, class S, class T>
  requires(!std::same_as<V, S>)
[[gnu::always_inline]] inline V load_cells(const T* from) {
  constexpr int n = lanes_in<V, S>;
  const lanes<T, n> cells = load<T, n>(from);
  if constexpr (narrow_integer<T>) {
    return convert<S, n>(convert<std::int32_t, n>(convert<std::uint16_t, n>(cells)));
  } else {
    return convert<S, n>(cells);
  }
}

template <class S, class V, class T>
  requires(!std::same_as<V, S>)
[[gnu::always_inline]] inline void store_cells(T* to, const V& v) {
  constexpr int n = lanes_in<V, S>;
  if constexpr (narrow_integer<T>) {
    store(to, convert<T, n>(convert<std::uint16_t, n>(convert<std::int32_t, n>(v))));
  } else {
    store(to, convert<T, n>(v));
  }
}

#endif

/// True when some lane of a comparison is.
template <class Mask>
[[gnu::always_inline]] inline bool any_lane(const Mask& mask) {
  if constexpr (std::same_as<Mask, bool>) {
    return mask;
  } else {
    using Word = std::remove_cvref_t<decltype(Mask{}[0])>;
    return !all_zero<Word, static_cast<int>(sizeof(Mask) / sizeof(Word))>(mask);
  }
}

/// Whether rows hold S in memory, which vectors can be loaded from where cells lie side by side.
template <class View, class S>
inline constexpr bool plain_rows = false;
template <class T, class S>
  requires(std::same_as<std::remove_const_t<T>, S>)
inline constexpr bool plain_rows<StridedView<T>, S> = true;

/// Calls kernel.operator()<V>(j) for j in [0, count) in steps of V's lanes, V = S at the end.
template <class S, int VectorBytes = native_vector_bytes, class Kernel>
void for_each_cell(Index count, const Kernel& kernel) {
  constexpr int n = row_lanes<S, VectorBytes>;
  Index j = 0;
  if constexpr (n > 1) {
    for (; j + n <= count; j += n) {
      kernel.template operator()<typename RowVector<S, n>::type>(j);
    }
  }
  for (; j < count; ++j) {
    kernel.template operator()<S>(j);
  }
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
