// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// The results of a frame for tables and pictures. Forces are those that the object exerts on the
// pad; NaN means unknown.
#include <cstdint>
#include <limits>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "common/true_forces.hpp"
#include "fingerpad/gel/gel_contact.hpp"
#include "fingerpad/gel/gel_slide.hpp"
#include "fingerpad/pipeline/fingertip_options.hpp"
#include "replay/dots/grid.hpp"

namespace replay {

using fingerpad::ContactResult;
using fingerpad::DotState;

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

/// One frame of a gel.
struct GelFrame {
  fingerpad::GelResult contact;
  fingerpad::SlideResult slide;
};

/// The numbers of one frame: a line of frames.csv.
struct FrameRow {
  int frame = 0;
  std::string time_s;  ///< empty if unknown
  double pressure_mpa = not_known;
  double valid_share = not_known;    ///< of the pad's pixels; NaN for a dots-only recording
  double depth_mean_mm = not_known;  ///< if no pixel is valid
  double depth_max_mm = not_known;
  bool has_depth = false;  ///< what the recording has the data for
  bool has_dots = false;
  bool has_curves = false;  ///< for forces by look-up
  bool has_rim = false;     ///< for the six axes
  /// "compressed", unlike the reference or much, or "saturated": depth errs by 0.1 mm or more.
  const char* picture_fault = nullptr;
  /// Its stick ratio is that of dots and friction together. A dots-only recording has that of the
  /// dots alone.
  fingerpad::FingertipResult touch;
  std::optional<GelFrame> gel;  ///< of a dots-only recording
  std::optional<TrueForce> truth;

  bool pad_has_changed() const {
    return has_depth && touch.depth.status == fingerpad::FrameStatus::not_of_this_pad;
  }
};

/// The dots of one frame. Grids are empty if the recording has no dots.
struct FrameDots {
  DotGrid dots_px;
  cv::Mat_<cv::Vec3d> dots_mm;        ///< NaN where a dot was not found or has no depth
  cv::Mat_<std::uint8_t> in_contact;  ///< 1 in contact, else 0
  cv::Mat_<std::uint8_t> states;      ///< DotState of each dot
  cv::Mat_<cv::Vec2d> slips_mm;       ///< of each dot since the reference, NaN if unknown; empty if
                                      ///< this frame has no new stick ratio

  DotState state(int row, int col) const { return static_cast<DotState>(states(row, col)); }
};

}  // namespace replay
