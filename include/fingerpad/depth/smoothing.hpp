// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Averages colours before the depth is computed. One grey level of noise in both channels is 0.7 mm
// of depth in a single pixel, so several hundred pixels must be averaged. The means leave out
// pixels that carry no information (outside the pad, dark, saturated, NaN). The cost per pixel does
// not depend on the window.
//
// A mean of colours over a curved membrane is biased by curvature times window^2 / 24 per axis, and
// near the rim, where the window is cut, also by slope. Therefore the deviation of the colours from
// the prediction for the free pad is averaged instead: this is exact where the pad has its free
// shape, and nearly exact elsewhere. The errors are in docs/depth/depth.md.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"

namespace fingerpad {
inline namespace v0 {

namespace detail {

/// The odd number nearest to x.
inline int nearest_odd(double x) {
  return 2 * static_cast<int>(std::floor(x / 2)) + 1;
}

}  // namespace detail

/// The difference of two means of the deviations over concentric square windows,
/// a box(inner) - b box(outer), with a - b = 1 and second moments that cancel. It is exact for
/// quadratic deviations where no window is cut. Inner and outer are 1.4 and 2.3 times window_px,
/// which gives the noise of a mean over window_px. The default; use it for curved contacts.
struct BiasFreeMean {
  static constexpr bool anchored = true;
  int window_px = 29;  ///< odd, 3..109
  int step = 1;        ///< pixels from one sample to the next, for sampled frames

  /// Sizes of the windows in samples, at least 3.
  std::array<int, 2> windows_px() const {
    expects(window_px >= 3 && window_px <= 109 && window_px % 2 == 1, "BiasFreeMean", "window_px",
            static_cast<long long>(window_px), "odd, 3..109");
    expects(step >= 1, "BiasFreeMean", "step", step, ">= 1");
    const int inner = (std::max)(3, detail::nearest_odd(1.4 * window_px / step));
    return {inner, (std::max)(inner + 2, detail::nearest_odd(2.3 * window_px / step))};
  }
};

/// The mean of the deviations over a square window. Use it when time matters and contacts are flat.
struct AnchoredMean {
  static constexpr bool anchored = true;
  int window_px = 29;  ///< odd, 3..255
  int step = 1;        ///< pixels from one sample to the next, for sampled frames

  /// Sizes of the windows in samples, at least 3.
  std::array<int, 1> windows_px() const {
    expects(step >= 1, "AnchoredMean", "step", step, ">= 1");
    const int nearest = detail::nearest_odd(static_cast<double>(window_px) / step);
    return {step == 1 ? window_px : (std::max)(3, nearest)};
  }
};

/// No averaging. Use it for frames without noise, for instance rendered ones.
struct NoSmoothing {
  static constexpr bool anchored = false;
};

namespace detail {

/// Weights of the means over windows of these sizes. They add up to 1; with two windows, the second
/// moments (w^2 - 1) / 12 cancel.
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
