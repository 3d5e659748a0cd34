// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Numbers over the frames of a recording: contact, and how the object moved.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "replay/io/output.hpp"

namespace replay {

/// Panels above each other: contact, displacement and angles of the object.
cv::Mat motion_chart(const std::string& title, const std::vector<FrameRow>& rows);

}  // namespace replay
