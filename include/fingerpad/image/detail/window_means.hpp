// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Means of two channels over two concentric square windows, row by row from top to bottom. A window
// holds the pixels that count among the w x w (odd, 3..255) around a pixel; where none counts, the
// mean is NaN. Green is averaged over the inner window only.
//
// Pixels are whole numbers with exact sums: any band of rows has the bits of the whole image, and
// float means have those of a box filter. Each object is the memory of one thread and allocates
// only at construction.
//
//   WindowMeans<std::uint16_t> means(rows, cols, {33, 55});
//   means.start(first, load_row);
//   for (Index row = first; row < last; ++row) {
//     means.advance(load_row, inner_red, inner_green, outer_red);
//   }
//
// load_row(row, red, green, counts) fills a row of the image. counts[j] is 1 where the pixel
// counts, else 0, and then red and green are 0, too. It is called for rows in order, once each,
// from half an outer window above `first` on. All rows are in memory for whole blocks of 64. Loops
// over pixels are blocks of a length known to the compiler, which GCC 12 vectorises at -O2 unless
// it inlines them: then it forgets __restrict (tests/vectors).
#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/image/detail/lanes.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// For pixels of 8 or 16 bits, or of 64 bits with a sign, which must not overflow in a window.
template <std::integral Pixel, std::floating_point Mean = float>
class WindowMeans {
 public:
  /// Refuses an empty image, and sizes that are even, out of range or not increasing.
  WindowMeans(Index rows, Index cols, const std::array<int, 2>& windows_px)
      : rows_(rows), cols_(cols), padded_((cols + block - 1) / block * block) {
    require("WindowMeans", {{"rows", rows, at_least(1)},
                            {"cols", cols, at_least(1)},
                            {"window_px", windows_px[0], odd_within(3, 253)},
                            {"window_px", windows_px[1], odd_within(windows_px[0] + 2, 255)}});
    inner_ = {windows_px[0] / 2, Sums(padded_)};
    outer_ = {windows_px[1] / 2, Sums(padded_)};
    ring_.assign(std::size_t(2 * outer_.radius + 2), Row(padded_));
    none_ = Row(padded_);
    along_ = Sums(padded_ + 2 * outer_.radius + 1);
  }

  /// Prepares for row `first`.
  template <class Load>
  void start(Index first, const Load& load_row) {
    next_row_ = first;
    for (Index row = first - 1 - outer_.radius; row < first + outer_.radius; ++row) {
      take_in(row, load_row);
    }
    for (Window* window : {&inner_, &outer_}) {
      std::fill(window->sums.red.begin(), window->sums.red.end(), Sum(0));
      std::fill(window->sums.green.begin(), window->sums.green.end(), Sum(0));
      std::fill(window->sums.count.begin(), window->sums.count.end(), 0U);
      for (Index row = first - 1 - window->radius; row < first + window->radius; ++row) {
        slide(row_or_none(row), none_, *window);
      }
    }
  }

  /// Writes the means of the next row.
  template <class Load>
  void advance(const Load& load_row, Mean* inner_red, Mean* inner_green, Mean* outer_red) {
    const Index row = next_row_++;
    take_in(row + outer_.radius, load_row);
    for (Window* window : {&inner_, &outer_}) {
      slide(row_or_none(row + window->radius), row_or_none(row - 1 - window->radius), *window);
    }
    sum_along(inner_.sums.count, inner_.radius, along_.count);
    average(inner_.sums.red, inner_.radius, along_.red, inner_red);
    average(inner_.sums.green, inner_.radius, along_.green, inner_green);
    sum_along(outer_.sums.count, outer_.radius, along_.count);
    average(outer_.sums.red, outer_.radius, along_.red, outer_red);
  }

 private:
  static constexpr Index block = 64;
  static constexpr bool wide = sizeof(Pixel) == 8;
  // Unsigned, so that running sums may wrap: their differences are exact.
  using Sum = std::conditional_t<wide, std::uint64_t, std::uint32_t>;

  template <class Value, class Count>
  struct Planes {
    std::vector<Value> red, green;
    std::vector<Count> count;

    explicit Planes(Index size = 0) : red(std::size_t(size)), green(red), count(red.size()) {}
  };
  using Row = Planes<Pixel, std::uint8_t>;
  using Sums = Planes<Sum, std::uint32_t>;

  struct Window {
    Index radius = 0;
    Sums sums;  ///< over the rows of the window, column by column
  };

  Row& slot(Index row) { return ring_[std::size_t(row) % ring_.size()]; }
  const Row& row_or_none(Index row) { return row >= 0 && row < rows_ ? slot(row) : none_; }

  template <class Load>
  void take_in(Index row, const Load& load_row) {
    if (row >= 0 && row < rows_) {
      Row& to = slot(row);
      load_row(row, to.red.data(), to.green.data(), to.count.data());
    }
  }

  /// Moves a window down: one row in, one out.
  void slide(const Row& in, const Row& out, Window& window) const {
    for (std::size_t j = 0; j < std::size_t(padded_); j += std::size_t(block)) {
      move(&in.red[j], &out.red[j], &window.sums.red[j]);
      if (&window == &inner_) {
        move(&in.green[j], &out.green[j], &window.sums.green[j]);
      }
      move(&in.count[j], &out.count[j], &window.sums.count[j]);
    }
  }

  template <class T, class N>
  [[gnu::noinline]] static void move(const T* __restrict in,
                                     const T* __restrict out,
                                     N* __restrict sum) {
    for (Index i = 0; i < block; ++i) {
      sum[i] = sum[i] + N(in[i]) - N(out[i]);
    }
  }

  /// to[j] = sum of the columns before j - r, for j in [0, padded + 2 r].
  template <class N>
  void sum_along(const std::vector<N>& columns, Index r, std::vector<N>& to) const {
    std::fill_n(to.data(), r + 1, N(0));
    N* sums = to.data() + r + 1;
    Index j = 0;
#if defined(FINGERPAD_HAS_VECTORS)
    if constexpr (sizeof(N) == 4) {
      using Four = lanes<N, 4>;
      for (Four before = {}; j + 4 <= cols_; j += 4) {
        Four sum = load<Four>(columns.data() + j);
        sum += __builtin_shufflevector(Four{}, sum, 0, 4, 5, 6);
        sum += __builtin_shufflevector(Four{}, sum, 0, 1, 4, 5);
        store(sums + j, Four(sum + before));
        before += __builtin_shufflevector(sum, sum, 3, 3, 3, 3);
      }
    }
#endif
    for (; j < cols_; ++j) {
      sums[j] = sums[j - 1] + columns[std::size_t(j)];
    }
    std::fill_n(sums + cols_, padded_ - cols_ + r, sums[cols_ - 1]);
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

  /// Multiplies by the reciprocal, as box filters do. 0 / 0 is NaN.
  [[gnu::noinline]] static void divide(const Sum* sum_before,
                                       const Sum* sum_after,
                                       const std::uint32_t* before,
                                       const std::uint32_t* after,
                                       Mean* __restrict to) {
    using Difference = std::conditional_t<wide, std::int64_t, Sum>;
    for (Index i = 0; i < block; ++i) {
      const Mean per_pixel = Mean(1) / Mean(int(after[i] - before[i]));
      to[i] = Mean(Difference(sum_after[i] - sum_before[i])) * per_pixel;
    }
  }

  Index rows_, cols_, padded_;
  Index next_row_ = 0;
  Window inner_, outer_;
  std::vector<Row> ring_;
  Row none_;    // a row outside the image
  Sums along_;  // running sums along the row
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
