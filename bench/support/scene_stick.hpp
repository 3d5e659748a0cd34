// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Errors of stick ratios on finite-element membranes that are dragged, rotated and pressed, in
// frames with an answer. "on scenes": against the share of the area that slipped less than the
// method's own threshold since its reference, which is the quantity it estimates. "by 5 um a step":
// against the nodes that slipped less than 5 um in the step, whatever the threshold.
#include <cstdint>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/stick_scene.hpp"

namespace bench {

/// `slip_share`: delta_0 / U of the ratio.
template <class Ratio>
void note_stick_on_scenes(Counters& counters,
                          const Ratio& ratio,
                          double noise_px,
                          double slip_share) {
  constexpr double mm_per_px = 0.092;  // of membrane, 10 mm from the plate
  std::vector<double> since_reference, in_step;
  for (const std::string name : {"drag", "twist", "mix", "cylinder"}) {
    const test::StickScene scene(name);
    const test::SlippedLess slipped(name, scene.steps());
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      test::Random random(seed);
      Ratio stick = ratio;
      for (fingerpad::Index k = 0; k < scene.steps(); ++k) {
        const auto seen = noisy(scene.dots(k), noise_px, random);
        const auto r = stick(seen, scene.contact(k));
        if (!r.updated()) {
          continue;
        }
        const double found = static_cast<double>(r.stick_ratio);
        const double length_mm = mm_per_px * slip_share * static_cast<double>(r.furthest);
        const double truth = slipped(k, r.reference_age, length_mm);
        since_reference.push_back(found - truth);  // NaN where the truth is not known
        in_step.push_back(found - scene.stick_ratio(k));
      }
    }
  }
  note_errors(counters, "stick ratio on scenes", "of 1", since_reference);
  note_errors(counters, "stick ratio by 5 um a step", "of 1", in_step);
}

}  // namespace bench
