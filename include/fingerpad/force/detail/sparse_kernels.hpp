// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Dense kernels of the sparse solver: products taken away from a block, and the Cholesky factor of
// the first columns of one. Blocks are stored column by column; every count is even.
//
// Written out because Eigen's products take memory from the heap for their packed operands, and
// because they must serve every scalar.
#include <cmath>
#include <cstddef>
#include <type_traits>

#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail::membrane {

/// Numbers of a machine vector; 1: none.
template <class R, int Bytes>
constexpr int lanes_of() {
  if constexpr (std::is_same_v<R, double> || std::is_same_v<R, float>) {
    return Bytes >= 16 ? Bytes / int(sizeof(R)) : 1;
  } else {
    return 1;
  }
}

#if defined(FINGERPAD_HAS_VECTORS)
/// c -= a b^T for `Vectors` vectors of N rows by `Cols` columns, kept in registers.
template <class R, int N, std::size_t Vectors, std::size_t Cols>
inline void subtract_tile(
    R* c, std::size_t c_step, const R* a, const R* b, std::size_t step, std::size_t depth) {
  using V = lanes<R, N>;
  constexpr auto n = std::size_t(N);
  V kept[Cols][Vectors];
  for (std::size_t k = 0; k < Cols; ++k) {
    for (std::size_t v = 0; v < Vectors; ++v) {
      kept[k][v] = load<R, N>(c + k * c_step + v * n);
    }
  }
  for (std::size_t q = 0; q < depth; ++q, a += step, b += step) {
    V left[Vectors];
    for (std::size_t v = 0; v < Vectors; ++v) {
      left[v] = load<R, N>(a + v * n);
    }
    for (std::size_t k = 0; k < Cols; ++k) {
      const V right = V{} + b[k];
      for (std::size_t v = 0; v < Vectors; ++v) {
        kept[k][v] -= left[v] * right;
      }
    }
  }
  for (std::size_t k = 0; k < Cols; ++k) {
    for (std::size_t v = 0; v < Vectors; ++v) {
      store(c + k * c_step + v * n, kept[k][v]);
    }
  }
}

/// The same for any number of rows: the widest vectors first, then narrower ones.
template <class R, int N, std::size_t Vectors, std::size_t Cols>
inline void subtract_columns(R* c,
                             std::size_t c_step,
                             std::size_t rows,
                             const R* a,
                             const R* b,
                             std::size_t step,
                             std::size_t depth) {
  constexpr std::size_t tall = std::size_t(N) * Vectors;
  std::size_t r = 0;
  for (; r + tall <= rows; r += tall) {
    subtract_tile<R, N, Vectors, Cols>(c + r, c_step, a + r, b, step, depth);
  }
  if constexpr (Vectors > 1) {
    subtract_columns<R, N, 1, Cols>(c + r, c_step, rows - r, a + r, b, step, depth);
  } else if constexpr (N > 2) {
    subtract_columns<R, N / 2, 1, Cols>(c + r, c_step, rows - r, a + r, b, step, depth);
  }
}
#endif

/// c -= a b^T for `Cols` columns of any number.
template <std::size_t Cols, class R>
inline void subtract_columns_plainly(R* c,
                                     std::size_t c_step,
                                     std::size_t rows,
                                     const R* a,
                                     const R* b,
                                     std::size_t step,
                                     std::size_t depth) {
  for (std::size_t q = 0; q < depth; ++q, a += step, b += step) {
    for (std::size_t k = 0; k < Cols; ++k) {
      for (std::size_t r = 0; r < rows; ++r) {
        c[k * c_step + r] = c[k * c_step + r] - a[r] * b[k];
      }
    }
  }
}

/// c -= a b^T for `Cols` columns.
template <int Bytes, std::size_t Cols, class R>
inline void subtract(R* c,
                     std::size_t c_step,
                     std::size_t rows,
                     const R* a,
                     const R* b,
                     std::size_t step,
                     std::size_t depth) {
  if (depth == 0) {
    return;
  }
#if defined(FINGERPAD_HAS_VECTORS)
  constexpr int n = lanes_of<R, Bytes>();
  if constexpr (n > 1) {
    subtract_columns<R, n, 2, Cols>(c, c_step, rows, a, b, step, depth);
    return;
  }
#endif
  subtract_columns_plainly<Cols>(c, c_step, rows, a, b, step, depth);
}

/// The lower half of c -= a a^T, whose first `cols` rows of `a` are those of the columns of c and
/// which has `rows` rows. What lies above the diagonal may be overwritten.
template <int Bytes, class R>
inline void subtract_square(R* c,
                            std::size_t c_step,
                            std::size_t rows,
                            std::size_t cols,
                            const R* a,
                            std::size_t step,
                            std::size_t depth) {
  std::size_t k = 0;
  for (; k + 4 <= cols; k += 4) {
    subtract<Bytes, 4>(c + k * c_step + k, c_step, rows - k, a + k, a + k, step, depth);
  }
  if (k < cols) {
    subtract<Bytes, 2>(c + k * c_step + k, c_step, rows - k, a + k, a + k, step, depth);
  }
}

/// Cholesky of `Cols` neighbouring columns from their diagonal on; false where a pivot is not > 0.
template <std::size_t Cols, class R>
inline bool factorise_columns(R* a, std::size_t step, std::size_t rows) {
  using std::sqrt;
  for (std::size_t k = 0; k < Cols; ++k) {
    R* column = a + k * step;
    const R pivot = column[k];
    if (!(value(pivot) > 0) || !is_finite(pivot)) {
      return false;
    }
    const R root = sqrt(pivot);
    const R inverse = R(1) / root;
    column[k] = root;
    for (std::size_t r = k + 1; r < rows; ++r) {
      column[r] = column[r] * inverse;
    }
    for (std::size_t c = k + 1; c < Cols; ++c) {
      R* next = a + c * step;
      const R factor = column[c];
      for (std::size_t r = c; r < rows; ++r) {
        next[r] = next[r] - factor * column[r];
      }
    }
  }
  return true;
}

/// Cholesky of the first `cols` columns of a block with `rows` rows.
template <int Bytes, class R>
inline bool factorise(R* a, std::size_t rows, std::size_t cols) {
  std::size_t k = 0;
  for (; k + 4 <= cols; k += 4) {
    subtract<Bytes, 4>(a + k * rows + k, rows, rows - k, a + k, a + k, rows, k);
    if (!factorise_columns<4>(a + k * rows + k, rows, rows - k)) {
      return false;
    }
  }
  if (k < cols) {
    subtract<Bytes, 2>(a + k * rows + k, rows, rows - k, a + k, a + k, rows, k);
    return factorise_columns<2>(a + k * rows + k, rows, rows - k);
  }
  return true;
}

/// Sum of a[k] b[k]. Four sums, because a running one waits for itself.
template <class R>
inline R product(const R* a, const R* b, std::size_t count) {
  R sums[4] = {R(0), R(0), R(0), R(0)};
  std::size_t k = 0;
  for (; k + 4 <= count; k += 4) {
    for (std::size_t v = 0; v < 4; ++v) {
      sums[v] = sums[v] + a[k + v] * b[k + v];
    }
  }
  for (; k < count; ++k) {
    sums[0] = sums[0] + a[k] * b[k];
  }
  return R(R(sums[0] + sums[1]) + R(sums[2] + sums[3]));
}

}  // namespace detail::membrane
}  // namespace v0
}  // namespace fingerpad
