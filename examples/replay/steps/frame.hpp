// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The results of a frame for tables and pictures. Forces are those that the object exerts on the
// pad; NaN means unknown.
#include <array>
#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/force/wrench.hpp"
#include "fingerpad/motion/contact_shift.hpp"
#include "fingerpad/motion/object_motion.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "replay/dots/grid.hpp"

namespace replay {

using fingerpad::ContactResult;
using fingerpad::DotState;

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

/// Stick and slip of the dots in a frame.
struct StickFrame {
  cv::Mat_<uchar> states;           ///< DotState of each dot; empty if the recording has no dots
  cv::Mat_<cv::Vec2d> slips_mm;     ///< of each dot since the reference, NaN if unknown; empty if
                                    ///< this frame has no new result
  fingerpad::StickResult<> result;  ///< uses friction if forces are known
  fingerpad::SlipEvidence evidence = fingerpad::SlipEvidence::none;

  DotState state(int row, int col) const { return static_cast<DotState>(states(row, col)); }
  bool present() const { return !states.empty(); }
};

/// The dots of one frame and their results. Grids are empty if the recording has no dots.
struct FrameDots {
  DotGrid dots_px;
  cv::Mat_<cv::Vec3d> dots_mm;  ///< NaN where a dot was not found or has no depth
  cv::Mat_<uchar> in_contact;   ///< 1 in contact, else 0
  fingerpad::ObjectMotionResult<double> motion;
  StickFrame stick;
};

/// Forces by look-up.
struct ForceFrame {
  fingerpad::ShiftResult<double> shift;  ///< mm, of the dots at the contact's edge
  bool looked_up = false;                ///< false: sensor.json has no curves; forces are empty
  double flat_area_mm2 = not_known;      ///< of a plate with the same force; needs no curves
  double normal_n = not_known;           ///< pressing force, >= 0
  double normal_sd_n = not_known;
  double disagreement = not_known;  ///< between area and depth, in standard deviations
  bool beyond_range = false;        ///< some measure exceeds the range of the calibration
  fingerpad::Point2<double> tangential_n = {not_known, not_known};
  double moment_n_mm = not_known;  ///< about the normal through the contact's center
};

struct WrenchFrame {
  bool present = false;  ///< false: the recording lacks data for the force
  fingerpad::WrenchResult result;
  /// Standard deviations of force and moment, N and N mm.
  std::array<double, 6> sd = {not_known, not_known, not_known, not_known, not_known, not_known};
};

}  // namespace replay
