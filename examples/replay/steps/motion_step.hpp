// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// From the dots of a frame, its depth map and its contact to the motion of the object, with the
// library's object_motion.hpp; the only place of the program that knows it. A dot counts as in
// contact when all of it is: one on the edge is about to let go, or has not been touched yet.
#include <opencv2/core.hpp>
#include <optional>

#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/motion/object_motion.hpp"
#include "replay/dots/grid.hpp"
#include "replay/io/sensor.hpp"
#include "replay/steps/stick_step.hpp"

namespace replay {

/// The dots of one frame and what they say. Grids are empty where the recording has no dots.
struct FrameDots {
  DotGrid dots_px;
  cv::Mat_<cv::Vec3d> dots_mm;  ///< NaN where a dot was not found or has no depth
  cv::Mat_<uchar> in_contact;   ///< 1 for dots that are
  fingerpad::ObjectMotionResult<double> motion;
  StickFrame stick;
};

/// Dots of a frame of which nothing else is known: each that is found counts as in contact.
FrameDots dots_alone(const DotGrid& dots_px);

class MotionStep {
 public:
  /// `initial_px` are the free pad's dots and `free_depth_mm` its depths; no dots: the step does
  /// nothing.
  MotionStep(const Sensor& sensor, const DotGrid& initial_px, const cv::Mat_<float>& free_depth_mm);

  /// Where the dots of a frame are, and which touch.
  FrameDots place(const DotGrid& dots_px,
                  const cv::Mat_<float>& depth_mm,
                  const cv::Mat_<uchar>& contact) const;
  /// Motion of the object, by the dots that do not slip. Frames in the order of time.
  void follow(FrameDots& frame);

 private:
  using Motion = fingerpad::ObjectMotion<>;
  cv::Mat_<cv::Vec3d> in_space(const DotGrid& dots_px, const cv::Mat_<float>& depth_mm) const;

  fingerpad::Camera<double> camera_;
  double dot_radius_px_;
  std::optional<Motion> motion_;
  std::optional<Motion::State> state_;
};

}  // namespace replay
