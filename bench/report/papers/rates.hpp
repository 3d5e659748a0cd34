// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Frames per second of each method on one thread, in processor time, the best of several runs. The
// printed rates are those of whole programs on a PC of 2010; docs/results.md times the chain.
#include <ctime>
#include <string>
#include <vector>

#include "bench/support/scene_frames.hpp"
#include "fingerpad/published/contact_region.hpp"
#include "fingerpad/published/depth.hpp"
#include "shape.hpp"
#include "six_axis.hpp"
#include "slippage.hpp"
#include "table.hpp"

namespace bench::papers {

/// Processor time of this thread, s: another program on the core does not count.
inline double processor_s() {
  timespec t = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Frames per second; a call of `work` processes `frames` frames.
template <class Work>
double best_rate(const Work& work, double frames = 1) {
  double best_s = 1e9, all_s = 0;
  for (int k = 0; k < 3 || (all_s < 0.5 && k < 1000); ++k) {
    const double start = processor_s();
    work();
    const double s = processor_s() - start;
    best_s = s < best_s ? s : best_s;
    all_s += s;
  }
  return frames / best_s;
}
template <class Work>
std::string rate(const Work& work, double frames = 1) {
  const double hz = best_rate(work, frames);
  return hz > 1e4 ? std::to_string(static_cast<long>(hz / 1000)) + " kHz" : number(hz) + " Hz";
}

template <class Estimator>
std::string depth_rate(Estimator estimator, const test::Frame<std::uint8_t>& frame) {
  test::Image<float> depth(frame.red.rows(), frame.red.cols());
  return rate([&] { (void)estimator(frame.red, frame.green, depth); });
}

template <class Region>
std::string region_rate(Region region, const test::Image<float>& depth) {
  test::Image<std::uint8_t> mask(depth.rows(), depth.cols());
  return rate([&] { (void)region(depth, mask); });
}

inline std::string published_wrench_rate() {
  const test::WrenchFrame& f = test::wrench_frames()[1];
  const auto dots = test::rows_of(f.dots, 1);
  fingerpad::published::SegmentEquilibrium<> wrench(test::rim_border());
  return rate([&] { (void)wrench(test::exact_heights(f.heights), dots, f.pressure_mpa); });
}

inline std::string wrench_rate() {
  const test::RimScene& scene = test::rim_scenes().front();
  test::SeenRim seen(scene, test::SeenRim::options_of(scene, true), 0.06, 1);
  std::size_t k = 0;
  return rate([&] { (void)seen.fit(k = k % (scene.frames.size() - 1) + 1); });
}

template <class Ratio, class Time>
std::string of_stick_ratio(const Ratio& ratio, const Time& time) {
  const test::StickScene drag("drag");
  Ratio stick = ratio;
  return time(
      [&] {
        for (fingerpad::Index step = 0; step < drag.steps(); ++step) {
          (void)stick(drag.dots(step), drag.contact(step));
        }
      },
      static_cast<double>(drag.steps()));
}
template <class Ratio>
std::string stick_rate(const Ratio& ratio) {
  return of_stick_ratio(ratio, [](const auto& work, double frames) { return rate(work, frames); });
}

inline Section rates_section() {
  using namespace fingerpad;
  SceneFrames& frames = SceneFrames::instance();
  const test::Pad& pad = frames.pad();
  const SceneFrame& press = frames("press");
  const DepthEstimator<> depth(pad.camera, pad.fluid, test::Scene().reference(frames.free_mm()));
  test::Image<std::uint8_t> mask(pad.rows, pad.cols);
  const std::string nearest = "640 x 480 px, one thread of this machine";
  return {
      "Rates",
      {{"shape [S]", "frames a second", "about 1 Hz", depth_rate(published_depth(), press.frame),
        depth_rate(depth, press.frame), nearest},
       {"contact and location [C]", "frames a second", "about 2 Hz",
        rate([&] { (void)published::contact_by_slides(press.measured_mm, mask); }),
        region_rate(ContactRegion<>(pad.camera, pad.rows, pad.cols), press.measured_mm),
        "contact region, the same"},
       {"stick ratio [R]", "frames a second", "about 4 Hz", stick_rate(test::PublishedStick{}),
        stick_rate(StickRatio<>(21, 21)), "21 x 21 dots that are found"},
       {"six-axis force [M]", "frames a second", "1.0 Hz", published_wrench_rate(), wrench_rate(),
        "published: shape that is given, 72 side dots, 72 x 70 segments; fingerpad: 250 printed "
        "dots"},
       {"camera", "frames a second", "30 Hz", "", "", ""}}};
}

}  // namespace bench::papers
