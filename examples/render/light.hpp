// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// From what the rays meet to the grey levels of a frame: the library's forward model, and the noise
// of a camera. Everything is deterministic, whatever the standard library.
#include <cstdint>
#include <opencv2/core.hpp>
#include <random>

#include "../replay/io/sensor.hpp"
#include "membrane.hpp"

namespace render {

/// Light and membrane; the first two give the changes of red and green over the pad's height that
/// the slides report (8 and 31.5 grey levels).
struct Lighting {
  double brightness = 57;      ///< of the flat membrane at depth 0 in the middle, grey levels
  double scattering = 0.0163;  ///< g in the middle, grey levels per mm^2
  double blue_share = 0.05;    ///< brightness in blue over that in green
  double dot_share = 0.4;      ///< brightness of a printed dot over that of the membrane
  double noise = 1;            ///< standard deviation where the brightness is `brightness`
};

/// The frame without noise, BGR in grey levels, as the mean of the samples of each pixel.
cv::Mat_<cv::Vec3f> ideal_frame(const replay::Sensor& sensor,
                                const Lighting& lighting,
                                const Sight& sight,
                                int samples);

/// Shot noise: its variance grows with the level.
class Noise {
 public:
  Noise(std::uint64_t seed, const Lighting& lighting);
  /// The 8-bit frame that a camera would give.
  cv::Mat_<cv::Vec3b> expose(const cv::Mat_<cv::Vec3f>& ideal);

 private:
  double normal();
  std::mt19937_64 bits_;
  double variance_per_level_;
};

}  // namespace render
