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

StickFrame StickStep::operator()(const DotGrid& dots_px,
                                 const cv::Mat_<uchar>& in_contact,
                                 double time_s) {
  StickFrame frame;
  if (ratio_) {
    frame.states.create(dots_px.size());
    frame.result = (*ratio_)(dots_px, in_contact, frame.states, *state_, time_s);
  }
  return frame;
}

}  // namespace replay
