// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/steps/motion_step.hpp"

#include <limits>
#include <opencv2/imgproc.hpp>

#include "fingerpad/adapt/opencv.hpp"

namespace replay {

FrameDots dots_alone(const DotGrid& dots_px) {
  FrameDots frame;
  frame.dots_px = dots_px;
  frame.dots_mm =
      cv::Mat_<cv::Vec3d>(dots_px.size(), cv::Vec3d::all(std::numeric_limits<double>::quiet_NaN()));
  frame.in_contact.create(dots_px.size());
  for (int i = 0; i < dots_px.rows; ++i) {
    for (int j = 0; j < dots_px.cols; ++j) {
      frame.in_contact(i, j) = is_present(dots_px(i, j)) ? 1 : 0;
    }
  }
  return frame;
}

MotionStep::MotionStep(const Sensor& sensor,
                       const DotGrid& initial_px,
                       const cv::Mat_<float>& free_depth_mm)
    : camera_(sensor.camera),
      dot_radius_px_(sensor.dots ? sensor.dots->diameter_mm / 2 / camera_.pitch_mm : 0.0) {
  if (!initial_px.empty()) {
    motion_.emplace(in_space(initial_px, free_depth_mm));
    state_.emplace(motion_->start());
  }
}

cv::Mat_<cv::Vec3d> MotionStep::in_space(const DotGrid& dots_px,
                                         const cv::Mat_<float>& depth_mm) const {
  cv::Mat_<cv::Vec3d> dots_mm(dots_px.size());
  (void)fingerpad::spatial_dots(camera_, dots_px, depth_mm, dots_mm);
  return dots_mm;
}

FrameDots MotionStep::place(const DotGrid& dots_px,
                            const cv::Mat_<float>& depth_mm,
                            const cv::Mat_<uchar>& contact) const {
  FrameDots frame;
  if (motion_) {
    frame.dots_px = dots_px;
    frame.dots_mm = in_space(dots_px, depth_mm);
    frame.in_contact.create(dots_px.size());
    cv::Mat_<float> from_edge_px;  // distance to the nearest pixel that does not touch
    cv::distanceTransform(contact, from_edge_px, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    cv::Mat_<uchar> inner(contact.size());
    cv::compare(from_edge_px, dot_radius_px_, inner, cv::CMP_GT);
    fingerpad::contact_at_dots(dots_px, inner, frame.in_contact);
  }
  return frame;
}

void MotionStep::follow(FrameDots& frame) {
  if (motion_) {
    cv::Mat_<uchar> slips;
    cv::compare(frame.stick.states, static_cast<int>(DotState::slip), slips, cv::CMP_EQ);
    if (frame.stick.slides) {
      slips = frame.in_contact;
    }
    frame.motion = (*motion_)(frame.dots_mm, frame.in_contact, slips, *state_);
  }
}

}  // namespace replay
