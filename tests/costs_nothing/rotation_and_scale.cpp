// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The object's turn and zoom in the stick ratio.
#include "fingerpad/slip/stick_ratio.hpp"

using namespace fingerpad;
using Shift = detail::stick::ObjectShift<float>;
using Sums = detail::stick::PairSums<float>;

extern "C" void switched_off(const Sums& sums, const Shift& about, Shift& best) {
  best = detail::stick::fit<Freedom::translation>(sums, about);
}

extern "C" void without_effect(const Sums& sums, const Shift& about, Shift& best) {
  const float weight = sums.weight;
  Shift mean = about;
  mean.now_x = about.now_x + sums.now_x / weight;
  mean.now_y = about.now_y + sums.now_y / weight;
  mean.then_x = about.then_x + sums.then_x / weight;
  mean.then_y = about.then_y + sums.then_y / weight;
  best = mean;
}
