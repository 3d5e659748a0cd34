// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "replay/steps/stick_step.hpp"

#include "fingerpad/adapt/opencv.hpp"

namespace replay {

StickStep::StickStep(cv::Size size, const fingerpad::StickTest& test) {
  if (!size.empty()) {
    ratio_.emplace(size.height, size.width, test);
    state_.emplace(ratio_->start());
  }
}

FrameDots StickStep::operator()(const DotGrid& dots_px, double time_s) {
  FrameDots frame;
  frame.dots_px = dots_px;
  frame.dots_mm = cv::Mat_<cv::Vec3d>(dots_px.size(), cv::Vec3d::all(not_known));
  frame.in_contact.create(dots_px.size());
  for (int i = 0; i < dots_px.rows; ++i) {
    for (int j = 0; j < dots_px.cols; ++j) {
      frame.in_contact(i, j) = is_present(dots_px(i, j)) ? 1 : 0;
    }
  }
  if (ratio_) {
    StickFrame& stick = frame.stick;
    stick.states.create(dots_px.size());
    stick.result = (*ratio_)(dots_px, frame.in_contact, stick.states, *state_, time_s);
    stick.evidence =
        stick.result.ok() ? fingerpad::SlipEvidence::dots : fingerpad::SlipEvidence::none;
  }
  return frame;
}

}  // namespace replay
