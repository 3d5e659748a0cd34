// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Reads the parts that calibrations need from a recording that is not complete yet.
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "common/sensor.hpp"
#include "fingerpad/optics/camera.hpp"

namespace calibrate {

using DepthMap = cv::Mat_<float>;

/// Reads sensor.json as far as it exists. Throws replay::Failure if one of `sections` is missing;
/// the message names the calibration that makes it.
replay::Sensor known_sensor(const std::filesystem::path& file,
                            const std::vector<std::string>& sections);

/// How pictures are stored, by the camera of sensor.json if it has one. Throws replay::Failure.
replay::PictureFormat known_pictures(const std::filesystem::path& file);

/// Reads all pictures of a folder, sorted by name, all of the same size, as colours linear in
/// light. Throws replay::Failure.
std::vector<cv::Mat> read_pictures(const std::filesystem::path& folder,
                                   const replay::PictureFormat& format = {});

/// A sphere over the plate.
struct Sphere {
  fingerpad::Point3<double> center_mm;
  double radius_mm = 0;
};

/// Depth at which the ray of a pixel enters the sphere; NaN if it does not above the
/// plate.
double depth_on(const fingerpad::Camera<double>& camera, int row, int col, const Sphere& sphere);

/// The known depths of frames/: from true_depth/ (a map for each frame), or from presses.csv (the
/// lowest point of a ball) for pixels that certainly lie on the ball. NaN where unknown.
std::vector<DepthMap> true_depths(const std::filesystem::path& recording,
                                  const replay::Sensor& sensor,
                                  const DepthMap& free_mm,
                                  std::size_t frames);

}  // namespace calibrate
