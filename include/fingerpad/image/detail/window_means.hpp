// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Means of two channels over two concentric square windows, row by row from top to bottom. A window
// holds the pixels that count among the w x w (odd, 3..255) around a pixel; where none counts, the
// mean is NaN. Green is averaged over the inner window only.
//
// Sums of 8- and 16-bit pixels are exact: complete windows give the bits of a float box filter.
// Other sums are in double and start anew at every 32nd row, so that a band of rows has the same
// bits as the whole image; for this they may begin up to 31 rows before the band. Each object is
// the memory of one thread and allocates only at construction.
//
//   WindowMeans<std::uint16_t> means(rows, cols, {33, 55});
//   means.start(first, load_row);
//   for (Index row = first; row < last; ++row) {
//     means.advance(load_row, inner_red, inner_green, outer_red);
//   }
//
// load_row(row, red, green, counts) fills a row of the image; counts[j] is 1 where the pixel
// counts, else 0. It is called for rows in order, once each, from half an outer window before
// `first` on. Loops over pixels are blocks of a length known to the compiler, which GCC 12
// vectorises at -O2 unless it inlines them: then it forgets __restrict (tests/vectors).
#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// For pixels of 8 or 16 bits, float or double.
template <class Pixel>
class WindowMeans {
 public:
  using Mean = std::conditional_t<std::integral<Pixel>, float, Pixel>;

  /// Refuses an empty image, and sizes that are even, out of range or not increasing.
  WindowMeans(Index rows, Index cols, const std::array<int, 2>& windows_px)
      : rows_(rows), cols_(cols), padded_((cols + block - 1) / block * block) {
    expects(rows >= 1, "WindowMeans", "rows", rows, ">= 1");
    expects(cols >= 1, "WindowMeans", "cols", cols, ">= 1");
    int before = 1;
    for (const int size : windows_px) {
      expects(size % 2 == 1 && size > before && size <= 255, "WindowMeans", "window_px", size,
              "odd, 3..255, and larger than the window before it");
      before = size;
    }
    reach_ = windows_px[1] / 2;
    windows_[0].radius = windows_px[0] / 2;
    windows_[1].radius = reach_;
    for (Window& window : windows_) {
      window.sums = Sums(padded_);
    }
    ring_.assign(std::size_t(2 * reach_ + 2), Row(padded_));
    none_ = Row(padded_);
    along_ = Sums(padded_ + 2 * reach_ + 1);
  }

  /// Prepares for row `first`.
  template <class Load>
  void start(Index first, const Load& load_row) {
    next_row_ = std::integral<Pixel> ? first : first - first % restart_rows;
    for (Index row = next_row_ - reach_; row < next_row_ + reach_; ++row) {
      take_in(row, load_row);
    }
    starts_ = true;
    while (next_row_ < first) {
      slide(load_row);
    }
  }

  /// Writes the means of the next row: `cols` numbers each, in memory for as many whole blocks
  /// of 64.
  template <class Load>
  void advance(const Load& load_row, Mean* inner_red, Mean* inner_green, Mean* outer_red) {
    slide(load_row);
    const auto& [inner, outer] = windows_;
    sum_along(inner.sums.count, inner.radius, along_.count);
    average(inner.sums.red, inner.radius, along_.red, inner_red);
    average(inner.sums.green, inner.radius, along_.green, inner_green);
    sum_along(outer.sums.count, outer.radius, along_.count);
    average(outer.sums.red, outer.radius, along_.red, outer_red);
  }

 private:
  static constexpr Index block = 64;
  static constexpr Index restart_rows = 32;
  // Integers wrap, so that differences of running sums are exact.
  using Sum = std::conditional_t<std::integral<Pixel>, std::uint32_t, double>;

  template <class Value, class Count>
  struct Planes {
    std::vector<Value> red, green;
    std::vector<Count> count;

    explicit Planes(Index size = 0)
        : red(std::size_t(size), Value(0)), green(red), count(red.size(), Count(0)) {}
  };
  using Row = Planes<Pixel, std::uint8_t>;
  using Sums = Planes<Sum, std::uint32_t>;

  struct Window {
    Index radius = 0;
    Sums sums;  ///< over the rows of the window, column by column
  };

  bool in_image(Index row) const { return row >= 0 && row < rows_; }
  Row& slot(Index row) { return ring_[std::size_t(row) % ring_.size()]; }
  const Row& row_or_none(Index row) { return in_image(row) ? slot(row) : none_; }

