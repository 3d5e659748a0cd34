// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Means of two channels over two concentric square windows, row by row from top to bottom. A window
// holds the pixels that count among the w x w (odd, 3..255) around a pixel; where none counts, the
// mean is NaN. Green is averaged over the inner window only.
//
// Pixels are whole numbers with exact sums, so float means have the bits of a box filter. Each
// object is the memory of one thread and allocates only at construction.
//
//   WindowMeans<std::uint32_t> means(rows, cols, {33, 55});
//   means.start(load_row);
//   for (Index row = 0; row < rows; ++row) {
//     means.advance(load_row, inner_red, inner_green, outer_red);
//   }
//
// load_row(row, red, green, counts) fills a row of the image. counts[j] is 1 where the pixel
// counts, else 0, and then red and green are 0, too. It is called for rows in order, once each. All
// rows are in memory for whole blocks of 64. Loops over pixels are blocks of a length known to the
// compiler, which GCC 12 vectorises at -O2 unless it inlines them: then it forgets __restrict
// (tests/vectors).
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
inline namespace v1 {
namespace detail {

/// Red has a sign and is kept modulo 2^32 (in [-2^15, 2^15]) or 2^64 (in [-2^47, 2^47]); green is
/// below 2^16 or 2^47. The sum over all pixels above and left of a pixel may wrap: the sum over a
/// window, a difference of four of them, fits and is exact.
template <std::unsigned_integral Pixel, std::floating_point Mean = float>
class WindowMeans {
 public:
  /// Refuses an empty image, and sizes that are even, out of range or not increasing.
  WindowMeans(Index rows, Index cols, const std::array<int, 2>& windows_px)
      : rows_(rows), cols_(cols), inner_(windows_px[0] / 2), outer_(windows_px[1] / 2) {
    require("WindowMeans", {{"rows", rows, at_least(1)},
                            {"cols", cols, at_least(1)},
                            {"window_px", windows_px[0], odd_within(3, 253)},
                            {"window_px", windows_px[1], odd_within(windows_px[0] + 2, 255)}});
    row_ = Planes(cols + block);
    none_ = Planes(cols + block + 2 * outer_ + 1);
    ring_.assign(std::size_t(2 * outer_ + 2), none_);
  }

  /// Prepares for the first row.
  template <class Load>
  void start(const Load& load_row) {
    next_row_ = 0;
    for (Index row = 0; row < outer_; ++row) {
      take_in(row, load_row);
    }
  }

  /// Writes the means of the next row.
  template <class Load>
  void advance(const Load& load_row, Mean* inner_red, Mean* inner_green, Mean* outer_red) {
    take_in(next_row_ + outer_, load_row);
    average(inner_, inner_red, inner_green);
    average(outer_, outer_red, nullptr);
    ++next_row_;
  }

 private:
  static constexpr Index block = 64;

  struct Planes {
    std::vector<Pixel> red, green;
    std::vector<std::uint32_t> count;

    explicit Planes(Index size = 0) : red(std::size_t(size)), green(red), count(red.size()) {}
  };

  /// Sums over the rows up to `row`: element j over the columns before j - outer_.
  Planes& sums(Index row) {
    return row < 0 ? none_ : ring_[std::size_t((std::min)(row, rows_ - 1)) % ring_.size()];
  }

  template <class Load>
  void take_in(Index row, const Load& load_row) {
    if (row < rows_) {
      load_row(row, row_.red.data(), row_.green.data(), row_.count.data());
      const Planes& above = sums(row - 1);
      Planes& to = sums(row);
      add(row_.red, above.red, to.red);
      add(row_.green, above.green, to.green);
      add(row_.count, above.count, to.count);
    }
  }

  /// to = above + the running sums of row.
  template <class N>
  void add(const std::vector<N>& row, const std::vector<N>& above, std::vector<N>& to) const {
    const N* up = above.data() + outer_ + 1;
    N* sums = to.data() + outer_ + 1;
    Index j = 0;
    N sum = N(0);
#if defined(FINGERPAD_HAS_VECTORS)
    if constexpr (sizeof(N) == 4) {  // GCC 12 does not vectorise running sums
      using Four = lanes<N, 4>;
      Four before = {};
      for (; j + 4 <= cols_; j += 4) {
        Four along = load<Four>(row.data() + j);
        along += __builtin_shufflevector(Four{}, along, 0, 4, 5, 6);
        along += __builtin_shufflevector(Four{}, along, 0, 1, 4, 5);
        store(sums + j, Four(load<Four>(up + j) + before + along));
        before += __builtin_shufflevector(along, along, 3, 3, 3, 3);
      }
      sum = before[0];
    }
#endif
    for (; j < cols_; ++j) {
      sum = sum + row[std::size_t(j)];
      sums[j] = up[j] + sum;
    }
    std::fill(sums + cols_, to.data() + to.size(), sums[cols_ - 1]);
  }

  /// Means of red, and of green unless it is nullptr.
  void average(Index radius, Mean* to_red, Mean* to_green) {
    const Planes& above = sums(next_row_ - radius - 1);
    const Planes& last = sums(next_row_ + radius);
    const Index width = 2 * radius + 1;
    for (Index j = 0; j < cols_; j += block) {
      const Index left = j + outer_ - radius;
      Mean per_pixel[block];
      invert(&above.count[std::size_t(left)], &last.count[std::size_t(left)], width, per_pixel);
      const auto multiply = [&]<class Sum>(const auto& top, const auto& bottom, Mean* to, Sum) {
        scale<Sum>(&top[std::size_t(left)], &bottom[std::size_t(left)], width, per_pixel, to + j);
      };
      using Signed = std::make_signed_t<Pixel>;
      multiply(above.red, last.red, to_red, Signed());
      if (to_green != nullptr) {
        multiply(above.green, last.green, to_green,
                 std::conditional_t<sizeof(Pixel) == 4, Pixel, Signed>());
      }
    }
  }

  /// Reciprocals of the counts, as in box filters.
  [[gnu::noinline]] static void invert(const std::uint32_t* above,
                                       const std::uint32_t* last,
                                       Index width,
                                       Mean* __restrict to) {
    for (Index i = 0; i < block; ++i) {
      to[i] = Mean(1) / Mean(int((last[i + width] - last[i]) - (above[i + width] - above[i])));
    }
  }

  /// Sums times reciprocals of counts. 0 times infinity is NaN.
  template <class Sum>
  [[gnu::noinline]] static void scale(const Pixel* above,
                                      const Pixel* last,
                                      Index width,
                                      const Mean* per_pixel,
                                      Mean* __restrict to) {
    for (Index i = 0; i < block; ++i) {
      const Pixel sum = (last[i + width] - last[i]) - (above[i + width] - above[i]);
      to[i] = Mean(Sum(sum)) * per_pixel[i];
    }
  }

  Index rows_, cols_;
  Index inner_, outer_;  // half windows
  Index next_row_ = 0;
  Planes row_, none_;
  std::vector<Planes> ring_;
};

}  // namespace detail
}  // namespace v1
}  // namespace fingerpad
