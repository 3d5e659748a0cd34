// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Computes a depth map in mm from image files: the free pad once, then each frame.
// Usage: 01_depth_in_ten_lines [RECORDING]
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/fit_reference.hpp"

// Views of the channels, without a copy. OpenCV stores colours as blue, green, red.
static auto green_of(const cv::Mat& image) {
  return fingerpad::channel<std::uint8_t>(image, 1);
}
static auto red_of(const cv::Mat& image) {
  return fingerpad::channel<std::uint8_t>(image, 2);
}

int main(int argc, char** argv) {
  const std::string recording = argc > 1 ? argv[1] : FINGERPAD_EXAMPLE_RECORDING;
  const cv::Mat pad = cv::imread(recording + "/reference.png");
  const cv::Mat1f shape = cv::imread(recording + "/reference_depth.tiff", cv::IMREAD_UNCHANGED);
  const cv::Mat frame = cv::imread(recording + "/frames/000005.png");
  if (pad.empty() || shape.empty() || frame.empty()) {
    std::fprintf(stderr, "%s: the reference or frame 5 is missing\n", recording.c_str());
    return 1;
  }

  const fingerpad::Camera<double> camera{.center_x_px = 239.5, .center_y_px = 239.5};
  const fingerpad::Absorption<double> fluid;  // the published fluid
  const auto reference = fit_reference(camera, fluid, red_of(pad), green_of(pad), shape);
  fingerpad::DepthEstimator estimate(camera, fluid, reference);  // nothing is allocated after this

  cv::Mat1f depth_mm(frame.size());
  const auto result = estimate(red_of(frame), green_of(frame), depth_mm);

  const float center = depth_mm(240, 240);
  std::printf("%td of %td pixels have a depth; %.2f mm at the center, %.2f mm in the free pad\n",
              result.valid_pixels(), result.pad_pixels, static_cast<double>(center),
              static_cast<double>(shape(240, 240)));
  return result.ok() && center > 8.0f && center < shape(240, 240) + 0.5f ? 0 : 1;
}
