// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/pictures/sheet.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "replay/pictures/picture_parts.hpp"

namespace replay {
namespace {

/// A round number of mm that is a fifth of the image or a little less.
double scale_bar_mm(double image_width_mm) {
  double best = 1e-3;
  for (double decade = 1e-3; decade < 1e4; decade *= 10) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      best = digit * decade < 0.21 * image_width_mm ? digit * decade : best;
    }
  }
  return best;
}

}  // namespace

Place large_place(cv::Size size) {
  const double shrink = 560.0 / (std::max)(size.width, size.height);
  return {{36, 56, size.width * shrink, size.height * shrink}, shrink};
}

void paint_image(Canvas& canvas, const cv::Rect2d& box, const cv::Mat& image, double brightest) {
  cv::Mat paper = canvas.area(box);
  const double units = image.depth() == CV_16U ? 256 : 1;
  cv::Mat levels;
  image.convertTo(levels, CV_8U, 245 / (brightest * units));
  if (levels.channels() == 4) {
    cv::cvtColor(levels, levels, cv::COLOR_BGRA2BGR);
  }
  cv::resize(levels, paper, paper.size(), 0, 0,
             paper.cols < image.cols ? cv::INTER_AREA : cv::INTER_CUBIC);
}

void paint_scale_bar(Canvas& canvas, const Place& place, int cols, double pitch_mm) {
  const double mm = scale_bar_mm(cols * pitch_mm);
  const double y = place.below() + 20;
  const double left = place.box.x;
  const double right = left + mm / pitch_mm * place.shrink;
  canvas.line({left, y}, {right, y}, 2.0, ink::black);
  canvas.line({left, y - 4}, {left, y + 4}, 1.2, ink::black);
  canvas.line({right, y - 4}, {right, y + 4}, 1.2, ink::black);
  canvas.text({right + 8, y + letter / 2}, format("%g mm at the plate", mm), letter, ink::black);
}

Sheet::Sheet(const std::string& title,
             const std::string& caption,
             cv::Size image,
             double space_px,
             double margin_px)
    : place(large_place(image)), canvas(place.right() + 36 + margin_px, place.below() + space_px) {
  canvas.text({place.box.x, 34}, title, 1.3 * letter, ink::black, Align::left, true);
  canvas.text({place.right() + margin_px, 34}, caption, letter, ink::black, Align::right);
}

void Sheet::write(double below_px, const std::string& words) {
  canvas.text({place.box.x, place.below() + below_px}, words, letter, ink::black);
}

}  // namespace replay
