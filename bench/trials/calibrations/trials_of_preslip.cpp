// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Trial of the calibration of pre-slip. Whole lifts are drawn, because their samples are
// correlated.
#include <array>

#include "bench/trials/calibrations/trial_parts.hpp"
#include "fingerpad/calibrate/foam.hpp"

namespace trials {

/// Eight lifts by a trembling hand, with three marked slips each.
Trial preslip() {
  using Lift = std::vector<fingerpad::MarkedSample<>>;
  const auto finger = [](double x_mm, fingerpad::Index waves, fingerpad::Index taxel) {
    fingerpad::FingerSample<double> sample;
    sample.status = waves > 0 ? fingerpad::TaxelStatus::vibrating : fingerpad::TaxelStatus::quiet;
    sample.center_x_mm = x_mm;
    sample.center_y_mm = 10;
    if (waves > 0) {
      sample.add_vibration(taxel, waves);
    }
    return sample;
  };
  const auto measure = [=](Chance& chance) {
    std::vector<Lift> lifts(8);
    for (Lift& lift : lifts) {
      for (int k = 0; k < 60; ++k) {
        const bool slips = k % 20 >= 16;
        const double x = 20 + 0.15 * chance.normal() + (slips ? 0.6 : 0.0);
        const auto trembles = static_cast<fingerpad::Index>(chance.uniform() < 0.1 ? 2 : 0);
        const auto waves = slips ? static_cast<fingerpad::Index>(2 + chance.below(3)) : trembles;
        lift.push_back(
            {{finger(x, waves, static_cast<fingerpad::Index>(chance.below(9))), finger(20, 0, 0)},
             slips,
             k == 0});
      }
    }
    return lifts;
  };
  const auto fit = [](const std::vector<Lift>& lifts) {
    Lift all;
    for (const Lift& lift : lifts) {
      all.insert(all.end(), lift.begin(), lift.end());
    }
    const auto found = fingerpad::fit_preslip(all, {.history = 10});
    return Estimate{{static_cast<double>(found.options.min_waves),
                     found.options.centroid_tolerance_mm, found.recall()},
                    diagonal({none, none, none})};
  };
  return trial({"min_waves", "centroid_tolerance_mm", "recall"}, {none, none, none}, 6, measure,
               draw_samples, fit);
}

}  // namespace trials
