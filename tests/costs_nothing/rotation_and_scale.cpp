// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The object's rotation and scale in the stick ratio.
#include "fingerpad/slip/stick_ratio.hpp"

using namespace fingerpad;
using Map = detail::stick::Similarity<float>;
using Sums = detail::stick::PairSums<float>;

extern "C" void switched_off(const Sums& sums, const Map& about, Map& best) {
  best = detail::stick::fit<Freedom::translation>(sums, about);
}

extern "C" void without_effect(const Sums& sums, const Map& about, Map& best) {
  Map mean = about;
  mean.now_at = about.now_at + sums.now / sums.weight;
  mean.then_at = about.then_at + sums.then / sums.weight;
  best = mean;
}
