// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every plan and any answers of the fingers, and the result for an object of known
// friction.
#include "fingerpad/foam/holding_force.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// '-' steady, 'p' pre-slip, 'x' slipped, 'm' missing
PreslipStatus update_of(char letter) {
  return letter == 'p'   ? PreslipStatus::preslip
         : letter == 'x' ? PreslipStatus::slipped
         : letter == 'm' ? PreslipStatus::cannot_tell
                         : PreslipStatus::steady;
}

/// The command after the last letter of the signal.
template <class Search>
auto tell(Search& search, const std::string& signal) {
  auto command = search.command();
  for (const char letter : signal) {
    command = search(update_of(letter));
  }
  return command;
}
template <class Plan, class Field>
void check_refused(Field Plan::*field, const std::string& name, std::initializer_list<Field> bad) {
  const bool loosens = std::is_same_v<Plan, LoosenOptions<double>>;
  for (const Field given : bad) {
    Plan plan;
    plan.*field = given;
    CAPTURE(name, given);
    const std::string said = test::refusal([&] {
      if constexpr (std::is_same_v<Plan, LoosenOptions<double>>) {
        LoosenUntilPreslip<double>{plan};
      } else {
        LiftWithRegrip<double>{plan};
      }
    });
    const std::string owner = loosens ? "LoosenOptions" : "LiftOptions";
    CHECK(test::begins_with(said, owner + ": " + name + " = "));
  }
}
std::string refusal_of(const LoosenOptions<double>& plan) {
  return test::refusal([&] { LoosenUntilPreslip<double>{plan}; });
}
std::string refusal_of(const LiftOptions<double>& plan) {
  return test::refusal([&] { LiftWithRegrip<double>{plan}; });
}

}  // namespace

TEST_CASE("searches: bad plans are refused by name, value and range", "[holding_force]") {
  using Loosen = LoosenOptions<double>;
  CHECK(refusal_of(Loosen{}) == "accepted");
  check_refused(&Loosen::first_force_n, "first_force_n", {0.5, 0.0, -1.0, none, infinity});
  check_refused(&Loosen::min_force_n, "min_force_n", {-1e-9, none, infinity, -infinity});
  check_refused(&Loosen::step_n, "step_n", {0.0, -1.0, none, infinity, 9.4e-6, 5e-324});
  check_refused<Loosen, Index>(&Loosen::settle_samples, "settle_samples", {-1});
  check_refused<Loosen, Index>(&Loosen::watch_samples, "watch_samples", {0, -1});
  check_refused<Loosen, Index>(&Loosen::margin_steps, "margin_steps", {-1, 1000001});
  CHECK(refusal_of(Loosen{.first_force_n = 2, .min_force_n = 2}) ==
        "LoosenOptions: first_force_n = 2, must be finite and > 2");
  CHECK(refusal_of(Loosen{.min_force_n = -1}) ==
        "LoosenOptions: min_force_n = -1, must be finite and >= 0");
  CHECK(refusal_of(Loosen{.step_n = 0}) ==
        "LoosenOptions: step_n = 0, must be finite and > 9.5e-06");
  CHECK(refusal_of(Loosen{.settle_samples = -2}) ==
        "LoosenOptions: settle_samples = -2, must be >= 0");
  CHECK(refusal_of(Loosen{.watch_samples = 0}) == "LoosenOptions: watch_samples = 0, must be >= 1");
  CHECK(refusal_of(Loosen{.margin_steps = -3}) ==
        "LoosenOptions: margin_steps = -3, must be in [0, 1000000]");
  CHECK(refusal_of(Loosen{.min_force_n = 0}) == "accepted");
  CHECK(refusal_of(Loosen{.step_n = 9.6e-6}) == "accepted");  // 989 583 steps
  CHECK(refusal_of(Loosen{.step_n = 1e9}) == "accepted");
  CHECK(refusal_of(Loosen{.settle_samples = 0, .watch_samples = 1, .margin_steps = 0}) ==
        "accepted");
  CHECK(refusal_of(Loosen{.margin_steps = 1000000}) == "accepted");

  using Lift = LiftOptions<double>;
  CHECK(refusal_of(Lift{}) == "accepted");
  check_refused(&Lift::first_force_n, "first_force_n", {0.0, -1.0, none, infinity});
  check_refused(&Lift::max_force_n, "max_force_n", {0.999, 0.0, -1.0, none, infinity});
  check_refused(&Lift::force_step_n, "force_step_n", {0.0, -1.0, none, infinity, 1.8e-5});
  check_refused(&Lift::height_mm, "height_mm", {0.0, -1.0, none, infinity});
  check_refused(&Lift::height_step_mm, "height_step_mm", {0.0, -1.0, none, infinity, 4.9e-5});
  check_refused<Lift, Index>(&Lift::settle_samples, "settle_samples", {-1});
  CHECK(refusal_of(Lift{.first_force_n = 0}) ==
        "LiftOptions: first_force_n = 0, must be finite and > 0");
  CHECK(refusal_of(Lift{.max_force_n = 0.5}) ==
        "LiftOptions: max_force_n = 0.5, must be finite and >= 1");
  CHECK(refusal_of(Lift{.force_step_n = -1}) ==
        "LiftOptions: force_step_n = -1, must be finite and > 1.9e-05");
  CHECK(refusal_of(Lift{.height_mm = 0}) == "LiftOptions: height_mm = 0, must be finite and > 0");
  CHECK(refusal_of(Lift{.height_step_mm = 0}) ==
        "LiftOptions: height_step_mm = 0, must be finite and > 5e-05");
  CHECK(refusal_of(Lift{.settle_samples = -1}) == "LiftOptions: settle_samples = -1, must be >= 0");
  CHECK(refusal_of(Lift{.first_force_n = 20, .force_step_n = 0}) != "accepted");
  CHECK(refusal_of(Lift{.first_force_n = 20}) == "accepted");  // nothing to tighten
  CHECK(refusal_of(Lift{.force_step_n = 1.95e-5}) == "accepted");
  CHECK(refusal_of(Lift{.height_step_mm = 5.1e-5, .settle_samples = 0}) == "accepted");
}

