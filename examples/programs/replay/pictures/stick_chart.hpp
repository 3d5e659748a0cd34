// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A chart of the stick ratio over the frames of a recording.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/output.hpp"

namespace replay {

/// Marks show new results and a faint line the last known one; a panel below shows the number of
/// dots in contact.
cv::Mat stick_chart(const std::string& title, const std::vector<FrameRow>& rows);

}  // namespace replay
