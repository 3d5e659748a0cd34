// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Means of two channels over square windows, with the number of pixels behind each, down the rows.
// A window holds the valid pixels of w x w (odd, 3..255) around a pixel: those of the image, inside
// the caller's mask, with both channels between the limits. Where none is, the mean is NaN.
//
// 8- and 16-bit sums are exact; whole windows give the bits of a float box filter. Each object is
// the workspace of one thread, all of it taken at construction; a band of rows gives the bits that
// the whole image gives. Several windows share all work but the last step.
//
//   WindowSums<std::uint8_t, 2> sums(rows, cols, {33, 55}, {0, 255});
//   sums.start(first, load_row);  // load_row(row, red, green) or (row, red, green, inside)
//   for (Index row = first; row < last; ++row) sums.advance(load_row, {{r33, g33}, {r55, g55}});
//
// Two more arguments of the constructor: green_windows limits green to the first so many windows,
// and scale multiplies the means of integers. load_row is asked for rows in order, once each, from
// half a window before `first` on (the plain path, which starts anew every 32 rows, may begin that
// much earlier).
#include <concepts>
#include <cstdint>

#include "fingerpad/image/detail/lanes.hpp"
#include "fingerpad/image/detail/window_interleaved.hpp"
#include "fingerpad/image/detail/window_running.hpp"
#if defined(FINGERPAD_HAS_VECTORS)
#include "fingerpad/image/detail/window_vector.hpp"
#endif

namespace fingerpad {
inline namespace v0 {
namespace detail {

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

/// The fastest way there is to sum pixels of this type; VectorBytes = 0 asks for the plain one.
template <class Pixel, int Windows = 1, int VectorBytes = native_vector_bytes>
using WindowSums = typename WindowSumsOf<Pixel, Windows, VectorBytes>::type;

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