TEMPLATE_TEST_CASE("searches: in any number",
                   "[holding_force]",
                   float,
                   double,
                   long double,
                   test::Digits50,
                   test::Tangent<double>) {
  using S = TestType;
  const auto number = [](const S& x) { return static_cast<double>(value(x)); };
  const LoosenUntilPreslip<S> loosen;
  auto loosening = loosen;
  for (int k = 0; k < 32 * 7; ++k) {
    (void)loosening(PreslipStatus::steady);
  }
  CHECK(number(loosening.command().force_n) == 8.25);
  auto end = tell(loosening, "----------------p");
  CHECK(end.phase == SearchPhase::found);
  CHECK(number(end.preslip_force_n) == 8.25);
  CHECK(number(end.force_n) == 8.75);
  const LiftWithRegrip<S> lift;
  auto lifting = lift;
  auto up = tell(lifting, std::string("----p").append(17, '-'));
  CHECK(number(up.force_n) == 1.5);
  CHECK(number(up.height_mm) == 1.25);
  up = tell(lifting, std::string(195, '-'));
  CHECK(up.phase == SearchPhase::lifted);
  CHECK(number(up.height_mm) == 50);
}

namespace {

using News = std::vector<PreslipStatus>;

LoosenOptions<double> any_loosen_plan() {
  LoosenOptions<double> plan;
  plan.min_force_n = test::whole(0, 1) == 0 ? 0 : test::uniform(0, 5);
  plan.first_force_n = plan.min_force_n + test::uniform(0.01, 20);
  plan.step_n = (plan.first_force_n - plan.min_force_n) / test::uniform(0.5, 25);
  plan.settle_samples = test::whole(0, 5);
  plan.watch_samples = test::whole(1, 5);
  plan.margin_steps = test::whole(0, 4);
  plan.until_slipped = test::whole(0, 1) == 0;
  return plan;
}

LiftOptions<double> any_lift_plan() {
  LiftOptions<double> plan;
  plan.first_force_n = test::uniform(0.1, 5);
  plan.max_force_n = plan.first_force_n + (test::whole(0, 3) == 0 ? 0 : test::uniform(0, 20));
  plan.force_step_n =
      (std::max)(plan.max_force_n - plan.first_force_n, 0.1) / test::uniform(0.5, 15);
  plan.height_mm = test::uniform(1, 100);
  plan.height_step_mm = plan.height_mm / test::uniform(0.5, 30);
  plan.settle_samples = test::whole(0, 5);
  return plan;
}

/// Mostly steady; slips are rare or absent.
News any_news(Index most) {
  News signal(static_cast<std::size_t>(test::whole(1, most)));
  const Index slips = test::whole(0, 1), often = test::whole(1, 20);
  for (PreslipStatus& one : signal) {
    const Index kind = test::whole(0, 60);
    one = kind < often          ? PreslipStatus::preslip
          : kind < 30           ? PreslipStatus::steady
          : kind < 35           ? PreslipStatus::cannot_tell
          : kind == 60 && slips ? PreslipStatus::slipped
                                : PreslipStatus::steady;
  }
  return signal;
}

template <class Search>
auto after(const Search& search, const News& signal) {
  auto state = search;
  for (const PreslipStatus one : signal) {
    (void)state(one);
  }
  return state.command();
}

bool equal(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}
bool equal(const HoldingCommand<double>& a, const HoldingCommand<double>& b) {
  return a.force_n == b.force_n && a.height_mm == b.height_mm && a.phase == b.phase &&
         a.steps == b.steps && equal(a.preslip_force_n, b.preslip_force_n) &&
         a.warning_steps == b.warning_steps;
}

/// Number of steps of this size that fit into `way`; the last may be shorter.
Index steps_in(double way, double step) {
  return static_cast<Index>(std::ceil(way / step * (1 + 1e-12)));
}

/// Answers of an object: part of its contact slips below one force, and all of it below another.
PreslipStatus object(double force_n, double begins_below_n, double slips_below_n) {
  return force_n < slips_below_n    ? PreslipStatus::slipped
         : force_n < begins_below_n ? PreslipStatus::preslip
                                    : PreslipStatus::steady;
}

/// The command at the end of a search; the object's answers may be missing for a while.
template <class Search>
auto end_of(const Search& search, double begins_below_n, double slips_below_n) {
  auto state = search;
  const Index seldom = test::whole(2, 10);
  for (int k = 0; k < 100000 && !is_end(state.command().phase); ++k) {
    const bool is_missing = k % seldom == 0;
    const double force_n = state.command().force_n;
    (void)state(is_missing ? PreslipStatus::cannot_tell
                           : object(force_n, begins_below_n, slips_below_n));
  }
  RC_ASSERT(is_end(state.command().phase));
  return state.command();
}

}  // namespace

