// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A picture of the vibration frequency of each taxel of a foam array over time.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "replay/foam/activity.hpp"
#include "replay/foam/step.hpp"

namespace replay {

/// Largest number of bins along the time axis.
constexpr std::size_t max_frequency_bins = 660;

cv::Mat foam_frequency_picture(const std::string& title,
                               const FoamRecording& recording,
                               const std::vector<FoamRow>& rows,
                               const FoamActivity& activity);

}  // namespace replay
