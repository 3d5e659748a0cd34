// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Means of two channels over square windows, row by row from top to bottom. A window holds the
// valid pixels among the w x w (odd, 3..255) around a pixel: those in the image, inside the
// caller's mask, with both channels between the limits. Without a valid pixel the mean is NaN.
//
// 8- and 16-bit sums are exact; complete windows give the bits of a float box filter. Each object
// is the workspace of one thread and allocates only at construction. A band of rows gives the same
// bits as the whole image. Several windows share all work but the last step.
//
//   WindowSums<std::uint8_t, 2> sums(rows, cols, {33, 55}, {0, 255});
//   sums.start(first, load_row);  // load_row(row, red, green) or (row, red, green, inside)
//   for (Index row = first; row < last; ++row) {
//     sums.advance(load_row, {{r33, g33}, {r55, nullptr}});
//   }
//
// Green is averaged over the first window only. The constructor's optional last argument, scale,
// multiplies the means of integers. load_row is called for rows in order, once each, from half a
// window before `first` on. The plain path restarts every 32 rows and may begin up to 31 rows
// earlier.
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/window_rows.hpp"
#include "fingerpad/image/detail/window_vector.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

// Two channels of an interleaved row (BGR, RGBA, ...) as two contiguous rows.

#if defined(FINGERPAD_HAS_VECTORS)
/// 16 pixels of C interleaved bytes, as one vector per channel. Riffling (interleaving) the two
/// halves of 16 C bytes takes byte i to 2 i modulo 16 C - 1. Four riffles multiply by 16 and
/// therefore take channel c of pixel p, byte C p + c, to byte p + 16 c.
template <std::size_t C>
using Planes = std::array<lanes<std::uint8_t, 16>, C>;

/// Interleaves the bytes of units A and B, where unit u is half u % 2 of vector u / 2.
template <std::size_t A, std::size_t B, std::size_t C>
[[gnu::always_inline]] inline lanes<std::uint8_t, 16> riffle_units(const Planes<C>& v) {
  using V = lanes<std::uint8_t, 16>;
  using Words = lanes<std::uint64_t, 2>;
  const V a = v[A / 2];
  if constexpr (A % 2 == B % 2) {
    const Two<V> both = zip<16>(a, v[B / 2]);
    return A % 2 == 0 ? both.first : both.second;
  } else {
    const Words b = Words(v[B / 2]);
    const Two<V> both = zip<16>(a, V(__builtin_shufflevector(b, b, 1, 0)));
    return A % 2 == 0 ? both.first : both.second;
  }
}

template <std::size_t C, std::size_t... I>
[[gnu::always_inline]] inline Planes<C> riffle(const Planes<C>& v, std::index_sequence<I...>) {
  return {riffle_units<I, I + C>(v)...};
}
#endif

/// red[i] = from[channels i + red_offset], and likewise green, for i < n.
template <int channels, class Pixel, int VectorBytes = native_vector_bytes>
void load_interleaved_row(
    const Pixel* from, Index n, int red_offset, int green_offset, Pixel* red, Pixel* green) {
  Index i = 0;
#if defined(FINGERPAD_HAS_VECTORS)
  if constexpr (sizeof(Pixel) == 1 && channels >= 2 && channels <= 4) {
    constexpr std::size_t C = std::size_t(channels);
    constexpr auto all = std::make_index_sequence<C>{};
    for (; i + 16 <= n; i += 16) {
      Planes<C> planes;
      for (std::size_t c = 0; c < C; ++c) {
        planes[c] = load<std::uint8_t, 16>(from + channels * i + 16 * Index(c));
      }
      planes = riffle(riffle(riffle(riffle(planes, all), all), all), all);
      for (std::size_t c = 0; c < C; ++c) {
        if (int(c) == red_offset) {
          store(red + i, planes[c]);
        }
        if (int(c) == green_offset) {
          store(green + i, planes[c]);
        }
      }
    }
  }
#endif
  for (; i < n; ++i) {
    red[i] = from[channels * i + red_offset];
    green[i] = from[channels * i + green_offset];
  }
}

