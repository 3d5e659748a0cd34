// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Sums over every pixel of a disc: each of its rows is the difference of two running sums.
#include <algorithm>
#include <bit>
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

/// Half width of a disc in the row at this distance from its center: the largest w with
/// w^2 + row^2 <= radius^2.
inline Index disc_half_width(Index radius, Index row) {
  Index w = radius;
  while (w * w + row * row > radius * radius) {
    --w;
  }
  return w;
}
inline double disc_pixels(Index radius) {
  double pixels = 0;
  for (Index y = -radius; y <= radius; ++y) {
    pixels += static_cast<double>(2 * disc_half_width(radius, y) + 1);
  }
  return pixels;
}

/// Sums of numbers S. In float and double the numbers must be whole: they are added as integers,
/// whose sums are exact in any order, even if they wrap on the way. O(radius) a pixel.
template <scalar S>
class DiscSums {
  static constexpr bool by_integers = std::same_as<S, float> || std::same_as<S, double>;
  template <class V>
  using Ints =
      lanes<std::conditional_t<sizeof(S) == 4, std::int32_t, std::int64_t>, lanes_in<V, S>>;

 public:
  /// Disc sums must be less than this to be exact.
  static constexpr double limit = sizeof(S) == 4 ? 0x1p30 : 0x1p62;

  DiscSums(Index rows, Index cols, Index radius_px)
      : rows_(rows),
        cols_(cols),
        radius_(radius_px),
        stride_(cols + 2 * radius_px + 1),
        sums_(static_cast<std::size_t>(rows * stride_), Sum(0)) {
    for (Index y = 0; y <= radius_px; ++y) {
      half_widths_.push_back(disc_half_width(radius_px, y));
    }
  }

  /// Sets every cell to 0.
  void clear() { std::fill(sums_.begin(), sums_.end(), Sum(0)); }

  /// Sets the cells of row i.
  void set(Index i, const S* cells) {
    Sum* row = sums_.data() + i * stride_ + radius_ + 1;
    for_each_cell<S>(cols_, [=]<class V>(Index j) {
      const V numbers = load_cells<V, S>(cells + j);
      if constexpr (by_integers) {
        using Sums = lanes<Sum, lanes_in<V, S>>;
        store_cells<Sum>(row + j, std::bit_cast<Sums>(each_as<Ints<V>>(numbers)));
      } else {
        row[j] = numbers;
      }
    });
    for (Index j = 1; j < cols_; ++j) {
      row[j] = Sum(row[j] + row[j - 1]);
    }
    std::fill(row + cols_, row + cols_ + radius_, row[cols_ - 1]);
  }

  /// to[j] = unit times the sum over the disc around row i and column j. Cells beyond the image
  /// count as 0.
  void sum(Index i, const S& unit, S* to) const {
    const Index top = (std::max)(-i, -radius_), bottom = (std::min)(rows_ - 1 - i, radius_);
    const Sum* row = sums_.data() + i * stride_ + radius_ + 1;
    for_each_cell<Sum>(cols_, [=, this, &unit]<class V>(Index j) {
      V sum = every_lane<V>(Sum(0));
      for (Index y = top; y <= bottom; ++y) {
        const Sum* center = row + y * stride_ + j;
        const Index w = half_widths_[static_cast<std::size_t>(y < 0 ? -y : y)];
        sum = sum + V(load_cells<V, Sum>(center + w) - load_cells<V, Sum>(center - w - 1));
      }
      if constexpr (by_integers) {
        using Numbers = lanes<S, lanes_in<V, S>>;
        const Numbers numbers = each_as<Numbers>(std::bit_cast<Ints<V>>(sum));
        store_cells<S>(to + j, Numbers(unit * numbers));
      } else {
        to[j] = S(unit * sum);
      }
    });
  }

 private:
  using Word = std::conditional_t<sizeof(S) == 4, std::uint32_t, std::uint64_t>;
  using Sum = std::conditional_t<by_integers, Word, S>;

  Index rows_, cols_, radius_, stride_;
  std::vector<Index> half_widths_;  // of the disc, by distance from its middle row
  std::vector<Sum> sums_;           // along each row, with a margin of the radius
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
