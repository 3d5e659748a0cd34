// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// An object hangs between two foam fingers (simulated); its weight and the friction are unknown.
// The grip is loosened until pre-slip, and then on, as the paper does to check: how many steps
// before the object slips did the warning come?
#include <array>
#include <cstdio>

#include "fingerpad/foam/holding_force.hpp"
#include "fingerpad/foam/preslip.hpp"
#include "fingerpad/foam/taxel_features.hpp"
#include "grip/foam_fingers.hpp"

int main() {
  const grip::FoamFingersSetup object;
  grip::FoamFingers hand(object, 1);

  const fingerpad::TaxelFeatures features(
      object.rows, object.cols,
      fingerpad::TaxelOptions<>{.pitch_mm = object.pitch_mm,
                                .sample_period_s = 1 / object.rate_hz,
                                .noise = object.noise_counts});
  const fingerpad::Preslip<fingerpad::GraspOptimise> preslip;  // two fingers
  const fingerpad::LoosenUntilPreslip loosen({.first_force_n = object.first_force_n,
                                              .min_force_n = 0.1,
                                              .step_n = 0.2,
                                              .settle_samples = 4,
                                              .watch_samples = 36,
                                              .until_slipped = true});
  std::array fingers{features.start(), features.start()};
  auto history = preslip.start();
  auto search = loosen.start();

  auto command = search.command();
  bool warned = false;
  while (!is_end(command.phase)) {
    hand.advance(command.force_n);
    std::array<fingerpad::FingerSample<>, 2> samples;
    for (std::size_t f = 0; f < 2; ++f) {
      samples[f] = features(hand.readings(f), hand.time_s(), fingers[f]);
    }
    const bool alarm = preslip(samples, history).is_fresh;
    command = loosen(hand.has_slipped() ? fingerpad::PreslipStatus::slipped
                     : alarm            ? fingerpad::PreslipStatus::preslip
                                        : fingerpad::PreslipStatus::steady,
                     search);
    if (!warned && command.preslip_force_n > 0) {
      warned = true;
      std::printf(
          "%5.2f s  %4.1f N  pre-slip: taxel %td of one finger and %td of the other, %td waves\n",
          hand.time_s(), command.preslip_force_n, samples[0].location, samples[1].location,
          samples[0].waves);
    }
  }
  std::printf("%5.2f s  %4.1f N  %s, %td steps after the warning\n", hand.time_s(), hand.force_n(),
              name_of(command.phase), command.warning_steps);
  return command.phase == fingerpad::SearchPhase::slipped && command.warning_steps > 0 ? 0 : 1;
}
