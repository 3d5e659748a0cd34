// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Errors of contact areas on finite-element membranes, from the depths that the default estimator
// measures in noisy frames. The true area is that of the finite elements (tests/data/contacts.csv).
// A method without a threshold of its own uses half of the free pad's curvature.
#include <string>
#include <utility>
#include <vector>

#include "bench/support/run.hpp"
#include "bench/support/scene_frames.hpp"
#include "support/contact_records.hpp"

namespace bench {

template <class Region, class Test>
void note_area_on_scenes(Counters& counters, const Test& test) {
  SceneFrames& frames = SceneFrames::instance();
  const test::Pad& pad = frames.pad();
  Region region(pad.camera, pad.rows, pad.cols, test);
  test::Image<std::uint8_t> mask(pad.rows, pad.cols);
  std::vector<double> errors;
  for (const auto& [name, step] :
       {std::pair{"press", 20}, {"tilt", 16}, {"cylinder", 10}, {"roll", 18}}) {
    for (const test::ContactRecord& r : test::contact_records({name})) {
      for (std::uint64_t seed = 1; seed <= 3 && r.step == step; ++seed) {
        const auto found = region(frames(name, seed).measured_mm, mask);
        errors.push_back(found.area_mm2 / r.area_mm2 - 1);
      }
    }
  }
  note_errors(counters, "area on scenes", "share", errors);
}

}  // namespace bench
