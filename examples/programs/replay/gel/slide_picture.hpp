// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Pictures of a gel: each frame with its contact and where the contact would be if it had stayed
// with the dots, and one chart of all frames.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

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

/// The data of a frame in the chart.
struct GelRow {
  int frame = 0;
  std::string time_s;
  GelFrame seen;
};

/// Index of the first row with an alarm, or rows.size().
std::size_t first_slip(const std::vector<GelRow>& rows);

/// Green without evidence of slip, red from the alarm on, grey without contact.
Ink slip_ink(const GelFrame& seen);

cv::Mat slide_picture(const GelScene& scene);

/// `shown`: scenes whose frames are shown above the curves, in order.
cv::Mat slide_chart(const std::string& title,
                    const std::vector<GelRow>& rows,
                    const std::vector<GelScene>& shown);

}  // namespace replay
