// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Calibrations: time of a fit ("ns/pixel" is per fit).
// "reference of a free pad": 480 x 640 pixels. Error: of the depth under a flat plate from exact
// colours, with the reference of a free frame with one grey level of noise; it is therefore the
// error of the reference alone.
#include <memory>
#include <string>

#include "bench/support/run.hpp"
#include "bench/support/scene.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#include "fingerpad/published/depth.hpp"
#include "support/pad.hpp"

using namespace fingerpad;

namespace {

/// An estimator without smoothing from what a fit returns.
DepthEstimator<double> estimator_of(const bench::Scene& scene, const DepthReference<double>& of) {
  return {scene.pad.camera, scene.pad.fluid, of, {.window_px = 1}};
}
published::DepthEstimator<> estimator_of(const bench::Scene&,
                                         const published::DepthEstimator<>& of) {
  return of;
}

/// `fit(scene, free frame)` returns a reference, or the published estimator, which holds its own.
template <class Fit>
void add_reference(const std::string& name, const bench::Scene& of, const Fit& fit) {
  const auto scene = std::make_shared<bench::Scene>(of);
  const auto free =
      std::make_shared<test::Frame<double>>(scene->pad.frame<double>(scene->free_mm, scene->noise));
  const bench::Memory memory;
  const auto reference = fit(*scene, *free);
  bench::add(
      "reference of a free pad/" + name, 1, memory.bytes(),
      [=] { benchmark::DoNotOptimize(fit(*scene, *free)); },
      [=](auto& counters) {
        auto estimate = estimator_of(*scene, reference);
        const auto seen = scene->pad.frame<double>(scene->pressed_mm);
        test::Image<double> depth_mm(scene->pad.rows, scene->pad.cols);
        (void)estimate(seen.red, seen.green, depth_mm);
        bench::note_errors(counters, "depth", "mm", bench::errors_of(depth_mm, scene->pressed_mm));
      });
}

void add_references() {
  const auto published = [](int window_px) {
    return [=](const bench::Scene& s, const test::Frame<double>& free) {
      return published::DepthEstimator<>(s.pad.published(window_px), free.red, free.green,
                                         s.free_mm);
    };
  };
  bench::Scene one_height = bench::round_pad();
  one_height.pad.one_height = true;
  add_reference("published: quotients of a smoothed frame", one_height, published(29));
  add_reference("quotients of a frame as it is", one_height, published(1));
  add_reference("fit_reference", bench::round_pad(),
                [](const bench::Scene& s, const test::Frame<double>& free) {
                  return fit_reference<double>(s.pad.camera, s.pad.fluid, free.red, free.green,
                                               s.free_mm);
                });
}

}  // namespace

int main(int argc, char** argv) {
  add_references();
  return bench::run(argc, argv);
}
