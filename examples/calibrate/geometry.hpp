// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Where the camera is, by a plate of dots, and a cap, by a ball that touches it: the fits alone.
#include <vector>

#include "calibrate/calibrations.hpp"
#include "calibrate/report.hpp"
#include "fingerpad/core/point.hpp"

namespace calibrate {

/// A dot of a plate, from the middle one, and where the picture has it.
struct PlateDot {
  fingerpad::Point2<double> plate_mm, picture_px;
};

/// A plate's dots as an affine picture of a square grid, by least squares.
struct PlatePicture {
  fingerpad::Point2<double> middle_px;
  double px_per_mm = 0;
  double anisotropy = 0;  ///< longest over shortest px of a mm, less 1
  double residual_px = 0;
  double middle_sd_px = 0, px_per_mm_sd = 0;
  Plot plot{"distance from the middle of the plate [mm]", "distance in the picture [px]", {}};
};
PlatePicture fit_plate(const std::vector<PlateDot>& dots);

/// From the entrance pupil to the plate, by two pictures between which it was raised by so much.
struct PlateDistance {
  double mm = 0, sd_mm = 0;
};
PlateDistance plate_distance(const PlatePicture& low, const PlatePicture& high, double raised_mm);

/// The cap that balls have touched. Base NaN: the touches lie on no cap over the plate.
struct TouchedCap {
  CapSize size;
  double base_sd_mm = 0, apex_sd_mm = 0, off_axis_mm = 0, off_axis_sd_mm = 0, residual_mm = 0;
  Plot plot{"distance from the axis [mm]", "distance from the center of the cap [mm]", {}};
};
/// `touches_mm`: the lowest points of the ball, five or more.
TouchedCap fit_cap(const std::vector<fingerpad::Point3<double>>& touches_mm, double ball_radius_mm);

}  // namespace calibrate
