// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for all options, every history and every input.
#include "fingerpad/slip/grip_control.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/allocations.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double frame_s = 1.0 / 30;
const GripOptions<double> plain{.set_point = 0.7, .raise_gain_n_per_s = 10};
constexpr auto fresh = RatioUpdate::fresh, unmoved = RatioUpdate::unmoved,
               missing = RatioUpdate::missing, no_contact = RatioUpdate::no_contact;

/// Repeats calls with the same update for a time and returns the last result.
GripResult<double> after(GripControl<>& control,
                         double time_s,
                         double ratio,
                         RatioUpdate update = fresh) {
  GripResult<double> result;
  for (int k = 0; k < std::lround(time_s / 0.01); ++k) {
    result = control(ratio, update, 0.01);
  }
  return result;
}

void check_refused(double GripOptions<double>::*field,
                   const std::string& name,
                   std::initializer_list<double> bad) {
  for (const double given : bad) {
    GripOptions<double> options;
    options.*field = given;
    CAPTURE(name, given);
    CHECK(test::begins_with(test::refusal([&] { GripControl<double>{options}; }),
                            "GripOptions: " + name + " = "));
  }
}

}  // namespace

TEST_CASE("grip control: the law", "[grip_control]") {
  const GripOptions<double> options{
      .set_point = 0.6, .raise_gain_n_per_s = 10, .rise_limit_n_per_s = 4};
  const auto rate = [&](double ratio) {
    GripControl control(options, 3);
    return (control(ratio, fresh, 0.01).force_n - 3) / 0.01;
  };
  CHECK(rate(0.5) == Approx(1.0));
  CHECK(rate(0.6) == 0);
  CHECK(rate(1.0) == 0);          // a held object is not released
  CHECK(rate(0.0) == Approx(4));  // as fast as the gripper can

  const auto force_n = [](const auto& ratio) {
    using S = std::decay_t<decltype(ratio)>;
    GripControl<S> control({}, S(3));
    return control(ratio, fresh, S(1) / S(8)).force_n;
  };
  using test::Digits50;
  CHECK(static_cast<double>(force_n(Digits50(0.75))) == Approx(3.3).epsilon(1e-14));
  CHECK(test::slope_by_tangent(force_n, 0.75) == Approx(-60 * 0.1));
}

TEST_CASE("grip control: the same time in finer steps gives the same force", "[grip_control]") {
  GripControl coarse(plain, 3), fine(plain, 3);
  for (int k = 0; k < 10; ++k) {
    (void)coarse(0.4, fresh, 0.08);
  }
  for (int k = 0; k < 800; ++k) {
    (void)fine(0.4, fresh, 0.001);
  }
  CHECK(coarse.force_n() == Approx(5.4));
  CHECK(fine.force_n() == Approx(5.4));
}

TEST_CASE("grip control: nothing winds up at a limit", "[grip_control]") {
  GripControl control({}, 15);
  const auto top = after(control, 100, 0.0);
  CHECK(top.force_n == 20);
  CHECK(top.at_limit);
  CHECK(top.why == GripReason::slipping);
  // the first call that requires less force lowers it
  SlipResult<double> slip;
  slip.stick_ratio = slip.dots_ratio = 0.9;
  slip.update = fresh;
  slip.normal_n = 20;
  slip.friction = 0.5;
  const double before = control(slip, 0.01).force_n;
  slip.friction = 0.4;
  const auto down = control(slip, 0.01);
  CHECK_FALSE(down.at_limit);
  CHECK(down.force_n == Approx(before - 0.01 * 2));
  slip.friction = 0.001;
  for (int k = 0; k < 2000; ++k) {
    (void)control(slip, 0.01);
  }
  CHECK(control.force_n() == 0.5);
  CHECK(control(0.5, fresh, 0.01).force_n == Approx(0.5 + 0.01 * 0.3 * 60));
}

TEST_CASE("grip control: a gripper that lags does not wind it up either", "[grip_control]") {
  GripControl control(plain, 3);
  for (int k = 0; k < 100; ++k) {
    control.follow(3.5);  // the gripper is stuck
    (void)control(0.2, fresh, 0.01);
  }
  CHECK(control.force_n() == Approx(3.55));
  control.follow(none);
  control.follow(infinity);
  CHECK(control.force_n() == Approx(3.55));
  control.follow(1e6);
  CHECK(control.force_n() == 20);
}

