// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Grids of samples, and the depth of a pixel between them.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/depth/sampling.hpp"

namespace fingerpad {
inline namespace v0 {
namespace detail {

/// A grid that owns its cells.
template <class T>
struct OwnedGrid {
  Index rows = 0, cols = 0;
  std::vector<T> cells = {};
  OwnedGrid() = default;
  OwnedGrid(Index height, Index width)
      : rows(height), cols(width), cells(static_cast<std::size_t>(height * width)) {}
  StridedView<T> view() { return {cells.data(), rows, cols, cols}; }
  StridedView<const T> view() const { return {cells.data(), rows, cols, cols}; }
};

/// The free pad, and its samples: constant, and shared by all copies of a fingertip.
template <scalar S>
struct SampledPad {
  int step;
  DepthReference<S> pixels, samples;
  std::vector<PadArea> spans;  ///< in each row of samples, from the first of the pad to the last

  SampledPad(const DepthReference<S>& reference, int pixels_a_sample)
      : step(pixels_a_sample), pixels(reference), samples(sampled(reference, step)) {
    pixels.scattering = pixels.red_gain = {};  // only its depth is needed
    for (Index i = 0; i < samples.rows; ++i) {
      PadArea row{i, 0, 1, 0};
      for (Index j = 0; j < samples.cols; ++j) {
        if (samples.in_pad(i, j)) {
          row.col = row.cols == 0 ? j : row.col;
          row.cols = j + 1 - row.col;
        }
      }
      spans.push_back(row);
    }
  }

  Index own_row(Index px) const { return (std::min)(px / step, samples.rows - 1); }
  Index own_col(Index px) const { return (std::min)(px / step, samples.cols - 1); }
};

/// Depth of a pixel from the depth of the samples: the difference from the free pad is interpolated
/// bilinearly and added to the free pad. Beside missing samples it is extrapolated from the other
/// side. NaN where its own sample has none, except at the pad's rim, where a sample may hold only
/// some pixels.
template <scalar S>
S pixel_depth(const SampledPad<S>& free,
              const StridedView<const S>& samples_mm,
              const StridedView<const PixelStatus>& sample_status,
              Index row,
              Index col) {
  if (free.step == 1) {
    return samples_mm(row, col);
  }
  const PixelStatus own = sample_status(free.own_row(row), free.own_col(col));
  if (!free.pixels.in_pad(row, col) ||
      (own != PixelStatus::ok && own != PixelStatus::outside_pad)) {
    return not_a_number<S>();
  }
  struct Place {
    Index sample;  // the one before
    S behind;      // of it, in samples
    Index next;    // 0: a single sample is everywhere
  };
  const auto place = [&free](Index px, Index count) {
    const double at = sampled_px(static_cast<double>(px), free.step);
    const double last = static_cast<double>(count - 2);
    const double before = (std::max)(0.0, (std::min)(std::floor(at), last));
    return Place{static_cast<Index>(before), S(at - before), count > 1 ? 1 : 0};
  };
  const auto moved = [&](Index i, Index j) { return samples_mm(i, j) - free.samples.depth(i, j); };
  const Place down = place(row, samples_mm.rows()), right = place(col, samples_mm.cols());
  for (const Index di : {0, -1, 1}) {
    for (const Index dj : {0, -1, 1}) {
      const Index i = down.sample + di, j = right.sample + dj;
      if (i >= 0 && j >= 0 && i + down.next < samples_mm.rows() &&
          j + right.next < samples_mm.cols()) {
        const S along = right.behind - S(static_cast<double>(dj));
        const auto between = [&](Index k) {
          return moved(k, j) + along * (moved(k, j + right.next) - moved(k, j));
        };
        const S up = between(i), low = between(i + down.next);
        const S change = up + (down.behind - S(static_cast<double>(di))) * (low - up);
        if (change == change) {
          return free.pixels.depth(row, col) + change;
        }
      }
    }
  }
  return not_a_number<S>();
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
