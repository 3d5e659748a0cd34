// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/foam/preslip.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr Index nowhere = FingerSample<>::no_location;
constexpr Index max_index = (std::numeric_limits<Index>::max)();
constexpr Index min_index = (std::numeric_limits<Index>::min)();

using Sample = FingerSample<double>;
template <std::size_t Fingers>
using Hand = std::array<Sample, Fingers>;
using Options = PreslipOptions;

Sample felt(Index location, Index waves, double x_mm = 0, double y_mm = 0) {
  Sample sample;
  sample.status = location >= 0 ? TaxelStatus::vibrating : TaxelStatus::quiet;
  if (location >= 0) {
    sample.add_vibration(location, waves);
  }
  sample.location = location;
  sample.waves = waves;
  sample.center_x_mm = x_mm;
  sample.center_y_mm = y_mm;
  return sample;
}

/// A quiet sample that is pressed at a place.
Sample silent(double x_mm = 0, double y_mm = 0) {
  return felt(nowhere, 0, x_mm, y_mm);
}

template <std::size_t Fingers>
bool holds(PreslipRule rule,
           const Hand<Fingers>& older,
           const Hand<Fingers>& later,
           Options options = {}) {
  options.rule = rule;
  return is_preslip(older, later, options);
}

bool pair(PreslipRule rule, const Sample& older, const Sample& later, const Options& options = {}) {
  return holds(rule, Hand<1>{older}, Hand<1>{later}, options);
}

template <std::size_t Fingers>
Hand<Fingers> all(const Sample& sample) {
  Hand<Fingers> hand;
  hand.fill(sample);
  return hand;
}

std::string refusal_of(const Options& options) {
  return test::refusal([&] { Preslip<>(2, options); });
}

void check_refused(Index Options::*field, const std::string& name, const std::string& range) {
  for (const Index given :
       {min_index, Index(-1), Index(0), Index(1), Index(65537), Index(100001), Index(1) << 62}) {
    Options options;
    options.*field = given;
    const std::string said = refusal_of(options);
    CAPTURE(name, given, said);
    const std::string refused =
        "PreslipOptions: " + name + " = " + std::to_string(given) + ", must be " + range;
    CHECK((said == "accepted" || said == refused));
  }
}
std::string with(Index Options::*field, Index given) {
  Options options;
  options.*field = given;
  return refusal_of(options);
}

}  // namespace

TEST_CASE("grasp-optimise: every clause of the rule is needed", "[preslip]") {
  const PreslipRule rule = PreslipRule::printed_grasp_optimise;
  const Hand<2> older{felt(3, 5), felt(8, 2)};
  const Hand<2> later{felt(4, 5), felt(9, 2)};
  CHECK(holds(rule, older, later));
  CHECK(holds(rule, later, older));  // equal waves have no order
  for (const std::size_t finger : {0U, 1U}) {
    CAPTURE(finger);
    const auto changed = [&](Hand<2> hand, auto change) {
      change(hand[finger]);
      return hand;
    };
    const Index there = older[finger].location;
    const auto elsewhere = [&](Sample& s) { s.location = there; };
    const auto more = [](Sample& s) { ++s.waves; };
    const auto fewer = [](Sample& s) { --s.waves; };
    const auto lost = [](Sample& s) { s.location = nowhere; };
    const auto none_seen = [](Sample& s) { s.waves = 0; };
    CHECK_FALSE(holds(rule, older, changed(later, elsewhere)));
    CHECK_FALSE(holds(rule, older, changed(later, more)));
    CHECK_FALSE(holds(rule, older, changed(later, fewer)));
    CHECK_FALSE(holds(rule, older, changed(later, lost)));
    CHECK_FALSE(holds(rule, changed(older, lost), later));
    CHECK_FALSE(holds(rule, changed(older, none_seen), changed(later, none_seen)));
    // the position of the force does not matter, nor whether there is any
    const auto unpressed = [](Sample& s) { s.center_x_mm = none; };
    const auto far = [](Sample& s) { s.center_y_mm = 1e300; };
    CHECK(holds(rule, older, changed(later, unpressed)));
    CHECK(holds(rule, changed(older, far), later));
    // waves are not compared across fingers
    CHECK(holds(rule, changed(older, more), changed(later, more)));
  }
  // locations are not compared across fingers
  CHECK(holds(rule, Hand<2>{felt(3, 5), felt(4, 5)}, Hand<2>{felt(4, 5), felt(3, 5)}));
}

