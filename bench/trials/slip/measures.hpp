// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The measures of a recording, frame by frame.
#include <filesystem>
#include <string>
#include <vector>

#include "slide.hpp"

namespace slip_trials {

/// The recording of one camera. NaN: no new stick ratio.
struct View {
  std::vector<double> ratio;  ///< the stick ratio with the default thresholds
  SlideSeries slide;          ///< empty if no frame of the free pad is known
  std::string fault;          ///< why there are no results

  int size() const { return static_cast<int>(ratio.size()); }
};

/// Finds the dots in a video or a folder of frames and tracks them to the end. Also follows the
/// contact if there are frames of the free pad.
View look_at(const std::filesystem::path& file, const std::vector<cv::Mat>& free_frames);

}  // namespace slip_trials
