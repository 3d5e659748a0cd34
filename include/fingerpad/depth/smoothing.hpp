// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How colours are averaged before a depth is looked for: one grey level of noise in both channels
// is 0.7 mm of depth in a single pixel, so some hundred pixels have to be averaged. The means leave
// out pixels that carry no information (outside the pad, dark, saturated, NaN) and cost the same
// per pixel whatever the window.
//
// A mean over a curved membrane is biased by curvature times window^2 / 24 per axis, and near the
// rim, where the window is cut, also by slope. BiasFreeMean removes the first; Anchored<> removes
// both where the pad has its free shape and most of it elsewhere, since it averages not the colours
// but their deviation from what the free pad's shape predicts. See docs/depth/depth.md for their errors.
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>

#include "fingerpad/core/expects.hpp"
#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v0 {

/// Each pixel for itself.
struct NoSmoothing {};

/// The published mean over a square window of window_px (odd, 3..255) pixels a side.
struct BoxMean {
  int window_px = 29;
};

/// a box(inner) - b box(outer), centered alike, with a - b = 1 and the second moments cancelling:
/// exact for quadratic fields where nothing is cut. Inner and outer are 1.4 and 2.3 times
/// window_px, which gives the noise of a BoxMean of window_px. window_px odd, 3..109.
struct BiasFreeMean {
  int window_px = 29;
};

/// Averages the deviation from the free pad's depth: see the top of this file.
template <class Mean>
struct Anchored {
  Mean mean = {};
};

namespace detail {

/// The odd number nearest to x.
inline int nearest_odd(double x) {
  return 2 * static_cast<int>(std::floor(x / 2)) + 1;
}

/// What a smoothing policy means for the rows: how many windows, their sizes and their weights.
template <class Smoothing>
struct WindowsOf;

template <>
struct WindowsOf<BoxMean> {
  static constexpr int count = 1;
  static constexpr bool anchored = false;
  static std::array<int, 1> sizes_px(const BoxMean& mean) { return {mean.window_px}; }
};

template <>
struct WindowsOf<BiasFreeMean> {
  static constexpr int count = 2;
  static constexpr bool anchored = false;
  static std::array<int, 2> sizes_px(const BiasFreeMean& mean) {
    expects(mean.window_px >= 3 && mean.window_px <= 109 && mean.window_px % 2 == 1, "BiasFreeMean",
            "window_px", static_cast<long long>(mean.window_px), "odd, 3..109");
    return {nearest_odd(1.4 * mean.window_px), nearest_odd(2.3 * mean.window_px)};
  }
};

template <class Mean>
struct WindowsOf<Anchored<Mean>> {
  static constexpr int count = WindowsOf<Mean>::count;
  static constexpr bool anchored = true;
  static auto sizes_px(const Anchored<Mean>& smoothing) {
    return WindowsOf<Mean>::sizes_px(smoothing.mean);
  }
};

/// Weights of the means of windows of these sizes: they add up to 1 and, where there are two, their
/// second moments (w^2 - 1) / 12 cancel.
inline std::array<double, 1> window_weights(const std::array<int, 1>&) {
  return {1};
}
inline std::array<double, 2> window_weights(const std::array<int, 2>& size_px) {
  const double inner = size_px[0] * size_px[0] - 1;
  const double outer = size_px[1] * size_px[1] - 1;
  return {outer / (outer - inner), -inner / (outer - inner)};
}

}  // namespace detail
}  // namespace v0
}  // namespace fingerpad
