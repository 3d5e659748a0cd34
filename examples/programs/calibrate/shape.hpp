// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The free shape of a pad, fitted to touches of a ball.
#include <opencv2/core.hpp>
#include <vector>

#include "calibrate/recordings.hpp"
#include "calibrate/report.hpp"
#include "fingerpad/core/point.hpp"

namespace calibrate {

/// The meridian from the apex to the rim: distance from the axis and height, mm.
using Meridian = std::vector<fingerpad::Point2<double>>;

/// A spherical cap with three even terms, (1 - s^2) s^2 (a1 + a2 s^2 + a3 s^4), s = r / base
/// radius.
Meridian cap_meridian(double base_radius_mm, double apex_height_mm, const double* terms = nullptr);

/// What is known of the pad before it is touched; 0: unknown.
struct TouchedPad {
  double ball_radius_mm = 0;
  double base_radius_mm = 0;
  double stress_free_height_mm = 0;  ///< of the rubber's apex before it is inflated
  bool is_rubber = true;             ///< an inflated membrane; else a cap with even terms
};

/// A shape with its uncertainty.
struct TouchedShape {
  Meridian meridian;  ///< empty if nothing fits
  double base_radius_mm = 0, base_sd_mm = 0;
  double apex_height_mm = 0, apex_sd_mm = 0;
  double off_axis_mm = 0, off_axis_sd_mm = 0;
  double residual_mm = 0;  ///< rms distance of the touches from the shape
  double reach_mm = 0;     ///< distance from the axis of the outermost point that was touched
  Plot plot{"distance from the axis [mm]", "height [mm]", {}};
};
/// `touches_mm`: lowest points of the ball, eight or more. The shape is that of free_pad.hpp, or
/// the cap with terms.
TouchedShape fit_shape(const std::vector<fingerpad::Point3<double>>& touches_mm,
                       const TouchedPad& pad);

/// Depth of a free pad along the ray of each pixel; NaN outside its base.
DepthMap depth_of_shape(const fingerpad::Camera<double>& camera,
                        cv::Size size,
                        const Meridian& meridian);

}  // namespace calibrate
