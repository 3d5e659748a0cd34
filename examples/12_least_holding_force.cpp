// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Finds the least force that holds an object between two foam fingers (simulated). Its weight and
// the friction are unknown. The grip is loosened until pre-slip and then until the object slips, as
// in the paper, to count the steps from the warning to the slip.
#include <array>
#include <cstdio>

#include "fingerpad/foam/holding_force.hpp"
#include "fingerpad/pipeline/foam_hand.hpp"
#include "grip/foam_fingers.hpp"

/// The rule of the paper's first experiment.
struct WhileLoosening : fingerpad::FoamHandMethods {
  static constexpr bool has_grasp_lift = false, has_grasp_optimise = true;
};

int main() {
  const grip::FoamFingersSetup object;
  grip::FoamFingers hand(object, 1);

  fingerpad::FoamHandOptions<2> options;
  options.arrays.fill({object.rows, object.cols});
  options.taxels.pitch_mm = object.pitch_mm;
  options.taxels.sample_period_s = 1 / object.rate_hz;
  options.taxels.noise = object.noise_counts;
  fingerpad::FoamHand<2, WhileLoosening> foam(options);
  const fingerpad::LoosenUntilPreslip loosen({.first_force_n = object.first_force_n,
                                              .min_force_n = 0.1,
                                              .step_n = 0.2,
                                              .settle_samples = 4,
                                              .watch_samples = 36,
                                              .until_slipped = true});
  auto search = loosen.start();

  auto command = search.command();
  bool warned = false;
  while (!is_end(command.phase)) {
    hand.advance(command.force_n);
    const auto felt = foam(std::array{hand.readings(0), hand.readings(1)}, hand.time_s());
    command = loosen(hand.has_slipped() ? fingerpad::PreslipStatus::slipped : felt.status, search);
    if (!warned && command.preslip_force_n > 0) {
      warned = true;
      std::printf(
          "%5.2f s  %4.1f N  pre-slip: taxel %td of one finger and %td of the other, %td waves\n",
          hand.time_s(), command.preslip_force_n, felt.fingers[0].location,
          felt.fingers[1].location, felt.fingers[0].waves);
    }
  }
  std::printf("%5.2f s  %4.1f N  %s, %td steps after the warning\n", hand.time_s(), hand.force_n(),
              name_of(command.phase), command.warning_steps);
  return command.phase == fingerpad::SearchPhase::slipped && command.warning_steps > 0 ? 0 : 1;
}
