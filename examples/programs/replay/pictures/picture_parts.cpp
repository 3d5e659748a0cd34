// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/pictures/picture_parts.hpp"

#include <algorithm>
#include <vector>

namespace replay {

std::string caption(int frame, const std::string& time_s) {
  const std::string name = "frame " + std::to_string(frame);
  return time_s.empty() ? name : name + ",  t = " + time_s + " s";
}

double brightest_level(const cv::Mat& image) {
  const double units = image.depth() == CV_16U ? 256 : 1;
  cv::Mat levels;
  image.convertTo(levels, CV_8U, 1 / units);
  std::vector<int> count(256, 0);
  for (int i = 0; i < levels.rows; ++i) {
    for (int j = 0; j < levels.cols * levels.channels(); ++j) {
      ++count[levels.ptr<uchar>(i)[j]];
    }
  }
  const double total = static_cast<double>(levels.total()) * levels.channels();
  double above = 0;
  int level = 255;
  while (level > 0 && above + count[static_cast<std::size_t>(level)] < 0.01 * total) {
    above += count[static_cast<std::size_t>(level)];
    --level;
  }
  return level;
}

bool is_chosen(int done, int total, int most) {
  const int count = (std::min)(total, most);
  for (int k = 0; k < count; ++k) {
    if (done == (count == 1 ? 0 : (k * (total - 1) + (count - 1) / 2) / (count - 1))) {
      return true;
    }
  }
  return false;
}

}  // namespace replay
