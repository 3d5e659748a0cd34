// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Foam fingers: how many steps before the slip a loosening grip is warned, and how often a steady
// grip without slip raises a false alarm. A warning counts only together with the false alarms,
// because a rule that always alarms warns before every slip.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "bench/trials/grip/foam_fingers.hpp"
#include "fingerpad/pipeline/foam_hand.hpp"
#include "table.hpp"

namespace bench::papers {

struct Warnings {
  int runs = 0, warned = 0, at_once = 0;  ///< at_once: within the first step, at full grip
  int fewest = 1000, most = 0;            ///< steps of warning
  double false_per_minute = 0;            ///< with a steady grip

  std::string steps() const {
    return std::to_string(fewest) + " to " + std::to_string(most) + " steps, in " +
           std::to_string(warned) + " of " + std::to_string(runs) + " runs";
  }
  std::string alarms() const {
    return number(false_per_minute) + " a minute; " + std::to_string(at_once) + " of " +
           std::to_string(runs) + " runs warned in the first step";
  }
};

/// Processing of both fingers from readings to an alarm.
class Watch {
 public:
  Watch(const fingerpad::PreslipOptions& rule, const grip::FoamFingersSetup& object)
      : finger_(object.rows,
                object.cols,
                {.pitch_mm = object.pitch_mm,
                 .sample_period_s = 1 / object.rate_hz,
                 .noise = object.noise_counts}),
        foam_({finger_, finger_}, rule) {}

  bool alarms(const grip::FoamFingers& hand) {
    return foam_(std::array{hand.readings(0), hand.readings(1)}, hand.time_s()) ==
           fingerpad::PreslipStatus::preslip;
  }

 private:
  fingerpad::TaxelFeatures<> finger_;
  fingerpad::FoamHand<> foam_;
};

inline grip::FoamFingersSetup object_of(unsigned seed) {
  grip::FoamFingersSetup object;
  object.friction.factor = 0.25 + 0.05 * (seed % 4);
  object.weight_n = 2.5 + 0.7 * (seed % 3);
  return object;
}

inline Warnings warnings_of(const fingerpad::PreslipOptions& rule) {
  using namespace fingerpad;
  Warnings w;
  constexpr double held_s = 20;
  for (unsigned seed = 0; seed < 10; ++seed) {
    const grip::FoamFingersSetup object = object_of(seed);
    grip::FoamFingers hand(object, seed);
    Watch watch(rule, object);
    constexpr double step_n = 0.2;
    constexpr int samples_a_step = 40;
    int step = 0, warned_at = -1;
    while (!hand.has_slipped() && step * step_n < object.first_force_n) {
      for (int k = 0; k < samples_a_step && !hand.has_slipped(); ++k) {
        hand.advance(object.first_force_n - step * step_n);
        warned_at = watch.alarms(hand) && warned_at < 0 ? step : warned_at;
      }
      ++step;
    }
    ++w.runs;
    if (warned_at >= 0) {
      const int steps = step - 1 - warned_at;  // until the step in which the object falls
      ++w.warned;
      w.at_once += warned_at == 0 ? 1 : 0;
      w.fewest = (std::min)(w.fewest, steps);
      w.most = (std::max)(w.most, steps);
    }
    grip::FoamFingers still(object, seed + 100);
    Watch idle(rule, object);
    for (int k = 0; k < held_s * object.rate_hz; ++k) {
      still.advance(object.first_force_n);
      w.false_per_minute += idle.alarms(still) ? 6 / held_s : 0;  // 10 runs
    }
  }
  return w;
}

inline Section preslip_section() {
  using namespace fingerpad;
  const auto old_optimise =
      warnings_of({.rule = PreslipRule::printed_grasp_optimise, .min_waves = 0});
  const auto optimise = warnings_of({.rule = PreslipRule::grasp_optimise});
  const auto lift = warnings_of({.rule = PreslipRule::grasp_lift});
  const std::string nearest =
      "object between simulated foam fingers, loosened by 0.2 N a step until it falls";
  const std::string held = "the same objects held for 20 s by a grip that does not change";
  return {"Pre-slip of foam fingers [P]",
          {{"grasp, optimise, replace, ten trials", "steps from the warning to the slip",
            "3 to 6, in 10 of 10", old_optimise.steps(), optimise.steps(), nearest},
           {"", "false alarms", "not said", old_optimise.alarms(), optimise.alarms(), held},
           {"grasp, lift, replace, ten trials", "steps from the warning to the slip",
            "3 to 6, in 10 of 10", lift.steps(), lift.steps(),
            nearest + "; whole lifts: docs/foam/preslip.md"},
           {"", "false alarms", "not said", lift.alarms(), lift.alarms(), held}}};
}

}  // namespace bench::papers
