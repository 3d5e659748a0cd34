// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/slip/grip_control.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/catch.hpp"
#include "support/numbers.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double frame_s = 1.0 / 30;
const GripLaw<double> plain{.set_point = 0.7, .raise_gain_n_per_s = 10};

GripLaw<double> lowering_law() {
  GripLaw<double> law = plain;
  law.lower_above = 0.8;
  law.lower_gain_n_per_s = 10;
  return law;
}

/// Repeats calls with the same update for a time and returns the last result.
GripResult<double> after(const GripControl<>& control,
                         GripControl<>::State& state,
                         double time_s,
                         double ratio,
                         RatioUpdate update = RatioUpdate::fresh) {
  GripResult<double> result;
  for (int k = 0; k < std::lround(time_s / 0.01); ++k) {
    result = control({ratio, update}, 0.01, state);
  }
  return result;
}

void check_refused(double GripLaw<double>::*field,
                   const std::string& name,
                   std::initializer_list<double> bad) {
  for (const double given : bad) {
    GripLaw<double> law;
    law.*field = given;
    CAPTURE(name, given);
    CHECK(test::begins_with(test::refusal([&] { GripControl<double>{law}; }),
                            "GripLaw: " + name + " = "));
  }
}

}  // namespace

TEST_CASE("grip control: the law", "[grip_control]") {
  const GripLaw<double> law{.set_point = 0.6,
                            .raise_gain_n_per_s = 10,
                            .lower_above = 0.9,
                            .lower_gain_n_per_s = 5,
                            .rise_limit_n_per_s = 4,
                            .fall_limit_n_per_s = 0.3};
  CHECK(grip_rate(law, 0.5) == Approx(1.0));
  CHECK(grip_rate(law, 0.6) == 0);
  CHECK(grip_rate(law, 0.75) == 0);
  CHECK(grip_rate(law, 0.9) == 0);
  CHECK(grip_rate(law, 0.95) == Approx(-0.25));
  CHECK(grip_rate(law, 0.0) == 4);  // as fast as the gripper can
  CHECK(grip_rate(law, 1.0) == -0.3);
  CHECK(grip_rate(GripLaw<double>(), 1.0) == 0);  // by default a held object is not released

  using test::Digits50;
  const double by_digits = static_cast<double>(grip_rate(GripLaw<Digits50>(), Digits50(0.75)));
  CHECK(by_digits == Approx(3).epsilon(1e-15));
  CHECK(test::slope_by_dual(
            [](const auto& x) { return grip_rate(GripLaw<std::decay_t<decltype(x)>>(), x); },
            0.75) == Approx(-60));
}

TEST_CASE("grip control: slip is answered in the call that shows it", "[grip_control]") {
  const GripControl control(plain);
  auto state = control.start(3);
  CHECK(control({0.9}, frame_s, state).why == GripReason::enough_sticks);
  const auto result = control({0.3}, frame_s, state);
  CHECK(result.status == GripStatus::raising);
  CHECK(result.why == GripReason::slipping);
  CHECK(result.force_n == Approx(3 + 10 * 0.4 * frame_s));
  CHECK(state.force_n() == result.force_n);
  // and no longer than the slip: the reached force is held
  const auto later = control({0.8}, frame_s, state);
  CHECK(later.status == GripStatus::holding);
  CHECK(later.force_n == result.force_n);
}

TEST_CASE("grip control: the same time in finer steps gives the same force", "[grip_control]") {
  const GripControl control(plain);
  auto coarse = control.start(3), fine = control.start(3);
  for (int k = 0; k < 10; ++k) {
    (void)control({0.4}, 0.08, coarse);
  }
  for (int k = 0; k < 800; ++k) {
    (void)control({0.4}, 0.001, fine);
  }
  CHECK(coarse.force_n() == Approx(5.4));
  CHECK(fine.force_n() == Approx(5.4));
}

