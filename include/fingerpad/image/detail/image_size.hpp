// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The sizes of images that methods take memory for, and parts of images.
#include <algorithm>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// Refuses images without pixels, and those of more than any camera has: sizes of memory would
/// overflow (parameter_error).
inline void expects_image_size(const char* owner, Index rows, Index cols, Index fewest = 1) {
  const char* range = fewest == 1 ? "in [1, 1000000]" : "in [2, 1000000]";
  expects(rows >= fewest && rows <= 1000000, owner, "rows", static_cast<long long>(rows), range);
  expects(cols >= fewest && cols <= 1000000, owner, "cols", static_cast<long long>(cols), range);
  expects(rows * cols <= 100000000, owner, "rows times cols", static_cast<long long>(rows * cols),
          "<= 100000000");
}

/// Rows and columns [first, last).
struct PixelBox {
  Index first_row = 0;
  Index last_row = 0;
  Index first_col = 0;
  Index last_col = 0;

  /// Larger by so many pixels on every side, within the image.
  PixelBox grown(Index by_px, Index rows, Index cols) const {
    return {(std::max)(first_row - by_px, Index(0)), (std::min)(last_row + by_px, rows),
            (std::max)(first_col - by_px, Index(0)), (std::min)(last_col + by_px, cols)};
  }
};

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
