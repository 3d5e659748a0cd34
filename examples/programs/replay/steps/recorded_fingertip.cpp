// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/pipeline/fingertip.hpp"
#include "replay/steps/fingertip_options.hpp"

namespace replay {

RecordedFingertip::RecordedFingertip(const fingerpad::FingertipOptions& options)
    : fingertip_(new fingerpad::Fingertip(options)) {}
RecordedFingertip::~RecordedFingertip() = default;

fingerpad::FingertipResult RecordedFingertip::operator()(
    const cv::Mat& frame,
    const DotGrid& dots_px,
    double pressure_mpa,
    double time_s,
    std::span<const fingerpad::Mark> side_dots) {
  return with_colors(frame, [&](const auto& red, const auto& green) {
    return (*fingertip_)(red, green, dots_px, pressure_mpa, time_s, side_dots);
  });
}

}  // namespace replay