TEST_CASE("grip control: nothing winds up at a limit", "[grip_control]") {
  const GripControl control(lowering_law());
  auto state = control.start(15);
  const auto top = after(control, state, 100, 0.0);
  CHECK(top.force_n == 20);
  CHECK(top.status == GripStatus::at_limit);
  CHECK(top.why == GripReason::slipping);
  // the first call that requires less force lowers it
  const auto down = control({1.0}, 0.01, state);
  CHECK(down.status == GripStatus::lowering);
  CHECK(down.force_n == Approx(20 - 0.01 * 2));
  const auto bottom = after(control, state, 100, 1.0);
  CHECK(bottom.force_n == 0.5);
  CHECK(bottom.status == GripStatus::at_limit);
  CHECK(bottom.why == GripReason::all_sticks);
  CHECK(control({0.5}, 0.01, state).force_n == Approx(0.5 + 0.02));
}

TEST_CASE("grip control: a gripper that lags does not wind it up either", "[grip_control]") {
  const GripControl control(plain);
  auto state = control.start(3);
  for (int k = 0; k < 100; ++k) {
    state.follow(3.5);  // the gripper is stuck
    (void)control({0.2}, 0.01, state);
  }
  CHECK(state.force_n() == Approx(3.55));
  state.follow(none);
  state.follow(infinity);
  CHECK(state.force_n() == Approx(3.55));
  state.follow(1e6);
  CHECK(control({0.9}, 0.01, state).force_n == 20);
}

TEST_CASE("grip control: dots that stand still", "[grip_control]") {
  const GripControl control(plain);
  SECTION("after a ratio that was good, or before any: the force is held for ever") {
    for (const double ratio : {none, 0.7, 1.0}) {
      auto state = control.start(3);
      const auto result = after(control, state, 1000, ratio, RatioUpdate::unmoved);
      CHECK(result.force_n == 3);
      CHECK(result.status == GripStatus::holding);
      CHECK(result.why == GripReason::unmoved);
    }
  }
  SECTION("a ratio below the set point is acted on for a while") {
    auto state = control.start(3);
    (void)control({0.6}, 0.01, state);
    const auto result = after(control, state, 0.05, 0.6, RatioUpdate::unmoved);
    CHECK(result.why == GripReason::slipping);
    CHECK(result.force_n == Approx(3 + 1.0 * 0.06));
    const auto later = after(control, state, 100, 0.6, RatioUpdate::unmoved);
    CHECK(later.why == GripReason::unmoved);
    CHECK(later.force_n == Approx(3 + 1.0 * 0.11).margin(0.011));
    (void)control({0.6}, 0.01, state);  // another gap may last as long again
    CHECK(control({0.6, RatioUpdate::unmoved}, 0.01, state).why == GripReason::slipping);
  }
  SECTION("an object that may slide over them is gripped harder, up to the safe force") {
    auto state = control.start(3);
    (void)control({0.4}, 0.01, state);
    const auto result = after(control, state, 1, 0.4, RatioUpdate::unmoved);
    CHECK(result.status == GripStatus::raising);
    CHECK(result.why == GripReason::may_slide);
    CHECK(result.force_n == Approx(3 + 3 * 1.01));
    const auto later = after(control, state, 100, 0.4, RatioUpdate::unmoved);
    CHECK(later.status == GripStatus::at_limit);
    CHECK(later.force_n == 10);
    // a fresh ratio exceeds it
    CHECK(control({0.4}, 0.01, state).force_n > 10);
    // and a standing one does not undo the demand of a fresh one
    CHECK(control({0.4, RatioUpdate::unmoved}, 0.01, state).force_n > 10);
  }
  SECTION("nothing is ever let go") {
    const GripControl lowering(lowering_law());
    auto state = lowering.start(3);
    CHECK(after(lowering, state, 10, 1.0, RatioUpdate::unmoved).force_n == 3);
    CHECK(lowering({1.0}, 0.01, state).force_n < 3);
  }
}