  /// Reads a row. Pixels that do not count become 0.
  template <class Load>
  void take_in(Index row, const Load& load_row) {
    if (in_image(row)) {
      Row& to = slot(row);
      load_row(row, to.red.data(), to.green.data(), to.count.data());
      std::fill(to.count.begin() + cols_, to.count.end(), std::uint8_t(0));
      for (Index j = 0; j < padded_; j += block) {
        clean(to.red.data() + j, to.count.data() + j);
        clean(to.green.data() + j, to.count.data() + j);
      }
    }
  }

  [[gnu::noinline]] static void clean(Pixel* __restrict cells,
                                      const std::uint8_t* __restrict counts) {
    for (Index i = 0; i < block; ++i) {
      if constexpr (std::integral<Pixel>) {
        cells[i] = Pixel(cells[i] & -int(counts[i]));
      } else {
        cells[i] = counts[i] != 0 ? cells[i] : Pixel(0);
      }
    }
  }

  /// Moves both windows down by one row.
  template <class Load>
  void slide(const Load& load_row) {
    const Index row = next_row_++;
    take_in(row + reach_, load_row);
    const bool anew = starts_ || (!std::integral<Pixel> && row % restart_rows == 0);
    starts_ = false;
    for (Window& window : windows_) {
      const Index r = window.radius;
      if (anew) {
        std::fill(window.sums.red.begin(), window.sums.red.end(), Sum(0));
        std::fill(window.sums.green.begin(), window.sums.green.end(), Sum(0));
        std::fill(window.sums.count.begin(), window.sums.count.end(), 0U);
      }
      for (Index i = anew ? row - r : row + r; i <= row + r; ++i) {
        const Row& in = row_or_none(i);
        const Row& out = anew ? none_ : row_or_none(row - r - 1);
        for (std::size_t j = 0; j < std::size_t(padded_); j += std::size_t(block)) {
          move(in.red.data() + j, out.red.data() + j, window.sums.red.data() + j);
          if (&window == &windows_[0]) {
            move(in.green.data() + j, out.green.data() + j, window.sums.green.data() + j);
          }
          move(in.count.data() + j, out.count.data() + j, window.sums.count.data() + j);
        }
      }
    }
  }

  template <class T, class N>
  [[gnu::noinline]] static void move(const T* __restrict in,
                                     const T* __restrict out,
                                     N* __restrict sum) {
    for (Index i = 0; i < block; ++i) {
      sum[i] = N(sum[i] + N(in[i]) - N(out[i]));
    }
  }

  /// to[j] = sum of the columns before j - r, for j in [0, padded + 2 r].
  template <class N>
  void sum_along(const std::vector<N>& columns, Index r, std::vector<N>& to) const {
    N sum = N(0);
    N* at = std::fill_n(to.data(), r + 1, sum);
    for (Index j = 0; j < cols_; ++j) {
      *at++ = sum = N(sum + columns[std::size_t(j)]);
    }
    std::fill_n(at, padded_ - cols_ + r, sum);
  }

  void average(const std::vector<Sum>& columns, Index r, std::vector<Sum>& along, Mean* to) {
    sum_along(columns, r, along);
    const Index width = 2 * r + 1;
    for (Index j = 0; j < cols_; j += block) {
      const Sum* sum = along.data() + j;
      const std::uint32_t* count = along_.count.data() + j;
      divide(sum, sum + width, count, count + width, to + j);
    }
  }

  /// Multiplies sums of integers by the reciprocal, as box filters do. 0 / 0 is NaN.
  [[gnu::noinline]] static void divide(const Sum* sum_before,
                                       const Sum* sum_after,
                                       const std::uint32_t* before,
                                       const std::uint32_t* after,
                                       Mean* __restrict to) {
    for (Index i = 0; i < block; ++i) {
      const int count = int(after[i] - before[i]);
      if constexpr (std::integral<Pixel>) {
        to[i] = float(sum_after[i] - sum_before[i]) * (1.0f / float(count));
      } else {
        to[i] =
            count == 0 ? not_a_number<Mean>() : Mean((sum_after[i] - sum_before[i]) / Sum(count));
      }
    }
  }

  Index rows_, cols_, padded_;
  Index reach_ = 0;  // of the outer window
  Index next_row_ = 0;
  bool starts_ = true;
  std::vector<Row> ring_;
  Row none_;    // a row outside the image
  Sums along_;  // running sums along the row
  std::array<Window, 2> windows_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
