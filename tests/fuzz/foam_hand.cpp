// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Foam fingers with any readings and any clock: what is told is finite, and a reset is a start.
#include "fingerpad/pipeline/foam_hand.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "fuzz/input.hpp"

using namespace fingerpad;
using fuzz::Grid;
using fuzz::Input;
using fuzz::require;

namespace {

PreslipOptions any_rule(Input& in) {
  PreslipOptions options;
  options.rule = static_cast<PreslipRule>(in.whole(0, 2));
  options.history = in.whole(0, 60);
  options.centroid_tolerance_mm = in.number(0, 1);
  return options;
}

void require_finite(const FingerSample<double>& finger) {
  require(finger.waves >= 0 && finger.frequency_hz >= 0, "waves and frequency are not negative");
  require(is_finite(finger.deviation) && is_finite(finger.frequency_hz),
          "deviation and frequency are finite");
}

void try_hand(Input& in) {
  const Index rows = in.whole(0, 6), cols = in.whole(0, 6);
  TaxelOptions taxels;
  taxels.window = in.whole(0, 40);
  taxels.pitch_mm = in.number(0.5, 10);
  taxels.noise = in.number(0, 10);
  taxels.sample_period_s = in.number(0.001, 0.1);
  const TaxelFeatures<> finger(rows, cols, taxels);
  FoamHand<> hand({finger, finger}, any_rule(in));

  double time_s = in.number(0, 10);
  for (Index samples = in.whole(1, 120); samples > 0; --samples) {
    const Grid<double> left(in, rows, cols, 0, 1000), right(in, rows, cols, 0, 1000);
    (void)fuzz::frame([&] { return hand(std::array{left.view(), right.view()}, time_s); });
    require_finite(hand.fingers()[0]);
    require_finite(hand.fingers()[1]);
    time_s += in.is_empty() ? 0.03 : in.number(0, 0.1);
  }
  hand.reset();
  const Grid<double> still(rows, cols);
  const auto status = fuzz::frame([&] {
    return hand(std::array{still.view(), still.view()}, 0.0);
  });
  require(status == PreslipStatus::cannot_tell, "after a reset the status is cannot_tell");
}

void try_preslip(Input& in) {
  const PreslipOptions options = any_rule(in);
  Preslip<> rule(2, options);
  std::vector<std::array<FingerSample<double>, 2>> history;
  for (Index samples = in.whole(1, 60); samples > 0; --samples) {
    std::array<FingerSample<double>, 2> fingers;
    for (auto& finger : fingers) {
      finger.status = static_cast<TaxelStatus>(in.whole(0, 2));
      finger.center_x_mm = in.number(-10, 10);
      finger.center_y_mm = in.number(-10, 10);
      for (Index k = in.whole(0, 20); k > 0; --k) {
        finger.add_vibration(in.whole(0, 60), in.whole(0, 20));
      }
    }
    const auto status = fuzz::frame([&] { return rule(fingers); });
    const auto kept = static_cast<std::ptrdiff_t>(options.history) - 1;
    const auto oldest = history.end() - (std::min)(kept, std::ssize(history));
    const bool pairs = std::any_of(oldest, history.end(), [&](const auto& older) {
      return is_preslip(older, fingers, options);
    });
    require((status == PreslipStatus::preslip) == pairs,
            "a sample is pre-slip if it makes a pair with one that is kept");
    history.push_back(fingers);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size,
                   [](Input& in) { return in.flag() ? try_hand(in) : try_preslip(in); });
}
