// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A white canvas for figures. Coordinates are pixels of the finished picture and may be fractions.
// Everything is drawn several times larger and shrunk at the end for smooth lines and letters; with
// scale 1 it is drawn at its final size, which is faster. ASCII text only.
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace replay {

using Spot = cv::Point2d;
using Ink = cv::Scalar;  ///< blue, green, red

namespace ink {
inline const Ink black(38, 34, 32);
inline const Ink grey(128, 122, 118);
inline const Ink pale(224, 221, 219);
inline const Ink white(255, 255, 255);
inline const Ink accent(48, 40, 214);
}  // namespace ink

enum class Align { left, center, right };

class Canvas {
 public:
  /// Everything is drawn `scale` times larger, >= 1. The time grows with the square of `scale`.
  Canvas(double width, double height, int scale = smooth);

  void line(Spot from, Spot to, double width, const Ink& colour);
  void curve(const std::vector<Spot>& spots, double width, const Ink& colour);
  void dashed_curve(const std::vector<Spot>& spots, double width, const Ink& colour);
  void polygon(const std::vector<Spot>& corners, const Ink& colour);
  void circle(Spot center, double radius, double width, const Ink& colour);
  void disc(Spot center, double radius, const Ink& colour);
  /// `at` lies on the baseline; `height` is the height of a capital letter.
  void text(Spot at,
            const std::string& words,
            double height,
            const Ink& colour,
            Align align = Align::left,
            bool bold = false);
  double text_width(const std::string& words, double height, bool bold = false) const;

  /// The enlarged pixels of a rectangle, for direct painting.
  cv::Mat area(const cv::Rect2d& rectangle);
  /// Blends a picture in with the weight `mask` / 255; mask is 8-bit, of the size of
  /// area(rectangle).
  void blend(const cv::Rect2d& rectangle, const cv::Mat& picture, const cv::Mat& mask);
  /// A mask for area(rectangle) that is set inside a polygon.
  cv::Mat mask_of(const cv::Rect2d& rectangle, const std::vector<Spot>& corners) const;

  cv::Mat finished() const;

  int scale() const { return scale_; }

  static constexpr int smooth = 4;

 private:
  std::vector<cv::Point> large(const std::vector<Spot>& spots, Spot origin = {0, 0}) const;
  cv::Rect large(const cv::Rect2d& rectangle) const;
  int strokes(double width) const;
  int strokes_of_text(double height, bool bold) const;
  double font_scale(double height) const;

  int scale_;
  cv::Size size_;
  cv::Mat sheet_;
};

}  // namespace replay
