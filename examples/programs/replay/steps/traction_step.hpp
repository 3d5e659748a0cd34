// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Computes the load of the object on each dot from the dots and their stress-free positions, with
// the library's traction.hpp. Only this step uses that header.
#include <functional>
#include <opencv2/core.hpp>

#include "common/recording.hpp"
#include "fingerpad/force/traction.hpp"
#include "replay/steps/frame.hpp"

namespace replay {

/// Maps are grids of dots, NaN where unknown; they are empty if the recording has no stress-free
/// dots.
struct TractionFrame {
  fingerpad::TractionResult<double> result;
  cv::Mat_<double> pressure_mpa;  ///< of the contact
  cv::Mat_<cv::Vec3d> shear_mpa;  ///< along the membrane
  bool present() const { return !pressure_mpa.empty(); }
};

using TractionStep = std::function<TractionFrame(const FrameDots& dots, double pressure_mpa)>;

/// Empty if the recording has no stress_free_dots.csv. Throws fingerpad::parameter_error.
TractionStep make_traction_step(const Recording& recording);

}  // namespace replay
