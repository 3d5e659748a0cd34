// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The fit of the camera to a plate of dots.
#include <vector>

#include "calibrate/calibrations.hpp"
#include "calibrate/report.hpp"
#include "fingerpad/core/point.hpp"
#include "fingerpad/optics/camera.hpp"

namespace calibrate {

/// A dot's position on the plate, relative to the center dot, and in the picture.
struct PlateDot {
  fingerpad::Point2<double> plate_mm, picture_px;
};

/// The camera that explains both pictures of a target best: pitch, distance, center and, where they
/// are beyond three standard deviations, the pixels' aspect and k1.
struct CameraFit {
  fingerpad::Camera<double> camera;  ///< of air: the refractive index is not its own
  double residual_px = 0;
  /// NaN for what was not fitted.
  double pitch_sd_mm = 0, aspect_sd = 0, center_sd_px = 0, distance_sd_mm = 0, k1_sd = 0;
  double moved_mm = 0;  ///< along the plate, when the target was raised
  Plot plot{"distance from the middle of the plate [mm]", "distance in the image [px]", {}};
};
/// `low` lies on the plate with its center dot on the axis, `high` is raised by raised_mm > 0 and
/// may be shifted and turned. If `high` is empty, the distance is the one given. Nine dots or more.
CameraFit fit_camera(const std::vector<PlateDot>& low,
                     const std::vector<PlateDot>& high,
                     double raised_mm,
                     double plate_distance_mm);

}  // namespace calibrate