TEST_CASE("grasp-optimise: the last of three fingers counts as the first", "[preslip]") {
  const Hand<3> older{felt(1, 2), felt(1, 3), felt(1, 4)};
  const Hand<3> later{felt(2, 2), felt(2, 3), felt(2, 4)};
  CHECK(holds(PreslipRule::printed_grasp_optimise, older, later));
  for (std::size_t finger = 0; finger < 3; ++finger) {
    Hand<3> same = later;
    same[finger].location = 1;
    CHECK_FALSE(holds(PreslipRule::printed_grasp_optimise, older, same));
  }
}

TEST_CASE("grasp-lift: every clause of the rule is needed", "[preslip]") {
  const PreslipRule rule = PreslipRule::printed_grasp_lift;
  const Sample older = felt(3, 4, 1, 1), later = felt(5, 6, 2, 2);
  CHECK(pair(rule, older, later));
  CHECK_FALSE(pair(rule, later, older));                    // waves fall
  CHECK_FALSE(pair(rule, older, felt(3, 6, 2, 2)));         // location
  CHECK_FALSE(pair(rule, older, felt(5, 4, 2, 2)));         // waves
  CHECK_FALSE(pair(rule, older, felt(5, 3, 2, 2)));         // waves
  CHECK_FALSE(pair(rule, older, felt(5, 6, 1, 1)));         // centroid
  CHECK_FALSE(pair(rule, older, felt(nowhere, 6, 2, 2)));   // no vibration now
  CHECK_FALSE(pair(rule, older, felt(5, 6, none, 2)));      // no pressure
  CHECK_FALSE(pair(rule, older, felt(5, 6, 2, infinity)));  // the same
  CHECK_FALSE(pair(rule, felt(3, 4, 1, none), later));
  CHECK_FALSE(pair(rule, felt(3, 4, -infinity, 1), later));
  // a silent finger had no location, which differs from any location
  CHECK(pair(rule, silent(1, 1), later));
  CHECK(pair(rule, silent(1, 1), felt(0, 1, 2, 2)));
  CHECK_FALSE(pair(rule, later, silent(1, 1)));
  CHECK_FALSE(pair(rule, silent(1, 1), silent(2, 2)));
  // waves counted before the location was lost still count
  CHECK_FALSE(pair(rule, felt(nowhere, 6, 1, 1), later));
}

TEST_CASE("grasp-lift: one finger is enough, but it must fulfil the whole rule", "[preslip]") {
  const Hand<2> older{felt(3, 4, 1, 1), felt(7, 4, 1, 1)};
  const Sample pair_of_0 = felt(5, 6, 2, 2);
  CHECK(holds(PreslipRule::printed_grasp_lift, older, Hand<2>{pair_of_0, older[1]}));
  CHECK(holds(PreslipRule::printed_grasp_lift, older, Hand<2>{older[0], pair_of_0}));
  CHECK(holds(PreslipRule::printed_grasp_lift, older,
              Hand<2>{pair_of_0, felt(nowhere, 0, none, none)}));
  CHECK(holds(PreslipRule::printed_grasp_lift, older,
              Hand<2>{felt(nowhere, 0, none, none), pair_of_0}));
  CHECK_FALSE(holds(PreslipRule::printed_grasp_lift, older, older));
  // location and waves of one finger, centroid of the other
  CHECK_FALSE(
      holds(PreslipRule::printed_grasp_lift, older, Hand<2>{felt(5, 6, 1, 1), felt(7, 4, 2, 2)}));
  CHECK_FALSE(
      holds(PreslipRule::printed_grasp_lift, older, Hand<2>{felt(5, 4, 2, 2), felt(7, 6, 2, 2)}));
}

