// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Converts the points that rays hit to grey levels of a frame, with the library's forward model and
// camera noise. The result is deterministic and does not depend on the standard library.
#include <cstdint>
#include <opencv2/core.hpp>
#include <random>

#include "common/sensor.hpp"
#include "membrane.hpp"

namespace render {

/// Light and membrane. The first two parameters give the published changes of red and green over
/// the pad's height (8 and 31.5 grey levels).
struct Lighting {
  double brightness = 57;      ///< of the flat membrane at depth 0 at the center, grey levels
  double scattering = 0.0163;  ///< g at the center, grey levels per mm^2
  double blue_share = 0.05;    ///< ratio of the brightness in blue to green
  double dot_share = 0.4;      ///< brightness ratio of a printed dot to the membrane
  double noise = 1;            ///< standard deviation where the brightness is `brightness`
};

/// The frame without noise, BGR in grey levels, as the mean of the samples of each pixel.
cv::Mat_<cv::Vec3f> ideal_frame(const replay::Sensor& sensor,
                                const Lighting& lighting,
                                const Sight& sight,
                                int samples);

/// Shot noise: the variance is proportional to the level.
class Noise {
 public:
  Noise(std::uint64_t seed, const Lighting& lighting);
  /// Returns the 8-bit frame that a camera would record.
  cv::Mat_<cv::Vec3b> expose(const cv::Mat_<cv::Vec3f>& ideal);

 private:
  double normal();
  std::mt19937_64 bits_;
  double variance_per_level_;
};

}  // namespace render