TEST_CASE("grip control: dots that stand still", "[grip_control]") {
  GripControl control(plain, 3);
  SECTION("after a ratio that was good, or before any: the force is held for ever") {
    for (const double ratio : {none, 0.7, 1.0}) {
      const auto result = after(control, 1000, ratio, unmoved);
      CHECK(result.force_n == 3);
      CHECK(result.why == GripReason::sticks);
    }
  }
  SECTION("a ratio below the set point is acted on for a while") {
    (void)control(0.6, fresh, 0.01);
    const auto result = after(control, 0.05, 0.6, unmoved);
    CHECK(result.why == GripReason::slipping);
    CHECK(result.force_n == Approx(3 + 1.0 * 0.06));
    const auto later = after(control, 100, 0.6, unmoved);
    CHECK(later.why == GripReason::sticks);
    CHECK(later.force_n == Approx(3 + 1.0 * 0.11).margin(0.011));
    (void)control(0.6, fresh, 0.01);  // another gap may last as long again
    CHECK(control(0.6, unmoved, 0.01).why == GripReason::slipping);
  }
  SECTION("an object that may slide over them is gripped harder, up to the safe force") {
    (void)control(0.4, fresh, 0.01);
    const auto result = after(control, 1, 0.4, unmoved);
    CHECK(result.why == GripReason::slipping);
    CHECK(result.force_n == Approx(3 + 3 * 1.01));
    const auto later = after(control, 100, 0.4, unmoved);
    CHECK(later.at_limit);
    CHECK(later.force_n == 10);
    // a fresh ratio exceeds it
    CHECK(control(0.4, fresh, 0.01).force_n > 10);
    // and a standing one does not undo the demand of a fresh one
    CHECK(control(0.4, unmoved, 0.01).force_n > 10);
  }
}

TEST_CASE("grip control: no ratio", "[grip_control]") {
  GripControl control(plain, 3);
  const auto blind = [&](double time_s) { return after(control, time_s, 0.9, missing); };
  SECTION("is waited for, then the force goes up to the safe one and stays") {
    (void)control(0.9, fresh, 0.01);
    auto result = blind(0.19);
    CHECK(result.why == GripReason::blind);
    CHECK(result.force_n == 3);
    result = blind(0.5);
    CHECK(result.why == GripReason::blind);
    CHECK(result.force_n == Approx(3 + 5 * 0.49).margin(0.051));
    result = blind(100);
    CHECK(result.at_limit);
    CHECK(result.force_n == 10);
    // a new ratio restarts the waiting time
    CHECK(control(0.9, fresh, 0.01).why == GripReason::sticks);
    CHECK_FALSE(blind(0.1).at_limit);
  }
  SECTION("is not waited for when the object was slipping") {
    (void)control(0.6, fresh, 0.01);
    const double before = control.force_n();
    CHECK(blind(0.01).force_n == Approx(before + 0.05));
  }
  SECTION("does not lower a force above the safe one") {
    control = GripControl(plain, 15);
    CHECK(blind(10).force_n == 15);
  }
  SECTION("is what a ratio is that cannot be one") {
    for (const double ratio : {none, infinity, -infinity, -0.001, 1.001, 1e300}) {
      control = GripControl(plain, 3);
      CHECK(control(ratio, fresh, 0.01).why == GripReason::blind);
      CHECK(control(ratio, missing, 0.01).why == GripReason::blind);
    }
    CHECK(control(7.0, unmoved, 0.01).why == GripReason::blind);
  }
}

TEST_CASE("grip control: time", "[grip_control]") {
  GripControl control(plain, 3);
  SECTION("a step that is none changes nothing") {
    for (const double step_s : {0.0, -0.01, none, infinity, -infinity}) {
      const auto result = control(0.0, fresh, step_s);
      CHECK(result.force_n == 3);
      CHECK_FALSE(result.ok());
    }
    CHECK(control(0.0, fresh, 0.01).force_n == Approx(3 + 0.07));
  }
  SECTION("a gap is no jump") {
    CHECK(control(0.5, fresh, 3600).force_n == Approx(3 + 2 * 0.1));
  }
  SECTION("but a gap without a ratio is long enough to be blind") {
    CHECK(control(none, fresh, 3600).why == GripReason::blind);
    CHECK(control.force_n() == Approx(3 + 5 * 0.1));
  }
}

