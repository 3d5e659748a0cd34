// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The stick ratio over the frames of a recording.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "replay/io/output.hpp"

namespace replay {

/// New answers are marks, and a faint line shows the last known one; below, the number of dots in
/// contact.
cv::Mat stick_chart(const std::string& title, const std::vector<FrameRow>& rows);

}  // namespace replay
