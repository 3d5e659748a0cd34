// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The whole chain from pixels: median processor time of a frame with its dots given, with dots that
// the fingertip finds, and of finder and follower alone, in one run. Usage: times [RECORDING]
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#include "fingerpad/dots/dot_finder.hpp"
#include "fingerpad/pipeline/fingertip.hpp"

using namespace fingerpad;

namespace {

auto plane(const cv::Mat& bgr, int k) {
  return channel<std::uint8_t>(bgr, k);
}

double thread_ms() {
  std::timespec now{};
  (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

using Grid = cv::Mat_<cv::Vec2d>;

/// Of frames forth and back, so that no dot jumps.
double median_ms(const std::vector<cv::Mat>& frames, const std::function<void(std::size_t)>& call) {
  constexpr std::size_t rounds = 40;
  std::vector<double> ms;
  const std::size_t last = frames.size() - 1;
  for (std::size_t k = 0; k < rounds * last; ++k) {
    const std::size_t at = k / last % 2 == 0 ? k % last : last - k % last;
    const double begin_ms = thread_ms();
    call(at);
    ms.push_back(thread_ms() - begin_ms);
  }
  std::nth_element(ms.begin(), ms.begin() + static_cast<std::ptrdiff_t>(ms.size() / 2), ms.end());
  return ms[ms.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const std::string recording = argc > 1 ? argv[1] : FINGERPAD_EXAMPLE_RECORDING;
  const cv::Mat pad = cv::imread(recording + "/reference.png");
  const cv::Mat1f depth_mm = cv::imread(recording + "/reference_depth.tiff", cv::IMREAD_UNCHANGED);
  std::vector<cv::Mat> frames;
  for (int k = 0; k < 11; ++k) {
    frames.push_back(cv::imread(recording + "/frames/" + detail::print("%06d.png", k)));
  }
  const Camera<double> camera{.center_x_px = 239.5, .center_y_px = 239.5};
  DotFinderOptions print;
  print.where = depth_mm > 0;
  print.color_weights = {0, 1, 1};
  DotFinder finder(pad, print);
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
  Fingertip given(options);
  options.dot_follower.emplace(mean_light(plane(pad, 2), plane(pad, 1)), finder.free_px(),
                               DotFollowerOptions{.radius_px = options.dot_radius_px});
  Fingertip found(options);
  DotFollower follower = *options.dot_follower;
  std::vector<Grid> dots;
  Grid grid(static_cast<int>(rows), static_cast<int>(cols));
  for (const cv::Mat& frame : frames) {
    (void)follower(mean_light(plane(frame, 2), plane(frame, 1)), grid);
    dots.push_back(grid.clone());
  }
  std::printf("| %d dots, %d x %d px | ms |\n|---|--:|\n", static_cast<int>(count_present(grid)),
              pad.cols, pad.rows);
  const auto row = [&](const char* name, const std::function<void(std::size_t)>& call) {
    std::printf("| %s | %.2f |\n", name, median_ms(frames, call));
  };
  row("DotFinder", [&](std::size_t k) { (void)finder(frames[k], grid); });
  row("DotFollower", [&](std::size_t k) {
    (void)follower(mean_light(plane(frames[k], 2), plane(frames[k], 1)), grid);
  });
  row("depth, contact, motion, stick ratio, dots given",
      [&](std::size_t k) { (void)given(plane(frames[k], 2), plane(frames[k], 1), dots[k]); });
  row("the same from pixels alone",
      [&](std::size_t k) { (void)found(plane(frames[k], 2), plane(frames[k], 1)); });
}
