// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The membrane to render: a triangulated surface and its printed dots at each step, and its view
// from a camera behind the plate.
#include <array>
#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/optics/camera.hpp"

namespace render {

using Point = fingerpad::Point3<double>;

struct Step {
  std::vector<Point> nodes;
  std::vector<Point> dots;  ///< centers of the printed dots
};

struct Membrane {
  std::vector<std::array<int, 3>> triangles;
  std::vector<Step> steps;
};

/// Reads nodes.npy (steps, nodes, 3), triangles.npy (triangles, 3) and dots.npy (steps, dots, 3);
/// throws replay::Failure.
Membrane read_membrane(const std::filesystem::path& folder);

/// The points that the rays of an image hit; each pixel has samples x samples rays.
struct Sight {
  cv::Mat_<float> depth_mm;  ///< NaN where a ray misses the membrane
  cv::Mat_<float> upright;   ///< cosine of the membrane's inclination; 1 where it is flat
  cv::Mat_<uchar> on_dot;    ///< 1 where the ray ends on a printed dot
};

/// Follows every refracted ray to the membrane. The ray that goes through (row, col) of the image
/// is sample (samples (row + 1/2) - 1/2, ...); samples = 1 gives the rays of the pixels' centers.
Sight look(const fingerpad::Camera<double>& camera,
           const std::vector<std::array<int, 3>>& triangles,
           const Step& step,
           cv::Size size,
           int samples,
           double dot_diameter_mm);

}  // namespace render