TEST_CASE("grip control: no ratio", "[grip_control]") {
  const GripControl control(plain);
  const auto blind = [&](auto& state, double time_s) {
    return after(control, state, time_s, 0.9, RatioUpdate::missing);
  };
  SECTION("is waited for, then the force goes up to the safe one and stays") {
    auto state = control.start(3);
    (void)control({0.9}, 0.01, state);
    auto result = blind(state, 0.19);
    CHECK(result.status == GripStatus::holding);
    CHECK(result.why == GripReason::waiting);
    CHECK(result.force_n == 3);
    result = blind(state, 0.5);
    CHECK(result.status == GripStatus::raising);
    CHECK(result.why == GripReason::blind);
    CHECK(result.force_n == Approx(3 + 5 * 0.49).margin(0.051));
    result = blind(state, 100);
    CHECK(result.status == GripStatus::at_limit);
    CHECK(result.force_n == 10);
    // a new ratio restarts the waiting time
    CHECK(control({0.9}, 0.01, state).status == GripStatus::holding);
    CHECK(blind(state, 0.1).why == GripReason::waiting);
  }
  SECTION("is not waited for when the object was slipping") {
    auto state = control.start(3);
    (void)control({0.6}, 0.01, state);
    CHECK(blind(state, 0.01).why == GripReason::blind);
    CHECK(state.force_n() > 3.01);
  }
  SECTION("does not lower a force above the safe one") {
    auto state = control.start(15);
    CHECK(blind(state, 10).force_n == 15);
  }
  SECTION("may also hold") {
    const GripControl holding({.blind_rise_n_per_s = 0});
    auto state = holding.start(3);
    const auto result = after(holding, state, 10, none);
    CHECK(result.force_n == 3);
    CHECK(result.status == GripStatus::holding);
    CHECK(result.why == GripReason::blind);
  }
  SECTION("is what a ratio is that cannot be one") {
    for (const double ratio : {none, infinity, -infinity, -0.001, 1.001, 1e300}) {
      auto state = control.start(3);
      CHECK(control({ratio}, 0.01, state).why == GripReason::waiting);
      CHECK(control({ratio, RatioUpdate::missing}, 0.01, state).why == GripReason::waiting);
    }
    auto state = control.start(3);
    CHECK(control({7.0, RatioUpdate::unmoved}, 0.01, state).why == GripReason::waiting);
  }
}

TEST_CASE("grip control: time", "[grip_control]") {
  const GripControl control(plain);
  auto state = control.start(3);
  SECTION("a step that is none changes nothing") {
    for (const double step_s : {0.0, -0.01, none, infinity, -infinity}) {
      const auto result = control({0.0}, step_s, state);
      CHECK(result.force_n == 3);
      CHECK(result.status == GripStatus::holding);
      CHECK(result.why == GripReason::no_time);
    }
    CHECK(control({0.0}, 0.01, state).force_n == Approx(3 + 0.07));
  }
  SECTION("a gap is no jump") {
    CHECK(control({0.5}, 3600, state).force_n == Approx(3 + 2 * 0.1));
  }
  SECTION("but a gap without a ratio is long enough to be blind") {
    CHECK(control({none}, 3600, state).why == GripReason::blind);
    CHECK(state.force_n() == Approx(3 + 5 * 0.1));
  }
}

TEST_CASE("grip control: the state is a value", "[grip_control]") {
  const GripControl control(plain);
  auto state = control.start(3);
  const auto bookmark = state;
  const double once = after(control, state, 0.3, 0.2).force_n;
  auto again = bookmark;
  CHECK(after(control, again, 0.3, 0.2).force_n == once);
  state.reset();
  CHECK(state.force_n() == 3);
  CHECK(control({none}, 0.01, state).why == GripReason::waiting);  // the slip is forgotten
  CHECK(control.start().force_n() == 0.5);
  CHECK(control.start(none).force_n() == 0.5);
  CHECK(control.start(infinity).force_n() == 20);
  CHECK(control.start(-1).force_n() == 0.5);
  static_assert(std::is_trivially_copyable_v<GripControl<float>::State>);
}