TEST_CASE("centroids differ from beyond the tolerance on", "[preslip]") {
  const double tolerance = 0.25;
  const Options options{.centroid_tolerance_mm = tolerance};
  const auto moved = [&](double x_mm, double y_mm) {
    return pair(PreslipRule::printed_grasp_lift, felt(3, 4, 1, 1), felt(5, 6, 1 + x_mm, 1 + y_mm),
                options);
  };
  const double beyond = tolerance + 1e-15;
  for (const double sign : {1.0, -1.0}) {
    CHECK_FALSE(moved(sign * tolerance, 0));
    CHECK_FALSE(moved(0, sign * tolerance));
    CHECK_FALSE(moved(sign * tolerance, -sign * tolerance));  // not along the diagonal
    CHECK(moved(sign * beyond, 0));
    CHECK(moved(0, sign * beyond));
  }
  // a tolerance of zero: any difference counts
  const Options exact{.centroid_tolerance_mm = 0};
  CHECK_FALSE(pair(PreslipRule::printed_grasp_lift, felt(3, 4, 0, 1), felt(5, 6, -0.0, 1), exact));
  CHECK(pair(PreslipRule::printed_grasp_lift, felt(3, 4, 0, 1), felt(5, 6, 5e-324, 1), exact));
}

TEST_CASE("centroids differ along any axis", "[preslip]") {
  const auto differ = [](double x_mm, double y_mm) {
    return pair(PreslipRule::printed_grasp_lift, felt(3, 4, 1, 1), felt(5, 6, 1 + x_mm, 1 + y_mm));
  };
  CHECK_FALSE(differ(0, 0));
  CHECK(differ(1, 0));
  CHECK(differ(0, -1));
  CHECK(differ(1, -1));
  CHECK(differ(-1, 1));
}

TEST_CASE("samples with fewer waves than asked for are silent", "[preslip]") {
  const auto optimise = [](Index waves, Index least) {
    return pair(PreslipRule::printed_grasp_optimise, felt(3, waves), felt(4, waves),
                {.min_waves = least});
  };
  CHECK(optimise(0, 0));  // as published: two missing locations are equal
  CHECK_FALSE(optimise(0, 1));
  CHECK(optimise(1, 1));
  CHECK_FALSE(optimise(1, 2));
  CHECK(optimise(2, 2));
  // a sample without a location makes no pair, whatever min_waves
  CHECK_FALSE(pair(PreslipRule::printed_grasp_optimise, silent(), felt(4, 0), {.min_waves = 0}));
  CHECK_FALSE(pair(PreslipRule::printed_grasp_optimise, felt(4, 0), silent(), {.min_waves = 0}));
  const auto lift = [](Index before, Index now, Index least) {
    return pair(PreslipRule::printed_grasp_lift, felt(3, before, 0, 0), felt(4, now, 1, 1),
                {.min_waves = least});
  };
  CHECK(lift(0, 1, 0));
  CHECK_FALSE(lift(0, 0, 0));
  CHECK(lift(0, 1, 1));
  CHECK_FALSE(lift(0, 1, 2));
  CHECK(lift(0, 2, 2));
  CHECK(lift(1, 2, 2));  // the older sample may be silent
}

TEST_CASE("waves and locations out of range", "[preslip]") {
  const auto optimise = [&](Index older, Index later, const Options& options) {
    return pair(PreslipRule::printed_grasp_optimise, felt(3, older), felt(4, later), options);
  };
  const auto lift = [&](Index older, Index later, const Options& options) {
    return pair(PreslipRule::printed_grasp_lift, felt(3, older, 0, 0), felt(4, later, 1, 1),
                options);
  };
  CHECK(optimise(max_index, max_index, {}));
  CHECK_FALSE(optimise(max_index - 1, max_index, {}));
  CHECK(lift(max_index - 1, max_index, {}));
  // negative waves count as none
  CHECK(lift(-3, 1, {}));
  CHECK(lift(min_index, 1, {}));
  CHECK_FALSE(lift(-3, -2, {.min_waves = 0}));
  CHECK_FALSE(optimise(-3, -3, {.min_waves = 0}));
  // locations before the first taxel count as none
  CHECK_FALSE(pair(PreslipRule::printed_grasp_optimise, felt(-7, 2), felt(4, 2)));
  CHECK_FALSE(pair(PreslipRule::printed_grasp_optimise, felt(4, 2), felt(min_index, 2)));
  CHECK(pair(PreslipRule::printed_grasp_lift, felt(min_index, 2, 0, 0), felt(4, 3, 1, 1)));
  CHECK_FALSE(pair(PreslipRule::printed_grasp_lift, felt(4, 2, 0, 0), felt(-7, 3, 1, 1)));
  CHECK(pair(PreslipRule::printed_grasp_optimise, felt(max_index, 2), felt(4, 2)));
}

