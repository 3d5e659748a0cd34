// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The threshold of the contact test, from frames of the free pad: half of the pad's own curvature,
// the level at the edge of a contact (straight, whatever the radius of the ring), or less if the
// noise demands it. Source: the slides, consideration of calculation error, delta = min over the
// pad of E - 2 sigma, with the mean E of a pixel over the frames and its standard deviation sigma.
// As published, the single worst pixel sets the threshold, and its sigma takes dozens of frames.
// Here a quantile replaces the minimum and the sigma of the whole pad that of a pixel.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <type_traits>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/curvature.hpp"

namespace fingerpad {
inline namespace v0 {

/// The threshold and the curvature of the free pad, 1/mm.
template <scalar S = double>
struct [[nodiscard]] ThresholdFit {
  const char* cause = nullptr;  ///< likely mistake
  S threshold_per_mm = S(0);    ///< for ContactTest, > 0
  S median_per_mm = S(0);       ///< of E over the pad
  /// Standard error of the median, from the scatter of the frames' medians; half of it is that of a
  /// threshold set by the level. NaN for a single frame.
  S median_error_per_mm = not_a_number<S>();
  S noise_per_mm = S(0);  ///< root mean square of sigma over the pad; 0 for a single frame

  bool ok() const { return cause == nullptr; }
};

namespace detail {

/// Running mean and sum of squared deviations from it; NaN from the first NaN on.
template <scalar S>
struct Scatter {
  S mean = S(0), squares = S(0);
  void add(const S& x, const S& count) {
    const S change = x - mean;
    mean += change / count;
    squares += change * (x - mean);
  }
};

}  // namespace detail

/// min(median / 2, quantile - 2 sigma) of the mean curvatures E, with the quantile 0.001: about
/// that share of a free pad may be taken for contact. Takes a container of depth maps of the free
/// pad in mm: one determines the level, two the noise. Camera and ring must be those of the contact
/// test. Pixels without a curvature in a frame do not count. Refuses bad parameters, frames of
/// several sizes, and a pad without a positive threshold (parameter_error). Not ok: a pad flatter
/// than a sphere of 1 m. Curvatures are computed in S, as in the contact test, and summed in double
/// if S is float. Allocates; O(frames rows cols directions).
template <scalar S = float,
          class CameraType,
          class Frames,
          class T = std::conditional_t<std::is_same_v<S, float>, double, S>>
ThresholdFit<T> fit_contact_threshold(const CameraType& camera,
                                      const Frames& free_mm,
                                      double ring_px = 25,
                                      int directions = 18) {
  const char* const owner = "fit_contact_threshold";
  expects(std::size(free_mm) > 0, owner, "number of frames", 0LL, ">= 1");
  const auto first = as_view(*std::begin(free_mm));
  const Index rows = first.rows(), cols = first.cols();
  CurvatureMap<S> map(camera, rows, cols, ring_px, directions);
  std::vector<S> curvature(static_cast<std::size_t>(rows * cols));
  std::vector<T> known;
  std::vector<detail::Scatter<T>> pixels(curvature.size());
  detail::Scatter<T> median;
  const auto quantile = [](std::vector<T>& of, double share) {
    const auto at = of.begin() + static_cast<Index>(share * static_cast<double>(of.size() - 1));
    std::nth_element(of.begin(), at, of.end());
    return *at;
  };
  T count = T(0);  // of frames
  for (const auto& depth_mm : free_mm) {
    const bool fits = map(depth_mm, StridedView<S>(curvature.data(), rows, cols, cols)).has_value();
    expects(fits, owner, "rows of a frame", static_cast<long long>(as_view(depth_mm).rows()),
            "of the same size as the first frame");
    count += T(1);
    known.clear();
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      pixels[k].add(T(curvature[k]), count);
      if (is_finite(pixels[k].mean)) {
        known.push_back(T(curvature[k]));
      }
    }
    expects(!known.empty(), owner, "pixels", 0LL, ">= 1 with a curvature in every frame");
    median.add(quantile(known, 0.5), count);
  }
  known.clear();
  T squares = T(0);
  for (const detail::Scatter<T>& pixel : pixels) {
    if (is_finite(pixel.mean)) {
      known.push_back(pixel.mean);
      squares += pixel.squares;
    }
  }
  ThresholdFit<T> fit;
  if (T(1) < count) {
    using std::sqrt;
    const auto root = [](const T& x) { return T(0) < x ? sqrt(x) : T(0); };
    fit.noise_per_mm = root(squares / (T(static_cast<double>(known.size())) * (count - T(1))));
    fit.median_error_per_mm = root(median.squares / (count * (count - T(1))));
  }
  fit.median_per_mm = quantile(known, 0.5);
  fit.threshold_per_mm =
      (std::min)(fit.median_per_mm / T(2), quantile(known, 0.001) - T(2) * fit.noise_per_mm);
  expects(
      T(0) < fit.threshold_per_mm, owner, "threshold_per_mm", fit.threshold_per_mm,
      "> 0: the pad bulges too little for its noise; use a larger ring or smooth the depth more");
  if (fit.median_per_mm < T(1e-3)) {
    fit.cause = cause::depths_not_in_mm;
  }
  return fit;
}

}  // namespace v0
}  // namespace fingerpad
