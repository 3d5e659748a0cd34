// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The whole step: a noisy 8-bit frame, BGR BGR ..., to depth in mm and a status per pixel. The
// error is of each visible pixel of the pad, under the plate and around it, against its true depth;
// of a sample, against the mean of its pixels. The reference is of a frame without noise, except
// for the published method, which takes one noisy 8-bit frame and tells no status.
#include <cstdint>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <string>

#include "bench/support/run.hpp"
#include "bench/support/scene.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/sampling.hpp"
#include "fingerpad/published/depth.hpp"

using namespace fingerpad;
using bench::Image;

namespace {

struct Bench {
  bench::Scene scene;
  bench::Interleaved<std::uint8_t> frame{scene.pressed_frame<std::uint8_t>()};
  Image<double> mean_of_samples_mm = means<3>(scene.pressed_mm);

  template <int Step>
  static Image<double> means(const Image<double>& depth_mm) {
    DepthReference<double> reference;
    reference.rows = depth_mm.rows();
    reference.cols = depth_mm.cols();
    reference.depth_mm = depth_mm.cells;
    const auto of = sampled(reference, Step);
    Image<double> out(of.rows, of.cols);
    out.cells = of.depth_mm;
    return out;
  }

  /// `measure(depth_mm)` fills a map. `memory` is made before everything that it holds.
  template <class S, class Measure>
  void add(const std::string& name,
           const Image<double>& truth_mm,
           const bench::Memory& memory,
           Measure measure) const {
    const auto depth_mm = std::make_shared<Image<S>>(truth_mm.rows(), truth_mm.cols());
    bench::add(
        scene.name + "/" + name, scene.pixels(), memory.bytes(),
        [=] { benchmark::DoNotOptimize(measure(*depth_mm)); },
        [=, &truth_mm](auto& counters) {
          bench::note_errors(counters, "depth", "mm", bench::errors_of(*depth_mm, truth_mm));
        });
  }

  template <class S>
  void add_ours(const std::string& name, const DepthOptions& options = {}) const {
    const auto reference = scene.pad.reference<S>();
    const bench::Memory memory;
    const auto estimate =
        std::make_shared<DepthEstimator<S>>(scene.pad.camera, scene.pad.fluid, reference, options);
    const auto status = std::make_shared<Image<PixelStatus>>(scene.pad.rows, scene.pad.cols);
    add<S>(name, scene.pressed_mm, memory, [=, this](Image<S>& depth_mm) {
      return (*estimate)(frame.red(), frame.green(), depth_mm, *status);
    });
  }

  void add_samples(const std::string& name, int step) const {
    using Samples = Image<std::uint16_t>;
    const auto reference = sampled(scene.pad.reference<float>(), step);
    const bench::Memory memory;
    const auto red = std::make_shared<Samples>(reference.rows, reference.cols);
    const auto green = std::make_shared<Samples>(*red);
    const auto estimate = std::make_shared<DepthEstimator<>>(
        sampled(scene.pad.camera, step), scene.pad.fluid, reference, DepthOptions{.step = step});
    const auto status = std::make_shared<Image<PixelStatus>>(reference.rows, reference.cols);
    add<float>(name, mean_of_samples_mm, memory, [=, this](Image<float>& depth_mm) {
      (void)sample_frame(frame.red(), frame.green(), step, red->view(), green->view());
      return (*estimate)(*red, *green, depth_mm, *status);
    });
  }

  void add_published(const std::string& name) const {
    const auto free = scene.pad.frame<std::uint8_t>(scene.free_mm, scene.noise, 2);
    const bench::Memory memory;
    const auto estimate = std::make_shared<published::DepthEstimator<>>(
        scene.pad.published(), free.red, free.green, scene.free_mm);
    add<double>(name, scene.pressed_mm, memory, [=, this](Image<double>& depth_mm) {
      return (*estimate)(frame.red(), frame.green(), depth_mm);
    });
  }

  void add_opencv() const {
    const bench::Memory memory;
    const auto out = std::make_shared<Image<float>>(scene.pad.rows, 3 * scene.pad.cols);
    const auto work = [=, this, rows = int(scene.pad.rows), cols = int(scene.pad.cols)] {
      const cv::Mat in(rows, cols, CV_8UC3, const_cast<std::uint8_t*>(frame.cells.cells.data()));
      cv::Mat smooth(rows, cols, CV_32FC3, out->cells.data());
      cv::boxFilter(in, smooth, CV_32F, {29, 29});
      cv::log(smooth, smooth);
    };
    bench::add(scene.name + "/cv::boxFilter and cv::log of the frame", scene.pixels(),
               memory.bytes(), work, [](auto&) {});
  }

  void add_all() const {
    add_published("published: BoxMean + Bisection in double");
    add_ours<float>("NoSmoothing + ExponentialFree<>", {.window_px = 1});
    add_ours<float>("BiasFreeMean + ExponentialFree<>");
    add_ours<double>("the default in double");
    add_samples("samples of 3", 3);
    bench::add_streaming(scene.name, scene.pixels());
    add_opencv();
  }
};

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const Bench pad{bench::round_pad()};  // outlives the rows
  pad.add_all();
  return bench::run(argc, argv);
}
