// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A chart of contact and object motion over the frames of a recording.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/output.hpp"

namespace replay {

/// Panels one above the other: contact, displacement and angles of the object.
cv::Mat motion_chart(const std::string& title, const std::vector<FrameRow>& rows);

}  // namespace replay
