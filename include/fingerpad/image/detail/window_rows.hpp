// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Shared by both implementations of window sums: which pixels count, how rows are passed in and
// out, and how a sum and a count become a mean. See window_sums.hpp.
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "fingerpad/core/expects.hpp"
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
    expects(size % 2 == 1 && size > before && size <= 255, "WindowSums", "window_px", size,
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

/// The mean of integer pixels. It multiplies by the reciprocal, as box filters do, so that complete
/// windows give the same bits and both channels can share one division.
inline float window_mean(std::uint32_t sum, std::uint16_t count) {
  return count == 0 ? not_a_number<float>() : float(sum) * (1.0f / float(count));
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
