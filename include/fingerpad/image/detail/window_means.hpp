// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Means of two channels over square windows, row by row from top to bottom. A window holds the
// valid pixels among the w x w (odd, 3..255) around a pixel: those in the image, inside the
// caller's mask, with both channels between the limits. Without a valid pixel the mean is NaN.
//
// 8- and 16-bit sums are exact; complete windows give the bits of a float box filter. A band of
// rows gives the same bits as the whole image. Each object is the workspace of one thread and
// allocates only at construction.
//
//   WindowMeans<std::uint8_t, 2> means(rows, cols, {33, 55}, {0, 255});
//   means.start(first, load_row);  // load_row(row, red, green) or (row, red, green, inside)
//   for (Index row = first; row < last; ++row) {
//     means.advance(load_row, {{r33, g33}, {r55, nullptr}});
//   }
//
// Green is averaged over the first window only. load_row is called for rows in order, once each,
// from half a window before `first` on. Rounded sums restart every 32 rows and may begin up to 31
// rows earlier. Loops over pixels are blocks of a length known to the compiler, which GCC 12
// vectorises at -O2 unless it inlines them: then it forgets __restrict (tests/vectors).
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// A pixel counts if dark < red < saturated and dark < green < saturated; NaN never counts.
template <class S>
struct ValueLimits {
  S dark;
  S saturated;
};

/// Limits are given as double for integer pixels (5.5 and infinity are fine), else in the pixel
/// type.
template <class Pixel>
using window_limits_t = ValueLimits<real_of_t<Pixel>>;

/// The type of a mean: float for integer pixels, whose sums are exact, else the pixel type.
template <class Pixel>
using window_mean_t = std::conditional_t<std::integral<Pixel>, float, Pixel>;

/// Output of one row of means, `cols` elements each; green for the first window only.
template <class Mean>
struct MeanRows {
  Mean* red;
  Mean* green;
};

/// The integer pixels inside an open interval as a closed range; [1, 0] if there are none.
template <std::unsigned_integral Pixel>
struct ClosedRange {
  Pixel low;
  Pixel high;

  constexpr ClosedRange(const ValueLimits<double>& open) : low(1), high(0) {
    constexpr double top = double((std::numeric_limits<Pixel>::max)());
    const double first = open.dark < 0 ? 0 : std::floor(open.dark) + 1;
    const double last = open.saturated > top ? top : std::ceil(open.saturated) - 1;
    if (!(first <= last)) {  // also for NaN
      return;
    }
    low = static_cast<Pixel>(first);
    high = static_cast<Pixel>(last);
  }
};

/// Half widths of the windows; refuses sizes that are even, out of range or not increasing.
template <int Windows>
std::array<Index, std::size_t(Windows)> window_radii(
    const std::array<int, std::size_t(Windows)>& sizes_px) {
  static_assert(Windows >= 1);
  std::array<Index, std::size_t(Windows)> radii{};
  int before = 1;
  for (std::size_t k = 0; k < sizes_px.size(); ++k) {
    const int size = sizes_px[k];
    expects(size % 2 == 1 && size > before && size <= 255, "WindowMeans", "window_px", size,
            "odd, 3..255, and larger than the window before it");
    before = size;
    radii[k] = size / 2;
  }
  return radii;
}

/// A caller's row source: load(row, red, green), or load(row, red, green, inside), which also fills
/// one byte per pixel, nonzero where the pixel may count. Only rows inside the image are requested.
template <class Load, class Pixel>
concept masked_row_source = std::invocable<Load&, Index, Pixel*, Pixel*, std::uint8_t*>;
template <class Load, class Pixel>
concept row_source = masked_row_source<Load, Pixel> || std::invocable<Load&, Index, Pixel*, Pixel*>;

template <class Pixel, int Windows = 1>
class WindowMeans {
 public:
  using Mean = window_mean_t<Pixel>;

  WindowMeans(Index rows,
              Index cols,
              const std::array<int, std::size_t(Windows)>& window_px,
              const window_limits_t<Pixel>& limits)
      : rows_(rows),
        cols_(cols),
        padded_((cols + block - 1) / block * block),
        radius_(window_radii<Windows>(window_px)),
        limits_(limits) {
    expects(rows >= 1, "WindowMeans", "rows", rows, ">= 1");
    expects(cols >= 1, "WindowMeans", "cols", cols, ">= 1");
    ring_.assign(std::size_t(2 * radius_.back() + 2), Row(padded_));
    none_ = Row(padded_);
    along_ = Sums(padded_ + 2 * radius_.back() + 1);
    sums_.fill(Sums(padded_));
  }

