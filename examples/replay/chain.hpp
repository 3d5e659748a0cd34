// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// All that is computed of a recording, frame by frame in the order of time.
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "replay/dots/dots.hpp"
#include "replay/io/recording.hpp"
#include "replay/pictures/pictures.hpp"
#include "replay/replay.hpp"
#include "replay/steps/fingertip_step.hpp"
#include "replay/steps/stick_step.hpp"
#include "replay/steps/traction_step.hpp"

namespace replay {

class Chain {
 public:
  /// Sets every step up; throws Failure.
  Chain(Recording& recording, const Options& options);
  /// The same for frames that come from elsewhere and are all like `first_image`.
  Chain(Recording& recording, const Options& options, const cv::Mat& first_image);

  /// The frame's maps are new ones each time.
  Scene operator()(int frame, const cv::Mat& image);

  const DotSource& dots() const { return dots_; }
  /// Medians over the frames so far; of a dots-only recording there are none.
  double depth_ms() const;
  double contact_ms() const;
  double wrench_ms() const;

 private:
  void look(const DotGrid& dots_px, Scene& scene);

  const Recording& recording_;
  DotSource dots_;
  std::unique_ptr<FingertipStep> fingertip_;  ///< none where the recording is of dots only
  StickStep stick_;                           ///< of dots alone
  TractionStep traction_;                     ///< empty where the recording lacks something
  std::vector<double> depth_ms_;
  std::vector<double> contact_ms_;
  std::vector<double> wrench_ms_;
};

}  // namespace replay
