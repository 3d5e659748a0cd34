// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Finds the least force that holds an object between two foam fingers (simulated). Its weight and
// the friction are unknown. The grip is loosened until pre-slip and then until the object slips, as
// in the paper, to count the steps from the warning to the slip.
#include <array>
#include <cstdio>

#include "bench/trials/grip/foam_fingers.hpp"
#include "fingerpad/foam/holding_force.hpp"
#include "fingerpad/pipeline/foam_hand.hpp"

int main() {
  const grip::FoamFingersSetup object;
  grip::FoamFingers hand(object, 1);

  const fingerpad::TaxelFeatures<> finger(object.rows, object.cols,
                                          {.pitch_mm = object.pitch_mm,
                                           .sample_period_s = 1 / object.rate_hz,
                                           .noise = object.noise_counts});
  // the rule of the paper's first experiment
  fingerpad::FoamHand<> foam({finger, finger}, {.rule = fingerpad::PreslipRule::grasp_optimise});
  fingerpad::LoosenUntilPreslip loosen({.first_force_n = object.first_force_n,
                                        .min_force_n = 0.1,
                                        .step_n = 0.2,
                                        .settle_samples = 4,
                                        .watch_samples = 36,
                                        .until_slipped = true});

  auto command = loosen.command();
  bool warned = false;
  while (!is_end(command.phase)) {
    hand.advance(command.force_n);
    const auto status = foam(std::array{hand.readings(0), hand.readings(1)}, hand.time_s());
    command = loosen(hand.has_slipped() ? fingerpad::PreslipStatus::slipped : status);
    if (!warned && command.preslip_force_n > 0) {
      warned = true;
      std::printf(
          "%5.2f s  %4.1f N  pre-slip: taxel %td of one finger and %td of the other, %td waves\n",
          hand.time_s(), command.preslip_force_n, foam.fingers()[0].location,
          foam.fingers()[1].location, foam.fingers()[0].waves);
    }
  }
  std::printf("%5.2f s  %4.1f N  %s, %td steps after the warning\n", hand.time_s(), hand.force_n(),
              name_of(command.phase), command.warning_steps);
  return command.phase == fingerpad::SearchPhase::slipped && command.warning_steps > 0 ? 0 : 1;
}
