// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Mistakes in the inputs of grip control: forces, ratios, times and signals, and the response at
// the end. With any input the force stays within its limits.
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "fingerpad/foam/holding_force.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/grip_control.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;

namespace {

template <class Input>
struct Mistake {
  const char* name;
  std::function<void(Input&)> make;
  const char* said;
};

}  // namespace

TEST_CASE("mistakes with the friction limit", "[mistakes]") {
  // An object is pressed with 4 N and pulled until it slides at 3.2 N, then held at 1 N.
  struct Input {
    ContactLoad<> load;
    double stick_ratio;
    RatioUpdate update = RatioUpdate::fresh;
  };
  const Mistake<Input> mistakes[] = {
      {"none", [](Input&) {}, "held"},
      {"normal force as a wrench has it", [](Input& in) { in.load.normal_n *= -1; }, "no load"},
      {"forces in mN: a ratio of two",
       [](Input& in) { in.load.normal_n *= 1e3, in.load.tangential_n *= 1e3; }, "held"},
      {"forces in kN", [](Input& in) { in.load.normal_n *= 1e-3, in.load.tangential_n *= 1e-3; },
       "no load"},
      {"normal and tangential force exchanged: the limit is forgotten where it holds beyond",
       [](Input& in) { std::swap(in.load.normal_n, in.load.tangential_n); }, "no limit"},
      {"no normal force", [](Input& in) { in.load.normal_n = test::nan; }, "no load"},
      {"stuck forces", [](Input& in) { in.load.normal_n = 4, in.load.tangential_n = 3.2; },
       "sliding"},
      {"stick ratio in percent", [](Input& in) { in.stick_ratio *= 100; }, "no limit"},
      {"no stick ratio", [](Input& in) { in.stick_ratio = test::nan; }, "no limit"},
      {"a ratio that is not of this frame", [](Input& in) { in.update = RatioUpdate::unmoved; },
       "no limit"},
  };
  for (const auto& mistake : mistakes) {
    FrictionLimit<> limit;
    SlipResult<> r;
    for (int k = 0; k < 30; ++k) {
      const double pull_n = k < 20 ? 0.16 * (k + 1) : 1;
      Input in{{.normal_n = 4, .tangential_n = pull_n}, k < 19 ? 1 - 0.03 * k : k == 19 ? 0.1 : 1};
      mistake.make(in);
      r = limit(in.load, in.stick_ratio, in.update);
    }
    INFO(mistake.name);
    CHECK(name_of(r.status) == std::string(mistake.said));
  }
}

TEST_CASE("mistakes with the grip's control", "[mistakes]") {
  // The ratio falls to 0.5 and stays: the force rises by 60 N/s x 0.3 for half a second.
  struct Input {
    double ratio, step_s = 0.02;
    RatioUpdate update = RatioUpdate::fresh;
  };
  const Mistake<Input> mistakes[] = {
      {"none", [](Input&) {}, "slipping"},
      {"ratio in percent", [](Input& in) { in.ratio *= 100; }, "blind"},
      {"ratio of slip for that of stick", [](Input& in) { in.ratio = 1 - in.ratio; }, "slipping"},
      {"no ratio", [](Input& in) { in.ratio = test::nan; }, "blind"},
      {"times in ms: each counts as 0.1 s", [](Input& in) { in.step_s *= 1e3; }, "slipping"},
      {"no times", [](Input& in) { in.step_s = test::nan; }, "blind"},
      {"time backwards", [](Input& in) { in.step_s *= -1; }, "blind"},
      {"times of the clock for steps", [](Input& in) { in.step_s = 1.7e9; }, "slipping"},
      {"a stuck ratio", [](Input& in) { in.ratio = 0.9; }, "sticks"},
      {"a ratio that nobody renews", [](Input& in) { in.update = RatioUpdate::missing; }, "blind"},
      {"nothing touches", [](Input& in) { in.update = RatioUpdate::no_contact; }, "lost"},
  };
  for (const auto& mistake : mistakes) {
    GripControl<> control({}, 2);
    GripResult<> r;
    for (int k = 0; k < 40; ++k) {
      Input in{k < 10 ? 1 - 0.05 * k : 0.5};
      mistake.make(in);
      r = control(in.ratio, in.update, in.step_s);
      CHECK((r.force_n >= control.options().min_force_n &&
             r.force_n <= control.options().max_force_n));
      CHECK((r.ok() || r.force_n <= control.options().safe_force_n));
    }
    INFO(mistake.name);
    CHECK(name_of(r.why) == std::string(mistake.said));
  }
}

