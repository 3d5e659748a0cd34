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
    frame.evidence =
        frame.result.ok() ? fingerpad::SlipEvidence::dots : fingerpad::SlipEvidence::none;
  }
  return frame;
}

SpatialStickStep::SpatialStickStep(cv::Size size, const fingerpad::SpatialStickTest& test) {
  if (!size.empty()) {
    ratio_.emplace(size.height, size.width, test);
    state_.emplace(ratio_->start());
  }
}

StickFrame SpatialStickStep::operator()(const cv::Mat_<cv::Vec3d>& dots_mm,
                                        const cv::Mat_<uchar>& in_contact,
                                        double time_s) {
  StickFrame frame;
  if (ratio_) {
    frame.states.create(dots_mm.size());
    const auto seen = (*ratio_)(dots_mm, in_contact, frame.states, *state_, time_s);
    frame.result.status = seen.status;
    frame.result.stick = seen.stick;
    frame.result.slip = seen.slip;
    frame.result.unknown = seen.unknown;
    frame.result.out_of_place = seen.out_of_place;
    frame.result.stick_ratio = static_cast<float>(seen.stick_ratio);
    frame.result.reference_age = seen.reference_age;
    frame.ratio_sd = seen.ratio_sd;
  }
  return frame;
}

void SpatialStickStep::fuse(const fingerpad::ContactLoad<double>& load, StickFrame& frame) {
  if (ratio_) {
    const auto slip = limit_(load, static_cast<double>(frame.result.stick_ratio),
                             update_of(frame.result.status), limit_state_);
    frame.evidence = slip.evidence;
    frame.slides = slip.status == fingerpad::FrictionLimitStatus::sliding;
    if (frame.slides) {
      frame.result.stick_ratio = 0;
      frame.result.status = fingerpad::StickStatus::updated;
      frame.ratio_sd = 0;
    }
  }
}

}  // namespace replay
