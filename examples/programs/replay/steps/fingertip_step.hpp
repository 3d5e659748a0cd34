// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Applies the library's pipeline/fingertip.hpp to a frame with its dots and pressure;
// only this step uses that header.
#include <memory>
#include <opencv2/core.hpp>

#include "common/recording.hpp"
#include "replay/steps/frame.hpp"

namespace replay {

struct FingertipFrame {
  cv::Mat_<float> depth_mm;      ///< NaN where there is no depth
  cv::Mat_<uchar> contact_mask;  ///< 255 in contact, else 0
  FrameDots dots;
  fingerpad::FingertipResult touch;
  bool has_rim = false;         ///< there is data for the six axes
  double frame_ms = not_known;  ///< time of the computation
};

class FingertipStep {
 public:
  virtual ~FingertipStep() = default;
  /// Takes frames of the reference's size, of 8 or 16 bit, in time order. `time_s` is NaN if
  /// unknown.
  virtual FingertipFrame operator()(int frame,
                                    const cv::Mat& image,
                                    const DotGrid& dots_px,
                                    std::span<const fingerpad::Mark> side_dots,
                                    double time_s) = 0;
};

/// Fits the reference and sets up the step. The contact
/// threshold comes from sensor.json, else from the recording's frames of the free pad, else from
/// the free pad's known shape. `initial_px` are the free pad's dots, maybe empty. The recording
/// must outlive the step. Throws fingerpad::parameter_error.
std::unique_ptr<FingertipStep> make_fingertip_step(Recording& recording,
                                                   int smoothing_px,
                                                   const DotGrid& initial_px);

}  // namespace replay