// Window means for any number: float, double, long double, a dual number, 50 digits, or integers.
// Plain running sums, down the columns and then along the row. See window_sums.hpp for the
// contract.

template <class Pixel, int Windows = 1>
class RunningWindowSums {
 public:
  using Mean = window_mean_t<Pixel>;
  using Sum = std::conditional_t<std::integral<Pixel>,
                                 std::uint32_t,
                                 std::conditional_t<std::same_as<Pixel, float>, double, Pixel>>;

  RunningWindowSums(Index rows,
                    Index cols,
                    const std::array<int, std::size_t(Windows)>& window_px,
                    const window_limits_t<Pixel>& limits,
                    float scale = 1)
      : rows_(rows),
        cols_(cols),
        radius_(window_radii<Windows>(window_px)),
        limits_(limits),
        scale_(scale) {
    expects(rows >= 1, "WindowSums", "rows", rows, ">= 1");
    expects(cols >= 1, "WindowSums", "cols", cols, ">= 1");
    ring_.resize(std::size_t(2 * radius_.back() + 2));
    for (Row& row : ring_) {
      row = Row{Pixels(size(), Pixel(0)), Pixels(size(), Pixel(0)), Bytes(size(), 1)};
    }
    for (ColumnSums& sums : sums_) {
      sums = ColumnSums{Sums(size(), Sum(0)), Sums(size(), Sum(0)), Counts(size(), 0)};
    }
  }

  /// Prepares for row `first_row`. Sums restart at fixed rows, because rounded sums depend on the
  /// row where they start: bands of one image then agree in every bit.
  template <row_source<Pixel> Load>
  void start(Index first_row, Load&& load_row) {
    next_row_ = first_row - first_row % restart_rows;
    for (Index row = next_row_ - radius_.back(); row < next_row_ + radius_.back(); ++row) {
      take_in(row, load_row);
    }
    while (next_row_ < first_row) {
      slide(load_row);
    }
  }

  Index next_row() const { return next_row_; }

  /// Writes the means of row next_row() and advances next_row() by one.
  template <row_source<Pixel> Load>
  void advance(Load&& load_row, const MeanRows<Mean> (&out)[std::size_t(Windows)]) {
    slide(load_row);
    for (std::size_t k = 0; k < sums_.size(); ++k) {
      average(k, out[k]);
    }
  }

 private:
  using Pixels = std::vector<Pixel>;
  using Bytes = std::vector<std::uint8_t>;
  using Sums = std::vector<Sum>;
  using Counts = std::vector<std::uint16_t>;
  struct Row {
    Pixels red, green;
    Bytes valid;
  };
  struct ColumnSums {
    Sums red, green;
    Counts count;
  };
  static constexpr Index restart_rows = 32;

  std::size_t size() const { return std::size_t(cols_); }
  bool in_image(Index row) const { return row >= 0 && row < rows_; }
  Row& slot(Index row) { return ring_[std::size_t(row) % ring_.size()]; }

  bool counts(const Pixel& v) const { return limits_.dark < v && v < limits_.saturated; }

  template <class Load>
  void take_in(Index row, Load& load_row) {
    if (!in_image(row)) {
      return;
    }
    Row& to = slot(row);
    if constexpr (masked_row_source<Load, Pixel>) {
      load_row(row, to.red.data(), to.green.data(), to.valid.data());
    } else {
      load_row(row, to.red.data(), to.green.data());
    }
    for (std::size_t j = 0; j < size(); ++j) {
      const bool inside = !masked_row_source<Load, Pixel> || to.valid[j] != 0;
      const bool valid = inside && counts(to.red[j]) && counts(to.green[j]);
      to.valid[j] = valid;
      if (!valid) {
        to.red[j] = to.green[j] = Pixel(0);
      }
    }
  }

