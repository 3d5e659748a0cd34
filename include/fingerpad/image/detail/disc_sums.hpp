// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Sums over every pixel of a disc: each of its rows is the difference of two running sums.
#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Half widths of a disc in its middle row, the next one and so on: the largest w with
/// w^2 + (pixel_aspect row)^2 <= radius^2, in widths of a pixel.
inline std::vector<Index> disc_half_widths(Index radius, double pixel_aspect) {
  std::vector<Index> half_widths;
  double left_sq = static_cast<double>(radius * radius);
  for (double row = 1; left_sq >= 0; ++row) {
    half_widths.push_back(static_cast<Index>(std::sqrt(left_sq)));
    left_sq = static_cast<double>(radius * radius) - square(pixel_aspect * row);
  }
  return half_widths;
}
inline double disc_pixels(Index radius, double pixel_aspect) {
  double pixels = static_cast<double>(-2 * radius - 1);  // the middle row is there once
  for (const Index w : disc_half_widths(radius, pixel_aspect)) {
    pixels += static_cast<double>(2 * (2 * w + 1));
  }
  return pixels;
}

/// Sums of numbers S in [-1.6, 1.6]. In float and double they are rounded to whole steps and added
/// as integers, whose sums are exact in any order, even if they wrap on the way. O(radius) a pixel.
template <scalar S>
class DiscSums {
 public:
  DiscSums(Index rows, Index cols, Index radius_px, double pixel_aspect)
      : rows_(rows),
        cols_(cols),
        margin_(radius_px + 1),
        half_widths_(disc_half_widths(radius_px, pixel_aspect)),
        sums_(static_cast<std::size_t>(rows * (cols + 2 * margin_)), Sum(0)) {
    const double limit = sizeof(S) == 4 ? 0x1p30 : 0x1p62;
    const double steps = limit / (1.6 * disc_pixels(radius_px, pixel_aspect));
    steps_ = S(std::exp2(std::floor(std::log2(steps))));  // a power of two: the unit is exact
  }

  /// Sets every cell to 0.
  void clear() { std::fill(sums_.begin(), sums_.end(), Sum(0)); }

  /// Sets the cells of row i.
  void set(Index i, const S* cells) {
    Sum* row = first_cell(i);
    const S steps = steps_;
    for_each_cell<S>(cols_, [=]<class V>(Index j) {
      const V cell = load_cells<V, S>(cells + j);
      if constexpr (by_integers) {
        const V half = every_lane<V>(S(0.5)), in_steps = cell * steps;
        const V rounded = in_steps + (in_steps < every_lane<V>(S(0)) ? -half : half);
        store_cells<Sum>(row + j, std::bit_cast<Like<Sum, V>>(each_as<Like<Int, V>>(rounded)));
      } else {
        row[j] = cell;
      }
    });
    for (Index j = 1; j < cols_; ++j) {
      row[j] = row[j] + row[j - 1];
    }
    std::fill_n(row + cols_, margin_, row[cols_ - 1]);
  }

  /// to[j] = the sum over the disc around row i and column j. Cells beyond the image count as 0.
  void sum(Index i, S* to) {
    const Index reach = static_cast<Index>(half_widths_.size()) - 1, stride = cols_ + 2 * margin_;
    const Index top = (std::max)(-i, -reach), bottom = (std::min)(rows_ - 1 - i, reach);
    const Index* half_widths = half_widths_.data();
    const Sum* row = first_cell(i);
    const S unit = S(1) / steps_;
    for_each_cell<Sum>(cols_, [=]<class V>(Index j) {
      V sum = every_lane<V>(Sum(0));
      for (Index y = top; y <= bottom; ++y) {
        const Sum* center = row + y * stride + j;
        const Index w = half_widths[y < 0 ? -y : y];
        sum = sum + V(load_cells<V, Sum>(center + w) - load_cells<V, Sum>(center - w - 1));
      }
      if constexpr (by_integers) {
        const auto in_steps = each_as<Like<S, V>>(std::bit_cast<Like<Int, V>>(sum));
        store_cells<S>(to + j, Like<S, V>(unit * in_steps));
      } else {
        to[j] = sum;
      }
    });
  }

 private:
  static constexpr bool by_integers = std::same_as<S, float> || std::same_as<S, double>;
  using Int = std::conditional_t<sizeof(S) == 4, std::int32_t, std::int64_t>;
  using Sum = std::conditional_t<by_integers, std::make_unsigned_t<Int>, S>;
  /// T, or a vector with as many of it as V has lanes.
  template <class T, class V>
  using Like = lanes<T, lanes_in<V, T>>;

  Sum* first_cell(Index row) { return sums_.data() + row * (cols_ + 2 * margin_) + margin_; }

  Index rows_, cols_, margin_;
  S steps_ = S(1);
  std::vector<Index> half_widths_;
  std::vector<Sum> sums_;  // along each row, with a margin on both sides
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