TEST_CASE("loosening whatever is told", "[holding_force][law]") {
  rc::prop("the force keeps its limits and rises only at the end", [] {
    const auto plan = any_loosen_plan();
    const LoosenUntilPreslip<double> search(plan);
    auto state = search;
    for (const PreslipStatus one : any_news(120)) {
      const auto before = state.command();
      const auto now = state(one);
      RC_ASSERT(now.force_n >= plan.min_force_n);
      RC_ASSERT(now.force_n <= plan.first_force_n);
      RC_ASSERT((now.force_n <= before.force_n || now.phase == SearchPhase::found ||
                 now.phase == SearchPhase::slipped));
      RC_ASSERT(before.force_n - now.force_n <= plan.step_n * (1 + 1e-12));
      RC_ASSERT(now.steps - before.steps == (now.force_n < before.force_n ? 1 : 0));
      const double stepped = plan.first_force_n - static_cast<double>(now.steps) * plan.step_n;
      if (!is_end(now.phase) || now.phase == SearchPhase::at_limit) {
        RC_ASSERT(now.force_n == (std::max)(stepped, plan.min_force_n));
      }
      // the first force with pre-slip is kept
      RC_ASSERT(
          (std::isnan(before.preslip_force_n) || now.preslip_force_n == before.preslip_force_n));
      RC_ASSERT((!std::isnan(now.preslip_force_n) || now.warning_steps == 0));
      RC_ASSERT(now.warning_steps <= now.steps);
      RC_ASSERT((now.phase != SearchPhase::found || !plan.until_slipped));
      RC_ASSERT(now.phase != SearchPhase::lifted);
      RC_ASSERT((!is_end(before.phase) || equal(before, now)));
    }
  });
  rc::prop("it ends in time", [] {
    const auto plan = any_loosen_plan();
    const LoosenUntilPreslip<double> search(plan);
    const Index levels = steps_in(plan.first_force_n - plan.min_force_n, plan.step_n) + 1;
    const Index bound = levels * (plan.settle_samples + plan.watch_samples);
    // a steady signal takes longest: the whole bound
    const News steady(static_cast<std::size_t>(bound), PreslipStatus::steady);
    RC_ASSERT(after(search, steady).phase == SearchPhase::at_limit);
    RC_ASSERT(!is_end(after(search, News(steady.begin() + 1, steady.end())).phase));
    auto state = search;
    Index told = 0;
    while (told < bound) {
      for (const PreslipStatus one : any_news(50)) {
        (void)state(one);
        told += one != PreslipStatus::cannot_tell ? 1 : 0;
      }
    }
    RC_ASSERT(is_end(state.command().phase));
  });
  rc::prop("while a step settles, pre-slip is not listened to", [] {
    auto plan = any_loosen_plan();
    plan.until_slipped = false;
    const LoosenUntilPreslip<double> search(plan);
    News signal(static_cast<std::size_t>(plan.settle_samples), PreslipStatus::preslip);
    RC_ASSERT(equal(after(search, signal), search.command()));
    signal.push_back(PreslipStatus::preslip);
    RC_ASSERT(after(search, signal).phase == SearchPhase::found);
  });
}

