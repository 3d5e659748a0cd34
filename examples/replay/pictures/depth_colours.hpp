// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Maps over the pad in false colours: the depth, and its change against the free pad.
#include <opencv2/core.hpp>

#include "replay/pictures/canvas.hpp"

namespace replay {

/// Which colour stands for which value.
struct ColourScale {
  double bottom_mm;
  double top_mm;
  double tick_mm;
  cv::Mat_<cv::Vec3b> colours;  ///< 1 x 256, from bottom to top
};

/// Dark to light, from 0 to top_mm.
ColourScale depth_scale(double top_mm);
/// Blue where the membrane bulges out, pale where it rests, red where it is pressed in.
ColourScale change_scale(double reach_mm);

/// The scale's colours as a column of `size`, its top above.
cv::Mat colour_column(const ColourScale& scale, cv::Size size);

/// Paints `values_mm` over `rectangle` with a touch of relief and, where line_every_mm > 0, lines
/// of equal value. White outside `in_pad` (0: outside) and where there is no value (NaN).
void paint_map(Canvas& canvas,
               const cv::Rect2d& rectangle,
               const cv::Mat_<float>& values_mm,
               const cv::Mat_<uchar>& in_pad,
               const ColourScale& scale,
               double line_every_mm);

/// A legend with ticks; `bar` is the coloured rectangle, labels stand on its right.
void paint_legend(Canvas& canvas,
                  const cv::Rect2d& bar,
                  const ColourScale& scale,
                  double text_height,
                  const char* unit = "mm");

}  // namespace replay
