// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// From dots of which nothing else is known to the stick ratio, with the library's stick_ratio.hpp;
// the only place of the program that knows it.
#include <opencv2/core.hpp>
#include <optional>

#include "fingerpad/slip/stick_ratio.hpp"
#include "replay/steps/frame.hpp"

namespace replay {

class StickStep {
 public:
  /// For a grid of `size`; an empty one: the step does nothing. Throws fingerpad::parameter_error.
  StickStep(cv::Size size, const fingerpad::StickTest& test);

  /// Frames in the order of time. `time_s` is NaN where unknown. Each dot that is found counts as
  /// in contact.
  FrameDots operator()(const DotGrid& dots_px, double time_s);

 private:
  using Ratio = fingerpad::StickRatio<>;
  std::optional<Ratio> ratio_;
  std::optional<Ratio::State> state_;
};

}  // namespace replay
