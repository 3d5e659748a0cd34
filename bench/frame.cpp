// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The whole step: a noisy 8-bit frame, BGR BGR ..., to depth in mm and a status per pixel. The
// error is the mean of |depth - truth| under the plate and around it, all of the pad that is seen.
#include <memory>

#include "fingerpad/depth.hpp"
#include "support/run.hpp"
#include "support/scene.hpp"

using namespace fingerpad;
using bench::Image;

namespace {

struct Bench {
  bench::Scene scene;
  bench::Interleaved<std::uint8_t> frame{scene.pressed_frame<std::uint8_t>()};

  template <class Smoothing, class Inverse, class S = float>
  void add(const std::string& name) const {
    const auto estimator =
        std::make_shared<DepthEstimator<Smoothing, Inverse, AstigmaticHeights, S>>(
            scene.pad.estimator<Smoothing, Inverse, S>());
    const auto depth = std::make_shared<Image<S>>(scene.pad.rows, scene.pad.cols);
    const auto status = std::make_shared<Image<PixelStatus>>(scene.pad.rows, scene.pad.cols);
    const auto workspace =
        std::make_shared<typename DepthEstimator<Smoothing, Inverse, AstigmaticHeights,
                                                 S>::template Workspace<std::uint8_t>>(
            estimator->template workspace<std::uint8_t>());
    bench::add(
        scene.name + "/" + name, scene.pixels(),
        [=, this] {
          benchmark::DoNotOptimize(
              (*estimator)(frame.red(), frame.green(), *depth, *status, *workspace));
        },
        [=, this](auto& counters) {
          const bench::MeanError error(*depth, scene.pressed_mm);
          counters["mean_error_mm"] = error.mm;
          counters["share_found"] = error.share;
        });
  }

  template <class Smoothing>
  void add_fast(const std::string& name) const {
    add<Smoothing, ExponentialFree<2, 5>>(name + " + ExponentialFree<2, 5>");
    add<Smoothing, ExponentialFree<>>(name + " + ExponentialFree<>");
  }

  void add_all() const {
    add<BoxMean, Bisection, double>("published: BoxMean + Bisection in double");
    add_fast<NoSmoothing>("NoSmoothing");
    add_fast<BoxMean>("BoxMean");
    add_fast<BiasFreeMean>("BiasFreeMean");
    add_fast<Anchored<BoxMean>>("Anchored<BoxMean>");
    add_fast<Anchored<BiasFreeMean>>("Anchored<BiasFreeMean>");
  }
};

}  // namespace

int main(int argc, char** argv) {
  const Bench full{bench::full_pad()};
  const Bench round{bench::round_pad()};
  full.add_all();
  round.add_all();
  return bench::run(argc, argv);
}
