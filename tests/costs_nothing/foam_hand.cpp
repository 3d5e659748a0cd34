// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The rules of a foam hand.
#include "fingerpad/pipeline/foam_hand.hpp"

#include <array>
#include <utility>
#include <vector>

using namespace fingerpad;
using Readings = StridedView<const float>;

struct NoRules : FoamHandMethods {
  static constexpr bool has_grasp_lift = false;
};

extern "C" void switched_off(FoamHand<1, NoRules>& hand,
                             const std::array<Readings, 1>& readings,
                             double time_s,
                             FoamHandResult<1>& felt) {
  felt = hand(readings, time_s);
}

extern "C" void without_effect(
    std::pair<std::vector<TaxelFeatures<>>, std::vector<TaxelFeatures<>::State>>& hand,
    const std::array<Readings, 1>& readings,
    double time_s,
    FoamHandResult<1>& to) {
  FoamHandResult<1> felt;
  for (std::size_t f = 0; f < 1; ++f) {
    felt.fingers[f] = hand.first[f](readings[f], time_s, hand.second[f]);
  }
  to = felt;
}
