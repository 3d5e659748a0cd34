// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/steps/stick_step.hpp"

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/slip/friction_limit.hpp"

namespace replay {

StickStep::StickStep(cv::Size size, const fingerpad::StickOptions& options) {
  if (!size.empty()) {
    stick_.emplace(size.height, size.width, options);
  }
}

FrameDots StickStep::operator()(const DotGrid& dots_px,
                                double time_s,
                                fingerpad::FingertipResult& touch) {
  FrameDots frame;
  frame.dots_px = dots_px;
  frame.dots_mm = cv::Mat_<cv::Vec3d>(dots_px.size(), cv::Vec3d::all(not_known));
  frame.in_contact.create(dots_px.size());
  for (int i = 0; i < dots_px.rows; ++i) {
    for (int j = 0; j < dots_px.cols; ++j) {
      frame.in_contact(i, j) = is_present(dots_px(i, j)) ? 1 : 0;
    }
  }
  if (stick_) {
    touch.stick = (*stick_)(dots_px, frame.in_contact, time_s);
    touch.slip = fingerpad::FrictionLimit<>()(fingerpad::ContactLoad<>{}, touch.stick);
    frame.states.create(dots_px.size());
    for (int i = 0; i < dots_px.rows; ++i) {
      for (int j = 0; j < dots_px.cols; ++j) {
        frame.states(i, j) = static_cast<uchar>(stick_->states()(i, j));
      }
    }
  }
  return frame;
}

}  // namespace replay
