// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/pipeline/foam_hand.hpp"

#include <array>

#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"

using namespace fingerpad;

TEST_CASE("foam hand: a sample allocates nothing", "[foam_hand]") {
  const TaxelFeatures<> finger(4, 3);
  FoamHand<> hand({finger, finger, finger}, {.rule = PreslipRule::grasp_optimise});
  test::Image<double> taxels(4, 3, 100);
  int preslips = 0;
  const long before = test::allocations();
  for (int k = 0; k < 100; ++k) {
    taxels(k > 50 ? 1 : 3, 2) = k > 30 && k % 4 < 2 ? 200 : 100;
    taxels(0, 1) = 100 + k;
    const auto view = as_view(taxels);
    const PreslipStatus status = hand(std::array{view, view, view}, k / 30.0);
    preslips += status == PreslipStatus::preslip ? 1 : 0;
  }
  hand.reset();
  CHECK(test::allocations() == before);
  CHECK(preslips > 0);
}
