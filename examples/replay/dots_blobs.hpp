// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Dark spots of about the size of a printed dot in a frame. What counts is by which share a spot is
// darker than the membrane around it, so neither the depth nor the fall of the light matters.
#include <opencv2/core.hpp>

#include "dots_grid.hpp"
#include "sensor.hpp"

namespace replay {

class BlobFinder {
 public:
  /// `sensor` has its section on dots. Spots are looked for where the free pad has a depth.
  BlobFinder(const Sensor& sensor, const cv::Mat_<float>& reference_depth);

  /// Their centers in an 8- or 16-bit colour frame of the reference's size; red and green are used.
  Blobs find(const cv::Mat& image) const;

 private:
  cv::Mat_<float> darkness(const cv::Mat& image) const;
  cv::Mat_<float> light_around(const cv::Mat_<float>& light, const cv::Mat_<float>& weight) const;
  bool looks_like_a_dot(const cv::Mat_<float>& dark, const cv::Vec2d& center) const;

  cv::Mat_<float> pad_;  ///< 1 on the pad, 0 elsewhere
  double radius_px_;     ///< of a dot at the free pad's median depth
  double pitch_px_;      ///< between dots there
};

}  // namespace replay
