// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// From the dots of a frame and their contact to the stick ratio, with the library's
// stick_ratio.hpp; the only place of the program that knows it.
#include <opencv2/core.hpp>
#include <optional>

#include "fingerpad/slip/stick_ratio.hpp"
#include "replay/dots/grid.hpp"

namespace replay {

using fingerpad::DotState;

/// What the dots of a frame say of stick and slip.
struct StickFrame {
  cv::Mat_<uchar> states;  ///< DotState of each dot; empty where the recording has no dots
  fingerpad::StickRatioResult<float> result;

  DotState state(int row, int col) const { return static_cast<DotState>(states(row, col)); }
  bool present() const { return !states.empty(); }
};

class StickStep {
 public:
  /// For a grid of `size`; an empty one: the step does nothing. Throws fingerpad::parameter_error.
  StickStep(cv::Size size, const fingerpad::StickTest& test);

  /// Frames in the order of time. `time_s` is NaN where unknown.
  StickFrame operator()(const DotGrid& dots_px, const cv::Mat_<uchar>& in_contact, double time_s);

 private:
  using Ratio = fingerpad::StickRatio<>;
  std::optional<Ratio> ratio_;
  std::optional<Ratio::State> state_;
};

}  // namespace replay
