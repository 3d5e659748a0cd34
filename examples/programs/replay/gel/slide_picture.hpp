// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// A picture of a gel's frame with its contact, and where the contact would be if it had stayed with
// the dots.
#include <opencv2/core.hpp>

#include "replay/pictures/canvas.hpp"
#include "replay/pictures/pictures.hpp"

namespace replay {

/// Green without evidence of slip, red from the alarm on, grey without contact.
Ink slip_ink(const GelFrame& seen);

/// Of a scene with a gel.
cv::Mat slide_picture(const Scene& scene);

}  // namespace replay
