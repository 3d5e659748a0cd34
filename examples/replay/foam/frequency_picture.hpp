// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// How fast each taxel of a foam array vibrates over time.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "replay/foam/activity.hpp"
#include "replay/foam/step.hpp"

namespace replay {

/// Samples side by side that are worth showing.
constexpr std::size_t max_frequency_bins = 660;

cv::Mat foam_frequency_picture(const std::string& title,
                               const FoamRecording& recording,
                               const std::vector<FoamRow>& rows,
                               const FoamActivity& activity);

}  // namespace replay
