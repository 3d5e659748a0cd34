// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The rules of a foam hand.
#include "fingerpad/pipeline/foam_hand.hpp"

#include <array>
#include <vector>

using namespace fingerpad;
using Readings = StridedView<const float>;

struct NoRules : FoamHandMethods {
  static constexpr bool has_grasp_lift = false;
};

/// The features alone, written by hand.
struct ByHand {
  std::vector<TaxelFeatures<>> features;
  std::vector<TaxelFeatures<>::State> windows;

  template <grid Grid>
  FoamHandResult<1> operator()(const std::array<Grid, 1>& readings, double time_s) {
    FoamHandResult<1> felt;
    for (std::size_t f = 0; f < 1; ++f) {
      felt.fingers[f] = features[f](readings[f], time_s, windows[f]);
    }
    return felt;
  }
};

// flatten: so that called functions are counted, too.
extern "C" __attribute__((flatten)) void switched_off(FoamHand<1, NoRules>& hand,
                                                      const std::array<Readings, 1>& readings,
                                                      double time_s,
                                                      FoamHandResult<1>& felt) {
  felt = hand(readings, time_s);
}

extern "C" __attribute__((flatten)) void without_effect(ByHand& hand,
                                                        const std::array<Readings, 1>& readings,
                                                        double time_s,
                                                        FoamHandResult<1>& felt) {
  felt = hand(readings, time_s);
}
