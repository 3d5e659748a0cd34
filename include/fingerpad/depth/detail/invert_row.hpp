// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Computes one image row of depths from a ScatterPolynomial, one vector register of pixels at a
// time. No allocation, no branch per pixel; a pixel without a depth gets NaN and the reason.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#include "fingerpad/depth/depth_inverse.hpp"
#include "fingerpad/depth/detail/scatter_polynomial.hpp"
#include "fingerpad/image/detail/row_lanes.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Improves a root s of sum f[j] s^{j+1} = target until its error is of the given order in the
/// error of the start: a Halley step for every factor 3 of Order, a Newton step for every 2.
template <int Order, std::size_t Degree, class V>
[[gnu::always_inline]] inline V refine(const V (&f)[Degree], V target, V s) noexcept {
  static_assert(Order == 1 || Order % 2 == 0 || Order % 3 == 0);
  if constexpr (Order == 1) {
    return s;
  } else {
    constexpr bool is_halley = Order % 3 == 0;
    V bend = f[Degree - 1];  // half the second derivative
    V slope = f[Degree - 1];
    V value = f[Degree - 1] * s + f[Degree - 2];
    slope = slope * s + value;
    for (int j = int(Degree) - 3; j >= 0; --j) {
      if constexpr (is_halley) {
        bend = bend * s + slope;
      }
      value = value * s + f[j];
      slope = slope * s + value;
    }
    value = value * s - target;
    if constexpr (is_halley) {
      return refine<Order / 3>(f, target, s - value * slope / (slope * slope - value * bend));
    } else {
      return refine<Order / 2>(f, target, s - value / slope);
    }
  }
}

/// A NaN that holds the reason in its last two bits; any other NaN reads as `not_a_number`.
template <class Scalar>
constexpr Scalar nan_because(PixelStatus why) {
  using Bits = std::conditional_t<sizeof(Scalar) == 4, std::uint32_t, std::uint64_t>;
  const Bits bits = std::bit_cast<Bits>(std::numeric_limits<Scalar>::quiet_NaN());
  return std::bit_cast<Scalar>(bits | Bits(3 - int(why)));
}

/// Reads the reasons back from `Count` depths.
template <std::size_t Count, class Scalar>
void write_status(const Scalar* depth_mm, PixelStatus* status) noexcept {
  using Bits = std::conditional_t<sizeof(Scalar) == 4, std::uint32_t, std::uint64_t>;
  Bits bits[Count];
  PixelStatus code[Count];
  std::memcpy(bits, depth_mm, sizeof bits);
  constexpr Bits infinity = std::bit_cast<Bits>(std::numeric_limits<Scalar>::infinity());
  for (std::size_t i = 0; i < Count; ++i) {
    code[i] = PixelStatus((bits[i] & ~Bits(0) >> 1) > infinity ? 3 - (bits[i] & 3) : 0);
  }
  std::memcpy(status, code, sizeof code);
}

/// Depth of one register of pixels, or a NaN with its reason. `gain` is a V, or nullptr if g is
/// folded into the table.
template <int Order, class Table, class V, class Gain>
[[gnu::always_inline]] inline V invert(
    const Table& table, V u, V red, V green, Gain gain) noexcept {
  using Scalar = decltype(Table::kappa);
  constexpr bool has_gain = !std::is_null_pointer_v<Gain>;
  constexpr std::size_t degree = sizeof(table.scatter) / sizeof(table.scatter[0]);
  V f[degree];
  V total = V{};
#pragma GCC unroll 16
  for (int j = int(degree) - 1; j >= 0; --j) {
    f[j] = polynomial(table.scatter[j], Table::scatter_radial(j), u);
    if constexpr (has_gain) {
      f[j] = f[j] * gain;
    }
    if (j < Table::exp_degree) {
      f[j] = f[j] + green * polynomial(table.exp_minus_1[j], Table::exp_radial(j), u);
    }
    total = j == int(degree) - 1 ? f[j] : total + f[j];
  }
  const V target = table.kappa * red - green;
  const V scaled = target * total;
  const V s = refine<Order>(f, target, scaled / (f[0] * (total - target) + scaled));
  auto inside = (target >= Scalar(0)) & (target <= total);
  if constexpr (has_gain) {
    inside = inside & (gain > Scalar(0));
  }
  const V nan = V{} + nan_because<Scalar>(PixelStatus::not_a_number);
  const V below = V{} + nan_because<Scalar>(PixelStatus::below_range);
  const V above = V{} + nan_because<Scalar>(PixelStatus::above_range);
  const V none = target < Scalar(0) ? below : target > total ? above : nan;
  return inside ? s * table.l_max_mm : none;
}

/// Columns [first, last) of a row that the table covers.
struct ColumnSpan {
  std::ptrdiff_t first, last;
};

