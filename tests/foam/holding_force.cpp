// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/foam/holding_force.hpp"

#include <cmath>
#include <initializer_list>
#include <limits>
#include <string>
#include <type_traits>

#include "support/catch.hpp"
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
template <class Search>
auto told(Search search, const std::string& signal) {
  return tell(search, signal);
}

/// The phase after each letter of the signal:
/// s(ettling), w(atching), F(ound), L(ifted), A(t limit), X (slipped).
template <class Search>
std::string phases(const Search& search, const std::string& signal) {
  auto state = search;
  std::string all;
  for (const char letter : signal) {
    all += "swFLAX"[static_cast<int>(state(update_of(letter)).phase)];
  }
  return all;
}
/// The force after each letter of the signal; the plans here keep it to one digit.
template <class Search>
std::string forces(const Search& search, const std::string& signal) {
  auto state = search;
  std::string all;
  for (const char letter : signal) {
    all += std::to_string(std::lround(state(update_of(letter)).force_n));
  }
  return all;
}

LoosenOptions<double> short_plan() {
  return {.first_force_n = 9,
          .min_force_n = 7,
          .step_n = 1,
          .settle_samples = 2,
          .watch_samples = 3,
          .margin_steps = 1};
}

LiftOptions<double> short_lift() {
  return {.first_force_n = 1,
          .max_force_n = 3,
          .force_step_n = 1,
          .height_mm = 10,
          .height_step_mm = 4,
          .settle_samples = 2};
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

TEST_CASE("loosening: settles, watches, loosens, down to the least force", "[holding_force]") {
  const LoosenUntilPreslip<double> search(short_plan());
  const auto first = search.command();
  CHECK(first.force_n == 9);
  CHECK(first.phase == SearchPhase::settling);
  CHECK(first.steps == 0);
  CHECK(std::isnan(first.preslip_force_n));
  CHECK(first.warning_steps == 0);

  const std::string steady(18, '-');
  // the first sample after the settling is the first watched one
  CHECK(phases(search, steady) ==
        "sswws"
        "sswws"
        "sswwA"
        "AAA");
  CHECK(forces(search, steady) ==
        "99998"
        "88887"
        "77777"
        "777");
  const auto end = told(search, steady);
  CHECK(end.phase == SearchPhase::at_limit);
  CHECK(end.steps == 2);
  CHECK(end.force_n == 7);
  CHECK(std::isnan(end.preslip_force_n));
  CHECK(end.warning_steps == 0);
}

TEST_CASE("loosening: pre-slip ends it, with the margin given back", "[holding_force]") {
  auto plan = short_plan();
  const auto found = [&](const std::string& signal) {
    return told(LoosenUntilPreslip<double>(plan), signal);
  };
  // at each of the three watched samples
  for (const char* const signal : {"-------p", "--------p", "---------p"}) {
    CAPTURE(signal);
    const auto at_8 = found(signal);
    CHECK(at_8.phase == SearchPhase::found);
    CHECK(at_8.preslip_force_n == 8);
    CHECK(at_8.force_n == 9);
    CHECK(at_8.steps == 1);
    CHECK(at_8.warning_steps == 0);
  }
  CHECK(found("------------p").preslip_force_n == 7);
  CHECK(found("------------p").force_n == 8);
  plan.margin_steps = 0;
  CHECK(found("------------p").force_n == 7);
  plan.margin_steps = 2;
  CHECK(found("------------p").force_n == 9);
  plan.margin_steps = 1000000;  // at most the first force
  CHECK(found("------------p").force_n == 9);
  CHECK(found("--p").force_n == 9);
  CHECK(found("--p").preslip_force_n == 9);
  CHECK(found("--p").phase == SearchPhase::found);
}

TEST_CASE("loosening: while the last step settles, only a slip is listened to", "[holding_force]") {
  const LoosenUntilPreslip<double> search(short_plan());
  CHECK(phases(search,
               "pp---"
               "pp---"
               "pp--p") ==
        "sswws"
        "sswws"
        "sswwF");
  CHECK(told(search,
             "pp---"
             "pp---")
            .steps == 2);
  for (const char* const signal : {"x", "-x", "--x", "-----x", "-----px", "--------x"}) {
    CAPTURE(signal);
    const auto end = told(search, signal);
    CHECK(end.phase == SearchPhase::slipped);
    CHECK(end.force_n == 9);  // the first force again
    CHECK(std::isnan(end.preslip_force_n));
  }
}

TEST_CASE("loosening until the object slips counts the steps of warning", "[holding_force]") {
  auto plan = short_plan();
  plan.min_force_n = 1;
  plan.until_slipped = true;
  const LoosenUntilPreslip<double> search(plan);
  auto state = search;
  CHECK(tell(state,
             "-----"
             "--p")
            .phase == SearchPhase::watching);
  CHECK(state.command().preslip_force_n == 8);
  CHECK(state.command().force_n == 8);
  CHECK(state.command().warning_steps == 0);
  auto now = tell(state, "p-");  // the rest of the watch: it is not shortened
  CHECK(now.phase == SearchPhase::settling);
  CHECK(now.force_n == 7);
  CHECK(now.warning_steps == 1);
  now = tell(state,
             "pp-p-"
             "--ppp");
  CHECK(now.force_n == 5);
  CHECK(now.preslip_force_n == 8);  // where it was found first
  CHECK(now.warning_steps == 3);
  CHECK(now.steps == 4);
  now = tell(state, "x");
  CHECK(now.phase == SearchPhase::slipped);
  CHECK(now.force_n == 9);
  CHECK(now.warning_steps == 3);
  CHECK(now.preslip_force_n == 8);
  // pre-slip on the last watched sample
  now = told(search, "----p");
  CHECK(now.force_n == 8);
  CHECK(now.preslip_force_n == 9);
  CHECK(now.warning_steps == 1);
  // without any slip the search ends at the least force
  now = told(search, "--p--" + std::string(40, '-'));
  CHECK(now.phase == SearchPhase::at_limit);
  CHECK(now.force_n == 1);
  CHECK(now.warning_steps == 8);
}

TEST_CASE("loosening: without settling, one look at each force", "[holding_force]") {
  auto plan = short_plan();
  plan.settle_samples = 0;
  plan.watch_samples = 1;
  const LoosenUntilPreslip<double> search(plan);
  CHECK(phases(search, "----") == "ssAA");
  CHECK(forces(search, "----") == "8777");
  CHECK(phases(search, "-p") == "sF");
  CHECK(forces(search, "-p") == "89");
  plan.watch_samples = 2;
  CHECK(phases(LoosenUntilPreslip<double>(plan), "-------") == "wswswAA");
  plan.settle_samples = 1;
  plan.watch_samples = 1;
  CHECK(phases(LoosenUntilPreslip<double>(plan), "-------") == "sssssAA");
}

TEST_CASE("loosening: forces do not collect rounding, and the last step may be short",
          "[holding_force]") {
  LoosenOptions<double> plan{.first_force_n = 10,
                             .min_force_n = 0.25,
                             .step_n = 0.1,
                             .settle_samples = 0,
                             .watch_samples = 1};
  const LoosenUntilPreslip<double> search(plan);
  auto state = search;
  for (int k = 1; k <= 97; ++k) {
    const auto now = state(PreslipStatus::steady);
    CHECK(now.force_n == 10 - k * 0.1);
    CHECK(now.steps == k);
  }
  CHECK(state(PreslipStatus::steady).force_n == 0.25);
  CHECK(state.command().phase == SearchPhase::settling);
  CHECK(state(PreslipStatus::steady).phase == SearchPhase::at_limit);
  CHECK(state.command().steps == 98);
  plan.step_n = 1000;  // one step to the least force
  CHECK(told(LoosenUntilPreslip<double>(plan), "-").force_n == 0.25);
  CHECK(told(LoosenUntilPreslip<double>(plan), "--").phase == SearchPhase::at_limit);
}

TEST_CASE("searches: signal that is missing changes nothing", "[holding_force]") {
  const LoosenUntilPreslip<double> loosen(short_plan());
  CHECK(phases(loosen,
               "m-m-m-mm--m"
               "--m--p") ==
        "ssssswwwwss"
        "ssswwF");
  const LiftWithRegrip<double> lift(short_lift());
  CHECK(phases(lift, "mpmmm-m-m-m") == "wssssssssww");
  CHECK(told(lift, "mmmm").height_mm == 0);
  CHECK(told(loosen, std::string(1000, 'm')).force_n == 9);
}

TEST_CASE("searches: an end is an end", "[holding_force]") {
  const LoosenUntilPreslip<double> loosen(short_plan());
  for (const std::string end : {"--p", "x", "---------------"}) {
    for (const std::string more : {"-", "p", "x", "m", "--pp--xx--mm"}) {
      CAPTURE(end, more);
      auto state = loosen;
      const auto before = tell(state, end);
      CHECK(is_end(before.phase));
      const auto after = tell(state, more);
      CHECK(after.phase == before.phase);
      CHECK(after.force_n == before.force_n);
      CHECK(after.steps == before.steps);
      CHECK(state.command().force_n == before.force_n);
    }
  }
  const LiftWithRegrip<double> lift(short_lift());
  for (const std::string end : {"---", "-x", "-p--p--p"}) {
    for (const std::string more : {"-", "p", "x", "m", "--pp--xx--mm"}) {
      CAPTURE(end, more);
      auto state = lift;
      const auto before = tell(state, end);
      CHECK(is_end(before.phase));
      const auto after = tell(state, more);
      CHECK(after.phase == before.phase);
      CHECK(after.force_n == before.force_n);
      CHECK(after.height_mm == before.height_mm);
      CHECK(after.steps == before.steps);
    }
  }
}

TEST_CASE("lifting: up in steps to the full height", "[holding_force]") {
  const LiftWithRegrip<double> search(short_lift());
  const auto first = search.command();
  CHECK(first.force_n == 1);
  CHECK(first.height_mm == 0);
  CHECK(first.phase == SearchPhase::watching);
  CHECK(first.steps == 0);
  auto state = search;
  CHECK(tell(state, "-").height_mm == 4);
  CHECK(tell(state, "-").height_mm == 8);
  CHECK(state.command().phase == SearchPhase::watching);
  CHECK(tell(state, "-").height_mm == 10);  // not 12
  CHECK(state.command().phase == SearchPhase::lifted);
  CHECK(state.command().force_n == 1);
  // a step that divides the height ends exactly on it
  LiftOptions<double> plan = short_lift();
  plan.height_step_mm = 5;
  CHECK(told(LiftWithRegrip<double>(plan), "-").phase == SearchPhase::watching);
  CHECK(told(LiftWithRegrip<double>(plan), "--").phase == SearchPhase::lifted);
  plan.height_step_mm = 0.1;
  auto slow = LiftWithRegrip<double>(plan);
  for (int k = 1; k < 100; ++k) {
    CHECK(slow(PreslipStatus::steady).height_mm == k * 0.1);
  }
}

TEST_CASE("lifting: pre-slip holds the lift and tightens the grip", "[holding_force]") {
  const LiftWithRegrip<double> search(short_lift());
  auto state = search;
  auto now = tell(state, "-p");
  CHECK(now.phase == SearchPhase::settling);
  CHECK(now.force_n == 2);
  CHECK(now.height_mm == 4);
  CHECK(now.steps == 1);
  now = tell(state, "p-");  // ignored
  CHECK(now.phase == SearchPhase::settling);
  CHECK(now.force_n == 2);
  CHECK(now.height_mm == 4);
  CHECK(tell(state, "-").height_mm == 8);
  CHECK(state.command().phase == SearchPhase::watching);
  now = tell(state, "p");
  CHECK(now.force_n == 3);
  CHECK(now.steps == 2);
  now = tell(state, "-p-");  // settled again from the start
  CHECK(now.phase == SearchPhase::lifted);
  CHECK(now.height_mm == 10);
  CHECK(now.force_n == 3);

  // pre-slip right after the settling
  CHECK(told(search, "p--p").force_n == 3);
  CHECK(phases(search, "pppppp") == "ssssss");
  CHECK(forces(search, "pppppp") == "222333");
  // at the largest force the search ends
  now = told(search, "-p--p--p");
  CHECK(now.phase == SearchPhase::at_limit);
  CHECK(now.force_n == 3);
  CHECK(now.height_mm == 0);
  CHECK(now.steps == 2);
  // and it goes on if the largest force suffices
  CHECK(told(search, "-p--p----").phase == SearchPhase::lifted);

  LiftOptions<double> plan = short_lift();
  plan.settle_samples = 0;
  CHECK(forces(LiftWithRegrip<double>(plan), "pp-") == "233");
  CHECK(phases(LiftWithRegrip<double>(plan), "pp-p") == "sswA");
  plan.force_step_n = 1.5;  // the last step may be short
  CHECK(told(LiftWithRegrip<double>(plan), "p").force_n == 2.5);
  CHECK(told(LiftWithRegrip<double>(plan), "pp").force_n == 3);
  plan.max_force_n = plan.first_force_n;  // nothing to tighten
  CHECK(told(LiftWithRegrip<double>(plan), "p").phase == SearchPhase::at_limit);
  CHECK(told(LiftWithRegrip<double>(plan), "-p").height_mm == 0);
}

TEST_CASE("lifting: an object that slips is put down at once", "[holding_force]") {
  const LiftWithRegrip<double> search(short_lift());
  for (const char* const signal : {"x", "-x", "-px", "-p-x", "--p--x"}) {
    CAPTURE(signal);
    const std::string before(signal, std::string(signal).size() - 1);
    const auto end = told(search, signal);
    CHECK(end.phase == SearchPhase::slipped);
    CHECK(end.height_mm == 0);
    CHECK(end.force_n == told(search, before).force_n);
    CHECK(end.steps == told(search, before).steps);
  }
}

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

TEST_CASE("searches: names, ends and plans", "[holding_force]") {
  const std::string names[] = {"settling", "watching", "found", "lifted", "at limit", "slipped"};
  for (int k = 0; k < 6; ++k) {
    CHECK(name_of(static_cast<SearchPhase>(k)) == names[k]);
    CHECK(is_end(static_cast<SearchPhase>(k)) == (k >= 2));
  }
  CHECK(std::string(name_of(static_cast<SearchPhase>(99))) == "unknown");
  CHECK(LoosenUntilPreslip<double>(short_plan()).options().watch_samples == 3);
  CHECK(LiftWithRegrip<double>(short_lift()).options().settle_samples == 2);
}

TEMPLATE_TEST_CASE("searches: in any number",
                   "[holding_force]",
                   float,
                   double,
                   long double,
                   test::Digits50,
                   test::Dual<double>) {
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