TEST_CASE("pre-slip: the newest sample makes a pair with any that the history still holds",
          "[preslip]") {
  Preslip<> preslip(2, {.rule = PreslipRule::printed_grasp_optimise, .history = 5});
  const auto see = [&](const Sample& sample) {
    return preslip(all<2>(sample)) == PreslipStatus::preslip;
  };
  CHECK_FALSE(see(felt(3, 5)));  // no sample to compare with
  CHECK_FALSE(see(felt(3, 5)));
  CHECK(see(felt(4, 5)));
  for (int k = 0; k < 5; ++k) {
    CHECK_FALSE(see(silent()));
  }
  CHECK_FALSE(see(felt(1, 2)));
  CHECK(see(felt(2, 2)));
  CHECK_FALSE(see(felt(2, 3)));
  CHECK(see(felt(2, 2)));  // with the older sample, which is still stored
  CHECK(see(felt(1, 2)));
  CHECK_FALSE(see(felt(2, 3)));
  CHECK(see(felt(1, 2)));  // not with the previous sample, which is at the same place
  for (const int between : {3, 4}) {
    preslip.reset();
    CHECK_FALSE(see(felt(3, 5)));  // all samples are forgotten
    for (int k = 0; k < between; ++k) {
      CHECK_FALSE(see(silent()));
    }
    CHECK(see(felt(4, 5)) == (between == 3));  // with the oldest sample, or after it has left
  }
}

TEST_CASE("pre-slip: what a lift stirs up", "[preslip]") {
  Preslip<> preslip(2, {.rule = PreslipRule::printed_grasp_lift, .history = 4});
  const auto see = [&](const Sample& sample) {
    return preslip(Hand<2>{silent(5, 5), sample}) == PreslipStatus::preslip;
  };
  CHECK_FALSE(see(felt(3, 2, 1, 1)));
  CHECK_FALSE(see(felt(4, 2, 2, 2)));  // not more waves
  CHECK(see(felt(4, 3, 2, 2)));        // than the first, elsewhere
  CHECK(see(felt(5, 3, 3, 3)));        // than the second
  CHECK(see(felt(5, 3, 3, 3)));
  CHECK_FALSE(see(felt(5, 2, 3, 3)));
  CHECK_FALSE(see(silent(3, 3)));
  CHECK_FALSE(see(felt(6, 1, 3, 3)));  // at a silent sample
  CHECK(see(felt(6, 1, 4, 4)));
  CHECK_FALSE(see(silent(none, none)));
  CHECK_FALSE(see(silent(none, none)));
  CHECK_FALSE(see(felt(6, 9, 8, 8)));  // was at this place, or not pressed
  CHECK_FALSE(see(felt(7, 9, 8, 8)));
  CHECK(see(felt(7, 10, 9, 9)));
}

TEST_CASE("pre-slip: the shortest history", "[preslip]") {
  Preslip<> preslip(1, {.rule = PreslipRule::printed_grasp_optimise, .history = 2});
  const auto see = [&](const Sample& sample) {
    return preslip(Hand<1>{sample}) == PreslipStatus::preslip;
  };
  CHECK_FALSE(see(felt(3, 5)));
  CHECK(see(felt(4, 5)));
  CHECK_FALSE(see(felt(4, 5)));
  CHECK(see(felt(3, 5)));
  CHECK_FALSE(see(silent()));
  CHECK_FALSE(see(felt(4, 5)));
}

TEST_CASE("pre-slip: a copy goes its own way", "[preslip]") {
  Preslip<> preslip(1, {.rule = PreslipRule::printed_grasp_optimise, .history = 8});
  const auto see = [](Preslip<>& of, const Sample& sample) {
    return of(Hand<1>{sample}) == PreslipStatus::preslip;
  };
  const Sample nothing = silent(none, none), first = felt(1, 2, 0, 0), second = felt(2, 2, 1, 1);
  CHECK_FALSE(see(preslip, first));
  auto copy = preslip;
  CHECK(see(preslip, second));
  CHECK_FALSE(see(copy, nothing));
  const auto before = copy;
  CHECK(see(copy, second));
  copy.reset();
  CHECK_FALSE(see(copy, second));
  copy = before;
  CHECK(see(copy, second));
}

