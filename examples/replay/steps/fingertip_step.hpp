// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What the program does with the library: a frame, its dots, its side dots and its pressure in, all
// results out, with pipeline/fingertip.hpp; the only place of the program that knows it. The cells
// of the frames and the smoothing are known only at run time here; the library has them as types.
#include <memory>
#include <opencv2/core.hpp>

#include "replay/io/recording.hpp"
#include "replay/steps/frame.hpp"

namespace replay {

enum class Smoothing { none, box, anchored };

struct FingertipFrame {
  cv::Mat_<float> depth_mm;      ///< NaN where there is none
  cv::Mat_<uchar> contact_mask;  ///< 255 in contact, else 0
  fingerpad::Index valid_pixels = 0;
  fingerpad::Index pad_pixels = 0;
  bool pad_has_changed = false;  ///< its light is not that of the reference
  ContactResult contact;
  FrameDots dots;
  ForceFrame force;
  WrenchFrame wrench;
  double depth_ms = not_known, contact_ms = not_known, wrench_ms = not_known;  ///< time of stages
};

class FingertipStep {
 public:
  virtual ~FingertipStep() = default;
  /// Frames in the order of time, of the reference's size; throws Failure where one has other cells
  /// than the first. `time_s` is NaN where unknown.
  virtual FingertipFrame operator()(int frame,
                                    const cv::Mat& image,
                                    const DotGrid& dots_px,
                                    double time_s) = 0;
};

/// Fits the reference and sets up everything that frames need, which are like `first_image`. The
/// threshold of the contact comes from the recording's frames of the free pad, or, where it has
/// none, from the known shape of the free pad. `initial_px` are the free pad's dots, perhaps none.
/// The recording must outlive the step. Throws fingerpad::parameter_error.
std::unique_ptr<FingertipStep> make_fingertip_step(Recording& recording,
                                                   const cv::Mat& first_image,
                                                   Smoothing smoothing,
                                                   int window_px,
                                                   const DotGrid& initial_px);

}  // namespace replay