template <class Table>
ColumnSpan covered_columns(const Table& table, std::ptrdiff_t row, std::ptrdiff_t cols) noexcept {
  const double scale = double(table.u_root_per_px);
  const double dy = (double(row) - double(table.center_row_px)) * scale;
  if (!(dy * dy <= 1)) {
    return {0, 0};
  }
  const double half_px = std::sqrt(1 - dy * dy) / scale;
  const auto clamp = [&](double col) {
    return col > 0 ? col < double(cols) ? std::ptrdiff_t(col) : cols : std::ptrdiff_t(0);
  };
  const std::ptrdiff_t first = clamp(std::ceil(double(table.center_col_px) - half_px));
  const std::ptrdiff_t last = clamp(std::floor(double(table.center_col_px) + half_px) + 1);
  return {first, last < first ? first : last};
}

/// Number of pixels that are inverted between two checks of their status.
inline constexpr std::ptrdiff_t inversion_block = 64;

/// Computes the depths of a block of pixels from column `first` on. Returns false if any of them
/// has none.
template <int Order, class V, class Table, class Scalar, class Gain>
[[gnu::always_inline]] inline bool invert_block(const Table& table,
                                                std::ptrdiff_t row,
                                                std::ptrdiff_t first,
                                                const Scalar* red,
                                                const Scalar* green,
                                                Gain gain,
                                                Scalar* depth_mm) noexcept {
  constexpr auto width = std::ptrdiff_t(sizeof(V) / sizeof(Scalar));
  Scalar steps[std::size_t(width)];
  for (std::ptrdiff_t i = 0; i < width; ++i) {
    steps[i] = Scalar(i) - table.center_col_px;
  }
  const V ramp = load_cells<V, Scalar>(steps);
  const Scalar dy = (Scalar(row) - table.center_row_px) * table.u_root_per_px;
  const Scalar dy_sq = dy * dy;
  auto bad = V{} != V{};
  for (std::ptrdiff_t i = 0; i < inversion_block; i += width) {
    const V dx = (ramp + Scalar(first + i)) * table.u_root_per_px;
    const V u = dx * dx + dy_sq;
    const V r = load_cells<V, Scalar>(red + i);
    const V b = load_cells<V, Scalar>(green + i);
    V l;
    if constexpr (std::is_null_pointer_v<Gain>) {
      l = invert<Order>(table, u, r, b, nullptr);
    } else {
      l = invert<Order>(table, u, r, b, load_cells<V, Scalar>(gain + i));
    }
    bad = bad | (l != l);
    store_cells<Scalar>(depth_mm + i, l);
  }
  return !any_lane(bad);
}

/// Depths of one image row. `gain` is a row of g, or nullptr when g is folded into the table; a
/// pixel whose g is not positive gets no depth. An output may be an input of the same column.
template <int Order, int VectorBytes = native_vector_bytes, class Table, class Scalar, class Gain>
void invert_row(const Table& table,
                std::ptrdiff_t row,
                std::ptrdiff_t cols,
                const Scalar* red,
                const Scalar* green,
                Gain gain,
                Scalar* depth_mm,
                PixelStatus* status) noexcept {
  constexpr bool has_gain = !std::is_null_pointer_v<Gain>;
  constexpr auto block = inversion_block;
  using V = typename RowVector<Scalar, row_lanes<Scalar, VectorBytes>>::type;
  const Table local = table;  // cannot alias the outputs, so it can stay in registers
  const auto [begin, end] = covered_columns(table, row, cols);
  std::fill(depth_mm, depth_mm + begin, std::numeric_limits<Scalar>::quiet_NaN());
  std::fill(depth_mm + end, depth_mm + cols, std::numeric_limits<Scalar>::quiet_NaN());
  std::fill(status, status + begin, PixelStatus::outside_pad);
  std::fill(status + end, status + cols, PixelStatus::outside_pad);
  PixelStatus code[std::size_t(block)];
  std::ptrdiff_t first = begin;
  for (; first + block <= end; first += block) {
    Gain g = gain;
    if constexpr (has_gain) {
      g += first;
    }
    if (invert_block<Order, V>(local, row, first, red + first, green + first, g,
                               depth_mm + first)) {
      std::fill_n(status + first, block, PixelStatus::ok);
    } else {
      write_status<std::size_t(block)>(depth_mm + first, code);
      std::copy_n(code, block, status + first);
    }
  }
  if (const std::ptrdiff_t rest = end - first; rest > 0) {
    Scalar spare[4][std::size_t(block)] = {};
    std::copy_n(red + first, rest, spare[0]);
    std::copy_n(green + first, rest, spare[1]);
    if constexpr (has_gain) {
      std::copy_n(gain + first, rest, spare[2]);
      invert_block<Order, V>(local, row, first, spare[0], spare[1], spare[2], spare[3]);
    } else {
      invert_block<Order, V>(local, row, first, spare[0], spare[1], nullptr, spare[3]);
    }
    write_status<std::size_t(block)>(spare[3], code);
    std::copy_n(code, rest, status + first);
    std::copy_n(spare[3], rest, depth_mm + first);
  }
}
}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
