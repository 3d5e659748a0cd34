// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Spots of about the size of a printed dot in a frame, dark or bright. What counts is by which
// share a spot is darker than the membrane around it, so neither the depth nor the fall of the
// light matters; bright spots are looked for in the negative.
#include <opencv2/core.hpp>

#include "replay/dots/grid.hpp"
#include "replay/io/sensor.hpp"

namespace replay {

/// How spots look that are looked for in a whole frame.
struct SpotLook {
  double radius_px = 0;
  double pitch_px = 0;  ///< between neighbours
  bool bright = false;  ///< brighter than what is around them
};

struct TypicalSpot {
  double radius_px = 0;  ///< of a disc as large as what is at least half as dark as the middle
  double darkness = 0;   ///< of the middle: 0 as light as its surroundings, 1 black
};

class BlobFinder {
 public:
  /// `sensor` has its section on dots. Spots are looked for where the free pad has a depth.
  BlobFinder(const Sensor& sensor, const cv::Mat_<float>& reference_depth);
  /// Spots are looked for everywhere, in all colours; those that the border cuts do not count.
  BlobFinder(cv::Size size, const SpotLook& look);

  /// Their centers in an 8- or 16-bit colour frame of the reference's size; red and green are used.
  Blobs find(const cv::Mat& image) const;

  /// The medians of some spots; all 0 where there are none.
  TypicalSpot typical(const cv::Mat& image, const Blobs& spots) const;

 private:
  cv::Mat_<float> light_of(const cv::Mat& image) const;
  cv::Mat_<float> darkness(const cv::Mat& image) const;
  cv::Mat_<float> light_around(const cv::Mat_<float>& light, const cv::Mat_<float>& weight) const;
  bool looks_like_a_dot(const cv::Mat_<float>& dark, const cv::Vec2d& center) const;

  cv::Mat_<float> pad_;   ///< 1 on the pad, 0 elsewhere
  double radius_px_;      ///< of a dot at the free pad's median depth
  double pitch_px_;       ///< between dots there
  double margin_px_ = 0;  ///< from the frame's border to the center of a spot
  bool whole_frame_ = false;
  bool bright_ = false;
};

}  // namespace replay
