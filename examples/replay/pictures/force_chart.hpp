// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Forces by look-up over the frames of a recording.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "replay/io/output.hpp"

namespace replay {

/// Panels above each other, each with the truth beside it where a frame has one. No line where
/// there is no answer.
cv::Mat force_chart(const std::string& title, const std::vector<FrameRow>& rows);

}  // namespace replay
