// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Converts sensor.json and the free pad to options of pipeline/fingertip.hpp. The library itself
// reads no files.
#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/pipeline/fingertip_options.hpp"
#include "replay/dots/grid.hpp"
#include "replay/io/recording.hpp"

namespace replay {

/// Views of red and green of an OpenCV image in BGR order.
template <class Pixel = std::uint8_t>
auto color_of(const cv::Mat& image) {
  return fingerpad::ColorFrame(fingerpad::channel<Pixel>(image, 2),
                               fingerpad::channel<Pixel>(image, 1));
}

/// The reference of the free pad; the same type for images of 8 and 16 bits.
using Reference =
    decltype(fingerpad::fit_reference(std::declval<const fingerpad::Camera<double>&>(),
                                      std::declval<const fingerpad::Absorption<double>&>(),
                                      color_of(cv::Mat()).red,
                                      color_of(cv::Mat()).green,
                                      std::declval<const cv::Mat_<float>&>()));

/// Options together with the points that they view.
struct FingertipSettings {
  fingerpad::FingertipOptions options;
  std::vector<fingerpad::Point3<double>> free_dots_mm = {};
  std::vector<fingerpad::Point3<double>> rim_mm = {};

  explicit FingertipSettings(fingerpad::FingertipOptions of) : options(std::move(of)) {}
  FingertipSettings(FingertipSettings&&) = default;
};

/// `free_dots_px` are the free pad's dots, maybe empty. The contact threshold comes from
/// sensor.json, else from the free pad's known shape. options.free_depth_mm, which neighbour light
/// needs, is not set. The recording must outlive the settings. Throws fingerpad::parameter_error.
FingertipSettings fingertip_settings(const Recording& recording, const DotGrid& free_dots_px);

/// Why a recording has no six-axis forces; empty if it has them.
std::string lacking_for_wrench(const Recording& recording);

/// A complete fingertip with these settings and the default methods, for 8-bit frames. It is
/// compiled once for all programs.
class RecordedFingertip {
 public:
  explicit RecordedFingertip(const FingertipSettings& settings);
  ~RecordedFingertip();

  /// See fingerpad::Fingertip.
  fingerpad::FingertipResult operator()(const cv::Mat& frame,
                                        const DotGrid& dots_px,
                                        const SpaceGrid& side_dots_mm,
                                        double pressure_mpa,
                                        double time_s);

 private:
  struct Whole;
  std::unique_ptr<Whole> whole_;
};

}  // namespace replay
