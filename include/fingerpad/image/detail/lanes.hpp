// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The few vector operations behind the row kernels: load, store, convert, running sum over lanes. A
// thin layer over the vector extensions that GCC and clang share. Vectors are explicit because GCC
// 12 does not vectorise loops of run-time length at -O2. Their width is that of the target
// instruction set, since compilers split wider vectors badly. The width is a template argument
// everywhere, so that translation units compiled for different instruction sets never share a
// function name. If the compiler, byte order or machine is not supported, or the user defines
// FINGERPAD_NO_VECTORS (for the whole program), `native_vector_bytes` is 0 and nothing else is
// declared.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <utility>

namespace fingerpad {
inline namespace v0 {
namespace detail {

#if defined(FINGERPAD_NO_VECTORS) || !defined(__GNUC__) ||                \
    (!defined(__clang__) && __GNUC__ < 12) || !defined(__BYTE_ORDER__) || \
    __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__ || (defined(__i386__) && !defined(__SSE2__))
constexpr int native_vector_bytes = 0;
#else
#define FINGERPAD_HAS_VECTORS
#if defined(__AVX512BW__) && defined(__AVX512VL__)
constexpr int native_vector_bytes = 64;
#elif defined(__AVX2__)
constexpr int native_vector_bytes = 32;
#else
constexpr int native_vector_bytes = 16;
#endif
#endif

#if defined(FINGERPAD_HAS_VECTORS)

/// N numbers of type T in one vector. A struct, because GCC 12 ignores a dependent size in a
/// function-local alias.
template <class T, int N>
struct Lanes {
  using type __attribute__((vector_size(N * sizeof(T)))) = T;
};
template <class T, int N>
using lanes = typename Lanes<T, N>::type;

template <class T, int N>
[[gnu::always_inline]] inline lanes<T, N> load(const T* from) {
  lanes<T, N> v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

template <class T, class V>
[[gnu::always_inline]] inline void store(T* to, V v) {
  std::memcpy(to, &v, sizeof v);
}

/// The same numbers as another type, lane by lane.
template <class To, int N, class V>
[[gnu::always_inline]] inline lanes<To, N> convert(V v) {
  return __builtin_convertvector(v, lanes<To, N>);
}

/// Lanes shifted up by `Step`, filled with zeros.
template <int Step, class V, std::size_t... I>
[[gnu::always_inline]] inline V moved_up(V v, std::index_sequence<I...>) {
  constexpr int n = int(sizeof...(I));
  return __builtin_shufflevector(v, V{}, (int(I) < Step ? n + int(I) : int(I) - Step)...);
}

template <class V, std::size_t... I>
[[gnu::always_inline]] inline V last_everywhere(V v, std::index_sequence<I...>) {
  constexpr int n = int(sizeof...(I));
  return __builtin_shufflevector(v, v, (int(I) * 0 + n - 1)...);
}

/// Lane i becomes the sum of lanes 0..i, modulo the range of T (unsigned).
template <int N, class V, int Step = 1>
[[gnu::always_inline]] inline V running_sum(V v) {
  if constexpr (Step < N) {
    v += moved_up<Step>(v, std::make_index_sequence<std::size_t(N)>{});
    return running_sum<N, V, 2 * Step>(v);
  } else {
    return v;
  }
}

/// True when every bit is 0.
template <class T, int N>
[[gnu::always_inline]] inline bool all_zero(lanes<T, N> v) {
  constexpr int words = N * int(sizeof(T)) / 8;
  using Words = lanes<std::uint64_t, words>;
  const Words w = Words(v);
  if constexpr (words > 2) {
    constexpr int half = words / 2;
    lanes<std::uint64_t, half> low, high;
    std::memcpy(&low, &w, sizeof low);
    std::memcpy(&high, reinterpret_cast<const char*>(&w) + sizeof low, sizeof high);
    return all_zero<std::uint64_t, half>(low | high);
  } else if constexpr (words == 2) {
    return (w[0] | w[1]) == 0;
  } else {
    return w[0] == 0;
  }
}

/// Lane by lane a where `mask` has all bits set, and b where it has none.
template <class V, class M>
[[gnu::always_inline]] inline V choose(M mask, V a, V b) {
  return V((M(a) & mask) | (M(b) & ~mask));
}

/// Two vectors. zip() interleaves the lanes of a and b into them: a0 b0 a1 b1 ...
template <class V>
struct Two {
  V first, second;
};
template <class V, std::size_t... I>
[[gnu::always_inline]] inline Two<V> zip(V a, V b, std::index_sequence<I...>) {
  constexpr int n = int(sizeof...(I));
  return {__builtin_shufflevector(a, b, (int(I) / 2 + int(I) % 2 * n)...),
          __builtin_shufflevector(a, b, (int(I) / 2 + int(I) % 2 * n + n / 2)...)};
}
template <int N, class V>
[[gnu::always_inline]] inline Two<V> zip(V a, V b) {
  return zip(a, b, std::make_index_sequence<std::size_t(N)>{});
}

/// Even and odd lanes, widened to `Wide` (twice as wide) without a shuffle.
template <class Wide, int N, class V>
[[gnu::always_inline]] inline Two<lanes<Wide, N>> unzip_wide(V v) {
  using W = lanes<Wide, N>;
  constexpr int half = 4 * int(sizeof(Wide));
  return {W(v) & (W{} + Wide((Wide(1) << half) - 1)), W(v) >> half};
}

/// 2 N lanes in order, widened to `Wide` (twice as wide).
template <class Wide, int N, class V>
[[gnu::always_inline]] inline Two<lanes<Wide, N>> widen(V v) {
  using W = lanes<Wide, N>;
  const Two<V> both = zip<2 * N>(v, V{});
  return {W(both.first), W(both.second)};
}

/// out[i] = sum of in[0..i], for i < n, a multiple of the lanes in a vector of In.
/// After it `tail` further elements (rounded up to vectors) repeat the total.
/// Sums are modulo the range of Lane: differences up to its maximum remain exact.
template <int Bytes, class In, class Lane>
inline void running_sum_row(const In* in, Lane* out, std::ptrdiff_t n, std::ptrdiff_t tail) {
  constexpr int N = Bytes / int(sizeof(Lane));
  using V = lanes<Lane, N>;
  constexpr auto order = std::make_index_sequence<std::size_t(N)>{};
  V carry{};
  if constexpr (sizeof(In) == sizeof(Lane)) {
    for (std::ptrdiff_t i = 0; i < n; i += N) {
      const V local = running_sum<N>(load<Lane, N>(in + i));
      store(out + i, V(local + carry));
      carry += last_everywhere(local, order);
    }
  } else {  // sums over pairs of columns: half as many lanes
    for (std::ptrdiff_t i = 0; i < n; i += 2 * N) {
      const Two<V> columns = unzip_wide<Lane, N>(load<In, 2 * N>(in + i));
      const V local = running_sum<N>(V(columns.first + columns.second));
      const V odd = local + carry;
      const Two<V> sums = zip<N>(V(odd - columns.second), odd);
      store(out + i, sums.first);
      store(out + i + N, sums.second);
      carry += last_everywhere(local, order);
    }
  }
  for (std::ptrdiff_t i = n; i < n + tail; i += N) {
    store(out + i, carry);
  }
}
#endif

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
