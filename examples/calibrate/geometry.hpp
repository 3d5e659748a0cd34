// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The fits of the camera to a plate of dots, and of a cap to touches of a ball.
#include <vector>

#include "calibrate/calibrations.hpp"
#include "calibrate/report.hpp"
#include "fingerpad/core/point.hpp"

namespace calibrate {

/// A dot's position on the plate, relative to the center dot, and in the picture.
struct PlateDot {
  fingerpad::Point2<double> plate_mm, picture_px;
};

/// Least-squares fit of an affine image of a square grid to a plate's dots.
struct PlatePicture {
  fingerpad::Point2<double> middle_px;
  double px_per_mm = 0;
  double anisotropy = 0;  ///< ratio of largest to smallest px per mm, minus 1
  double residual_px = 0;
  double middle_sd_px = 0, px_per_mm_sd = 0;
  Plot plot{"distance from the middle of the plate [mm]", "distance in the image [px]", {}};
};
PlatePicture fit_plate(const std::vector<PlateDot>& dots);

/// Distance from the entrance pupil to the plate, from two pictures; the plate is raised between
/// them by `raised_mm`.
struct PlateDistance {
  double mm = 0, sd_mm = 0;
};
PlateDistance plate_distance(const PlatePicture& low, const PlatePicture& high, double raised_mm);

/// A cap fitted to touches. The base is NaN if the touches lie on no cap over the plate.
struct TouchedCap {
  CapSize size;
  double base_sd_mm = 0, apex_sd_mm = 0, off_axis_mm = 0, off_axis_sd_mm = 0, residual_mm = 0;
  Plot plot{"distance from the axis [mm]", "distance from the center of the cap [mm]", {}};
};
/// `touches_mm`: five or more lowest points of the ball.
TouchedCap fit_cap(const std::vector<fingerpad::Point3<double>>& touches_mm, double ball_radius_mm);

}  // namespace calibrate
