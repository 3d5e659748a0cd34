// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/foam/preslip.hpp"

#include <array>

#include "fingerpad/foam/holding_force.hpp"
#include "fingerpad/published/preslip.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;

namespace {

template <class S, std::size_t Fingers>
std::array<FingerSample<S>, Fingers> hand(int k) {
  std::array<FingerSample<S>, Fingers> now;
  for (std::size_t f = 0; f < Fingers; ++f) {
    const int seed = k + static_cast<int>(f);
    now[f].status = TaxelStatus::vibrating;
    now[f].location = seed % 7 - 1;
    now[f].waves = seed % 11 % 5;
    now[f].center_x_mm = S(seed % 3) / S(4);
    now[f].center_y_mm = seed % 13 == 0 ? not_a_number<S>() : S(seed % 5) / S(4);
  }
  return now;
}

}  // namespace

TEMPLATE_TEST_CASE("pre-slip: a sample allocates nothing",
                   "[preslip]",
                   (Preslip<GraspOptimise, 3, float>),
                   (Preslip<>),
                   (Preslip<GraspLift, 2, test::Dual<double>>),
                   (published::StackScan<GraspLift>)) {
  const auto run = []<template <class, std::size_t, class> class Search, class Rule,
                      std::size_t Fingers, class S>(const Search<Rule, Fingers, S>& preslip) {
    const long before_state = test::allocations();
    auto state = preslip.start();
    CHECK(test::allocations() > before_state);
    const auto copied = state;
    int alarms = 0;
    const auto last = hand<S, Fingers>(0);
    const long before = test::allocations();
    for (int k = 0; k < 300; ++k) {
      if (k == 200) {
        state.reset();
      }
      const auto now = hand<S, Fingers>(k * k);
      alarms += preslip(now, state).alarm ? 1 : 0;
      alarms += is_preslip<Rule>(last, now, preslip.options()) ? 1 : 0;
    }
    state = copied;  // of the same size: the memory exists
    CHECK(test::allocations() == before);
    CHECK(alarms > 0);
  };
  run(TestType({.history = 40}));
}

TEST_CASE("searches for the holding force: nothing is allocated", "[holding_force]") {
  const LoosenUntilPreslip<double> loosen;
  const LiftWithRegrip<double> lift;
  const long before = test::allocations();
  auto loosening = loosen.start();
  auto lifting = lift.start();
  for (int k = 0; k < 300; ++k) {
    const auto signal = k % 40 == 39 ? PreslipStatus::preslip : PreslipStatus::steady;
    (void)loosen(k > 200 ? signal : PreslipStatus::steady, loosening);
    (void)lift(signal, lifting);
  }
  CHECK(test::allocations() == before);
  CHECK(loosening.command().phase == SearchPhase::found);
  CHECK(lifting.command().steps > 0);
}
