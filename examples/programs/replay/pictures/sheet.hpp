// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The sheet of a large picture: the camera's image of one frame between its title and lines of
// text.
#include <opencv2/core.hpp>
#include <string>

#include "replay/pictures/canvas.hpp"

namespace replay {

/// Maps pixel centers of the camera's image to the rectangle that shows it on a canvas.
struct Place {
  cv::Rect2d box;
  double shrink;

  Spot of(double x_px, double y_px) const {
    return {box.x + shrink * (x_px + 0.5), box.y + shrink * (y_px + 0.5)};
  }
  double right() const { return box.x + box.width; }
  double below() const { return box.y + box.height; }
};

/// The place of an image of `size` in a large picture.
Place large_place(cv::Size size);

/// Paints the camera's image so that the level `brightest` is nearly white.
void paint_image(Canvas& canvas, const cv::Rect2d& box, const cv::Mat& image, double brightest);

/// Paints a scale bar for an image of `cols` columns below it.
void paint_scale_bar(Canvas& canvas, const Place& place, int cols, double pitch_mm);

struct Sheet {
  Place place;
  Canvas canvas;

  /// Leaves `space_px` for text below the image, and `margin_px` for a legend to its right.
  Sheet(const std::string& title,
        const std::string& caption,
        cv::Size image,
        double space_px,
        double margin_px = 0);

  /// Writes a line whose baseline is `below_px` below the image.
  void write(double below_px, const std::string& words);
};

}  // namespace replay