TEST_CASE("loosening the grip of an object that is known", "[holding_force][law]") {
  rc::prop("finds its least force within a step, and gives the margin back", [] {
    auto plan = any_loosen_plan();
    plan.until_slipped = false;
    const double begins_n = test::uniform(plan.min_force_n, plan.first_force_n * 1.1);
    const auto end = end_of(LoosenUntilPreslip<double>(plan), begins_n, 0);
    const double small = 1e-12 * plan.first_force_n;
    if (end.phase == SearchPhase::at_limit) {
      RC_ASSERT(plan.min_force_n >= begins_n);
      return;
    }
    RC_ASSERT(end.phase == SearchPhase::found);
    RC_ASSERT(end.preslip_force_n < begins_n);
    const double margin_n = static_cast<double>(plan.margin_steps) * plan.step_n;
    const double min_n = (std::min)(begins_n, plan.first_force_n);
    RC_ASSERT(end.preslip_force_n >= min_n - plan.step_n - small);
    RC_ASSERT(std::abs(end.force_n -
                       (std::min)(end.preslip_force_n + margin_n, plan.first_force_n)) <= small);
    RC_ASSERT((plan.margin_steps == 0 || end.force_n >= min_n - small));  // it holds
    RC_ASSERT(end.force_n <= min_n + margin_n);
  });
  rc::prop("counts the steps from the first sign to the slip", [] {
    auto plan = any_loosen_plan();
    plan.until_slipped = true;
    const double begins_n = test::uniform(plan.min_force_n, plan.first_force_n);
    const double slips_n = test::uniform(0, begins_n);
    const auto end = end_of(LoosenUntilPreslip<double>(plan), begins_n, slips_n);
    const double small = 1e-12 * plan.first_force_n;
    if (slips_n <= plan.min_force_n + small) {
      RC_ASSERT((end.phase == SearchPhase::at_limit || end.phase == SearchPhase::slipped));
      return;
    }
    RC_ASSERT(end.phase == SearchPhase::slipped);
    RC_ASSERT(end.force_n == plan.first_force_n);
    // no step lies between the two forces, so it slips without a warning
    const auto first_below = [&](double force_n) {
      Index step = 0;
      while (!((std::max)(plan.first_force_n - static_cast<double>(step) * plan.step_n,
                          plan.min_force_n) < force_n)) {
        ++step;
      }
      return step;
    };
    const Index sign = first_below(begins_n), slip = first_below(slips_n);
    RC_ASSERT(end.steps == slip);
    RC_ASSERT(end.warning_steps == slip - sign);
    RC_ASSERT(std::isnan(end.preslip_force_n) == (slip == sign));
    const double apart = (begins_n - slips_n) / plan.step_n;
    RC_ASSERT(static_cast<double>(end.warning_steps) <= std::ceil(apart + 1e-9));
    const bool is_short = plan.first_force_n - static_cast<double>(slip) * plan.step_n <
                          plan.min_force_n;  // the last step
    RC_ASSERT((is_short || static_cast<double>(end.warning_steps) >= std::floor(apart - 1e-9)));
  });
}

