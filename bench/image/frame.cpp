// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The whole step: a noisy 8-bit frame, BGR BGR ..., to depth in mm and a status per pixel. The
// error is of each visible pixel of the pad, under the plate and around it, against its true depth.
// The reference is of a frame without noise, except for the quotient per pixel, which takes one
// noisy 8-bit frame.
#include <memory>
#include <opencv2/imgproc.hpp>
#include <string>

#include "bench/support/run.hpp"
#include "bench/support/scene.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/published/depth.hpp"

using namespace fingerpad;
using bench::Image;

namespace {

struct Bench {
  bench::Scene scene;
  bench::Interleaved<std::uint8_t> frame{scene.pressed_frame<std::uint8_t>()};

  template <class Inverse, class Smoothing, class S, class Scattering, class Heights>
  void add_with(const std::string& name,
                const DepthReference<S, Scattering, Heights>& reference) const {
    using Estimator = DepthEstimator<Smoothing, Inverse, Heights, S, Scattering>;
    using Workspace = typename Estimator::template Workspace<std::uint8_t>;
    const bench::Memory memory;
    const auto estimator =
        std::make_shared<const Estimator>(scene.pad.camera, scene.pad.fluid, reference);
    const auto workspace =
        std::make_shared<Workspace>(estimator->template workspace<std::uint8_t>());
    const auto depth = std::make_shared<Image<S>>(scene.pad.rows, scene.pad.cols);
    const auto status = std::make_shared<Image<PixelStatus>>(scene.pad.rows, scene.pad.cols);
    bench::add(
        scene.name + "/" + name, scene.pixels(), memory.bytes(),
        [=, this] {
          benchmark::DoNotOptimize(
              (*estimator)(frame.red(), frame.green(), *depth, *status, *workspace));
        },
        [=, this](auto& counters) {
          bench::note_errors(counters, "depth", "mm", bench::errors_of(*depth, scene.pressed_mm));
        });
  }

  /// The rendered light does not depend on the Heights of the estimator.
  template <class Smoothing, class Inverse, class S = float, class Heights = AstigmaticHeights>
  void add(const std::string& name) const {
    const auto free = scene.pad.frame<double>(scene.free_mm);
    add_with<Inverse, Smoothing>(
        name, fit_reference<Heights, S>(scene.pad.camera, scene.pad.fluid, free.red, free.green,
                                        scene.free_mm));
  }

  /// g pixel by pixel, as published, from a noisy 8-bit frame that `Before` smooths first.
  template <class Before, class Smoothing, class Inverse, class Heights, class S>
  void add_quotient(const std::string& name) const {
    const auto free = scene.pad.frame<std::uint8_t>(scene.free_mm, scene.noise, 2);
    add_with<Inverse, Smoothing>(
        name, published::depth_reference<S, Heights>(scene.pad.camera, scene.pad.fluid, free.red,
                                                     free.green, scene.free_mm, Before()));
  }

  template <class Smoothing>
  void add_fast(const std::string& name) const {
    add<Smoothing, ExponentialFree<2, 5>>(name + " + ExponentialFree<2, 5>");
    add<Smoothing, ExponentialFree<>>(name + " + ExponentialFree<>");
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
    using Default = BiasFreeMean;
    using published::Bisection;
    using published::BoxMean;
    using published::SingleHeight;
    add_quotient<BoxMean, BoxMean, Bisection, SingleHeight, double>(
        "published: BoxMean + Bisection in double");
    add_quotient<NoSmoothing, BoxMean, Bisection, SingleHeight, double>(
        "published, g of the raw reference");
    add<BoxMean, Bisection, double, SingleHeight>("published, radial g");
    add_fast<NoSmoothing>("NoSmoothing");
    add_fast<published::BoxMean>("published::BoxMean");
    add_fast<BiasFreeMean>("BiasFreeMean");
    add_fast<AnchoredMean>("AnchoredMean");
    add<Default, ExponentialFree<>, float, SingleHeight>("the default, SingleHeight");
    add_quotient<BoxMean, Default, ExponentialFree<>, AstigmaticHeights, float>(
        "the default, published::depth_reference");
    add<Default, ExponentialFree<>, double>("the default in double");
    add<Default, ExponentialFree<9, 12, 8>, double>(
        "BiasFreeMean + ExponentialFree<9, 12, 8> in double");
    add<Default, Newton, double>("BiasFreeMean + Newton in double");
    add<Default, Newton>("BiasFreeMean + Newton");
    bench::add_streaming(scene.name, scene.pixels());
    add_opencv();
  }
};

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  const Bench full{bench::full_pad()};
  const Bench round{bench::round_pad()};
  full.add_all();
  round.add_all();
  return bench::run(argc, argv);
}
