// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What became of a pixel. Where the status is not `ok` the depth is NaN; it is never clamped.
#include <cstddef>
#include <cstdint>

namespace fingerpad {
inline namespace v0 {

enum class PixelStatus : std::uint8_t {
  ok = 0,            ///< the depth is right
  below_range = 1,   ///< the colours ask for a depth below zero
  above_range = 2,   ///< the colours ask for a depth above max_depth_mm
  not_a_number = 3,  ///< a colour is NaN or infinite
  dark = 4,          ///< a colour is at or below the dark limit
  saturated = 5,     ///< a colour is at or above the saturation limit
  outside_pad = 6,   ///< the reference has no depth here
};
inline constexpr std::size_t pixel_status_count = 7;

}  // namespace v0
}  // namespace fingerpad
