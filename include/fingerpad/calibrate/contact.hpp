// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The threshold of the contact test, from frames of the free pad.
// Source: the slides, consideration of calculation error: delta = min over the pad of E - 2 sigma,
// where E is the statistic's mean over the frames and sigma its standard deviation.
//
// As published, the single worst pixel of the pad sets the threshold; here a quantile replaces the
// minimum. E - 2 sigma is the highest threshold that noise allows. It is not the level at the edge
// of the contact: at a straight edge this is half the level of the free pad, which is the default.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "fingerpad/calibrate/fit.hpp"
#include "fingerpad/core/check.hpp"
#include "fingerpad/core/grid.hpp"
#include "fingerpad/core/scalar.hpp"
#include "fingerpad/image/curvature.hpp"
#include "fingerpad/optics/camera.hpp"

namespace fingerpad {
inline namespace v0 {

/// delta = min(level_share x median of E, quantile over the pad of E - sigmas x sigma).
/// The sigma of a single pixel, as published, needs dozens of frames; that of the whole pad needs
/// two.
struct ThresholdRule {
  double level_share = 0.5;  ///< in (0, 1]
  double sigmas = 2;         ///< >= 0
  double quantile = 0.001;   ///< in [0, 0.5]; share of the free pad that may be taken for contact
  bool pooled_sigma = true;  ///< one sigma, the root mean square over the pad, for all pixels
};

/// Curvature of the free pad. All curvatures in 1/mm.
template <scalar S = double>
struct [[nodiscard]] FreePadCurvature {
  const char* cause = nullptr;  ///< likely mistake
  S threshold_per_mm = S(0);    ///< delta, for ContactTest
  S median_per_mm = S(0);       ///< of E over the pad
  /// Standard error of the median, from the scatter of the frames' medians; NaN for a single frame.
  /// Times level_share it is that of the threshold, if the level sets the threshold.
  S median_error_per_mm = not_a_number<S>();
  S noise_per_mm = S(0);   ///< root mean square of sigma over the pad; 0 for a single frame
  S edge_noise_mm = S(0);  ///< standard deviation of an edge point of a flat object due to this
                           ///< noise alone; smaller with a placed edge, which is smoothed
  Index pixels = 0;        ///< with a curvature in every frame
  int frames = 0;

  bool ok() const { return cause == nullptr; }
};

/// Collects mean curvatures of the free pad. Ring and camera must be those of the contact test.
/// Sums of float are double. Takes 32 bytes per pixel.
template <scalar S = float>
class FreePadCalibration {
  using T = std::conditional_t<std::is_same_v<S, float>, double, S>;

 public:
  /// Refuses bad parameters (parameter_error).
  template <class CameraType = Camera<double>>
  FreePadCalibration(const CameraType& camera,
                     Index rows,
                     Index cols,
                     const CurvatureRing& ring = {})
      : pixel_mm_(pitch_of(camera, rows, cols)),
        ring_px_(T(ring.radius_px)),
        map_(camera, rows, cols, ring),
        curvature_(static_cast<std::size_t>(rows * cols)),
        mean_(curvature_.size(), T(0)),
        squares_(curvature_.size(), T(0)) {}

  /// Adds the depth map of a frame, mm; false, and nothing changed, if it has another size.
  template <grid Depth>
  bool add(const Depth& depth_mm) {
    const StridedView<S> curvature(curvature_.data(), map_.rows(), map_.cols(), map_.cols());
    if (!map_(depth_mm, curvature).ok()) {
      return false;
    }
    ++frames_;
    of_frame_.clear();
    for (std::size_t k = 0; k < mean_.size(); ++k) {
      // a pixel without curvature in one frame remains NaN
      const T here = T(curvature_[k]);
      const T change = here - mean_[k];
      mean_[k] += T(change / T(frames_));
      squares_[k] += T(change * T(here - mean_[k]));
      if (is_finite(mean_[k])) {
        of_frame_.push_back(here);
      }
    }
    if (!of_frame_.empty()) {
      medians_.push_back(quantile(of_frame_, 0.5));
    }
    return true;
  }

  /// Refuses a rule out of range, no frames, no pixel with a curvature in all frames, and a pad for
  /// which the rule gives no positive threshold (parameter_error).
  FreePadCurvature<T> fit(const ThresholdRule& rule = {}) const {
    check(rule);
    FreePadCurvature<T> pad;
    pad.frames = frames_;
    std::vector<T> means;
    std::vector<T> sigmas;
    T variance = T(0);
    for (std::size_t k = 0; k < mean_.size(); ++k) {
      if (is_finite(squares_[k])) {
        const T of_pixel = frames_ > 1 ? T(squares_[k] / T(frames_ - 1)) : T(0);
        means.push_back(mean_[k]);
        sigmas.push_back(root_of(of_pixel));
        variance += of_pixel;
      }
    }
    pad.pixels = static_cast<Index>(means.size());
    expects(frames_ > 0, "FreePadCalibration", "frames", static_cast<long long>(frames_), ">= 1");
    expects(pad.pixels > 0, "FreePadCalibration", "pixels", static_cast<long long>(pad.pixels),
            ">= 1 with a curvature in every frame");
    pad.noise_per_mm = root_of(T(variance / T(static_cast<double>(pad.pixels))));
    std::vector<T> lows = means;
    for (std::size_t k = 0; k < lows.size(); ++k) {
      lows[k] -= T(T(rule.sigmas) * (rule.pooled_sigma ? pad.noise_per_mm : sigmas[k]));
    }
    pad.median_per_mm = quantile(means, 0.5);
    pad.median_error_per_mm = standard_error(medians_);
    const T level = T(rule.level_share) * pad.median_per_mm;
    const T low = quantile(lows, rule.quantile);
    pad.threshold_per_mm = low < level ? low : level;
    // the mean curvature across an edge rises by 4 / (pi r) of its jump per mm, see edge_level.hpp
    pad.edge_noise_mm =
        pad.noise_per_mm / pad.median_per_mm * T(0.785398163397448) * ring_px_ * pixel_mm_;
    expects(T(0) < pad.threshold_per_mm, "FreePadCalibration", "threshold_per_mm",
            pad.threshold_per_mm,
            "> 0: the pad bulges too little for its noise; use a larger ring or "
            "smooth the depth more");
    if (pad.median_per_mm < T(1e-3)) {  // a sphere of 1 m radius: no pad is as flat
      pad.cause = cause::depths_not_in_mm;
    } else if (2 * means.size() < mean_.size()) {
      pad.cause =
          "fewer than half of the pixels have a depth: "
          "check calibration, exposure and frame";
    }
    return pad;
  }

 private:
  template <class CameraType>
  static T pitch_of(const CameraType& camera, Index rows, Index cols) {
    expects_grid_size("FreePadCalibration", rows, cols);
    require(camera);
    return static_cast<T>(camera.pitch_mm);
  }

  static void check(const ThresholdRule& rule) {
    expects(rule.level_share > 0 && rule.level_share <= 1, "ThresholdRule", "level_share",
            rule.level_share, "in (0, 1]");
    expects(is_finite(rule.sigmas) && rule.sigmas >= 0, "ThresholdRule", "sigmas", rule.sigmas,
            "finite and >= 0");
    expects(rule.quantile >= 0 && rule.quantile <= 0.5, "ThresholdRule", "quantile", rule.quantile,
            "in [0, 0.5]");
  }

  static T quantile(std::vector<T>& values, double share) {
    const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
  }

  /// Standard error of the mean of independent values; NaN for a single value.
  static T standard_error(const std::vector<T>& values) {
    const T n = T(static_cast<double>(values.size()));
    T mean = T(0), squares = T(0);
    for (const T& x : values) {
      mean += T(x / n);
    }
    for (const T& x : values) {
      squares += square(T(x - mean));
    }
    return root_of(T(squares / T(n * T(n - T(1)))));
  }

  /// Square root; 0 at 0, without the infinite derivative.
  static T root_of(const T& x) {
    using std::sqrt;
    return value(x) == 0 ? T(0) : T(sqrt(x));
  }

  T pixel_mm_;
  T ring_px_;
  CurvatureMap<S> map_;
  std::vector<S> curvature_;
  std::vector<T> mean_;     ///< E of each pixel
  std::vector<T> squares_;  ///< sum of squared deviations from it
  std::vector<T> of_frame_;
  std::vector<T> medians_;  ///< of the frames
  int frames_ = 0;
};

}  // namespace v0
}  // namespace fingerpad
