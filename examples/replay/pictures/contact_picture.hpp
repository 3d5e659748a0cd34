// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The contact region and the dots, drawn over the camera's image.
#include <opencv2/core.hpp>

#include "replay/pictures/canvas.hpp"
#include "replay/steps/frame.hpp"

namespace replay {

/// The edge of a mask that is shown over `rectangle`.
void paint_outline(Canvas& canvas,
                   const cv::Rect2d& rectangle,
                   const cv::Mat_<uchar>& mask,
                   double width);

/// Dots in contact are full, the others hollow; lines lead back to where they were on the free pad,
/// and the contact reference dot has a ring. `size` is that of the camera's image.
void paint_dots(Canvas& canvas,
                const cv::Rect2d& rectangle,
                cv::Size size,
                const FrameDots& dots,
                const DotGrid& initial_px);

}  // namespace replay
