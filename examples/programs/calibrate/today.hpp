// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What has changed on a pad since its calibration, from a picture of it with nothing in contact.
#include <opencv2/core.hpp>
#include <vector>

#include "calibrate/recordings.hpp"

namespace calibrate {

/// A property of the pad today.
struct Change {
  const char* what;   ///< with its unit
  double by;          ///< today less then
  double sd;          ///< of `by`; 0: counted
  double tolerated;   ///< what the comparison cannot tell, or what costs no depth
  const char* again;  ///< what must be done again

  /// Whether it is larger than tolerated, and than its noise.
  bool is_told() const;
};

/// Brightness, its slope, white balance, apex, place in the picture, spots, and dots that are gone
/// if sensor.json describes dots. `reference` and `today` are pictures of one size, linear in
/// light; `free_mm` is the depth of the pad when it was calibrated.
///
/// The light of both colours changes alike, so that ln(red / green) changes by the white balance
/// and by the height alone: by what the law of depth/absorption.hpp says, on a spherical cap that
/// rises. What green changes beyond that is the lamp. A picture that has moved is moved back first.
std::vector<Change> changes(const replay::Sensor& sensor,
                            const cv::Mat& reference,
                            const DepthMap& free_mm,
                            const cv::Mat& today);

}  // namespace calibrate