TEST_CASE("grip control: a lost object is not closed upon", "[grip_control]") {
  GripControl control(GripOptions<double>(), 2);
  (void)control(0.3, fresh, 0.01);  // it slips and is gone
  GripResult<double> result;
  for (int k = 0; k < 49; ++k) {
    result = control(none, no_contact, 0.01);
    CHECK(result.why == GripReason::blind);
  }
  const double force_n = result.force_n;
  result = after(control, 3, none, no_contact);
  CHECK(result.why == GripReason::lost);
  CHECK(result.force_n <= force_n + 0.1);
  CHECK_FALSE(result.ok());
  // an object that touches again is gripped
  CHECK(control(0.3, fresh, 0.01).why == GripReason::slipping);
  CHECK(control(none, no_contact, 0.01).why == GripReason::blind);
}

// a bare number could be mistaken for the time step
static_assert(!std::is_invocable_v<GripControl<>&, double, double>);

namespace {

/// Result of dots and friction for a contact pressed with `normal_n` that carries `tangential_n`.
SlipResult<double> carried(double normal_n, double tangential_n, double ratio, Index age = 1) {
  SlipResult<double> slip;
  slip.stick_ratio = slip.dots_ratio = ratio;
  slip.update = RatioUpdate::fresh;
  slip.reference_age = age;
  slip.normal_n = normal_n;
  slip.friction = tangential_n / normal_n;
  return slip;
}

}  // namespace

TEST_CASE("grip control: with friction the force follows the load", "[grip_control]") {
  GripControl control(GripOptions<double>(), 4);
  // a slip at L = 0.5: from now on the required friction is lower by the margin
  (void)control(carried(4, 2, 0.9), frame_s);
  const auto slipped = control(carried(4, 2, 0.1), frame_s);
  CHECK(slipped.why == GripReason::slipping);
  CHECK(slipped.force_n > 4);
  CHECK(control.friction() == Approx(0.5 / 1.15).epsilon(0.01));
  SECTION("what the dots say since a reference before the slip is that slip") {
    for (int k = 1; k < 60; ++k) {
      CHECK(control(carried(4.6, 2, 0.1, 60), frame_s).why == GripReason::follows_load);
    }
    CHECK(control.force_n() == Approx(2 / control.friction()).epsilon(0.01));
    CHECK(control(carried(4.6, 2, 0.1, 30), frame_s).why == GripReason::slipping);
  }
  SECTION("a load that grows is gripped harder in the same share, though the ratio stays") {
    double force_n = 4.6;
    for (int k = 0; k < 90; ++k) {
      force_n = control(carried(force_n, 2 + k / 45.0, 0.2), frame_s).force_n;
      CHECK(force_n * control.friction() > 0.98 * (2 + k / 45.0));
    }
    CHECK(force_n == Approx(1.15 * 4 / 0.5).epsilon(0.05));
  }
  SECTION("with stick to spare more friction is asked for, at the rate of the law") {
    const double before = control.friction();
    double force_n = 4.6;
    for (int k = 0; k < 60; ++k) {
      force_n = control(carried(force_n, 2, 0.9), frame_s).force_n;
    }
    CHECK(control.friction() > before * 1.05);
    CHECK(control.friction() <= before * std::exp(0.04 * 2) + 1e-9);
    CHECK(force_n < 4.6);
  }
  SECTION("a load that falls while little sticks may be friction that fell") {
    auto copy = control;
    const auto after = [&](double ratio, double load_n) {
      copy = control;
      double force_n = control.force_n();
      for (int k = 0; k < 15; ++k) {
        auto slip = carried(force_n, 2 - (2 - load_n) * k / 14, ratio, 60);
        slip.update = RatioUpdate::unmoved;
        slip.dots_ratio = not_a_number<double>();
        force_n = copy(slip, frame_s).force_n;
      }
      return force_n;
    };
    CHECK(after(0.7, 1.6) < 0.95 * control.force_n());
    CHECK(after(0.3, 1.9) >= control.force_n());       // not taken for a smaller load
    CHECK(after(0.3, 1.6) > 1.1 * control.force_n());  // responds once it exceeds noise
    // once dots stick again, a falling load is real: the first such frame is no slip
    CHECK(copy(carried(copy.force_n(), 1, 0.9), frame_s).why == GripReason::follows_load);
  }
  SECTION("dots that fall back with little of them carried are a slide") {
    const auto after = [&](double ratio) {
      auto copy = control;
      double force_n = control.force_n();
      for (int k = 0; k < 10; ++k) {
        auto slip = carried(force_n, 2 - 0.01 * k, ratio);
        slip.falls_back = true;
        force_n = copy(slip, frame_s).force_n;
      }
      return force_n;
    };
    CHECK(after(0.63) <= 1.05 * control.force_n());  // an unloaded contact keeps as much
    CHECK(after(0.3) > 1.1 * control.force_n());
  }
  SECTION("but not by what is old, and not beyond a limit") {
    const double before = control.friction();
    for (int k = 0; k < 30; ++k) {
      auto slip = carried(4.6, 2, 0.9, 100);
      slip.limit = 0.4;
      (void)control(slip, frame_s);
    }
    CHECK(control.friction() < before);
    CHECK(control.friction() == Approx(0.4 / 1.15));
  }
  SECTION("dots that are lost leave it to the ratio's law: nothing is let go") {
    const double before = control.force_n();
    for (int k = 0; k < 30; ++k) {
      auto slip = carried(4.6, 0.1, none);
      slip.update = RatioUpdate::missing;
      CHECK(control(slip, frame_s).force_n >= before);
    }
  }
}

