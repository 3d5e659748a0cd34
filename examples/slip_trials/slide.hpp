// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What the imprint says of slip, frame by frame: contact by difference from frames of the free pad,
// and its slide past the dots.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "replay/dots/grid.hpp"
#include "trials.hpp"

namespace slip_trials {

/// NaN where there is no answer.
struct SlideSeries {
  std::vector<double> slide;     ///< in pitches
  std::vector<double> lost;      ///< share of the contact's area
  std::vector<double> evidence;  ///< of both; above 1 the method gives an alarm
  std::vector<double> recoil;    ///< of the dots alone, in pitches
  std::size_t end = 0;  ///< the first frame in which the contact is gone; past the last one
};

/// Frames of the free pad for the trials of an object: those in free/ of the folder, else the last
/// frames of slipping trials of other objects (of others of the same one where there are no other
/// objects), as far as they agree. Empty: there are none.
std::vector<cv::Mat> free_frames_for(const Trial& trial, const std::vector<Trial>& trials);

/// `dot_px`: diameter of the dots.
SlideSeries slide_in(const std::vector<cv::Mat>& frames,
                     const std::vector<replay::DotGrid>& dots,
                     double dot_px,
                     const std::vector<cv::Mat>& free_frames);

}  // namespace slip_trials
