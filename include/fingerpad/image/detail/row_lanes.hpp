// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Applies one formula along a row: by vectors for float, double and unsigned integers if the
// compiler has them, else cell by cell. Both ways compute a cell alike.
#include <algorithm>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/image/detail/lanes.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// The number of lanes of S in a vector of VectorBytes; 1 if there are no vectors of S.
template <class S, int VectorBytes = native_vector_bytes>
inline constexpr int row_lanes = 1;
template <class S, int VectorBytes>
  requires(VectorBytes > 0 &&
           (std::same_as<S, float> || std::same_as<S, double> || std::unsigned_integral<S>))
inline constexpr int row_lanes<S, VectorBytes> = VectorBytes / static_cast<int>(sizeof(S));

/// A vector of N numbers S, or S itself.
template <class S, int N>
struct RowVector;
template <class S>
struct RowVector<S, 1> {
  using type = S;
};

/// x in every lane; x itself if V is a scalar (empty braces leave some dual numbers undefined).
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

/// Stores the cells of v in to[0], to[1], ..., truncated if T is an integer.
template <class S, class V, class T>
  requires(std::same_as<V, S>)
void store_cells(T* to, const V& v) {
  if constexpr (std::integral<T> && scalar<S>) {
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

/// Integers that are widened or narrowed by a factor of two at a time. Machines have instructions
/// for these steps, and GCC 12 uses them.
template <class T> concept narrow_integer = std::unsigned_integral<T> && sizeof(T) <= 2;

/// The first four of 16 bytes or of eight 16-bit numbers, as 32-bit ones.
[[gnu::always_inline]] inline lanes<std::uint32_t, 4> first_widened(lanes<std::uint16_t, 8> cells) {
  return widen<std::uint32_t, 4>(cells).first;
}
[[gnu::always_inline]] inline lanes<std::uint32_t, 4> first_widened(lanes<std::uint8_t, 16> cells) {
  return first_widened(widen<std::uint16_t, 8>(cells).first);
}

template <class V, class S, class T>
  requires(!std::same_as<V, S>)
[[gnu::always_inline]] inline V load_cells(const T* from) {
  constexpr int n = lanes_in<V, S>;
  if constexpr (std::same_as<S, T>) {
    return load<T, n>(from);
  } else if constexpr (narrow_integer<T> && n == 4) {  // avoids a general register in GCC 12
    std::uint64_t word = 0;
    std::memcpy(&word, from, n * sizeof(T));
    const lanes<std::uint64_t, 2> words{word, 0};
    const auto cells = lanes<T, 16 / static_cast<int>(sizeof(T))>(words);
    return convert<S, n>(lanes<std::int32_t, n>(first_widened(cells)));
  } else if constexpr (narrow_integer<T>) {
    const lanes<T, n> cells = load<T, n>(from);
    return convert<S, n>(convert<std::int32_t, n>(convert<std::uint16_t, n>(cells)));
  } else {
    return convert<S, n>(load<T, n>(from));
  }
}

template <class S, class V, class T>
  requires(!std::same_as<V, S>)
[[gnu::always_inline]] inline void store_cells(T* to, const V& v) {
  constexpr int n = lanes_in<V, S>;
  if constexpr (std::same_as<S, T>) {
    store(to, v);
  } else if constexpr (narrow_integer<T>) {
    store(to, convert<T, n>(convert<std::uint16_t, n>(convert<std::int32_t, n>(v))));
  } else {
    store(to, convert<T, n>(v));
  }
}

#endif

/// True if any lane of a comparison is true.
template <class Mask>
[[gnu::always_inline]] inline bool any_lane(const Mask& mask) {
  if constexpr (std::same_as<Mask, bool>) {
    return mask;
  } else {
    using Word = std::remove_cvref_t<decltype(Mask{}[0])>;
    return !all_zero<Word, static_cast<int>(sizeof(Mask) / sizeof(Word))>(mask);
  }
}

/// True where x is not NaN.
template <class V>
[[gnu::always_inline]] inline auto known(const V& x) {
  if constexpr (scalar<V>) {
    return value(x) == value(x);
  } else {
    return x == x;
  }
}

/// Whether View holds cells S in memory, so that vectors can be loaded from rows whose cells are
/// adjacent.
template <class View, class S>
inline constexpr bool plain_rows = false;
template <class T, class S>
  requires(std::same_as<std::remove_const_t<T>, S>)
inline constexpr bool plain_rows<StridedView<T>, S> = true;

/// v converted to `To`, a number or a vector with as many lanes.
template <class To, class V>
[[gnu::always_inline]] inline To each_as(const V& v) {
  if constexpr (std::is_arithmetic_v<V>) {
    return static_cast<To>(v);
  } else {
    return __builtin_convertvector(v, To);
  }
}

/// Row i of a grid as contiguous numbers S: in place if possible, else copied to `spare`.
template <class S, class View>
const S* row_of(const View& from, Index i, S* spare) {
  if constexpr (plain_rows<View, S>) {
    if (from.col_stride() == 1) {
      return from.row(i);
    }
  }
  for (Index j = 0; j < from.cols(); ++j) {
    spare[j] = S(from(i, j));
  }
  return spare;
}

/// Writes numbers to a row of a grid.
template <class S, class View>
void store_row(const S* from, const View& view, Index row) {
  for (Index j = 0; j < view.cols(); ++j) {
    view(row, j) = static_cast<cell_t<View>>(from[j]);
  }
}
template <class S>
void store_row(const S* from, const StridedView<S>& view, Index row) {
  if (view.col_stride() == 1) {
    std::copy_n(from, view.cols(), view.row(row));
    return;
  }
  for (Index j = 0; j < view.cols(); ++j) {
    view(row, j) = from[j];
  }
}

/// Calls kernel.operator()<V>(j) for j in [0, count) in steps of V's lanes, with V = S for the
/// rest. Always inlined, since a call would reload the kernel's captures for each vector. A large
/// kernel must therefore be marked always_inline, too.
template <class S, int VectorBytes = native_vector_bytes, class Kernel>
[[gnu::always_inline]] inline void for_each_cell(Index count, const Kernel& kernel) {
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
