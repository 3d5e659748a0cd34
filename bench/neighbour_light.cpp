// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Removal of the neighbouring membrane's light from a depth map, for small to large discs. The
// error is the largest against every pixel of the exact disc, summed in double.
#include "fingerpad/neighbour_light.hpp"

#include <memory>

#include "support/run.hpp"
#include "support/scene.hpp"

using namespace fingerpad;
using bench::Image;

namespace {

/// A depth map as a frame gives it: round and smooth, NaN outside the pad.
Image<float> smooth_depths(const Image<double>& depth_mm) {
  Image<float> out(depth_mm.rows(), depth_mm.cols());
  std::copy(depth_mm.cells.begin(), depth_mm.cells.end(), out.cells.begin());
  return out;
}

struct Bench {
  bench::Scene scene = bench::round_pad();
  Image<float> free = smooth_depths(scene.free_mm);
  Image<float> pressed = smooth_depths(scene.pressed_mm);

  template <class Disc, class S>
  Image<S> compensated(Index radius_px) const {
    const NeighbourLightCompensation<Disc, S> compensate({.radius_px = radius_px}, pitch<S>(),
                                                         free);
    auto workspace = compensate.workspace();
    Image<S> out(scene.pad.rows, scene.pad.cols);
    compensate(pressed, out, workspace);
    return out;
  }

  template <class S>
  S pitch() const {
    return S(scene.pad.camera.pitch_mm * 1.1);
  }

  template <class Disc, class S>
  void add(Index radius_px, const std::string& name) const {
    using Compensation = NeighbourLightCompensation<Disc, S>;
    const auto compensate =
        std::make_shared<Compensation>(NeighbourLight<S>{.radius_px = radius_px}, pitch<S>(), free);
    const auto workspace =
        std::make_shared<typename Compensation::Workspace>(compensate->workspace());
    const auto out = std::make_shared<Image<S>>(scene.pad.rows, scene.pad.cols);
    bench::add(
        "radius " + std::to_string(radius_px) + " px/" + name, scene.pixels(),
        [=, this] { (*compensate)(pressed, *out, *workspace); },
        [=, this](auto& counters) {
          counters["max_error_mm"] =
              test::largest_error(*out, compensated<ExactDisc, double>(radius_px));
        });
  }
};

}  // namespace

int main(int argc, char** argv) {
  const Bench b;
  for (const Index radius_px : {5, 15, 30, 50}) {
    b.add<ExactDisc, double>(radius_px, "ExactDisc, double");
    b.add<ExactDisc, float>(radius_px, "ExactDisc, float");
    b.add<SteppedDisc<>, float>(radius_px, "SteppedDisc<5>, float, the default");
    b.add<SteppedDisc<3>, float>(radius_px, "SteppedDisc<3>, float");
  }
  return bench::run(argc, argv);
}
