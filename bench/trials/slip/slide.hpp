// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Slip from the imprint, frame by frame: contact by comparison with frames of the free pad, and its
// slide past the dots.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "replay/dots/grid.hpp"
#include "trials.hpp"

namespace slip_trials {

/// Values per frame; NaN without a result.
struct SlideSeries {
  std::vector<double> slide;     ///< in pitches
  std::vector<double> lost;      ///< lost share of the contact's area
  std::vector<double> evidence;  ///< from both; above 1 the method raises an alarm
  std::size_t end = 0;           ///< first frame in which contact is lost, or the number of frames
};

/// Frames of the free pad for a trial: those in free/ of the folder, else the last frames of
/// slipping trials of other objects, or of other trials if there is only one object, as far as they
/// agree. May be empty.
std::vector<cv::Mat> free_frames_for(const Trial& trial, const std::vector<Trial>& trials);

/// `free_dots`: where they are first found; `dot_px`: their diameter.
SlideSeries slide_in(const std::vector<cv::Mat>& frames,
                     const std::vector<replay::DotGrid>& dots,
                     const replay::DotGrid& free_dots,
                     double dot_px,
                     const std::vector<cv::Mat>& free_frames);

}  // namespace slip_trials
