// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A chart of force and moment over the frames of a recording.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/output.hpp"

namespace replay {

/// Panels one above the other: force, moment and pressure. Lines have gaps without a result.
cv::Mat wrench_chart(const std::string& title, const std::vector<FrameRow>& rows);

}  // namespace replay
