// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Computes stick ratio and motion of an object from images alone: one object finds the printed dots
// of each frame. Usage: 12_image_in_touch_out [RECORDING]
#include <cstdint>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#include "fingerpad/dots/dot_finder.hpp"
#include "fingerpad/pipeline/fingertip.hpp"

using namespace fingerpad;

auto plane(const cv::Mat& bgr, int k) {
  return channel<std::uint8_t>(bgr, k);
}

int main(int argc, char** argv) {
  const std::string recording = argc > 1 ? argv[1] : FINGERPAD_EXAMPLE_RECORDING;
  const cv::Mat pad = cv::imread(recording + "/reference.png");
  const cv::Mat1f depth_mm = cv::imread(recording + "/reference_depth.tiff", cv::IMREAD_UNCHANGED);
  const Camera<double> camera{.center_x_px = 239.5, .center_y_px = 239.5};

  // Once: the dots of the free pad, and where they are in space.
  DotFinderOptions print;
  print.where = depth_mm > 0;
  print.color_weights = {0, 1, 1};  // the fluid's light is green and red
  const DotFinder finder(pad, print);
  if (!finder.ok()) {
    std::fprintf(stderr, "%s\n", finder.refusal().c_str());
    return 1;
  }
  const Index rows = finder.rows(), cols = finder.cols();
  std::vector<Point3<double>> points(static_cast<std::size_t>(rows * cols));
  StridedView<Point3<double>> free_dots_mm(points.data(), rows, cols, cols);
  (void)spatial_dots(camera, finder.free_px(), depth_mm, free_dots_mm);

  FingertipOptions options{
      camera, {}, fit_reference(camera, Absorption<>(), plane(pad, 2), plane(pad, 1), depth_mm)};
  options.free_dots_mm = free_dots_mm;
  options.dot_radius_px = finder.pattern().radius_px;
  options.dot_follower.emplace(mean_light(plane(pad, 2), plane(pad, 1)), finder.free_px(),
                               DotFollowerOptions{.radius_px = options.dot_radius_px});
  Fingertip fingertip(options);

  // Every frame.
  Index most = 0;
  double least = 1;
  for (int k = 0; k < 11; ++k) {
    char name[16];
    std::snprintf(name, sizeof name, "%06d.png", k);
    const cv::Mat frame = cv::imread(recording + "/frames/" + name);
    const auto touch = fingertip(plane(frame, 2), plane(frame, 1));
    std::printf("%2d: %ld of %ld dots, %3.0f mm^2 in contact, stick ratio %4.2f\n", k,
                static_cast<long>(touch.dots.found), static_cast<long>(touch.dots.expected),
                touch.contact.area_mm2, touch.stick.stick_ratio);
    most = touch.dots.found > most ? touch.dots.found : most;
    least = touch.stick.stick_ratio < least ? touch.stick.stick_ratio : least;
  }
  return most > 300 && least < 0.9 ? 0 : 1;  // the rod slides at the end
}