  /// Prepares for row `first_row`. Rounded sums depend on the row where they start, so they start
  /// at fixed rows.
  template <row_source<Pixel> Load>
  void start(Index first_row, Load&& load_row) {
    next_row_ = std::integral<Pixel> ? first_row : first_row - first_row % restart_rows;
    for (Index row = next_row_ - radius_.back(); row < next_row_ + radius_.back(); ++row) {
      take_in(row, load_row);
    }
    restarts_ = true;
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
      const Index r = radius_[k];
      sum_along(sums_[k].count, r, along_.count);
      average(sums_[k].red, r, along_.red, out[k].red);
      if (k == 0) {
        average(sums_[k].green, r, along_.green, out[k].green);
      }
    }
  }

 private:
  static constexpr Index block = 64;
  static constexpr Index restart_rows = 32;
  // Integers wrap, so that differences of running sums are exact; floats are summed in double.
  using Sum = std::conditional_t<std::integral<Pixel>,
                                 std::uint32_t,
                                 std::conditional_t<std::same_as<Pixel, float>, double, Pixel>>;

  template <class Value, class Count>
  struct Planes {
    std::vector<Value> red, green;
    std::vector<Count> count;

    explicit Planes(Index size = 0)
        : red(std::size_t(size), Value(0)), green(red), count(red.size(), Count(0)) {}
    void clear() {
      std::fill(red.begin(), red.end(), Value(0));
      std::fill(green.begin(), green.end(), Value(0));
      std::fill(count.begin(), count.end(), Count(0));
    }
  };
  using Row = Planes<Pixel, std::uint8_t>;
  using Sums = Planes<Sum, std::uint32_t>;

  bool in_image(Index row) const { return row >= 0 && row < rows_; }
  Row& slot(Index row) { return ring_[std::size_t(row) % ring_.size()]; }
  const Row& row_or_none(Index row) { return in_image(row) ? slot(row) : none_; }

  /// Reads a row and sets its invalid pixels to 0 in both channels.
  template <class Load>
  void take_in(Index row, Load& load_row) {
    if (!in_image(row)) {
      return;
    }
    Row& to = slot(row);
    if constexpr (masked_row_source<Load, Pixel>) {
      load_row(row, to.red.data(), to.green.data(), to.count.data());
    } else {
      load_row(row, to.red.data(), to.green.data());
      std::fill(to.count.begin(), to.count.end(), std::uint8_t(1));
    }
    std::fill(to.count.begin() + cols_, to.count.end(), std::uint8_t(0));
    for (Index j = 0; j < padded_; j += block) {
      clean(limits_, to.red.data() + j, to.green.data() + j, to.count.data() + j);
    }
  }

  [[gnu::noinline]] static void clean(const window_limits_t<Pixel>& limits,
                                      Pixel* __restrict red,
                                      Pixel* __restrict green,
                                      std::uint8_t* __restrict valid) {
    if constexpr (std::integral<Pixel>) {
      const ClosedRange<Pixel> range(limits);
      const Pixel low = range.low, high = range.high;
      Pixel keep[block];  // all bits of a valid pixel
      for (Index i = 0; i < block; ++i) {
        const bool in_range =
            (red[i] >= low) & (red[i] <= high) & (green[i] >= low) & (green[i] <= high);
        keep[i] = Pixel(-int(in_range & (valid[i] != 0)));
      }
      for (Index i = 0; i < block; ++i) {
        red[i] = Pixel(red[i] & keep[i]);
      }
      for (Index i = 0; i < block; ++i) {
        green[i] = Pixel(green[i] & keep[i]);
      }
      for (Index i = 0; i < block; ++i) {
        valid[i] = std::uint8_t(keep[i] & 1);
      }
    } else {
      const auto counts = [&](const Pixel& x) { return limits.dark < x && x < limits.saturated; };
      for (Index i = 0; i < block; ++i) {
        valid[i] = valid[i] != 0 && counts(red[i]) && counts(green[i]);
        if (valid[i] == 0) {
          red[i] = green[i] = Pixel(0);
        }
      }
    }
  }

  /// Moves the sums over the columns of all windows down by one row.
  template <class Load>
  void slide(Load& load_row) {
    const Index row = next_row_++;
    take_in(row + radius_.back(), load_row);
    const bool anew = restarts_ || (!std::integral<Pixel> && row % restart_rows == 0);
    restarts_ = false;
    for (std::size_t k = 0; k < sums_.size(); ++k) {
      const Index r = radius_[k];
      if (anew) {
        sums_[k].clear();
      }
      for (Index i = anew ? row - r : row + r; i <= row + r; ++i) {
        const Row& in = row_or_none(i);
        const Row& out = anew ? none_ : row_or_none(row - r - 1);
        move(in.red, out.red, sums_[k].red);
        if (k == 0) {
          move(in.green, out.green, sums_[k].green);
        }
        move(in.count, out.count, sums_[k].count);
      }
    }
  }

  template <class T, class N>
  static void move(const std::vector<T>& in, const std::vector<T>& out, std::vector<N>& sum) {
    for (std::size_t j = 0; j < sum.size(); j += std::size_t(block)) {
      move(in.data() + j, out.data() + j, sum.data() + j);
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
      if (j + block <= cols_) {
        divide(sum, sum + width, count, count + width, to + j);
      } else {
        Mean last[block];
        divide(sum, sum + width, count, count + width, last);
        std::copy_n(last, cols_ - j, to + j);
      }
    }
  }

  /// The mean of integers multiplies by the reciprocal, as box filters do, so that complete windows
  /// give the same bits.
  [[gnu::noinline]] static void divide(const Sum* sum_before,
                                       const Sum* sum_after,
                                       const std::uint32_t* before,
                                       const std::uint32_t* after,
                                       Mean* __restrict to) {
    for (Index i = 0; i < block; ++i) {
      const int count = int(after[i] - before[i]);
      if constexpr (std::integral<Pixel>) {
        to[i] = float(sum_after[i] - sum_before[i]) * (1.0f / float(count));  // 0 / 0 is NaN
      } else {
        to[i] =
            count == 0 ? not_a_number<Mean>() : Mean((sum_after[i] - sum_before[i]) / Sum(count));
      }
    }
  }

  Index rows_, cols_, padded_;
  std::array<Index, std::size_t(Windows)> radius_;
  window_limits_t<Pixel> limits_;
  Index next_row_ = 0;
  bool restarts_ = true;
  std::vector<Row> ring_;
  Row none_;    // a row outside the image
  Sums along_;  // running sums along the row
  std::array<Sums, std::size_t(Windows)> sums_;
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
