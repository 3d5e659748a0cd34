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
#include <cstdint>
#include <iterator>
#include <numbers>
#include <type_traits>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/curvature.hpp"

namespace fingerpad {
inline namespace v1 {

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

/// The smallest press of a flat object on the apex that a contact test finds, and how often it
/// finds one where there is none.
struct [[nodiscard]] DetectionLimit {
  Index free_frames = 0;                      ///< that were judged
  Index false_frames = 0;                     ///< of them, seem touched
  double depth_mm = not_a_number<double>();   ///< found in nine of ten frames; NaN: none is
  double radius_mm = not_a_number<double>();  ///< of its contact
  /// Area of the contact: the press is the pressure times this area.
  double area_mm2() const { return std::numbers::pi * radius_mm * radius_mm; }
};

/// Lays dents into depth maps of the free pad in mm and looks for them; each is that of a shallow
/// membrane of this base radius under its own pressure, wider than the last by an eighth. The
/// curvature of the free pad is `free_per_mm`, as fit_contact_threshold() gives it. Refuses bad
/// parameters and frames of several sizes (parameter_error). Allocates; O(frames rows cols
/// directions) for each of some ten dents.
template <scalar S = float, class CameraType, class Frames>
DetectionLimit detection_limit(const CameraType& camera,
                               const Frames& free_mm,
                               const ContactTest& test,
                               double free_per_mm,
                               double base_radius_mm) {
  const char* const owner = "detection_limit";
  expects(std::size(free_mm) > 0, owner, "number of frames", 0LL, ">= 1");
  expects(free_per_mm > 0, owner, "free_per_mm", free_per_mm, "> 0");
  expects(base_radius_mm > 0, owner, "base_radius_mm", base_radius_mm, "> 0");
  const auto first = as_view(*std::begin(free_mm));
  const Index rows = first.rows(), cols = first.cols();
  ContactRegion<S> find(camera, rows, cols, test);
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(rows * cols));
  const auto touched = [&](double radius_mm) {
    Index count = 0;
    for (const auto& frame : free_mm) {
      const auto depth_mm = as_view(frame);
      const LazyView dented(depth_mm.rows(), depth_mm.cols(), [&](Index i, Index j) {
        const S l = static_cast<S>(depth_mm(i, j));
        if (!(radius_mm > 0) || !is_finite(l)) {
          return l;
        }
        const auto at = point_at(camera, static_cast<double>(i), static_cast<double>(j),
                                 static_cast<double>(l));
        const double r = std::hypot(at.x, at.y), a = radius_mm;
        const double dent_mm = r > a ? a * a * std::log(base_radius_mm / r)
                                     : a * a * std::log(base_radius_mm / a) + (a * a - r * r) / 2;
        return l - S((std::max)(0.0, dent_mm * free_per_mm));
      });
      const auto result = find(dented, StridedView<std::uint8_t>(mask.data(), rows, cols, cols));
      expects(result.accepted(), owner, "rows of a frame", static_cast<long long>(depth_mm.rows()),
              "of the same size as the first frame");
      count += result.in_contact() ? 1 : 0;
    }
    return count;
  };
  DetectionLimit limit;
  limit.free_frames = static_cast<Index>(std::size(free_mm));
  limit.false_frames = touched(0);
  for (double a = base_radius_mm / 32; a < base_radius_mm / 2; a *= 1.125) {
    if (10 * touched(a) >= 9 * limit.free_frames) {
      limit.radius_mm = a;
      limit.depth_mm = a * a * free_per_mm * (std::log(base_radius_mm / a) + 0.5);
      break;
    }
  }
  return limit;
}

}  // namespace v1
}  // namespace fingerpad
