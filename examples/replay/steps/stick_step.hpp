// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// From the dots of a frame and their contact to the stick ratio, with the library's
// stick_ratio.hpp, or where there is depth spatial_stick_ratio.hpp and friction_limit.hpp; the only
// place of the program that knows them.
#include <limits>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/spatial_stick_ratio.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "replay/dots/grid.hpp"

namespace replay {

using fingerpad::DotState;

/// What the dots of a frame say of stick and slip.
struct StickFrame {
  cv::Mat_<uchar> states;  ///< DotState of each dot; empty where the recording has no dots
  fingerpad::StickRatioResult<float> result;  ///< with friction where forces are known
  double ratio_sd = std::numeric_limits<double>::quiet_NaN();  ///< NaN: not known
  fingerpad::SlipEvidence evidence = fingerpad::SlipEvidence::none;
  bool slides = false;  ///< as a whole, by friction

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

/// The same in space, and by the forces of the frame.
class SpatialStickStep {
 public:
  /// For a grid of `size`; an empty one: the step does nothing. Throws fingerpad::parameter_error.
  SpatialStickStep(cv::Size size, const fingerpad::SpatialStickTest& test);

  /// Frames in the order of time: what the dots say.
  StickFrame operator()(const cv::Mat_<cv::Vec3d>& dots_mm,
                        const cv::Mat_<uchar>& in_contact,
                        double time_s);
  /// What they say together with the load of the contact.
  void fuse(const fingerpad::ContactLoad<double>& load, StickFrame& frame);

 private:
  using Ratio = fingerpad::SpatialStickRatio<double>;
  using Limit = fingerpad::FrictionLimit<double>;
  std::optional<Ratio> ratio_;
  std::optional<Ratio::State> state_;
  Limit limit_;
  Limit::State limit_state_ = limit_.start();
};

}  // namespace replay
