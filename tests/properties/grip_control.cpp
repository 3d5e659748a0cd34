// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for all options, every history and every input.
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

GripOptions<double> any_options() {
  GripOptions<double> options;
  options.set_point = test::uniform(0.1, 0.9);
  options.raise_gain_n_per_s = test::log_uniform(0.1, 1000);
  options.rise_limit_n_per_s = test::log_uniform(0.1, 100);
  options.fall_limit_n_per_s = zero_or(10);
  options.min_force_n = zero_or(2);
  options.max_force_n = options.min_force_n + test::uniform(0.1, 30);
  options.safe_force_n = test::uniform(options.min_force_n, options.max_force_n);
  return options;
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

/// After any history.
GripControl<double> any_grip(const GripOptions<double>& options) {
  GripControl<double> control(options, test::uniform(-1, 40));
  const auto calls = test::whole(0, 8);
  for (int k = 0; k < calls; ++k) {
    (void)control(any_ratio(), any_news(), any_step());
  }
  if (test::whole(0, 3) == 0) {
    control.follow(test::uniform(-10, 100));
  }
  return control;
}

}  // namespace

TEST_CASE("grip force whatever is given", "[grip_control][law]") {
  rc::prop("is finite, within the limits, and no faster than the gripper", [] {
    const GripOptions<double> options = any_options();
    auto control = any_grip(options);
    for (int k = 0; k < 30; ++k) {
      const double before = control.force_n();
      const double step_s = any_step();
      const auto result = control(any_ratio(), any_news(), step_s);
      const double change = result.force_n - before;
      RC_ASSERT(result.force_n >= options.min_force_n);
      RC_ASSERT(result.force_n <= options.max_force_n);
      RC_ASSERT(control.force_n() == result.force_n);
      const double time_s = step_s > 0 && step_s < infinity ? step_s : 0;
      const double allowed_s = (std::min)(time_s, 0.1) + 1e-12;
      RC_ASSERT(change <= options.rise_limit_n_per_s * allowed_s + 1e-12);
      RC_ASSERT(change >= 0);  // without a load nothing is let go
      RC_ASSERT((change == 0 || !result.at_limit));
      RC_ASSERT((time_s > 0 || !result.ok()));
    }
  });
  rc::prop("never rises above the safe force, and never falls, without a fresh ratio", [] {
    const GripOptions<double> options = any_options();
    GripControl control(options, test::uniform(0, 40));
    for (int k = 0; k < 30; ++k) {
      const double before = control.force_n();
      const bool by_nan = test::whole(0, 1) == 0;
      const auto result =
          by_nan ? control(none, RatioUpdate::fresh, any_step())
                 : control(any_ratio(), static_cast<RatioUpdate>(test::whole(1, 3)),  // not fresh
                           any_step());
      RC_ASSERT(result.force_n >= before);
      RC_ASSERT(result.force_n <= (std::max)(before, options.safe_force_n));
      if (test::whole(0, 4) == 0) {
        (void)control(test::uniform(0, 1), RatioUpdate::fresh, 0.01);
      }
    }
  });
}

TEST_CASE("grip force and stick ratio", "[grip_control][law]") {
  rc::prop("less sticking never gives less force", [] {
    auto high = any_grip(any_options());
    auto low = high;
    const double a = test::uniform(0, 1), b = test::uniform(0, 1);
    const RatioUpdate update = test::whole(0, 1) == 0 ? RatioUpdate::fresh : RatioUpdate::unmoved;
    const double step_s = test::uniform(0.001, 0.1);
    RC_ASSERT(low((std::min)(a, b), update, step_s).force_n >=
              high((std::max)(a, b), update, step_s).force_n);
  });
  rc::prop("nor along a whole history of fresh ratios", [] {
    auto high = any_grip(any_options());
    auto low = high;
    for (int k = 0; k < 20; ++k) {
      const double ratio = test::uniform(0, 1), step_s = test::uniform(0.001, 0.1);
      const double less = test::uniform(0, ratio);
      RC_ASSERT(low(less, RatioUpdate::fresh, step_s).force_n >=
                high(ratio, RatioUpdate::fresh, step_s).force_n - 1e-12);
    }
  });
  rc::prop("slip is answered at once, unless at the limit; from the set point on it rests", [] {
    const GripOptions<double> options = any_options();
    auto control = any_grip(options);
    const double before = control.force_n();
    const double more = test::uniform(options.set_point, 1);
    RC_ASSERT(control(more, RatioUpdate::fresh, 0.02).force_n == before);
    const double less = test::uniform(0, 0.99) * options.set_point;
    const auto result = control(less, RatioUpdate::fresh, 0.02);
    RC_ASSERT(result.why == GripReason::slipping);
    RC_ASSERT((result.force_n > before || before == options.max_force_n));
    RC_ASSERT(result.at_limit == (before == options.max_force_n));
  });
  rc::prop("a plant in which more grip sticks more comes to rest at the set point or above", [] {
    // ratio = 1 - load / (mu force), see docs/slip/grip_control.md
    const double load_n = test::uniform(0.1, 2), mu = test::uniform(0.5, 1);
    GripOptions<double> options;
    options.raise_gain_n_per_s = test::uniform(1, 50);
    options.set_point = test::uniform(0.3, 0.9);
    GripControl control(options, 1);
    double ratio = 0;
    for (int k = 0; k < 30 * 600; ++k) {
      ratio = (std::max)(0.0, 1 - load_n / (mu * control.force_n()));
      (void)control(ratio, RatioUpdate::fresh, 1.0 / 30);
    }
    const double needed_n = load_n / mu / (1 - options.set_point);
    RC_ASSERT((ratio > options.set_point - 1e-2 || needed_n > options.max_force_n));
    const double last_step_n =
        (std::min)(options.raise_gain_n_per_s, options.rise_limit_n_per_s) / 30;
    RC_ASSERT(control.force_n() <= (std::max)(needed_n + last_step_n, 1.0));
  });
}

TEST_CASE("grip force in float follows that in double", "[grip_control][law]") {
  rc::prop("to its roundoff", [] {
    GripControl<double> control({}, 3);
    GripControl<float> single({}, 3);
    for (int k = 0; k < 50; ++k) {
      const double ratio = static_cast<double>(test::whole(0, 32)) / 32;  // exact in both
      const auto a = control(ratio, RatioUpdate::fresh, 1.0 / 64);
      const auto b = single(static_cast<float>(ratio), RatioUpdate::fresh, 1.0F / 64);
      RC_ASSERT(std::abs(a.force_n - static_cast<double>(b.force_n)) < 1e-4);
    }
  });
}
