// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Force and moment over the frames of a recording.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "replay/io/output.hpp"

namespace replay {

/// Panels above each other: force, moment and pressure. No line where there is no answer.
cv::Mat wrench_chart(const std::string& title, const std::vector<FrameRow>& rows);

}  // namespace replay
