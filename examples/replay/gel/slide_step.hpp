// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Contact, slide and slip of a gel pad with printed dots, of which nothing but its frames is known.
#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "fingerpad/contact/contact_by_difference.hpp"
#include "fingerpad/slip/contact_slide.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/recoil.hpp"
#include "replay/dots/grid.hpp"
#include "replay/io/recording.hpp"

namespace replay {

/// Median distance of neighbours; NaN where no two are present.
double pitch_px(const DotGrid& dots);

/// Thresholds of contact by difference for dots of this diameter.
fingerpad::DifferenceTest difference_test_for(double dot_px);

/// What is taken for the free pad.
struct FreePad {
  std::vector<cv::Mat> frames;
  const char* source;  ///< in words
};

/// The frames in free/, else the picture that sensor.json names, else the recording's first ones,
/// as far as they show the same. Throws Failure.
FreePad free_pad_of(Recording& recording);

/// One frame of a gel.
struct GelFrame {
  fingerpad::ContactResult contact;  ///< in px: mm_per_px is 1
  fingerpad::SlideResult<float> slide;
  fingerpad::RecoilResult<float> recoil;
  fingerpad::SlipResult<double> slip;  ///< fused; no force is known
};

class SlideStep {
 public:
  /// `dot_px`: diameter of the dots; 0: not known, as large as is usual for frames of this size.
  /// Throws fingerpad::parameter_error.
  SlideStep(const std::vector<cv::Mat>& free_frames, const DotGrid& free_dots, double dot_px);

  /// Frames in the order of time; `mask` receives 255 in contact and 0 elsewhere.
  GelFrame operator()(const cv::Mat& image, const DotGrid& dots, cv::Mat_<uchar>& mask);
  /// The last frame's difference from the free pad, cell by cell.
  fingerpad::StridedView<const float> difference() const { return workspace_.difference(); }
  /// Of contact and slide, over the frames so far.
  double median_ms() const;

 private:
  using Contact = fingerpad::ContactByDifference<3>;
  Contact contact_;
  Contact::Workspace workspace_;
  fingerpad::ContactSlide<> slide_;
  fingerpad::ContactSlide<>::State slide_state_;
  fingerpad::Recoil<> recoil_;
  fingerpad::Recoil<>::State recoil_state_;
  fingerpad::FrictionLimit<> limit_;
  fingerpad::FrictionLimit<>::State limit_state_;
  std::vector<double> ms_;
};

}  // namespace replay
