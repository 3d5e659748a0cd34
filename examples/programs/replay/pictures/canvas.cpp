// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/pictures/canvas.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace replay {
namespace {

constexpr int fraction_bits = 4;
constexpr int font = cv::FONT_HERSHEY_SIMPLEX;
constexpr double capital_height = 21;  // of the font at scale 1

}  // namespace

Canvas::Canvas(double width, double height, int scale)
    : scale_(scale),
      size_(static_cast<int>(std::ceil(width)), static_cast<int>(std::ceil(height))),
      sheet_(size_ * scale, CV_8UC3, ink::white) {}

int Canvas::strokes(double width) const {
  return (std::max)(1, static_cast<int>(std::lround(width * scale_)));
}
int Canvas::strokes_of_text(double height, bool bold) const {
  return strokes(height * (bold ? 0.19 : 0.125));
}
double Canvas::font_scale(double height) const {
  return height * scale_ / capital_height;
}

cv::Rect Canvas::large(const cv::Rect2d& r) const {
  const auto big = [&](double x) { return static_cast<int>(std::lround(x * scale_)); };
  return {cv::Point(big(r.x), big(r.y)), cv::Point(big(r.x + r.width), big(r.y + r.height))};
}

std::vector<cv::Point> Canvas::large(const std::vector<Spot>& spots, Spot origin) const {
  std::vector<cv::Point> points;
  for (const Spot& spot : spots) {
    const Spot at = (spot - origin) * (scale_ << fraction_bits);
    points.emplace_back(static_cast<int>(std::lround(at.x)), static_cast<int>(std::lround(at.y)));
  }
  return points;
}

void Canvas::line(Spot from, Spot to, double width, const Ink& colour) {
  curve({from, to}, width, colour);
}

void Canvas::curve(const std::vector<Spot>& spots, double width, const Ink& colour) {
  if (spots.size() > 1) {
    cv::polylines(sheet_, large(spots), false, colour, strokes(width), cv::LINE_AA, fraction_bits);
  }
}

void Canvas::dashed_curve(const std::vector<Spot>& spots, double width, const Ink& colour) {
  const double dash = 4 * width;
  const double gap = 3 * width;
  double along = 0;
  std::vector<Spot> piece;
  for (std::size_t i = 1; i < spots.size(); ++i) {
    const Spot step = spots[i] - spots[i - 1];
    const double length = std::hypot(step.x, step.y);
    const int parts = (std::max)(1, static_cast<int>(std::ceil(length / (width / 2))));
    for (int k = 0; k < parts; ++k) {
      along += length / parts;
      if (std::fmod(along, dash + gap) < dash) {
        piece.push_back(spots[i - 1] + step * (static_cast<double>(k + 1) / parts));
      } else if (!piece.empty()) {
        curve(piece, width, colour);
        piece.clear();
      }
    }
  }
  curve(piece, width, colour);
}

void Canvas::polygon(const std::vector<Spot>& corners, const Ink& colour) {
  cv::fillPoly(sheet_, std::vector<std::vector<cv::Point>>{large(corners)}, colour, cv::LINE_AA,
               fraction_bits);
}

void Canvas::circle(Spot center, double radius, double width, const Ink& colour) {
  cv::circle(sheet_, large({center}).front(),
             static_cast<int>(std::lround(radius * (scale_ << fraction_bits))), colour,
             strokes(width), cv::LINE_AA, fraction_bits);
}

void Canvas::disc(Spot center, double radius, const Ink& colour) {
  cv::circle(sheet_, large({center}).front(),
             static_cast<int>(std::lround(radius * (scale_ << fraction_bits))), colour, cv::FILLED,
             cv::LINE_AA, fraction_bits);
}

double Canvas::text_width(const std::string& words, double height, bool bold) const {
  int baseline = 0;
  const cv::Size size =
      cv::getTextSize(words, font, font_scale(height), strokes_of_text(height, bold), &baseline);
  return static_cast<double>(size.width) / scale_;
}

void Canvas::text(
    Spot at, const std::string& words, double height, const Ink& colour, Align align, bool bold) {
  const double width = text_width(words, height, bold);
  at.x -= align == Align::left ? 0 : align == Align::right ? width : width / 2;
  const cv::Point origin(static_cast<int>(std::lround(at.x * scale_)),
                         static_cast<int>(std::lround(at.y * scale_)));
  cv::putText(sheet_, words, origin, font, font_scale(height), colour,
              strokes_of_text(height, bold), cv::LINE_AA);
}

cv::Mat Canvas::area(const cv::Rect2d& rectangle) {
  return sheet_(large(rectangle) & cv::Rect(cv::Point(0, 0), sheet_.size()));
}

void Canvas::blend(const cv::Rect2d& rectangle, const cv::Mat& picture, const cv::Mat& mask) {
  cv::Mat below = area(rectangle);
  for (int i = 0; i < below.rows; ++i) {
    const auto* from = picture.ptr<cv::Vec3b>(i);
    const uchar* weight = mask.ptr<uchar>(i);
    auto* to = below.ptr<cv::Vec3b>(i);
    for (int j = 0; j < below.cols; ++j) {
      for (int c = 0; c < 3; ++c) {
        to[j][c] =
            static_cast<uchar>((to[j][c] * (255 - weight[j]) + from[j][c] * weight[j]) / 255);
      }
    }
  }
}

cv::Mat Canvas::mask_of(const cv::Rect2d& rectangle, const std::vector<Spot>& corners) const {
  cv::Mat mask(large(rectangle).size(), CV_8UC1, cv::Scalar(0));
  cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{large(corners, rectangle.tl())},
               cv::Scalar(255), cv::LINE_AA, fraction_bits);
  return mask;
}

cv::Mat Canvas::finished() const {
  cv::Mat picture;
  cv::resize(sheet_, picture, size_, 0, 0, cv::INTER_AREA);
  return picture;
}

}  // namespace replay
