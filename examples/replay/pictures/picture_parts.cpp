// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/pictures/picture_parts.hpp"

#include <opencv2/imgproc.hpp>

namespace replay {

std::string caption(int frame, const std::string& time_s) {
  const std::string name = "frame " + std::to_string(frame);
  return time_s.empty() ? name : name + ",  t = " + time_s + " s";
}

double scale_bar_mm(double image_width_mm) {
  double best = 1e-3;
  for (double decade = 1e-3; decade < 1e4; decade *= 10) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      best = digit * decade < 0.21 * image_width_mm ? digit * decade : best;
    }
  }
  return best;
}

void paint_scale_bar(Canvas& canvas, Spot left, double length, double mm, double text_height) {
  const double right = left.x + length;
  canvas.line(left, {right, left.y}, 2.0, ink::black);
  canvas.line({left.x, left.y - 4}, {left.x, left.y + 4}, 1.2, ink::black);
  canvas.line({right, left.y - 4}, {right, left.y + 4}, 1.2, ink::black);
  canvas.text({right + 8, left.y + text_height / 2}, format("%g mm at the plate", mm), text_height,
              ink::black);
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

cv::Mat displayed(const cv::Mat& image, double brightest, cv::Size size) {
  const double units = image.depth() == CV_16U ? 256 : 1;
  cv::Mat levels;
  image.convertTo(levels, CV_8U, 245 / (brightest * units));
  if (levels.channels() == 4) {
    cv::cvtColor(levels, levels, cv::COLOR_BGRA2BGR);
  }
  cv::Mat shown;
  cv::resize(levels, shown, size, 0, 0, size.width < image.cols ? cv::INTER_AREA : cv::INTER_CUBIC);
  return shown;
}

}  // namespace replay
