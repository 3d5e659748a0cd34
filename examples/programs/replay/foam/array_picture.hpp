// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A picture of a foam array at a few times around the first alarm, side by side: readings and
// vibration of each taxel.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "replay/foam/activity.hpp"
#include "replay/foam/step.hpp"

namespace replay {

/// Indices of the rows to show: half a window apart with the first alarm in the middle, or evenly
/// spaced over all rows without an alarm.
std::vector<std::size_t> shown_rows(const std::vector<FoamRow>& rows, int window);

/// `activity` must have been computed for these rows.
cv::Mat foam_array_picture(const std::string& title,
                           const FoamRecording& recording,
                           const std::vector<FoamRow>& rows,
                           const std::vector<std::size_t>& shown,
                           const FoamActivity& activity);

}  // namespace replay
