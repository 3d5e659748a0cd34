// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Which pixels of a row count: those inside the pad with both channels within a closed range.
#include <concepts>
#include <cstdint>

#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/window_rows.hpp"
#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// valid[j] becomes nonzero where inside[j] is and both channels are in `range`.
template <std::unsigned_integral Pixel, int VectorBytes = native_vector_bytes>
void mark_valid(const ClosedRange<Pixel>& range,
                const Pixel* red,
                const Pixel* green,
                const std::uint8_t* inside,
                std::uint8_t* valid,
                Index count) {
  Index j = 0;
#if defined(FINGERPAD_HAS_VECTORS)
  constexpr int n = VectorBytes / static_cast<int>(sizeof(Pixel));
  using V = lanes<Pixel, n>;
  const V low = V{} + range.low;
  const V high = V{} + range.high;
  for (; j + n <= count; j += n) {
    const V r = load<Pixel, n>(red + j);
    const V g = load<Pixel, n>(green + j);
    const V in_range = V((r >= low) & (r <= high) & (g >= low) & (g <= high));
    store(valid + j, convert<std::uint8_t, n>(in_range) & load<std::uint8_t, n>(inside + j));
  }
#endif
  for (; j < count; ++j) {
    const bool in_range = red[j] >= range.low && red[j] <= range.high && green[j] >= range.low &&
                          green[j] <= range.high;
    valid[j] = in_range ? inside[j] : std::uint8_t(0);
  }
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
