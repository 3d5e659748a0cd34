// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every law, every history and every input.
#include "fingerpad/slip/grip_control.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/catch.hpp"
#include "support/generators.hpp"

using namespace fingerpad;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Zero in half of the cases, because zero has a meaning of its own.
double zero_or(double high) {
  return test::whole(0, 1) == 0 ? 0 : test::uniform(0, high);
}

GripLaw<double> any_law() {
  GripLaw<double> law;
  law.set_point = test::uniform(0.1, 0.9);
  law.raise_gain_n_per_s = test::log_uniform(0.1, 1000);
  law.lower_above = test::uniform(law.set_point, 1);
  law.lower_gain_n_per_s = zero_or(100);
  law.rise_limit_n_per_s = test::log_uniform(0.1, 100);
  law.fall_limit_n_per_s = zero_or(10);
  law.min_force_n = zero_or(2);
  law.max_force_n = law.min_force_n + test::uniform(0.1, 30);
  law.safe_force_n = test::uniform(law.min_force_n, law.max_force_n);
  law.ratio_lasts_s = zero_or(0.5);
  law.sliding_ratio = zero_or(law.set_point);
  law.blind_after_s = zero_or(0.5);
  law.blind_rise_n_per_s = zero_or(20);
  law.longest_step_s = test::log_uniform(0.01, 1);
  return law;
}

double any_ratio() {
  const double odd[] = {none, infinity, -infinity, -0.5, 1.5, 0, 1, 1e300};
  const auto kind = test::whole(0, 15);
  return kind < 8 ? odd[kind] : test::uniform(0, 1);
}

double any_step() {
  const double odd[] = {none, infinity, -infinity, -0.5, 0, 1e300, 1e-300, 100};
  const auto kind = test::whole(0, 15);
  return kind < 8 ? odd[kind] : test::uniform(0.001, 0.1);
}

RatioUpdate any_news() {
  return static_cast<RatioUpdate>(test::whole(0, 2));
}

using State = GripControl<double>::State;

/// The state after any history.
State any_state(const GripControl<>& control) {
  State state = control.start(test::uniform(-1, 40));
  const auto calls = test::whole(0, 8);
  for (int k = 0; k < calls; ++k) {
    (void)control({any_ratio(), any_news()}, any_step(), state);
  }
  if (test::whole(0, 3) == 0) {
    state.follow(test::uniform(-10, 100));
  }
  return state;
}

}  // namespace

TEST_CASE("grip force whatever is given", "[grip_control][law]") {
  rc::prop("is finite, within the limits, and no faster than the gripper", [] {
    const GripLaw<double> law = any_law();
    const GripControl control(law);
    State state = any_state(control);
    (void)control({none}, 0.001,
                  state);  // after an update the force is within the limits
    for (int k = 0; k < 30; ++k) {
      const double before = state.force_n();
      const double step_s = any_step();
      const auto result = control({any_ratio(), any_news()}, step_s, state);
      const double change = result.force_n - before;
      RC_ASSERT(result.force_n >= law.min_force_n);
      RC_ASSERT(result.force_n <= law.max_force_n);
      RC_ASSERT(state.force_n() == result.force_n);
      const double time_s = step_s > 0 && step_s < infinity ? step_s : 0;
      const double allowed_s = (std::min)(time_s, law.longest_step_s) + 1e-12;
      RC_ASSERT(change <= law.rise_limit_n_per_s * allowed_s + 1e-12);
      RC_ASSERT(change >= -law.fall_limit_n_per_s * allowed_s - 1e-12);
      // and the status reports the change
      RC_ASSERT((change <= 0) || result.status == GripStatus::raising);
      RC_ASSERT((change >= 0) || result.status == GripStatus::lowering);
      RC_ASSERT((result.why != GripReason::no_time) == (time_s > 0));
    }
  });
  rc::prop("never rises above the safe force, and never falls, without a fresh ratio", [] {
    const GripLaw<double> law = any_law();
    const GripControl control(law);
    State state = control.start(test::uniform(0, 40));
    for (int k = 0; k < 30; ++k) {
      const double before = state.force_n();
      const bool by_nan = test::whole(0, 1) == 0;
      const auto result =
          by_nan ? control({none}, any_step(), state)
                 : control(
                       {any_ratio(), static_cast<RatioUpdate>(test::whole(1, 3))},  // any but fresh
                       any_step(), state);
      RC_ASSERT(result.force_n >= before);
      RC_ASSERT(result.force_n <= (std::max)(before, law.safe_force_n));
      if (test::whole(0, 4) == 0) {
        (void)control({test::uniform(0, 1)}, 0.01, state);
      }
    }
  });
}

