// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Reduces a frame to the means of its square cells, channel by channel, in one pass. It serves
// methods that look at structures much larger than a pixel.
#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/detail/lanes.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// The value of a pixel's channel: the pixel itself if it is a number, else pixel[c].
template <class Pixel>
inline constexpr bool is_number = std::is_arithmetic_v<Pixel> || scalar<Pixel>;
template <class Pixel>
decltype(auto) channel_of(const Pixel& pixel, int c) {
  if constexpr (is_number<Pixel>) {
    return (pixel);
  } else if constexpr (requires {
                         { pixel.size() } -> std::same_as<std::size_t>;
                       }) {
    return pixel[static_cast<std::size_t>(c)];
  } else {
    return pixel[c];
  }
}

/// True if a pixel consists of `Channels` bytes and nothing else.
template <class View, int Channels>
inline constexpr bool is_packed_bytes = false;
template <class T, int Channels>
inline constexpr bool is_packed_bytes<StridedView<T>, Channels> =
    std::is_trivially_copyable_v<T> && sizeof(T) == std::size_t(Channels) &&
    std::is_same_v<std::remove_cvref_t<decltype(channel_of(std::declval<const T&>(), 0))>,
                   std::uint8_t>;

/// sums[k] += bytes[k].
inline void add_bytes(const std::uint8_t* bytes, Index count, std::uint16_t* sums) {
  using Sum = std::uint16_t;
  for_each_cell<Sum>(count, [&]<class V>(Index k) {
    store_cells<Sum>(sums + k, V(load_cells<V, Sum>(sums + k) + load_cells<V, Sum>(bytes + k)));
  });
}

/// Means over cells of size_px x size_px (1..16) pixels; the last cells of a row or column may be
/// smaller. A NaN pixel makes its cell NaN. Each object is the workspace of one thread.
template <int Channels, scalar S>
class CellMeans {
 public:
  CellMeans(Index rows, Index cols, Index size_px)
      : rows_(rows),
        cols_(cols),
        size_px_(size_px),
        sums_(static_cast<std::size_t>(cols * Channels)),
        line_(static_cast<std::size_t>(cell_cols() * Channels)) {}

  Index cell_rows() const { return (rows_ + size_px_ - 1) / size_px_; }
  Index cell_cols() const { return (cols_ + size_px_ - 1) / size_px_; }

  /// Calls write(row, col, channel, mean) for every cell and channel.
  template <class View, class Write>
  void operator()(const View& frame, const Write& write) {
    for (Index i = 0; i < cell_rows(); ++i) {
      const Index first = i * size_px_;
      const Index last = (std::min)(first + size_px_, rows_);
      sum_rows(frame, first, last);
      for (Index j = 0; j < cell_cols(); ++j) {
        const Index width = (std::min)(size_px_, cols_ - j * size_px_);
        const S share = S(1.0 / static_cast<double>(width * (last - first)));
        for (int c = 0; c < Channels; ++c) {
          write(i, j, c, S(line_[static_cast<std::size_t>(j * Channels + c)] * share));
        }
      }
    }
  }

 private:
  template <class View>
  void sum_rows(const View& frame, Index first, Index last) {
    if constexpr (is_packed_bytes<View, Channels>) {
      if (frame.col_stride() == 1) {
        sum_bytes(frame, first, last);
        return;
      }
    }
    std::fill(line_.begin(), line_.end(), S(0));
    for (Index i = first; i < last; ++i) {
      for (Index j = 0; j < cols_; ++j) {
        const auto& pixel = frame(i, j);
        for (int c = 0; c < Channels; ++c) {
          S& sum = line_[static_cast<std::size_t>(j / size_px_ * Channels + c)];
          sum = sum + S(channel_of(pixel, c));
        }
      }
    }
  }

  template <class View>
  void sum_bytes(const View& frame, Index first, Index last) {
    std::fill(sums_.begin(), sums_.end(), std::uint16_t{0});
    for (Index i = first; i < last; ++i) {
      add_bytes(reinterpret_cast<const std::uint8_t*>(frame.row(i)), cols_ * Channels,
                sums_.data());
    }
    if (size_px_ == 4) {
      sum_columns(std::integral_constant<Index, 4>{});
    } else {
      sum_columns(size_px_);
    }
  }

  /// Adds up the columns of each cell, from sums_ to line_. `size` is size_px_; for the usual size
  /// it is a compile-time constant.
  template <class Size>
  void sum_columns(const Size& size) {
    const std::uint16_t* at = sums_.data();
    const Index whole = cols_ / size_px_;
    for (Index j = 0; j < whole; ++j, at += size * Channels) {
      add_columns(at, size, j);
    }
    if (whole < cell_cols()) {
      add_columns(at, cols_ - whole * size_px_, whole);
    }
  }
  template <class Width>
  void add_columns(const std::uint16_t* at, const Width& width, Index j) {
    for (int c = 0; c < Channels; ++c) {
      int total = 0;
      for (Index k = 0; k < width; ++k) {
        total += at[k * Channels + c];
      }
      line_[static_cast<std::size_t>(j * Channels + c)] = S(total);
    }
  }

  Index rows_;
  Index cols_;
  Index size_px_;
  std::vector<std::uint16_t> sums_;
  std::vector<S> line_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