TEST_CASE("lifting whatever is told", "[holding_force][law]") {
  rc::prop("force and height keep their limits and never fall before the end", [] {
    const auto plan = any_lift_plan();
    const LiftWithRegrip<double> search(plan);
    auto state = search;
    for (const PreslipStatus one : any_news(120)) {
      const auto before = state.command();
      const auto now = state(one);
      RC_ASSERT(now.force_n >= plan.first_force_n);
      RC_ASSERT(now.force_n <= plan.max_force_n);
      RC_ASSERT(now.force_n >= before.force_n);
      RC_ASSERT(now.force_n - before.force_n <= plan.force_step_n * (1 + 1e-12));
      RC_ASSERT(now.steps - before.steps == (now.force_n > before.force_n ? 1 : 0));
      RC_ASSERT(now.height_mm >= 0);
      RC_ASSERT(now.height_mm <= plan.height_mm);
      RC_ASSERT(now.height_mm - before.height_mm <= plan.height_step_mm * (1 + 1e-12));
      const bool is_given_up =
          now.phase == SearchPhase::slipped || now.phase == SearchPhase::at_limit;
      RC_ASSERT((is_given_up ? now.height_mm == 0 : now.height_mm >= before.height_mm));
      RC_ASSERT((now.phase == SearchPhase::lifted) == (now.height_mm == plan.height_mm));
      // never both at once
      RC_ASSERT((now.force_n == before.force_n || now.height_mm == before.height_mm));
      RC_ASSERT(now.phase != SearchPhase::found);
      RC_ASSERT((!is_end(before.phase) || equal(before, now)));
    }
  });
  rc::prop("it ends in time", [] {
    const auto plan = any_lift_plan();
    const LiftWithRegrip<double> search(plan);
    const Index regrips = steps_in(plan.max_force_n - plan.first_force_n, plan.force_step_n);
    const Index lifts = steps_in(plan.height_mm, plan.height_step_mm);
    // each tightening settles; after it follows at most the last lift or the end
    const Index bound = regrips * (1 + plan.settle_samples) + lifts;
    auto state = search;
    Index told = 0;
    while (told < bound) {
      for (const PreslipStatus one : any_news(50)) {
        (void)state(one);
        told += one != PreslipStatus::cannot_tell ? 1 : 0;
      }
    }
    RC_ASSERT(is_end(state.command().phase));
    // the longest course: all but one lift, all tightenings, the last lift
    News longest(static_cast<std::size_t>(lifts - 1), PreslipStatus::steady);
    longest.insert(longest.end(), static_cast<std::size_t>(bound - lifts + 1),
                   PreslipStatus::preslip);
    longest.back() = PreslipStatus::steady;
    RC_ASSERT(after(search, longest).phase == SearchPhase::lifted);
    longest.pop_back();
    RC_ASSERT(!is_end(after(search, longest).phase));
  });
  rc::prop("while the grip tightens, pre-slip is not listened to", [] {
    auto plan = any_lift_plan();
    plan.max_force_n = plan.first_force_n + 2 * plan.force_step_n;
    const LiftWithRegrip<double> search(plan);
    News signal(static_cast<std::size_t>(1 + plan.settle_samples), PreslipStatus::preslip);
    RC_ASSERT(after(search, signal).steps == 1);
    signal.push_back(PreslipStatus::preslip);
    RC_ASSERT(after(search, signal).steps == 2);
  });
}

TEST_CASE("lifting an object that is known", "[holding_force][law]") {
  rc::prop("ends with it up and held within a step of its least force, or gives it up", [] {
    const auto plan = any_lift_plan();
    const double begins_n = test::uniform(0, plan.max_force_n * 1.2);
    const double slips_n = test::uniform(0, begins_n);
    const auto end = end_of(LiftWithRegrip<double>(plan), begins_n, slips_n);
    if (plan.first_force_n < slips_n) {
      RC_ASSERT(end.phase == SearchPhase::slipped);
      RC_ASSERT(end.force_n == plan.first_force_n);
    } else if (plan.max_force_n < begins_n) {
      RC_ASSERT(end.phase == SearchPhase::at_limit);
      RC_ASSERT(end.force_n == plan.max_force_n);
    } else {
      RC_ASSERT(end.phase == SearchPhase::lifted);
      RC_ASSERT(end.height_mm == plan.height_mm);
      RC_ASSERT(end.force_n >= begins_n);
      RC_ASSERT(end.force_n <=
                (std::max)(begins_n + plan.force_step_n * (1 + 1e-12), plan.first_force_n));
    }
  });
}
