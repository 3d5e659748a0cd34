// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Pictures for people: false-colour depth, a side view, the contact over the camera's image, and an
// overview of a recording.
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/sensor.hpp"
#include "common/true_forces.hpp"
#include "replay/pictures/canvas.hpp"
#include "replay/pictures/depth_colours.hpp"
#include "replay/steps/frame.hpp"
#include "replay/steps/traction_step.hpp"

namespace replay {

/// The image row of a side view.
struct Section {
  int row = 0;
  int col = 0;         ///< column of the point that determines the row
  double dent_mm = 0;  ///< depth of that point below the free pad; 0 without contact
};

/// The data of one frame for pictures.
struct Scene : FrameRow {
  cv::Mat image;             ///< 8- or 16-bit colour
  cv::Mat_<float> depth_mm;  ///< empty for a dots-only recording
  Section section;
  cv::Mat_<uchar> contact_mask;  ///< nonzero in contact; empty like the depth
  FrameDots dots;
  TractionFrame traction;
};

class Painter {
 public:
  /// `brightest` is the grey level that is shown as white.
  Painter(const Sensor& sensor, const cv::Mat_<float>& free_depth_mm, double brightest);

  /// The row through the deepest dent, or on a free pad through the point of largest depth.
  Section find_section(const cv::Mat_<float>& depth_mm) const;

  cv::Mat depth(const Scene& scene) const;
  cv::Mat side(const Scene& scene) const;
  /// `initial_px` are the free pad's dots.
  cv::Mat contact(const Scene& scene, const DotGrid& initial_px) const;
  /// Contact pressure and shear at the dots, over the camera's image.
  cv::Mat traction(const Scene& scene) const;
  /// One column per scene: camera image, depth, its change, side view. For `scale` see Canvas.
  cv::Mat montage(const std::string& title,
                  const std::vector<Scene>& scenes,
                  int scale = Canvas::smooth) const;

 private:
  fingerpad::Camera<double> camera_;
  cv::Mat_<float> free_depth_mm_;
  cv::Mat_<uchar> in_pad_;
  double half_width_mm_;  ///< of side views
  double dot_pitch_px_;   ///< at the plate; 0 without dots
  double top_mm_;         ///< of the depth scale
  ColourScale scale_;
  double brightest_;
};

}  // namespace replay
