// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The state of each dot over the camera's image: discs stick, crosses slip, rings are unknown, and
// points are not in contact. If 3D positions are known, an arrow shows how far each slipping dot
// has slipped on the object.
#include <opencv2/core.hpp>

#include "replay/pictures/pictures.hpp"

namespace replay {

/// `brightest` is the grey level that is shown as white.
cv::Mat stick_picture(const Scene& scene, double brightest);

}  // namespace replay
