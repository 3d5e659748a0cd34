// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Foam fingers with any readings and any clock: what is told is finite, and a reset is a start.
#include "fingerpad/pipeline/foam_hand.hpp"

#include <array>
#include <cstdint>

#include "fuzz/input.hpp"

using namespace fingerpad;
using fuzz::Grid;
using fuzz::Input;
using fuzz::require;

namespace {

struct BothRules : FoamHandMethods {
  static constexpr bool has_grasp_optimise = true;
};
using Hand = FoamHand<2, BothRules>;

void require_finite(const FingerSample<double>& finger) {
  require(finger.waves >= 0 && finger.frequency_hz >= 0, "waves and frequency are not negative");
  require(is_finite(finger.deviation) && is_finite(finger.frequency_hz),
          "deviation and frequency are finite");
}

void try_hand(Input& in) {
  const Index rows = in.whole(0, 6), cols = in.whole(0, 6);
  FoamHandOptions<2> options;
  options.arrays.fill({rows, cols});
  options.taxels.window = in.whole(0, 40);
  options.taxels.pitch_mm = in.number(0.5, 10);
  options.taxels.noise = in.number(0, 10);
  options.taxels.sample_period_s = in.number(0.001, 0.1);
  options.rules.history = in.whole(0, 60);
  options.rules.centroid_tolerance_mm = in.number(0, 1);
  Hand hand(options);

  double time_s = in.number(0, 10);
  for (Index samples = in.whole(1, 120); samples > 0; --samples) {
    const Grid<double> left(in, rows, cols, 0, 1000), right(in, rows, cols, 0, 1000);
    const auto felt = fuzz::frame([&] {
      return hand(std::array{left.view(), right.view()}, time_s);
    });
    require_finite(felt.fingers[0]);
    require_finite(felt.fingers[1]);
    time_s += in.is_empty() ? 0.03 : in.number(0, 0.1);
  }
  hand.reset();
  const Grid<double> still(rows, cols);
  const auto felt = fuzz::frame([&] { return hand(std::array{still.view(), still.view()}, 0.0); });
  require(felt.status == PreslipStatus::cannot_tell, "after a reset the status is cannot_tell");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, try_hand);
}
