// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Draws the contact region and the dots over the camera's image.
#include <opencv2/core.hpp>

#include "replay/pictures/sheet.hpp"
#include "replay/steps/frame.hpp"

namespace replay {

/// Paints the outline of a mask over the camera's image.
void paint_outline(Canvas& canvas, const Place& place, const cv::Mat_<uchar>& mask, double width);

/// Paints dots in contact filled and the others hollow, with lines to their positions on the free
/// pad. The contact reference dot has a ring.
void paint_dots(Canvas& canvas,
                const Place& place,
                const FrameDots& dots,
                const DotGrid& initial_px);

}  // namespace replay
