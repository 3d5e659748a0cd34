// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The whole fingertip on frames of a pressed pad that are damaged, late, early or of another size:
// what a stage tells is finite, and after a reset a clean frame is as if nothing had been.
#include "fingerpad/pipeline/fingertip.hpp"

#include <cstdint>

#include "bench/report/chain/pressed_frames.hpp"
#include "fuzz/input.hpp"

using namespace fingerpad;
using fuzz::Input;
using fuzz::require;

namespace {

const chain::PressedFrames& frames() {
  static const chain::PressedFrames all(45, 60, 2, 9);
  return all;
}

auto touched(auto& fingertip,
             const chain::PressedFrame& frame,
             double pressure_mpa,
             double time_s) {
  return fuzz::frame([&] {
    return fingertip(frame.image.red, frame.image.green, frame.dots_px.view(), pressure_mpa,
                     time_s);
  });
}

chain::PressedFrame damaged(Input& in) {
  chain::PressedFrame frame = frames()[static_cast<std::size_t>(in.whole(0, 1))];
  for (Index k = in.whole(0, 8); k > 0; --k) {
    const Index row = in.whole(0, 44), from = in.whole(0, 59), to = in.whole(0, 59);
    const std::uint8_t level = in.byte();
    for (Index j = from; j < to; ++j) {
      frame.image.red(row, j) = level;
      frame.image.green(row, j) = in.is_empty() ? 0 : level;
    }
  }
  for (Index k = in.whole(0, 8); k > 0; --k) {
    frame.dots_px.view()(in.whole(0, 8), in.whole(0, 8)) = {in.number(-10, 70), in.number(-10, 55)};
  }
  return frame;
}

template <class Result>
void require_sound(const Result& touch) {
  require(!touch.wrench.ok() || is_finite(touch.wrench.force_n), "a force is finite");
  require(
      !touch.normal.has_force() || (is_finite(touch.normal.force_n) && touch.normal.force_n >= 0),
      "a normal force is finite and not negative");
  require(std::isnan(touch.slip.stick_ratio) ||
              (touch.slip.stick_ratio >= 0 && touch.slip.stick_ratio <= 1),
          "a ratio is in [0, 1], or NaN");
  require(!touch.contact.in_contact() || is_finite(touch.contact.center_mm),
          "a contact has a finite center");
}

void try_fingertip(Input& in) {
  static const auto options = frames().options();
  static const Fingertip start(options);
  static Fingertip tip = start;
  tip = start;  // into the memory that is there: to take it anew costs a third of an execution
  double time_s = in.number(0, 10);
  for (Index k = in.whole(1, 4); k > 0; --k) {
    require_sound(touched(tip, damaged(in), in.number(0, 0.05), time_s));
    time_s += in.number(-0.1, 0.2);
  }
  tip.reset();
  static const auto clean = [] {
    Fingertip fresh = start;
    return touched(fresh, frames()[0], chain::pressure_mpa, 0);
  }();
  const auto again = touched(tip, frames()[0], chain::pressure_mpa, 0);
  require(again.status == clean.status && again.stick.status == clean.stick.status &&
              again.slip.status == clean.slip.status &&
              fuzz::same_bits(again.contact.area_mm2, clean.contact.area_mm2) &&
              fuzz::same_bits(again.normal.force_n, clean.normal.force_n) &&
              fuzz::same_bits(again.wrench.force_n, clean.wrench.force_n) &&
              fuzz::same_bits(again.wrench.moment_n_mm, clean.wrench.moment_n_mm),
          "after a reset a clean frame is as if nothing had been");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, try_fingertip);
}
