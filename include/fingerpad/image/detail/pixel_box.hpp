// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Rectangles of pixels.
#include <algorithm>

#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Rows and columns [first, last).
struct PixelBox {
  Index first_row = 0;
  Index last_row = 0;
  Index first_col = 0;
  Index last_col = 0;

  /// The box grown by `by_px` pixels on every side, clipped to the image.
  PixelBox grown(Index by_px, Index rows, Index cols) const {
    return {(std::max)(first_row - by_px, Index(0)), (std::min)(last_row + by_px, rows),
            (std::max)(first_col - by_px, Index(0)), (std::min)(last_col + by_px, cols)};
  }
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
