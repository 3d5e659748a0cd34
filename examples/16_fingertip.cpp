// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Uses a fingertip as one object that turns frames into touch. Dots and side dots are not used
// here, so their stages are switched off. Usage: 16_fingertip [RECORDING]
#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/pipeline/fingertip.hpp"

struct DepthAndContact : fingerpad::FingertipMethods {
  static constexpr bool has_dots = false;
  static constexpr bool has_wrench = false;
};

int main(int argc, char** argv) {
  const std::string recording = argc > 1 ? argv[1] : FINGERPAD_EXAMPLE_RECORDING;
  const cv::Mat pad = cv::imread(recording + "/reference.png");
  const cv::Mat1f shape = cv::imread(recording + "/reference_depth.tiff", cv::IMREAD_UNCHANGED);
  const cv::Mat image = cv::imread(recording + "/frames/000005.png");
  if (pad.empty() || shape.empty() || image.empty()) {
    std::fprintf(stderr, "%s: the reference or frame 5 is missing\n", recording.c_str());
    return 1;
  }
  const auto frame_of = [](const cv::Mat& bgr) {
    return fingerpad::ColorFrame(fingerpad::channel<std::uint8_t>(bgr, 2),
                                 fingerpad::channel<std::uint8_t>(bgr, 1));
  };

  // Once: what is known of the free pad.
  const fingerpad::Camera<double> camera{.center_x_px = 239.5, .center_y_px = 239.5};
  const fingerpad::Absorption<double> fluid;
  const auto free_pad = frame_of(pad);
  const auto reference = fit_reference(camera, fluid, free_pad.red, free_pad.green, shape);
  fingerpad::FingertipOptions options{camera, fluid, reference, shape.rows, shape.cols};
  options.contact.free_apex_mm = 13.03;
  fingerpad::Fingertip<DepthAndContact> fingertip(options);

  // Every frame.
  const auto no_dots = fingerpad::StridedView<const fingerpad::Point2<double>>();
  const auto touch = fingertip(frame_of(image), no_dots, 0);

  std::printf("%s: %.1f mm^2 in contact, %.2f mm deep\n", name_of(touch.status),
              touch.contact.area_mm2, touch.contact.depth_mm);
  return touch.ok() && std::abs(touch.contact.area_mm2 - 100) < 20 ? 0 : 1;
}
