// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// From a frame's depth map, contact and side dots to the force on the pad, with the library's
// wrench.hpp; the only place of the program that knows it.
#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "fingerpad/core/dots.hpp"
#include "fingerpad/force/wrench_options.hpp"
#include "replay/io/recording.hpp"

namespace replay {

/// What the membrane pulls a rim point with.
struct RimTension {
  fingerpad::Point3<double> border_mm;
  fingerpad::Point3<double> n_per_mm;  ///< NaN: not known
};

struct WrenchFrame {
  bool present = false;  ///< false: the recording does not have what the force needs
  fingerpad::WrenchResult<double> result;
  bool given_modulus = false;  ///< by the modulus in sensor.json, because the shape did not tell
  std::vector<RimTension> tension;  ///< around the rim
};

/// Frames in any order. `contact` is nonzero where a pixel is in contact.
using WrenchStep = std::function<WrenchFrame(
    int frame, const cv::Mat_<float>& depth_mm, const cv::Mat_<uchar>& contact)>;

/// Why a recording has no forces; empty where it has.
std::string lacking_for_wrench(const Recording& recording);

/// Empty where something is lacking. The recording must outlive the step. Throws
/// fingerpad::parameter_error.
WrenchStep make_wrench_step(const Recording& recording);

}  // namespace replay
