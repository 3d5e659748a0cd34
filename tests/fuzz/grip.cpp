// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Grip control, friction limit and the searches for the holding force, told anything at any time: a
// command is finite and within its limits, less sticking never gives less force, and what has ended
// stays as it is.
#include <cstdint>

#include "fingerpad/foam/holding_force.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/grip_control.hpp"
#include "fuzz/input.hpp"

using namespace fingerpad;
using fuzz::Input;
using fuzz::require;

namespace {

GripOptions<double> any_options(Input& in) {
  GripOptions<double> options;
  options.set_point = in.number(0.1, 0.9);
  options.raise_gain_n_per_s = in.number(1, 100);
  options.rise_limit_n_per_s = in.number(1, 50);
  options.fall_limit_n_per_s = in.number(0, 5);
  options.min_force_n = in.number(0, 2);
  options.max_force_n = in.number(5, 30);
  options.safe_force_n = in.number(2, 10);
  options.response_s = in.number(0, 1);
  return options;
}

void try_grip(Input& in) {
  const GripOptions<double> options = any_options(in);
  GripControl<double> control(options, in.number(0, 20));
  FrictionLimit<double> limit({.slide_fraction = in.number(0.5, 1)});
  const auto is_within = [&](double force_n) {
    return is_finite(force_n) && force_n >= options.min_force_n && force_n <= options.max_force_n;
  };
  for (Index calls = in.whole(1, 60); calls > 0; --calls) {
    const ContactLoad<double> load{in.number(0, 10), in.number(0, 10), in.number(-20, 20)};
    const auto update = static_cast<RatioUpdate>(in.whole(0, 3));
    const double ratio = in.number(0, 1), step_s = in.number(0, 0.2);
    const auto slip = fuzz::frame([&] { return limit(load, ratio, update); });
    require(std::isnan(slip.stick_ratio) || (slip.stick_ratio >= 0 && slip.stick_ratio <= 1),
            "a ratio is in [0, 1], or NaN");
    if (in.flag()) {
      control.follow(in.number(0, 30));
    }
    auto less = control, by_slip = control;
    const auto held = fuzz::frame([&] { return control(ratio, update, step_s); });
    require(is_within(held.force_n), "a force is within its limits");
    if (ratio >= 0 && ratio <= 1) {
      const double smaller = ratio * static_cast<double>(in.byte()) / 255;
      require(less(smaller, update, step_s).force_n >= held.force_n,
              "less sticking never gives less force");
    }
    const auto fed = fuzz::frame([&] { return by_slip(slip, step_s); });
    require(is_within(fed.force_n), "a force from friction is within its limits");
    control = in.flag() ? by_slip : control;
  }
}

template <class Search>
void follow(Input& in, const Search& search, double least_n, double most_n) {
  auto state = search;
  for (Index samples = in.whole(1, 400); samples > 0; --samples) {
    const HoldingCommand<double> before = state.command();
    const auto signal = static_cast<PreslipStatus>(in.whole(0, 3));
    const auto command = fuzz::frame([&] { return state(signal); });
    require(command.force_n >= least_n && command.force_n <= most_n,
            "a force is within its limits");
    require(!is_end(before.phase) ||
                (command.phase == before.phase && command.force_n == before.force_n),
            "a phase that has ended and its force do not change");
    if (in.is_empty()) {
      break;
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::run(data, size, [](Input& in) {
    switch (in.whole(0, 2)) {
      case 0:
        return try_grip(in);
      case 1: {
        LoosenOptions<double> options;
        options.first_force_n = in.number(1, 20);
        options.min_force_n = in.number(0, 2);
        options.step_n = in.number(0.01, 2);
        options.settle_samples = in.whole(0, 4);
        options.watch_samples = in.whole(1, 4);
        options.margin_steps = in.whole(0, 60000);
        options.until_slipped = in.flag();
        return follow(in, LoosenUntilPreslip<double>(options), options.min_force_n,
                      options.first_force_n);
      }
      default: {
        LiftOptions<double> options;
        options.first_force_n = in.number(0.1, 2);
        options.max_force_n = in.number(2, 20);
        options.force_step_n = in.number(0.01, 2);
        options.height_mm = in.number(1, 60);
        options.height_step_mm = in.number(0.1, 5);
        options.settle_samples = in.whole(0, 4);
        return follow(in, LiftWithRegrip<double>(options), options.first_force_n,
                      options.max_force_n);
      }
    }
  });
}
