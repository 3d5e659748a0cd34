// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Computes the stick ratio of a dots-only recording with the library's stick_ratio.hpp. Only this
// step uses that header.
#include <opencv2/core.hpp>
#include <optional>

#include "fingerpad/slip/stick_ratio.hpp"
#include "replay/steps/frame.hpp"

namespace replay {

class StickStep {
 public:
  /// For a grid of `size`; with an empty size the step does nothing. Throws
  /// fingerpad::parameter_error.
  StickStep(cv::Size size, const fingerpad::StickOptions& options);

  /// Takes frames in time order. `time_s` is NaN if unknown. Each dot that is found counts as in
  /// contact. Sets the stick ratio of `touch`.
  FrameDots operator()(const DotGrid& dots_px, double time_s, fingerpad::FingertipResult& touch);

 private:
  std::optional<fingerpad::StickRatio<>> stick_;
};

}  // namespace replay