TEST_CASE("pre-slip: a sample that is refused, or of another hand, is not added", "[preslip]") {
  Preslip<> preslip(2, {.rule = PreslipRule::printed_grasp_optimise, .history = 2});
  Sample refused;
  refused.status = TaxelStatus::refused;
  CHECK(preslip(all<2>(felt(3, 5))) == PreslipStatus::steady);
  CHECK(preslip(Hand<2>{felt(4, 5), refused}) == PreslipStatus::cannot_tell);
  CHECK(preslip(all<1>(felt(4, 5))) == PreslipStatus::cannot_tell);
  CHECK(preslip(all<3>(felt(4, 5))) == PreslipStatus::cannot_tell);
  CHECK(preslip(all<2>(felt(4, 5))) == PreslipStatus::preslip);
}

TEST_CASE("pre-slip: bad parameters are refused by name, value and range", "[preslip]") {
  CHECK(refusal_of(Options{}) == "accepted");
  check_refused(&Options::history, "history", "in [2, 100000]");
  check_refused(&Options::min_waves, "min_waves", ">= 0");
  CHECK(with(&Options::history, 1) == "PreslipOptions: history = 1, must be in [2, 100000]");
  CHECK(with(&Options::history, 100001) ==
        "PreslipOptions: history = 100001, must be in [2, 100000]");
  CHECK(with(&Options::history, 2) == "accepted");
  CHECK(with(&Options::history, min_index) != "accepted");
  CHECK(with(&Options::min_waves, -1) == "PreslipOptions: min_waves = -1, must be >= 0");
  CHECK(with(&Options::min_waves, 0) == "accepted");
  CHECK(with(&Options::min_waves, max_index) == "accepted");
  const auto tolerance = [](double mm) { return Options{.centroid_tolerance_mm = mm}; };
  for (const double bad : {-0.1, none, infinity, -infinity}) {
    CAPTURE(bad);
    CHECK(
        test::begins_with(refusal_of(tolerance(bad)), "PreslipOptions: centroid_tolerance_mm = "));
  }
  CHECK(refusal_of(tolerance(-0.5)) ==
        "PreslipOptions: centroid_tolerance_mm = -0.5, must be finite and >= 0");
  CHECK(refusal_of(tolerance(0)) == "accepted");
}

TEST_CASE("pre-slip: what is written down of itself", "[preslip]") {
  CHECK(Preslip<>(2, {.history = 7}).options().history == 7);
  CHECK(test::refusal([] { Preslip<>(0); }) == "Preslip: fingers = 0, must be in [1, 100]");
  CHECK(test::refusal([] { Preslip<>(101); }) == "Preslip: fingers = 101, must be in [1, 100]");
  CHECK(std::string(name_of(PreslipRule::grasp_lift)) == "grasp_lift");
  CHECK(std::string(name_of(PreslipRule::grasp_optimise)) == "grasp_optimise");
  CHECK(std::string(name_of(PreslipRule::printed_grasp_lift)) == "printed_grasp_lift");
  CHECK(std::string(name_of(PreslipRule::printed_grasp_optimise)) == "printed_grasp_optimise");
}

TEST_CASE("rules take all taxels that vibrate", "[preslip]") {
  using List = std::vector<std::array<Index, 2>>;  // location and waves, strongest first
  const auto listed = [](const List& list, double x_mm = 0) {
    Sample sample = list.empty() ? silent(x_mm) : felt(list[0][0], list[0][1], x_mm);
    for (const auto& one : list) {
      sample.add_vibration(one[0], one[1]);
    }
    return sample;
  };
  const auto optimise = [&](const List& older, const List& later) {
    return holds(PreslipRule::grasp_optimise, Hand<1>{listed(older)}, Hand<1>{listed(later)});
  };
  CHECK(optimise({{3, 5}, {8, 2}}, {{3, 5}, {9, 2}}));        // 9 vibrates as 8 did
  CHECK(optimise({{3, 5}, {8, 5}}, {{3, 5}, {8, 5}}));        // two equal ones suffice
  CHECK(optimise({{3, 5}}, {{8, 2}, {4, 5}}));                // not the strongest
  CHECK_FALSE(optimise({{3, 5}, {8, 2}}, {{3, 5}, {8, 2}}));  // each as before
  CHECK_FALSE(optimise({{3, 5}, {8, 2}}, {{4, 6}, {9, 3}}));  // none equally fast
  CHECK_FALSE(optimise({{3, 5}}, {}));
  // a taxel of another finger is a different one, wherever it is
  const auto two = [&](const List& a, const List& b) { return Hand<2>{listed(a), listed(b)}; };
  CHECK(holds(PreslipRule::grasp_optimise, two({{3, 5}}, {{3, 5}}), two({{3, 5}}, {{3, 5}})));
  CHECK_FALSE(holds(PreslipRule::grasp_optimise, two({{3, 5}}, {{3, 6}}), two({{3, 5}}, {{3, 6}})));
  CHECK_FALSE(holds(PreslipRule::grasp_optimise, two({{3, 5}}, {{3, 5}}), two({{3, 5}}, {})));
  const auto lift = [&](const List& older, const List& later) {
    return holds(PreslipRule::grasp_lift, Hand<1>{listed(older, 1)}, Hand<1>{listed(later, 2)});
  };
  CHECK(lift({{3, 5}}, {{3, 5}, {8, 6}}));  // one more, which is faster
  CHECK(lift({}, {{8, 1}}));
  CHECK_FALSE(lift({{3, 5}}, {{3, 6}}));  // the same one, faster
  CHECK_FALSE(lift({{3, 5}}, {{8, 5}, {9, 4}}));
  CHECK_FALSE(lift({{3, 5}}, {}));
  CHECK_FALSE(holds(PreslipRule::grasp_lift, Hand<1>{listed({{3, 5}}, 1)},
                    Hand<1>{listed({{3, 5}, {8, 6}}, 1)}));  // force unchanged
  // more numbers of waves than are stored
  Sample many = felt(0, 1);
  for (Index k = 0; k < 40; ++k) {
    many.add_vibration(k, k + 1);
  }
  CHECK(many.vibration_count == 16);
}

