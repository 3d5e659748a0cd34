// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A frame of a gel with its contact, and where the contact would be had it stayed with the dots;
// and one chart of all frames.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "replay/gel/slide_step.hpp"
#include "replay/pictures/canvas.hpp"

namespace replay {

/// What is drawn of a frame.
struct GelScene {
  int frame = 0;
  std::string time_s;
  cv::Mat image;
  cv::Mat_<uchar> contact_mask;
  DotGrid dots_px;
  GelFrame seen;
};

/// What a chart shows of a frame.
struct GelRow {
  int frame = 0;
  std::string time_s;
  GelFrame seen;
};

/// The first row with an alarm; rows.size(): none has one.
std::size_t first_slip(const std::vector<GelRow>& rows);

/// Green while nothing speaks for slip, red from the alarm on, grey without contact.
Ink slip_ink(const GelFrame& seen);

cv::Mat slide_picture(const GelScene& scene);

/// `shown`: scenes whose frames stand above the curves, in order.
cv::Mat slide_chart(const std::string& title,
                    const std::vector<GelRow>& rows,
                    const std::vector<GelScene>& shown);

}  // namespace replay
