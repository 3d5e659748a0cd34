// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// All computations on a recording, frame by frame in time order.
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "common/recording.hpp"
#include "replay/dots/dots.hpp"
#include "replay/pictures/pictures.hpp"
#include "replay/replay.hpp"
#include "replay/steps/fingertip_step.hpp"
#include "replay/steps/stick_step.hpp"
#include "replay/steps/traction_step.hpp"

namespace replay {

class Chain {
 public:
  /// Sets up all steps; throws Failure.
  Chain(Recording& recording, const Options& options);

  /// Processes a frame. The maps in the result are newly allocated.
  Scene operator()(int frame, const cv::Mat& image);

  const DotSource& dots() const { return dots_; }
  /// Median over the frames so far; NaN for a dots-only recording.
  double frame_ms() const;

 private:
  void look(const DotGrid& dots_px, Scene& scene);

  const Recording& recording_;
  DotSource dots_;
  std::unique_ptr<FingertipStep> fingertip_;  ///< null for a dots-only recording
  StickStep stick_;                           ///< for dots-only recordings
  TractionStep traction_;                     ///< empty if the recording lacks data for it
  cv::Mat_<uchar> pad_;                       ///< 255 where the reference has a depth
  double reference_step_ = 1;                 ///< between its blocks
  std::vector<double> frame_ms_;
};

}  // namespace replay