TEST_CASE("grip control: a lost object is not closed upon", "[grip_control]") {
  const GripControl control;
  auto state = control.start(2);
  (void)control({0.3, RatioUpdate::fresh}, 0.01, state);  // it slips and is gone
  GripResult<double> result;
  for (int k = 0; k < 49; ++k) {
    result = control({not_a_number<double>(), RatioUpdate::no_contact}, 0.01, state);
    CHECK(result.why == GripReason::blind);
  }
  const double force_n = result.force_n;
  for (int k = 0; k < 300; ++k) {
    result = control({not_a_number<double>(), RatioUpdate::no_contact}, 0.01, state);
  }
  CHECK(result.why == GripReason::lost);
  CHECK(result.status == GripStatus::holding);
  CHECK(result.force_n <= force_n + 0.1);
  CHECK_FALSE(result.ok());
  // an object that touches again is gripped
  CHECK(control({0.3, RatioUpdate::fresh}, 0.01, state).why == GripReason::slipping);
  result = control({not_a_number<double>(), RatioUpdate::no_contact}, 0.01, state);
  CHECK(result.why == GripReason::blind);
}

// a bare number could be mistaken for the time step
static_assert(!std::is_invocable_v<const GripControl<>&, double, double, GripControl<>::State&>);

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
  const GripControl control;
  auto state = control.start(4);
  // a slip at L = 0.5: from now on the required friction is lower by the margin
  (void)control(carried(4, 2, 0.9), frame_s, state);
  const auto slipped = control(carried(4, 2, 0.1), frame_s, state);
  CHECK(slipped.why == GripReason::slipping);
  CHECK(slipped.status == GripStatus::raising);
  CHECK(state.friction() == Approx(0.5 / 1.15).epsilon(0.01));
  SECTION("what the dots say since a reference before the slip is that slip") {
    for (int k = 1; k < 60; ++k) {
      CHECK(control(carried(4.6, 2, 0.1, 60), frame_s, state).why == GripReason::follows_load);
    }
    CHECK(state.force_n() == Approx(2 / state.friction()).epsilon(0.01));
    CHECK(control(carried(4.6, 2, 0.1, 30), frame_s, state).why == GripReason::slipping);
  }
  SECTION("a load that grows is gripped harder in the same share, though the ratio stays") {
    double force_n = 4.6;
    for (int k = 0; k < 90; ++k) {
      force_n = control(carried(force_n, 2 + k / 45.0, 0.2), frame_s, state).force_n;
      CHECK(force_n * state.friction() > 0.98 * (2 + k / 45.0));
    }
    CHECK(force_n == Approx(1.15 * 4 / 0.5).epsilon(0.05));
  }
  SECTION("with stick to spare more friction is asked for, at the rate of the law") {
    const double before = state.friction();
    double force_n = 4.6;
    for (int k = 0; k < 60; ++k) {
      force_n = control(carried(force_n, 2, 0.9), frame_s, state).force_n;
    }
    CHECK(state.friction() > before * 1.05);
    CHECK(state.friction() <= before * std::exp(0.04 * 2) + 1e-9);
    CHECK(force_n < 4.6);
  }
  SECTION("a load that falls while little sticks may be friction that fell") {
    auto copy = state;
    const auto after = [&](double ratio, double load_n) {
      copy = state;
      double force_n = state.force_n();
      for (int k = 0; k < 15; ++k) {
        auto slip = carried(force_n, 2 - (2 - load_n) * k / 14, ratio, 60);
        slip.update = RatioUpdate::unmoved;
        slip.dots_ratio = not_a_number<double>();
        force_n = control(slip, frame_s, copy).force_n;
      }
      return force_n;
    };
    CHECK(after(0.7, 1.6) < 0.95 * state.force_n());
    CHECK(after(0.3, 1.9) >= state.force_n());       // not taken for a smaller load
    CHECK(after(0.3, 1.6) > 1.1 * state.force_n());  // responds once it exceeds noise
    // once dots stick again, a falling load is real: the first such frame is no slip
    CHECK(control(carried(copy.force_n(), 1, 0.9), frame_s, copy).why == GripReason::follows_load);
  }
  SECTION("dots that fall back with little of them carried are a slide") {
    const auto after = [&](double ratio) {
      auto copy = state;
      double force_n = state.force_n();
      for (int k = 0; k < 10; ++k) {
        auto slip = carried(force_n, 2 - 0.01 * k, ratio);
        slip.falls_back = true;
        force_n = control(slip, frame_s, copy).force_n;
      }
      return force_n;
    };
    CHECK(after(0.63) <= 1.05 * state.force_n());  // an unloaded contact keeps as much
    CHECK(after(0.3) > 1.1 * state.force_n());
  }
  SECTION("but not by what is old, and not beyond a limit") {
    const double before = state.friction();
    for (int k = 0; k < 30; ++k) {
      auto slip = carried(4.6, 2, 0.9, 100);
      slip.limit = 0.4;
      (void)control(slip, frame_s, state);
    }
    CHECK(state.friction() < before);
    CHECK(state.friction() == Approx(0.4 / 1.15));
  }
  SECTION("dots that are lost leave it to the ratio's law: nothing is let go") {
    const double before = state.force_n();
    for (int k = 0; k < 30; ++k) {
      auto slip = carried(4.6, 0.1, none);
      slip.update = RatioUpdate::missing;
      CHECK(control(slip, frame_s, state).force_n >= before);
    }
  }
}

