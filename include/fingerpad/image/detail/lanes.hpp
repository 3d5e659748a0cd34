// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Applies one formula along a row: by vectors for float, else cell by cell. Both ways compute a
// cell alike. A thin layer over the vector extensions that GCC and clang share; vectors are
// explicit where GCC 12 does not vectorise plain loops (see docs/design.md). Their width is that of
// the target instruction set, since compilers split wider vectors badly: compile a whole program
// for one instruction set. If the compiler, byte order or machine is not supported, or the user
// defines FINGERPAD_NO_VECTORS (for the whole program), everything goes cell by cell.
#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

#if !defined(FINGERPAD_NO_VECTORS) && defined(__GNUC__) &&               \
    (defined(__clang__) || __GNUC__ >= 12) && defined(__BYTE_ORDER__) && \
    __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__ && (!defined(__i386__) || defined(__SSE2__))
#define FINGERPAD_HAS_VECTORS
#endif

namespace fingerpad {
inline namespace v1 {
namespace detail {

/// The number of lanes of S in a vector; 1 if there are no vectors of S.
template <class S>
inline constexpr int row_lanes = 1;
#if !defined(FINGERPAD_HAS_VECTORS)
#elif defined(__AVX512BW__) && defined(__AVX512VL__)
template <>
inline constexpr int row_lanes<float> = 16;
#elif defined(__AVX2__)
template <>
inline constexpr int row_lanes<float> = 8;
#else
template <>
inline constexpr int row_lanes<float> = 4;
#endif

/// N numbers S in one vector, or S itself. A struct, because GCC 12 ignores a dependent size in a
/// function-local alias.
template <class S, int N>
struct RowVector {
#if defined(FINGERPAD_HAS_VECTORS)
  using type __attribute__((vector_size(N * sizeof(S)))) = S;
#endif
};
template <class S>
struct RowVector<S, 1> {
  using type = S;
};
template <class S, int N>
using lanes = typename RowVector<S, N>::type;

/// The number of lanes of V, a vector of S or S itself.
template <class V, class S>
inline constexpr int lanes_in = static_cast<int>(sizeof(V) / sizeof(S));

template <class V, class T>
[[gnu::always_inline]] inline V load(const T* from) {
  V v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
template <class T, class V>
[[gnu::always_inline]] inline void store(T* to, V v) {
  std::memcpy(to, &v, sizeof v);
}

/// v converted to `To`, a number or a vector with as many lanes.
template <class To, class V>
[[gnu::always_inline]] inline To each_as(const V& v) {
  if constexpr (std::is_arithmetic_v<V>) {
    return static_cast<To>(v);
  } else {
    return __builtin_convertvector(v, To);
  }
}

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
template <class V, class S>
[[gnu::always_inline]] inline V load_cells(const S* from) {
  if constexpr (std::same_as<V, S>) {
    return *from;
  } else {
    return load<V>(from);
  }
}

/// Stores the cells of v in to[0], to[1], ..., truncated if T is a byte.
template <class S, class V, class T>
[[gnu::always_inline]] inline void store_cells(T* to, const V& v) {
  if constexpr (std::same_as<V, S> && std::same_as<T, std::uint8_t>) {
    *to = static_cast<T>(value(v));
  } else if constexpr (std::same_as<V, S>) {
    *to = v;
  } else if constexpr (std::same_as<S, T>) {
    store(to, v);
  } else {  // by a factor of two at a time: machines have instructions for these steps
    constexpr int n = lanes_in<V, S>;
    const auto words = each_as<lanes<std::int32_t, n>>(v);
    store(to, each_as<lanes<T, n>>(each_as<lanes<std::uint16_t, n>>(words)));
  }
}

/// True if any lane of a comparison is true.
template <class Mask>
[[gnu::always_inline]] inline bool any_lane(const Mask& mask) {
  if constexpr (std::same_as<Mask, bool>) {
    return mask;
  } else {
    std::uint64_t any = 0;
    for (std::size_t at = 0; at < sizeof(Mask); at += 8) {
      any |= load<std::uint64_t>(reinterpret_cast<const char*>(&mask) + at);
    }
    return any != 0;
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

/// Calls kernel.operator()<V>(j) for j in [0, count) in steps of V's n lanes, with V = S for the
/// rest. Always inlined, since a call would reload the kernel's captures for each vector. A large
/// kernel must therefore be marked always_inline, too.
template <class S, int n = row_lanes<S>, class Kernel>
[[gnu::always_inline]] inline void for_each_cell(Index count, const Kernel& kernel) {
  Index j = 0;
  if constexpr (n > 1) {
    for (; j + n <= count; j += n) {
      kernel.template operator()<lanes<S, n>>(j);
    }
  }
  for (; j < count; ++j) {
    kernel.template operator()<S>(j);
  }
}

/// Whether View holds cells S in memory, so that vectors can be loaded from rows whose cells are
/// adjacent.
template <class View, class S>
inline constexpr bool plain_rows = false;
template <class T, class S>
  requires(std::same_as<std::remove_const_t<T>, S>)
inline constexpr bool plain_rows<StridedView<T>, S> = true;

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
  if constexpr (plain_rows<View, S>) {
    if (view.col_stride() == 1) {
      std::copy_n(from, view.cols(), view.row(row));
      return;
    }
  }
  for (Index j = 0; j < view.cols(); ++j) {
    view(row, j) = static_cast<cell_t<View>>(from[j]);
  }
}

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
