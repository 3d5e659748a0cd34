// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What every dot does, over the camera's image: discs stick, crosses slip, rings nobody knows of,
// and points touch nothing. Where dots are known in space an arrow shows how far each that slips
// has slipped on the object.
#include <opencv2/core.hpp>

#include "replay/pictures/pictures.hpp"

namespace replay {

/// `brightest` is the grey level that shows as white in the camera's picture.
cv::Mat stick_picture(const Scene& scene, double brightest);

}  // namespace replay
