// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What calibrations read of a recording that is not complete yet.
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "fingerpad/optics/camera.hpp"
#include "replay/io/sensor.hpp"

namespace calibrate {

using DepthMap = cv::Mat_<float>;

/// sensor.json as far as it is known; each of `sections` must be there, or the calibration that
/// makes it is named. Throws replay::Failure.
replay::Sensor known_sensor(const std::filesystem::path& file,
                            const std::vector<std::string>& sections);

/// All pictures of a folder, in the order of their names; all of one size. Throws replay::Failure.
std::vector<cv::Mat> read_pictures(const std::filesystem::path& folder);

/// A sphere over the plate; radius and center in mm.
struct Sphere {
  fingerpad::Point3<double> center_mm;
  double radius_mm = 0;
};
/// The sphere of a cap on the plate.
Sphere cap(double base_radius_mm, double apex_height_mm);

/// Depth at which the ray of a pixel leaves the sphere (`far`) or first meets it; NaN: never above
/// the plate.
double depth_on(
    const fingerpad::Camera<double>& camera, int row, int col, const Sphere& sphere, bool far);

/// Depth of a free pad that is a spherical cap; NaN outside of its base.
DepthMap spherical_cap_depth(const fingerpad::Camera<double>& camera,
                             cv::Size size,
                             double base_radius_mm,
                             double apex_height_mm);

/// The known depths of frames/: from true_depth/ (a map for each frame), or, where presses.csv says
/// where the lowest point of a ball was, of the pixels that certainly lie on it. NaN: not known.
std::vector<DepthMap> true_depths(const std::filesystem::path& recording,
                                  const replay::Sensor& sensor,
                                  const DepthMap& free_mm,
                                  std::size_t frames);

}  // namespace calibrate
