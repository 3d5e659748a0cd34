// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Converts sensor.json and the free pad to options of pipeline/fingertip.hpp. The library itself
// reads no files.
#include <cstdint>
#include <limits>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/recording.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/pipeline/fingertip_options.hpp"
#include "replay/dots/grid.hpp"

namespace fingerpad {
inline namespace v1 {
class Fingertip;
}
}  // namespace fingerpad

namespace replay {

/// `use(red, green)` of an OpenCV image in BGR order, of 8 or 16 bit.
template <class Use>
auto with_colors(const cv::Mat& image, const Use& use) {
  return image.depth() == CV_16U ? use(fingerpad::channel<std::uint16_t>(image, 2),
                                       fingerpad::channel<std::uint16_t>(image, 1))
                                 : use(fingerpad::channel<std::uint8_t>(image, 2),
                                       fingerpad::channel<std::uint8_t>(image, 1));
}

/// Options together with the points that they view.
struct FingertipSettings {
  fingerpad::FingertipOptions options;
  std::vector<fingerpad::Point3<double>> free_dots_mm = {};

  explicit FingertipSettings(fingerpad::FingertipOptions of) : options(std::move(of)) {}
  FingertipSettings(FingertipSettings&&) = default;
};

/// `free_dots_px` are the free pad's dots, maybe empty. The contact threshold comes from
/// sensor.json, else from the free pad's known shape. options.free_depth_mm, which neighbour light
/// needs, is not set. The recording must outlive the settings. Throws fingerpad::parameter_error.
FingertipSettings fingertip_settings(const Recording& recording, const DotGrid& free_dots_px);

/// The pressure that makes the free pad as high as it is; none if its rubber is not known.
std::optional<double> free_pressure_mpa(const Recording& recording);

/// Says that the pressure is too low or too high for the height of the free pad; empty if it is
/// not.
std::string fault_of_pressure(const Recording& recording);

/// Why a recording has no six-axis forces; empty if it has them.
std::string lacking_for_wrench(const Recording& recording);

/// A fingertip with these options, compiled once for all programs.
class RecordedFingertip {
 public:
  explicit RecordedFingertip(const fingerpad::FingertipOptions& options);
  ~RecordedFingertip();

  /// See fingerpad::Fingertip. A frame alone is enough where no stage takes dots.
  fingerpad::FingertipResult operator()(
      const cv::Mat& frame,
      const DotGrid& dots_px = {},
      double pressure_mpa = std::numeric_limits<double>::quiet_NaN(),
      double time_s = std::numeric_limits<double>::quiet_NaN(),
      std::span<const fingerpad::Mark> side_dots = {});
  /// The maps of the last frame.
  const fingerpad::Fingertip& last() const { return *fingertip_; }

 private:
  std::unique_ptr<fingerpad::Fingertip> fingertip_;
};

}  // namespace replay