TEST_CASE("mistakes with the grip's control by friction", "[mistakes]") {
  // An object pulls with 1 N, then 2 N, at a friction of 0.8; the dots slip from 0.6 on. Checks the
  // last response and whether the object ever slid.
  struct Input {
    ContactLoad<> load;
    double stick_ratio;
    int k;
  };
  const Mistake<Input> mistakes[] = {
      {"none", [](Input&) {}, "follows the load, held"},
      {"forces in mN", [](Input& in) { in.load.normal_n *= 1e3, in.load.tangential_n *= 1e3; },
       "follows the load, held"},
      {"forces in kN", [](Input& in) { in.load.normal_n *= 1e-3, in.load.tangential_n *= 1e-3; },
       "slipping, held"},
      {"tangential force in mN", [](Input& in) { in.load.tangential_n *= 1e3; },
       "follows the load, held"},
      {"tangential force in kN", [](Input& in) { in.load.tangential_n *= 1e-3; },
       "follows the load, held"},
      {"normal and tangential force exchanged",
       [](Input& in) { std::swap(in.load.normal_n, in.load.tangential_n); }, "slipping, slid"},
      {"normal force as a wrench has it", [](Input& in) { in.load.normal_n *= -1; },
       "slipping, held"},
      {"no forces",
       [](Input& in) {
         in.load = {test::nan, test::nan};
       },
       "slipping, held"},
      {"forces stuck from frame 50 on",
       [](Input& in) {
         in.load = in.k < 50 ? in.load : ContactLoad<>{2, 1};
       },
       "slipping, slid"},
      {"a stuck ratio", [](Input& in) { in.stick_ratio = 1; }, "follows the load, slid"},
      {"forces and ratio stuck from frame 50 on",
       [](Input& in) {
         in.load = in.k < 50 ? in.load : ContactLoad<>{2, 1};
         in.stick_ratio = 1;
       },
       "follows the load, slid"},
  };
  for (const auto& mistake : mistakes) {
    FrictionLimit<> limit;
    GripControl<> control({}, 4);
    GripResult<> r{.force_n = 4};
    bool slid = false;
    for (int k = 0; k < 400; ++k) {
      const double pull_n = k < 100 ? 1 : std::fmin(2, 1 + 0.02 * (k - 100));
      const double friction = pull_n / r.force_n;
      slid = slid || friction > 0.8;
      const double share = std::cbrt(std::fmax(0, 1 - friction / 0.8));
      Input in{{.normal_n = r.force_n, .tangential_n = pull_n}, share * share, k};
      mistake.make(in);
      const auto slip = limit(in.load, in.stick_ratio, RatioUpdate::fresh);
      r = control(slip, 0.02);
      CHECK((r.force_n >= control.options().min_force_n &&
             r.force_n <= control.options().max_force_n));
    }
    INFO(mistake.name << ": " << r.force_n << " N");
    CHECK(std::string(name_of(r.why)) + (slid ? ", slid" : ", held") == mistake.said);
  }
}

TEST_CASE("mistakes with the search for the holding force", "[mistakes]") {
  // Pre-slip at 4 N, then slip; `signal` is the hand's status.
  const auto ends = [](const std::function<PreslipStatus(double force_n, int k)>& signal) {
    LoosenUntilPreslip<> loosen({.settle_samples = 2, .watch_samples = 4});
    LiftWithRegrip<> lift({.settle_samples = 2});
    for (int k = 0; k < 2000; ++k) {
      (void)loosen(signal(loosen.command().force_n, k));
      (void)lift(signal(lift.command().force_n, k));
    }
    return std::string(name_of(loosen.command().phase)) + ", " + name_of(lift.command().phase);
  };
  using enum PreslipStatus;
  CHECK(ends([](double f, int) { return f < 4 ? preslip : steady; }) == "found, lifted");
  CHECK(ends([](double, int) { return cannot_tell; }) == "settling, watching");
  CHECK(ends([](double f, int k) {
          return k % 2 == 0 ? cannot_tell : f < 4 ? preslip : steady;
        }) == "found, lifted");
  CHECK(ends([](double, int) { return preslip; }) == "found, at limit");
  CHECK(ends([](double, int) { return slipped; }) == "slipped, slipped");
  // a stuck "steady" is undetectable, except through the least force and the lost object
  CHECK(ends([](double, int) { return steady; }) == "at limit, lifted");

  const auto loosened = [](const LoosenOptions<>& o) {
    return test::refusal([&] { LoosenUntilPreslip<> search(o); });
  };
  const auto lifted = [](const LiftOptions<>& o) {
    return test::refusal([&] { LiftWithRegrip<> search(o); });
  };
  CHECK(test::begins_with(loosened({.first_force_n = 0.5, .min_force_n = 10}),
                          "LoosenOptions: first_force_n = 0.5"));
  CHECK(test::begins_with(loosened({.step_n = -0.25}), "LoosenOptions: step_n"));
  CHECK(test::begins_with(loosened({.step_n = 1e-9}), "LoosenOptions: step_n"));
  CHECK(test::begins_with(lifted({.first_force_n = 20, .max_force_n = 1}),
                          "LiftOptions: max_force_n = 1"));
  CHECK(test::begins_with(lifted({.height_mm = 0.05e9}), "LiftOptions: height_step_mm"));
}
