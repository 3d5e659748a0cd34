// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// All that is computed of a recording, frame by frame in the order of time.
#include <opencv2/core.hpp>
#include <vector>

#include "contact_step.hpp"
#include "depth_step.hpp"
#include "dots.hpp"
#include "motion_step.hpp"
#include "pictures.hpp"
#include "recording.hpp"
#include "replay.hpp"

namespace replay {

class Chain {
 public:
  /// Sets every step up; throws Failure.
  Chain(Recording& recording, const Options& options);

  /// The frame's maps are new ones each time.
  Scene operator()(int frame, const cv::Mat& image);

  const DotSource& dots() const { return dots_; }
  /// Medians over the frames so far.
  double depth_ms() const;
  double contact_ms() const;

 private:
  const Recording& recording_;
  DepthStep depth_;
  ContactStep contact_;
  DotSource dots_;
  MotionStep motion_;
  std::vector<double> depth_ms_;
  std::vector<double> contact_ms_;
};

}  // namespace replay