TEST_CASE("grip control: update of a stick ratio", "[grip_control]") {
  CHECK(update_of(StickStatus::updated) == RatioUpdate::fresh);
  CHECK(update_of(StickStatus::standing) == RatioUpdate::unmoved);
  CHECK(update_of(StickStatus::no_reference) == RatioUpdate::unmoved);
  CHECK(update_of(StickStatus::no_contact) == RatioUpdate::no_contact);
  for (const auto status : {StickStatus::too_few_dots, StickStatus::no_dots, StickStatus::jumped,
                            StickStatus::restarted}) {
    CHECK(update_of(status) == RatioUpdate::missing);
  }
}

TEST_CASE("grip control: names", "[grip_control]") {
  CHECK(std::string(name_of(GripStatus::at_limit)) == "at limit");
  CHECK(std::string(name_of(GripReason::may_slide)) == "may slide");
  CHECK(std::string(name_of(static_cast<GripStatus>(77))) == "unknown");
  CHECK(std::string(name_of(static_cast<GripReason>(77))) == "unknown");
}

TEST_CASE("grip control: bad parameters are refused by name", "[grip_control]") {
  using Law = GripLaw<double>;
  check_refused(&Law::set_point, "set_point", {0, 1, -1, none, infinity});
  check_refused(&Law::raise_gain_n_per_s, "raise_gain_n_per_s", {0, -1, none, infinity});
  check_refused(&Law::lower_above, "lower_above", {0.79, 1.01, none});
  check_refused(&Law::lower_gain_n_per_s, "lower_gain_n_per_s", {-1, none, infinity});
  check_refused(&Law::rise_limit_n_per_s, "rise_limit_n_per_s", {0, -1, none, infinity});
  check_refused(&Law::fall_limit_n_per_s, "fall_limit_n_per_s", {-1, none, infinity});
  check_refused(&Law::min_force_n, "min_force_n", {-1, none, infinity});
  check_refused(&Law::max_force_n, "max_force_n", {0.5, 0, none, infinity});
  check_refused(&Law::safe_force_n, "safe_force_n", {0.4, 20.1, none});
  check_refused(&Law::ratio_lasts_s, "ratio_lasts_s", {-1, none, infinity});
  check_refused(&Law::sliding_ratio, "sliding_ratio", {-0.1, 0.81, none});
  check_refused(&Law::blind_after_s, "blind_after_s", {-1, none, infinity});
  check_refused(&Law::blind_rise_n_per_s, "blind_rise_n_per_s", {-1, none, infinity});
  check_refused(&Law::slip_ratio, "slip_ratio", {-0.1, 0.6, none});
  check_refused(&Law::slip_margin, "slip_margin", {0, -1, none, infinity});
  check_refused(&Law::first_search_per_s, "first_search_per_s", {-1, none, infinity});
  check_refused(&Law::search_per_s, "search_per_s", {-1, none, infinity});
  check_refused(&Law::response_s, "response_s", {-1, none, infinity});
  check_refused(&Law::longest_step_s, "longest_step_s", {0, -1, none, infinity});
  CHECK(test::refusal([] { GripControl({.set_point = 1.5}); }) ==
        "GripLaw: set_point = 1.5, must be in (0, 1)");
}
