// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The frames of a dots-only recording that show the free pad.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/recording.hpp"
#include "replay/check/check.hpp"
#include "replay/dots/dots.hpp"

namespace replay {

/// The frames that are taken as the free pad.
struct FreePad {
  std::vector<cv::Mat> frames;
  std::string source;  ///< in words
  Findings told;       ///< what is wrong with free/ or with the first frames
};

/// The frames in free/ that show no contact, else the reference of sensor.json, else the first
/// frames of the recording before any contact. Throws Failure.
FreePad free_pad_of(Recording& recording, const DotSource& dots);

}  // namespace replay
