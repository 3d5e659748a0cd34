// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// What is computed of a frame, as tables and pictures take it. Forces are what the object exerts on
// the pad; what is NaN is not known.
#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/force/wrench_options.hpp"
#include "fingerpad/motion/contact_shift.hpp"
#include "fingerpad/motion/object_motion.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "replay/dots/grid.hpp"

namespace replay {

using fingerpad::ContactResult;
using fingerpad::DotState;

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

/// What the dots of a frame say of stick and slip.
struct StickFrame {
  cv::Mat_<uchar> states;        ///< DotState of each dot; empty where the recording has no dots
  cv::Mat_<cv::Vec3d> slips_mm;  ///< of each dot since the reference, NaN where it is not known;
                                 ///< empty where no answer is of this frame
  fingerpad::StickRatioResult<float> result;  ///< with friction where forces are known
  fingerpad::SlipEvidence evidence = fingerpad::SlipEvidence::none;

  DotState state(int row, int col) const { return static_cast<DotState>(states(row, col)); }
  bool present() const { return !states.empty(); }
};

/// The dots of one frame and what they say. Grids are empty where the recording has no dots.
struct FrameDots {
  DotGrid dots_px;
  cv::Mat_<cv::Vec3d> dots_mm;  ///< NaN where a dot was not found or has no depth
  cv::Mat_<uchar> in_contact;   ///< 1 for dots that are
  fingerpad::ObjectMotionResult<double> motion;
  StickFrame stick;
};

/// Forces by look-up.
struct ForceFrame {
  fingerpad::ShiftResult<double> shift;  ///< mm, of the dots beside the contact's edge
  bool looked_up = false;                ///< false: sensor.json has no curves; forces are empty
  double flat_area_mm2 = not_known;  ///< of the plate that would press as hard; without curves, too
  double normal_n = not_known;       ///< that presses, >= 0
  double normal_sd_n = not_known;
  double disagreement = not_known;  ///< of area and depth, in standard deviations
  bool beyond_range = false;        ///< something is larger than in the calibration
  fingerpad::Point2<double> tangential_n = {not_known, not_known};
  double moment_n_mm = not_known;  ///< about the normal through the middle of the contact
};

/// What the membrane pulls a rim point with.
struct RimTension {
  fingerpad::Point3<double> border_mm;
  fingerpad::Point3<double> n_per_mm;
};

struct WrenchFrame {
  bool present = false;  ///< false: the recording does not have what the force needs
  fingerpad::WrenchResult<double> result;
  std::vector<RimTension> tension;  ///< around the rim
};

}  // namespace replay
