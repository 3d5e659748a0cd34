// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The measures of a recording, frame by frame, and their means over frames.
#include <filesystem>
#include <string>
#include <vector>

#include "slide.hpp"

namespace slip_trials {

/// The recording of one camera. NaN: no new stick ratio, or no dots.
struct View {
  std::vector<double> ratio;           ///< the stick ratio with the default thresholds
  std::vector<double> ratio_by_noise;  ///< the same with the noise of the first frames
  std::vector<double> moved_share;     ///< share of dots more than 2 px off the median motion
  SlideSeries slide;                   ///< empty if no frame of the free pad is known
  std::string fault;                   ///< why there are no results

  int size() const { return static_cast<int>(ratio.size()); }
};

/// Finds the dots in a video or a folder of frames and tracks them to the end. Also follows the
/// contact if there are frames of the free pad.
View look_at(const std::filesystem::path& file, const std::vector<cv::Mat>& free_frames);

/// Means over the frames with a value, then over the views.
struct Measures {
  std::size_t answers = 0;  ///< number of new stick ratios in all views
  double ratio = 0;         ///< a view without a stick ratio counts as 1
  double lowest = 0;
  double ratio_by_noise = 0;
  double moved_share = 0;
};

/// Means over the first `frames` frames of each view, or over all if there are fewer.
Measures mean_over(const std::vector<View>& views, int frames);

/// The mean stick ratio in each tenth of a recording over all views; "-" without a new one.
std::vector<std::string> tenths_of(const std::vector<View>& views);

}  // namespace slip_trials
