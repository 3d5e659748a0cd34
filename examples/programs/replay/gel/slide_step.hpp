// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Contact, slide and slip of a gel pad with printed dots, from its frames only.
#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "common/recording.hpp"
#include "fingerpad/gel/gel_contact.hpp"
#include "fingerpad/gel/gel_slide.hpp"
#include "replay/dots/grid.hpp"
#include "replay/steps/frame.hpp"

namespace replay {

/// Options of the contact for dots of this diameter.
fingerpad::GelOptions gel_options_for(double dot_px);

/// The same for a frame so wide; `dot_px` 0: 14 px in a frame 640 px wide.
fingerpad::GelOptions gel_options_of(int width_px, double dot_px, bool bright_dots);

class SlideStep {
 public:
  /// `dot_px`: diameter of the dots; 0 if unknown. Throws fingerpad::parameter_error.
  SlideStep(const std::vector<cv::Mat>& free_frames,
            const DotGrid& free_dots,
            double dot_px,
            bool bright_dots = false);

  /// Takes frames in time order; `mask` receives 255 in contact and 0 elsewhere. A frame that is
  /// not of this pad keeps the slide of the one before.
  GelFrame operator()(const cv::Mat& image, const DotGrid& dots, cv::Mat_<uchar>& mask);
  /// Median time of contact and slide over the frames so far.
  double median_ms() const;

 private:
  fingerpad::GelOptions options_;
  fingerpad::GelContact contact_;
  fingerpad::GelSlide slide_;
  fingerpad::SlideResult last_;
  std::vector<double> ms_;
};

}  // namespace replay
