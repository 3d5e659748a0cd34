// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Lines over the frames of a recording, in panels above each other.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "replay/io/output.hpp"

namespace replay {

struct LineSeries {
  std::string name;
  std::vector<double> values;  ///< one a frame; NaN: none
  int beside = -1;             ///< which one of its panel it is the truth of: dashed, in its colour
};

struct LinePanel {
  std::string title;
  std::vector<LineSeries> series;  ///< at most three, and as many truths after them
};

template <class Value>
LineSeries line_series(const std::string& name,
                       const std::vector<FrameRow>& rows,
                       const Value& value) {
  LineSeries s;
  s.name = name;
  for (const FrameRow& row : rows) {
    s.values.push_back(value(row));
  }
  return s;
}

cv::Mat line_chart(const std::string& title, const std::vector<LinePanel>& panels, int first_frame);

}  // namespace replay
