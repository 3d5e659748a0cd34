// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A picture of a gel's frame with its contact, and where the contact would be if it had stayed with
// the dots.
#include <opencv2/core.hpp>
#include <string>

#include "replay/gel/slide_step.hpp"
#include "replay/pictures/canvas.hpp"

namespace replay {

/// The data that is drawn of a frame.
struct GelScene {
  int frame = 0;
  std::string time_s;
  cv::Mat image;
  cv::Mat_<uchar> contact_mask;
  DotGrid dots_px;
  GelFrame seen;
};

/// Green without evidence of slip, red from the alarm on, grey without contact.
Ink slip_ink(const GelFrame& seen);

cv::Mat slide_picture(const GelScene& scene);

}  // namespace replay
