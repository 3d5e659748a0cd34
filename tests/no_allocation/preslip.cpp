// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/foam/preslip.hpp"

#include <array>

#include "fingerpad/foam/holding_force.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;

namespace {

template <class S>
std::array<FingerSample<S>, 2> hand(int k) {
  std::array<FingerSample<S>, 2> now;
  for (int f = 0; f < 2; ++f) {
    FingerSample<S>& finger = now[static_cast<std::size_t>(f)];
    const int seed = k + f;
    finger.status = TaxelStatus::vibrating;
    finger.add_vibration(seed % 7, seed % 11 % 5);
    finger.center_x_mm = S(seed % 3) / S(4);
    finger.center_y_mm = seed % 13 == 0 ? not_a_number<S>() : S(seed % 5) / S(4);
  }
  return now;
}

}  // namespace

TEMPLATE_TEST_CASE(
    "pre-slip: a sample allocates nothing", "[preslip]", float, double, test::Dual<double>) {
  for (const PreslipRule rule :
       {PreslipRule::grasp_lift, PreslipRule::grasp_optimise, PreslipRule::printed_grasp_lift,
        PreslipRule::printed_grasp_optimise}) {
    const long at_start = test::allocations();
    Preslip<TestType> preslip(2, {.rule = rule, .history = 40});
    CHECK(test::allocations() > at_start);
    const auto copied = preslip;
    int alarms = 0;
    const long before = test::allocations();
    for (int k = 0; k < 300; ++k) {
      if (k == 200) {
        preslip.reset();
      }
      const auto now = hand<TestType>(k * k);
      alarms += preslip(now) == PreslipStatus::preslip ? 1 : 0;
    }
    preslip = copied;  // of the same size: the memory exists
    CHECK(test::allocations() == before);
    CHECK(alarms > 0);
  }
}

TEST_CASE("searches for the holding force: nothing is allocated", "[holding_force]") {
  const long before = test::allocations();
  LoosenUntilPreslip<> loosen;
  LiftWithRegrip<> lift;
  for (int k = 0; k < 300; ++k) {
    const auto signal = k % 40 == 39 ? PreslipStatus::preslip : PreslipStatus::steady;
    (void)loosen(k > 200 ? signal : PreslipStatus::steady);
    (void)lift(signal);
  }
  CHECK(test::allocations() == before);
  CHECK(loosen.command().phase == SearchPhase::found);
  CHECK(lift.command().steps > 0);
}
