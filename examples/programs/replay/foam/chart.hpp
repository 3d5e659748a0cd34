// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A chart of load, waves and alarms of a foam recording over its samples.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "replay/foam/step.hpp"

namespace replay {

cv::Mat foam_chart(const std::string& title,
                   const FoamRecording& recording,
                   const std::vector<FoamRow>& rows);

}  // namespace replay
