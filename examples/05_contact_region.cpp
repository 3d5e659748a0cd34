// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Finds where a rod touches the pad, and its curvature, from depth maps: first the threshold from
// the free pad, then area and depth of the contact and the surface in it.
// Usage: 05_contact_region [RECORDING]
#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/calibrate/contact.hpp"
#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/contact/surface.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/fit_reference.hpp"

int main(int argc, char** argv) {
  const std::string recording = argc > 1 ? argv[1] : FINGERPAD_EXAMPLE_RECORDING;
  const cv::Mat pad = cv::imread(recording + "/reference.png");
  const cv::Mat1f shape = cv::imread(recording + "/reference_depth.tiff", cv::IMREAD_UNCHANGED);
  const cv::Mat frame = cv::imread(recording + "/frames/000005.png");
  if (pad.empty() || shape.empty() || frame.empty()) {
    std::fprintf(stderr, "%s: the reference or frame 5 is missing\n", recording.c_str());
    return 1;
  }
  const auto red = [](const cv::Mat& image) { return fingerpad::channel<std::uint8_t>(image, 2); };
  const auto green = [](const cv::Mat& image) {
    return fingerpad::channel<std::uint8_t>(image, 1);
  };
  const fingerpad::Camera<double> camera{.center_x_px = 239.5, .center_y_px = 239.5};
  const fingerpad::Absorption<double> fluid;
  const auto reference = fit_reference(camera, fluid, red(pad), green(pad), shape);
  fingerpad::DepthEstimator depth_of(camera, fluid, reference);

  // Once per sensor: the threshold from the free pad's shape. More frames of it would also give the
  // noise.
  const auto free_pad = fit_contact_threshold(camera, std::vector{shape});
  fingerpad::ContactTest test{.free_apex_mm = 13.03};
  test.threshold_per_mm = free_pad.threshold_per_mm;
  fingerpad::ContactRegion<> contact_of(camera, shape.rows, shape.cols, test);

  // Every frame.
  cv::Mat1f depth_mm(frame.size());
  cv::Mat1b mask(frame.size());
  (void)depth_of(red(frame), green(frame), depth_mm);
  const fingerpad::ContactResult contact = contact_of(depth_mm, mask);
  const auto surface = fit_surface(camera, depth_mm, mask);

  std::printf("contact: %.1f mm^2, %.2f mm deep, center (%.2f, %.2f) mm\n", contact.area_mm2,
              contact.depth_mm, contact.center_mm.x, contact.center_mm.y);
  const double radius_mm = 1 / surface.curvature_1_per_mm;  // the rod has 12 mm
  std::printf("object: radius %.1f mm, residual %.3f mm rms\n", radius_mm, surface.rms_mm);
  const bool plausible = contact.area_mm2 > 80 && contact.area_mm2 < 120 &&
                         std::abs(contact.center_mm.x) < 0.5 && std::abs(radius_mm - 12) < 2;
  return plausible ? 0 : 1;
}