  template <class Load>
  void slide(Load& load_row) {
    const Index row = next_row_++;
    take_in(row + radius_.back(), load_row);
    for (std::size_t k = 0; k < sums_.size(); ++k) {
      const Index r = radius_[k];
      if (row % restart_rows != 0) {
        add_row(sums_[k], row + r);
        subtract_row(sums_[k], row - r - 1);
        continue;
      }
      sums_[k].red.assign(size(), Sum(0));
      sums_[k].green.assign(size(), Sum(0));
      sums_[k].count.assign(size(), 0);
      for (Index i = row - r; i <= row + r; ++i) {
        add_row(sums_[k], i);
      }
    }
  }

  void add_row(ColumnSums& sums, Index row) {
    if (!in_image(row)) {
      return;
    }
    const Row& from = slot(row);
    for (std::size_t j = 0; j < size(); ++j) {
      sums.red[j] = Sum(sums.red[j] + Sum(from.red[j]));
      sums.green[j] = Sum(sums.green[j] + Sum(from.green[j]));
      sums.count[j] = std::uint16_t(sums.count[j] + from.valid[j]);
    }
  }

  void subtract_row(ColumnSums& sums, Index row) {
    if (!in_image(row)) {
      return;
    }
    const Row& from = slot(row);
    for (std::size_t j = 0; j < size(); ++j) {
      sums.red[j] = Sum(sums.red[j] - Sum(from.red[j]));
      sums.green[j] = Sum(sums.green[j] - Sum(from.green[j]));
      sums.count[j] = std::uint16_t(sums.count[j] - from.valid[j]);
    }
  }

  void average(std::size_t k, const MeanRows<Mean>& out) const {
    const ColumnSums& sums = sums_[k];
    const Index r = radius_[k];
    Sum red(0), green(0);
    int count = 0;
    for (Index j = -r; j < cols_; ++j) {
      if (j + r < cols_) {
        const std::size_t in = std::size_t(j + r);
        red = Sum(red + sums.red[in]);
        green = Sum(green + sums.green[in]);
        count += sums.count[in];
      }
      if (j > r) {
        const std::size_t past = std::size_t(j - r - 1);
        red = Sum(red - sums.red[past]);
        green = Sum(green - sums.green[past]);
        count -= sums.count[past];
      }
      if (j < 0) {
        continue;
      }
      out.red[j] = mean(red, std::uint16_t(count));
      if (k == 0) {
        out.green[j] = mean(green, std::uint16_t(count));
      }
    }
  }

  Mean mean(const Sum& sum, std::uint16_t count) const {
    if constexpr (std::integral<Pixel>) {
      return window_mean(sum, count) * scale_;
    } else {
      return count == 0 ? not_a_number<Mean>() : Mean(sum / Sum(int(count)));
    }
  }

  Index rows_, cols_;
  std::array<Index, std::size_t(Windows)> radius_;
  window_limits_t<Pixel> limits_;
  float scale_;
  Index next_row_ = 0;
  std::vector<Row> ring_;
  std::array<ColumnSums, std::size_t(Windows)> sums_;
};

template <class Pixel, int Windows, int VectorBytes>
struct WindowSumsOf {
  using type = RunningWindowSums<Pixel, Windows>;
};
#if defined(FINGERPAD_HAS_VECTORS)
template <class Pixel, int Windows, int VectorBytes>
  requires(VectorBytes > 0 &&
           (std::same_as<Pixel, std::uint8_t> || std::same_as<Pixel, std::uint16_t>))
struct WindowSumsOf<Pixel, Windows, VectorBytes> {
  using type = VectorWindowSums<Pixel, Windows, VectorBytes>;
};
#endif

/// The fastest implementation for pixels of this type; VectorBytes = 0 selects the plain one.
template <class Pixel, int Windows = 1, int VectorBytes = native_vector_bytes>
using WindowSums = typename WindowSumsOf<Pixel, Windows, VectorBytes>::type;

}  // namespace detail

}  // namespace v0
}  // namespace fingerpad