TEST_CASE("a finger that cannot be judged makes no pair", "[preslip]") {
  const Sample older = felt(3, 4, 1, 1), later = felt(5, 6, 2, 2);
  CHECK(pair(PreslipRule::grasp_lift, older, later));
  for (const TaxelStatus status :
       {TaxelStatus::filling, TaxelStatus::no_taxels, TaxelStatus::frozen, TaxelStatus::too_weak,
        TaxelStatus::clock_jumps}) {
    Sample bad = later, was_bad = older;
    bad.status = was_bad.status = status;
    CHECK_FALSE(pair(PreslipRule::grasp_lift, older, bad));
    CHECK_FALSE(pair(PreslipRule::grasp_lift, was_bad, later));
    Preslip<> preslip(2);
    CHECK(preslip(Hand<2>{older, bad}) == PreslipStatus::cannot_tell);
    CHECK(preslip(Hand<2>{later, bad}) == PreslipStatus::preslip);  // the other finger slips
    CHECK(preslip(Hand<2>{older, older}) == PreslipStatus::steady);
  }
  Sample restless = later;
  restless.has_rested = false;
  CHECK_FALSE(pair(PreslipRule::grasp_lift, older, restless));
  CHECK(std::string(name_of(PreslipStatus::cannot_tell)) == "cannot tell");
  CHECK(std::string(name_of(PreslipStatus::steady)) == "steady");
  CHECK(std::string(name_of(PreslipStatus::preslip)) == "preslip");
  CHECK(std::string(name_of(PreslipStatus::slipped)) == "slipped");
  CHECK(std::string(name_of(static_cast<PreslipStatus>(9))) == "unknown");
}

TEST_CASE("finger sample: when it is pressed, and when it vibrates", "[preslip]") {
  const Sample empty;
  CHECK_FALSE(empty.is_pressed());
  CHECK_FALSE(empty.is_vibrating());
  CHECK(empty.status == TaxelStatus::filling);
  CHECK(felt(0, 1).is_vibrating());
  CHECK_FALSE(felt(0, 0).is_vibrating());
  CHECK_FALSE(felt(nowhere, 1).is_vibrating());
  CHECK(felt(0, 1, 0, 0).is_pressed());
  CHECK_FALSE(felt(0, 1, none, 0).is_pressed());
  CHECK_FALSE(felt(0, 1, 0, infinity).is_pressed());
  CHECK(std::string(name_of(TaxelStatus::vibrating)) == "vibrating");
  CHECK(std::string(name_of(TaxelStatus::quiet)) == "quiet");
  CHECK(std::string(name_of(TaxelStatus::filling)) == "filling");
  CHECK(std::string(name_of(TaxelStatus::no_taxels)) == "no taxels");
  CHECK(std::string(name_of(TaxelStatus::refused)) == "refused");
  CHECK(std::string(name_of(static_cast<TaxelStatus>(99))) == "unknown");
}
