// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What is measured of a recording, frame by frame, and over frames.
#include <filesystem>
#include <string>
#include <vector>

#include "slide.hpp"

namespace slip_trials {

/// One camera's recording. NaN: no new answer, or no dots.
struct View {
  std::vector<double> ratio;           ///< the stick ratio with the default thresholds
  std::vector<double> ratio_by_noise;  ///< with slip_px from the noise of the first frames
  std::vector<double> moved_share;     ///< of dots more than 2 px off the median motion
  SlideSeries slide;                   ///< empty where no frame of the free pad is known
  std::string fault;                   ///< why there is nothing

  int size() const { return static_cast<int>(ratio.size()); }
};

/// Finds the dots in a video or a folder of frames and follows them to its end; the contact too,
/// where there are frames of the free pad.
View look_at(const std::filesystem::path& file, const std::vector<cv::Mat>& free_frames);

/// Means over the frames that have a value, then over the views.
struct Measures {
  std::size_t answers = 0;  ///< new ones of the stick ratio, in all views
  double ratio = 0;         ///< a view without a new answer counts as 1
  double lowest = 0;
  double ratio_by_noise = 0;
  double moved_share = 0;
};

/// Of the first `frames` frames of each view, or of all that it has.
Measures mean_over(const std::vector<View>& views, int frames);

/// The mean ratio in each tenth of a recording, over all views; "-" where there is no new answer.
std::vector<std::string> tenths_of(const std::vector<View>& views);

}  // namespace slip_trials