TEST_CASE("grip control: update of a stick ratio", "[grip_control]") {
  CHECK(update_of(StickStatus::updated) == RatioUpdate::fresh);
  CHECK(update_of(StickStatus::unmoved) == RatioUpdate::unmoved);
  CHECK(update_of(StickStatus::no_contact) == RatioUpdate::no_contact);
  for (const auto status : {StickStatus::too_few_dots, StickStatus::not_in_order,
                            StickStatus::no_outline, StickStatus::refused}) {
    CHECK(update_of(status) == RatioUpdate::missing);
  }
}

TEST_CASE("grip control: bad parameters are refused by name", "[grip_control]") {
  using Options = GripOptions<double>;
  check_refused(&Options::set_point, "set_point", {0, 1, -1, none, infinity});
  check_refused(&Options::raise_gain_n_per_s, "raise_gain_n_per_s", {0, -1, none, infinity});
  check_refused(&Options::rise_limit_n_per_s, "rise_limit_n_per_s", {0, -1, none, infinity});
  check_refused(&Options::fall_limit_n_per_s, "fall_limit_n_per_s", {-1, none, infinity});
  check_refused(&Options::min_force_n, "min_force_n", {-1, none, infinity});
  check_refused(&Options::max_force_n, "max_force_n", {0.5, 0, none, infinity});
  check_refused(&Options::safe_force_n, "safe_force_n", {0.4, 20.1, none});
  check_refused(&Options::slip_margin, "slip_margin", {0, -1, none, infinity});
  check_refused(&Options::response_s, "response_s", {-1, none, infinity});
  CHECK(test::refusal([] { GripControl<double>({.set_point = 1.5}); }) ==
        "GripOptions: set_point = 1.5, must be in (0, 1)");
}

namespace {

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

TEST_CASE("grip control: nothing allocates", "[grip_control]") {
  const long before = test::allocations();
  GripControl<double> control({}, 3);
  double force_n = 0;
  for (int k = 0; k < 300; ++k) {
    const double ratio = k % 7 == 0 ? not_a_number<double>() : 0.004 * (k % 250);
    force_n += control(ratio, static_cast<RatioUpdate>(k % 3), 0.01).force_n;
    const auto bookmark = control;
    force_n += bookmark.force_n();
  }
  const long after = test::allocations();
  CHECK(force_n > 0);
  CHECK(after == before);
}
