// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// False-colour maps of the pad: the depth, and its change relative to the free pad.
#include <opencv2/core.hpp>

#include "replay/pictures/canvas.hpp"

namespace replay {

/// Maps values to colours.
struct ColourScale {
  double bottom_mm;
  double top_mm;
  double tick_mm;
  cv::Mat_<cv::Vec3b> colours;  ///< 1 x 256, from bottom to top
};

/// From dark at 0 to light at `top_mm`.
ColourScale depth_scale(double top_mm);
/// Blue where the membrane bulges out, pale where it is unchanged, red where it is pressed in.
ColourScale change_scale(double reach_mm);

/// The scale's colours as a column of `size`, with the top value above.
cv::Mat colour_column(const ColourScale& scale, cv::Size size);

/// Paints `values_mm` over `rectangle` with slight relief shading and, if line_every_mm > 0,
/// contour lines. White outside the pad (`in_pad` is 0) and where there is no value (NaN).
void paint_map(Canvas& canvas,
               const cv::Rect2d& rectangle,
               const cv::Mat_<float>& values_mm,
               const cv::Mat_<uchar>& in_pad,
               const ColourScale& scale,
               double line_every_mm);

/// Paints a legend with ticks; `bar` is the coloured rectangle, the labels are to its right.
void paint_legend(Canvas& canvas,
                  const cv::Rect2d& bar,
                  const ColourScale& scale,
                  double text_height,
                  const char* unit = "mm");

}  // namespace replay
