// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Line charts over the frames of a recording, in panels one above the other.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/output.hpp"

namespace replay {

struct LineSeries {
  std::string name;
  std::vector<double> values;  ///< one per frame; NaN if missing
  int beside = -1;             ///< series whose truth this is: dashed, in the same colour
};

struct LinePanel {
  std::string title;
  std::vector<LineSeries> series;  ///< at most three, then their truths
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
