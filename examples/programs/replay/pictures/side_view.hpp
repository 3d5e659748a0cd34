// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A side view of the pad: depth over x along one row of the camera, with equal scales.
#include <opencv2/core.hpp>
#include <vector>

#include "fingerpad/optics/camera.hpp"
#include "replay/pictures/canvas.hpp"
#include "replay/pictures/depth_colours.hpp"

namespace replay {

/// Points (x, z) in mm of one row, split into pieces where pixels have no depth.
using Profile = std::vector<std::vector<Spot>>;

Profile profile_of(const fingerpad::Camera<double>& camera,
                   const cv::Mat_<float>& depth_mm,
                   int row);

/// Maps mm to the canvas.
struct Frame2d {
  cv::Rect2d rectangle;
  double half_width_mm;
  double top_mm;

  Spot at(Spot mm) const {
    return {rectangle.x + rectangle.width * (mm.x / half_width_mm + 1) / 2,
            rectangle.y + rectangle.height * (1 - mm.y / top_mm)};
  }
};

/// Paints the pad filled in the colours of the depth scale, with its free shape dashed.
void paint_profile(Canvas& canvas,
                   const Frame2d& frame,
                   const Profile& profile,
                   const Profile& free_profile,
                   const ColourScale& scale,
                   double line_width);

/// Text at the axes: names and all numbers, or only numbers, or only the numbers of x.
enum class Labels { full, numbers, x_numbers };

/// Paints axes with ticks and labels of `text_height`.
void paint_axes(Canvas& canvas, const Frame2d& frame, double text_height, Labels labels);

}  // namespace replay
