// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// From a frame's contact and dots to forces by look-up, with the library's contact_shift.hpp,
// normal_force.hpp and shear.hpp; the only place of the program that knows them.
#include <functional>
#include <limits>

#include "fingerpad/motion/contact_shift.hpp"
#include "replay/io/recording.hpp"
#include "replay/steps/contact_step.hpp"
#include "replay/steps/motion_step.hpp"

namespace replay {

/// What is NaN is not known. Forces are what the object exerts on the pad.
struct ForceFrame {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  fingerpad::ShiftResult<double> shift;  ///< mm, of the dots beside the contact's edge
  bool looked_up = false;                ///< false: sensor.json has no curves; all below is empty
  double normal_n = none;                ///< that presses, >= 0
  double disagreement = none;            ///< of area and depth, in standard deviations
  bool beyond_range = false;             ///< something is larger than in the calibration
  fingerpad::Point2<double> tangential_n = {none, none};
  double moment_n_mm = none;  ///< about the normal through the middle of the contact
};

using ForceStep = std::function<ForceFrame(const ContactResult& contact, const FrameDots& dots)>;

/// `initial_px` are the free pad's dots, perhaps none. Only the shift where sensor.json has no
/// curves. Throws fingerpad::parameter_error.
ForceStep make_force_step(const Recording& recording, const DotGrid& initial_px);

}  // namespace replay
