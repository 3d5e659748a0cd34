// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Six axes from some 250 dots near the rim; "ns/pixel" is per frame. Errors over finite-element
// membranes (tests/data/rim_marks.txt), relative to the largest of the scene, with noise of each
// dot's pixel.
#include "fingerpad/force/wrench.hpp"

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "support/rim_marks.hpp"

using namespace fingerpad;

namespace {

void note(bench::Counters& counters, bool loose_rim, double noise_px) {
  std::vector<double> along, normal, tilting, turning;
  for (const test::RimScene& s : test::rim_scenes()) {
    const auto largest = s.largest();
    test::SeenRim rim(s, test::SeenRim::options_of(s, loose_rim), noise_px, 5);
    for (std::size_t k = 1; k < s.frames.size(); ++k) {
      const auto r = rim.fit(k);
      const auto& truth = s.frames[k].load;
      const auto add = [&](std::vector<double>& to, double error, double full, double least) {
        if (full > least) {
          to.push_back(r.ok() ? error / full : std::nan(""));
        }
      };
      add(along, std::hypot(r.force_n.x - truth[0], r.force_n.y - truth[1]), largest[0], 0.1);
      add(normal, r.force_n.z - truth[2], largest[1], 0.1);
      add(tilting, std::hypot(r.moment_n_mm.x - truth[3], r.moment_n_mm.y - truth[4]), largest[2],
          4);
      add(turning, r.moment_n_mm.z - truth[5], largest[3], 4);
    }
  }
  bench::note_errors(counters, "F_xy on scenes", "of the largest", along);
  bench::note_errors(counters, "F_z on scenes", "of the largest", normal);
  bench::note_errors(counters, "M_xy on scenes", "of the largest", tilting);
  bench::note_errors(counters, "M_z on scenes", "of the largest", turning);
}

void add_frame(const std::string& name, bool loose_rim) {
  const test::RimScene& scene = test::rim_scenes().front();
  const bench::Memory memory;
  const auto rim =
      std::make_shared<test::SeenRim>(scene, test::SeenRim::options_of(scene, loose_rim), 0.06, 5);
  bench::add(
      "frame of 250 dots/" + name, 1, memory.bytes(),
      [rim, &scene, k = std::size_t{0}]() mutable {
        k = k % (scene.frames.size() - 1) + 1;  // each frame is far from the last one
        benchmark::DoNotOptimize(rim->fit(k));
      },
      [loose_rim](auto& counters) { note(counters, loose_rim, 0.06); });
}

}  // namespace

int main(int argc, char** argv) {
  add_frame("loose rim, the default", true);
  add_frame("clamped rim", false);
  bench::add_streaming("frame of 250 dots");
  return bench::run(argc, argv);
}
