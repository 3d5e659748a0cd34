// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A chart of forces by look-up over the frames of a recording.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/output.hpp"

namespace replay {

/// Panels one above the other, each also with the true force of frames that have one. Lines have
/// gaps where there is no result.
cv::Mat force_chart(const std::string& title, const std::vector<FrameRow>& rows);

}  // namespace replay
