// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Uses a fingertip as one object that turns frames into touch. Without free dots in the
// options their stages do not exist. Usage: 16_fingertip [RECORDING]
#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/pipeline/fingertip.hpp"

int main(int argc, char** argv) {
  const std::string recording = argc > 1 ? argv[1] : FINGERPAD_EXAMPLE_RECORDING;
  const cv::Mat pad = cv::imread(recording + "/reference.png");
  const cv::Mat1f shape = cv::imread(recording + "/reference_depth.tiff", cv::IMREAD_UNCHANGED);
  const cv::Mat image = cv::imread(recording + "/frames/000005.png");
  if (pad.empty() || shape.empty() || image.empty()) {
    std::fprintf(stderr, "%s: the reference or frame 5 is missing\n", recording.c_str());
    return 1;
  }
  const auto red = [](const cv::Mat& bgr) { return fingerpad::channel<std::uint8_t>(bgr, 2); };
  const auto green = [](const cv::Mat& bgr) { return fingerpad::channel<std::uint8_t>(bgr, 1); };

  // Once: what is known of the free pad.
  const fingerpad::Camera<double> camera{.center_x_px = 239.5, .center_y_px = 239.5};
  const fingerpad::Absorption<double> fluid;
  const auto reference = fit_reference(camera, fluid, red(pad), green(pad), shape);
  fingerpad::FingertipOptions options{camera, fluid, reference};
  options.contact.free_apex_mm = 13.03;
  fingerpad::Fingertip fingertip(options);

  // Every frame.
  const auto touch = fingertip(red(image), green(image));

  std::printf("%s: %.1f mm^2 in contact, %.2f mm deep\n", name_of(touch.status),
              touch.contact.area_mm2, touch.contact.depth_mm);
  return touch.ok() && std::abs(touch.contact.area_mm2 - 100) < 20 ? 0 : 1;
}