TEST_CASE("grip force and stick ratio", "[grip_control][law]") {
  rc::prop("less sticking never gives less force", [] {
    const GripControl control(any_law());
    State high = any_state(control);
    State low = high;
    const double a = test::uniform(0, 1), b = test::uniform(0, 1);
    const RatioUpdate update = test::whole(0, 1) == 0 ? RatioUpdate::fresh : RatioUpdate::unmoved;
    const double step_s = test::uniform(0.001, 0.1);
    RC_ASSERT(control({(std::min)(a, b), update}, step_s, low).force_n >=
              control({(std::max)(a, b), update}, step_s, high).force_n);
  });
  rc::prop("nor along a whole history of fresh ratios", [] {
    const GripControl control(any_law());
    State high = any_state(control);
    State low = high;
    for (int k = 0; k < 20; ++k) {
      const double ratio = test::uniform(0, 1), step_s = test::uniform(0.001, 0.1);
      const double less = test::uniform(0, ratio);
      RC_ASSERT(control({less}, step_s, low).force_n >=
                control({ratio}, step_s, high).force_n - 1e-12);
    }
  });
  rc::prop("slip is answered at once, unless at the limit", [] {
    const GripLaw<double> law = any_law();
    const GripControl control(law);
    State state = any_state(control);
    (void)control({law.set_point}, 0.001, state);
    const double before = state.force_n();
    const auto result = control({test::uniform(0, 0.99) * law.set_point}, 0.02, state);
    RC_ASSERT(result.why == GripReason::slipping);
    RC_ASSERT(result.force_n > before || before == law.max_force_n);
    RC_ASSERT((result.status == GripStatus::at_limit) == (before == law.max_force_n));
  });
  rc::prop("between the set point and lower_above the force rests", [] {
    const GripLaw<double> law = any_law();
    const GripControl control(law);
    State state = any_state(control);
    (void)control({law.set_point}, 0.001, state);
    const double before = state.force_n();
    const double ratio = law.set_point + test::uniform(0, 1) * (law.lower_above - law.set_point);
    RC_ASSERT(control({ratio}, 0.02, state).force_n == before);
  });
  rc::prop("a plant in which more grip sticks more comes to rest at the set point or above", [] {
    // ratio = 1 - load / (mu force), see docs/slip/grip_control.md
    const double load_n = test::uniform(0.1, 2), mu = test::uniform(0.5, 1);
    GripLaw<double> law;
    law.raise_gain_n_per_s = test::uniform(1, 50);
    law.set_point = test::uniform(0.3, 0.9);
    law.sliding_ratio = 0;
    const GripControl control(law);
    auto state = control.start(1);
    double ratio = 0;
    for (int k = 0; k < 30 * 600; ++k) {
      ratio = (std::max)(0.0, 1 - load_n / (mu * state.force_n()));
      (void)control({ratio}, 1.0 / 30, state);
    }
    const double needed_n = load_n / mu / (1 - law.set_point);
    RC_ASSERT(ratio > law.set_point - 1e-2 || needed_n > law.max_force_n);
    const double last_step_n = (std::min)(law.raise_gain_n_per_s, law.rise_limit_n_per_s) / 30;
    RC_ASSERT(state.force_n() <= (std::max)(needed_n + last_step_n, 1.0));
  });
}

TEST_CASE("grip force in float follows that in double", "[grip_control][law]") {
  rc::prop("to its roundoff", [] {
    const GripControl<double> control;
    const GripControl<float> single;
    auto state = control.start(3);
    auto s = single.start(3);
    for (int k = 0; k < 50; ++k) {
      const double ratio = static_cast<double>(test::whole(0, 32)) / 32;  // exact in both
      const auto a = control({ratio}, 1.0 / 64, state);
      const auto b = single({static_cast<float>(ratio)}, 1.0F / 64, s);
      RC_ASSERT(std::abs(a.force_n - static_cast<double>(b.force_n)) < 1e-4);
    }
  });
}
