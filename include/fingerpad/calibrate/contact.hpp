// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The threshold of the contact test, from frames of the free pad: half of the pad's own curvature,
// the level at the edge of a contact (straight, whatever the radius of the ring), or less if noise
// would make a contact of more than one free frame in 10,000. Source: the slides, consideration of
// calculation error, delta = min over the pad of E - 2 sigma, with the mean E of a pixel over the
// frames and its standard deviation sigma. A pixel says nothing about a region, though, and the
// pixel of 300,000 that is lowest lies beyond 2 sigma. Here each frame says at which level noise
// makes a region that counts. As the lowest of many places it follows the law of least values
// (Gumbel), which a mean and a standard deviation extrapolate.
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
  S faint_per_mm = S(0);        ///< for ContactTest: what noise alone allows; 0: not known
  S median_per_mm = S(0);       ///< of E over the pad
  /// Standard error of the median, from the scatter of the frames' medians; half of it is that of a
  /// threshold set by the level. NaN for a single frame.
  S median_error_per_mm = not_a_number<S>();
  S region_per_mm = S(0);  ///< level at which noise makes a region in a free frame, mean
  S noise_per_mm = S(0);   ///< standard deviation of that level; 0 for a single frame

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

/// The level below which `pixels` connected pixels lie, between two others.
template <scalar S>
S level_of_region(const StridedView<S>& curvature, Regions& regions, Index pixels, S low, S high) {
  for (int round = 0; round < 20; ++round) {
    const S middle = (low + high) / S(2);
    for (Index i = 0; i < curvature.rows(); ++i) {
      mark_below(middle, curvature.row(i), curvature.cols(), regions.marks().row(i));
    }
    bool is_found = false;
    (void)regions.for_each(
        [&](const Regions::Region& region) {
          is_found = is_found || region.pixels() >= pixels;
          return false;
        },
        [](Regions::Region&) {});
    (is_found ? high : low) = middle;
  }
  return high;
}

/// By how many standard deviations the level that is undercut in one of 10,000 frames lies below
/// their mean, by Gumbel's law, and one standard error of that from so many frames. Fewer than 16
/// say nothing of rare ones: two, as published.
inline double rarely_below(double frames, int running) {
  if (frames < 16) {
    return 2;
  }
  const double share = std::pow(1e-4, 1.0 / running);
  const double k =
      -(std::numbers::egamma + std::log(-std::log1p(-share))) * std::sqrt(6) / std::numbers::pi;
  return k + std::sqrt((1 + 1.1396 * k + 1.1 * k * k) / frames);
}

}  // namespace detail

/// Half of the median curvature or, if that is less, what free frames undercut in `running` frames
/// one after the other once in 10,000: for a caller who believes a contact that is found in so many
/// (1 to 3). Takes a container of depth maps of the free pad in mm: one determines the level, 300
/// the noise; from fewer the threshold is lower, by the error that they leave, and from fewer than
/// 16 it is two standard deviations below the mean, whatever `running`. Camera, ring and
/// `region_px` must be those of the contact test. Pixels without a curvature in a frame do not
/// count. Refuses bad parameters, frames of several sizes, and a pad without a positive threshold
/// (parameter_error). Not ok: a pad flatter than a sphere of 1 m. Curvatures are computed in S, as
/// in the contact test, and summed in double if S is float. Allocates; O(frames rows cols
/// directions).
template <scalar S = float,
          class CameraType,
          class Frames,
          class T = std::conditional_t<std::is_same_v<S, float>, double, S>>
ThresholdFit<T> fit_contact_threshold(const CameraType& camera,
                                      const Frames& free_mm,
                                      double ring_px = 25,
                                      int directions = 18,
                                      Index region_px = 200,
                                      int running = 1) {
  const char* const owner = "fit_contact_threshold";
  expects(std::size(free_mm) > 0, owner, "number of frames", 0LL, ">= 1");
  require(owner, {{"region_px", region_px, at_least(1)}, {"running", running, within(1, 3)}});
  const auto first = as_view(*std::begin(free_mm));
  const Index rows = first.rows(), cols = first.cols();
  CurvatureMap<S> map(camera, rows, cols, ring_px, directions);
  const detail::BorderedImage image{rows, cols};
  detail::Regions regions(image);
  std::vector<S> curvature(static_cast<std::size_t>(rows * cols)), known;
  const StridedView<S> seen(curvature.data(), rows, cols, cols);
  detail::Scatter<T> median, level;
  T count = T(0);  // of frames
  for (const auto& depth_mm : free_mm) {
    const bool fits = map(depth_mm, seen).has_value();
    expects(fits, owner, "rows of a frame", static_cast<long long>(as_view(depth_mm).rows()),
            "of the same size as the first frame");
    count += T(1);
    known.clear();
    std::copy_if(curvature.begin(), curvature.end(), std::back_inserter(known),
                 [](const S& k) { return is_finite(k); });
    expects(!known.empty(), owner, "pixels", 0LL, ">= 1 with a curvature in every frame");
    const auto middle = known.begin() + static_cast<Index>(known.size() / 2);
    std::nth_element(known.begin(), middle, known.end());
    const S lowest = *std::min_element(known.begin(), middle + 1);
    median.add(T(*middle), count);
    level.add(T(detail::level_of_region(seen, regions, region_px, lowest, *middle)), count);
  }
  ThresholdFit<T> fit;
  fit.median_per_mm = median.mean;
  fit.region_per_mm = level.mean;
  T lowered = T(0);
  if (T(1) < count) {
    using std::sqrt;
    const auto root = [](const T& x) { return T(0) < x ? sqrt(x) : T(0); };
    fit.median_error_per_mm = root(median.squares / (count * (count - T(1))));
    fit.noise_per_mm = root(level.squares / (count - T(1)));
    lowered =
        T(detail::rarely_below(static_cast<double>(value(count)), running)) * fit.noise_per_mm;
  }
  fit.threshold_per_mm = (std::min)(fit.median_per_mm / T(2), fit.region_per_mm - lowered);
  fit.faint_per_mm = count < T(16) ? T(0) : fit.region_per_mm - lowered;
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
