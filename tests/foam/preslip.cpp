// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/foam/preslip.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "fingerpad/published/preslip.hpp"
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
using Options = PreslipOptions<double>;
Sample felt(Index location, Index waves, double x_mm = 0, double y_mm = 0) {
  Sample sample;
  sample.status = location >= 0 ? TaxelStatus::vibrating : TaxelStatus::quiet;
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

template <class Rule>
bool pair(const Sample& older, const Sample& later, const Options& options = {}) {
  return is_preslip<Rule>(Hand<1>{older}, Hand<1>{later}, options);
}

/// Alarm, whether it is fresh, and its age in samples.
using Answer = std::array<std::int64_t, 3>;
Answer answer(const PreslipResult& r) {
  return {r.alarm ? 1 : 0, r.is_fresh ? 1 : 0, r.samples_ago};
}
constexpr Answer no_alarm{0, 0, PreslipResult::none};
Answer fresh(std::int64_t samples_ago) {
  return {1, 1, samples_ago};
}
Answer stands(std::int64_t samples_ago) {
  return {1, 0, samples_ago};
}

template <std::size_t Fingers>
Hand<Fingers> all(const Sample& sample) {
  Hand<Fingers> hand;
  hand.fill(sample);
  return hand;
}

/// A rule and its search method.
template <class Rule_>
struct ByNewest {
  using Rule = Rule_;
  template <std::size_t Fingers>
  using Detector = Preslip<Rule, Fingers>;
};
template <class Rule_>
struct ByScan {
  using Rule = Rule_;
  template <std::size_t Fingers>
  using Detector = published::StackScan<Rule, Fingers>;
};

template <class Options_>
std::string refusal_of(const Options_& options) {
  return test::refusal([&] { Preslip<>{options}; });
}

void check_refused(Index Options::*field, const std::string& name, const std::string& range) {
  for (const Index given :
       {min_index, Index(-1), Index(0), Index(1), Index(65537), Index(100001), max_index}) {
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
  using Rule = published::GraspOptimise;
  const Hand<2> older{felt(3, 5), felt(8, 2)};
  const Hand<2> later{felt(4, 5), felt(9, 2)};
  CHECK(is_preslip<Rule>(older, later));
  CHECK(is_preslip<Rule>(later, older));  // equal waves have no order
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
    CHECK_FALSE(is_preslip<Rule>(older, changed(later, elsewhere)));
    CHECK_FALSE(is_preslip<Rule>(older, changed(later, more)));
    CHECK_FALSE(is_preslip<Rule>(older, changed(later, fewer)));
    CHECK_FALSE(is_preslip<Rule>(older, changed(later, lost)));
    CHECK_FALSE(is_preslip<Rule>(changed(older, lost), later));
    CHECK_FALSE(is_preslip<Rule>(changed(older, none_seen), changed(later, none_seen)));
    // the position of the force does not matter, nor whether there is any
    const auto unpressed = [](Sample& s) { s.center_x_mm = none; };
    const auto far = [](Sample& s) { s.center_y_mm = 1e300; };
    CHECK(is_preslip<Rule>(older, changed(later, unpressed)));
    CHECK(is_preslip<Rule>(changed(older, far), later));
    // waves are not compared across fingers
    CHECK(is_preslip<Rule>(changed(older, more), changed(later, more)));
  }
  // locations are not compared across fingers
  CHECK(is_preslip<Rule>(Hand<2>{felt(3, 5), felt(4, 5)}, Hand<2>{felt(4, 5), felt(3, 5)}));
}

TEST_CASE("grasp-optimise: the last of three fingers counts as the first", "[preslip]") {
  const Hand<3> older{felt(1, 2), felt(1, 3), felt(1, 4)};
  const Hand<3> later{felt(2, 2), felt(2, 3), felt(2, 4)};
  CHECK(is_preslip<published::GraspOptimise>(older, later));
  for (std::size_t finger = 0; finger < 3; ++finger) {
    Hand<3> same = later;
    same[finger].location = 1;
    CHECK_FALSE(is_preslip<published::GraspOptimise>(older, same));
  }
}

TEST_CASE("grasp-lift: every clause of the rule is needed", "[preslip]") {
  using Rule = published::GraspLift;
  const Sample older = felt(3, 4, 1, 1), later = felt(5, 6, 2, 2);
  CHECK(pair<Rule>(older, later));
  CHECK_FALSE(pair<Rule>(later, older));                    // waves fall
  CHECK_FALSE(pair<Rule>(older, felt(3, 6, 2, 2)));         // location
  CHECK_FALSE(pair<Rule>(older, felt(5, 4, 2, 2)));         // waves
  CHECK_FALSE(pair<Rule>(older, felt(5, 3, 2, 2)));         // waves
  CHECK_FALSE(pair<Rule>(older, felt(5, 6, 1, 1)));         // centroid
  CHECK_FALSE(pair<Rule>(older, felt(nowhere, 6, 2, 2)));   // no vibration now
  CHECK_FALSE(pair<Rule>(older, felt(5, 6, none, 2)));      // no pressure
  CHECK_FALSE(pair<Rule>(older, felt(5, 6, 2, infinity)));  // the same
  CHECK_FALSE(pair<Rule>(felt(3, 4, 1, none), later));
  CHECK_FALSE(pair<Rule>(felt(3, 4, -infinity, 1), later));
  // a silent finger had no location, which differs from any location
  CHECK(pair<Rule>(silent(1, 1), later));
  CHECK(pair<Rule>(silent(1, 1), felt(0, 1, 2, 2)));
  CHECK_FALSE(pair<Rule>(later, silent(1, 1)));
  CHECK_FALSE(pair<Rule>(silent(1, 1), silent(2, 2)));
  // waves counted before the location was lost still count
  CHECK_FALSE(pair<Rule>(felt(nowhere, 6, 1, 1), later));
}

TEST_CASE("grasp-lift: one finger is enough, but it must fulfil the whole rule", "[preslip]") {
  const Hand<2> older{felt(3, 4, 1, 1), felt(7, 4, 1, 1)};
  const Sample pair_of_0 = felt(5, 6, 2, 2);
  CHECK(is_preslip<published::GraspLift>(older, Hand<2>{pair_of_0, older[1]}));
  CHECK(is_preslip<published::GraspLift>(older, Hand<2>{older[0], pair_of_0}));
  CHECK(is_preslip<published::GraspLift>(older, Hand<2>{pair_of_0, felt(nowhere, 0, none, none)}));
  CHECK(is_preslip<published::GraspLift>(older, Hand<2>{felt(nowhere, 0, none, none), pair_of_0}));
  CHECK_FALSE(is_preslip<published::GraspLift>(older, older));
  // location and waves of one finger, centroid of the other
  CHECK_FALSE(is_preslip<published::GraspLift>(older, Hand<2>{felt(5, 6, 1, 1), felt(7, 4, 2, 2)}));
  CHECK_FALSE(is_preslip<published::GraspLift>(older, Hand<2>{felt(5, 4, 2, 2), felt(7, 6, 2, 2)}));
}

TEST_CASE("centroids differ from beyond the tolerance on", "[preslip]") {
  const double tolerance = 0.25;
  const Options options{.centroid_tolerance_mm = tolerance};
  const auto moved = [&](double x_mm, double y_mm) {
    return pair<published::GraspLift>(felt(3, 4, 1, 1), felt(5, 6, 1 + x_mm, 1 + y_mm), options);
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
  CHECK_FALSE(pair<published::GraspLift>(felt(3, 4, 0, 1), felt(5, 6, -0.0, 1), exact));
  CHECK(pair<published::GraspLift>(felt(3, 4, 0, 1), felt(5, 6, 5e-324, 1), exact));
}

TEST_CASE("centroids differ along any axis", "[preslip]") {
  const auto differ = [](double x_mm, double y_mm) {
    return pair<published::GraspLift>(felt(3, 4, 1, 1), felt(5, 6, 1 + x_mm, 1 + y_mm));
  };
  CHECK_FALSE(differ(0, 0));
  CHECK(differ(1, 0));
  CHECK(differ(0, -1));
  CHECK(differ(1, -1));
  CHECK(differ(-1, 1));
}

TEST_CASE("samples with fewer waves than asked for are silent", "[preslip]") {
  const auto optimise = [](Index waves, Index least) {
    return pair<published::GraspOptimise>(felt(3, waves), felt(4, waves), {.min_waves = least});
  };
  CHECK(optimise(0, 0));  // as published: two missing locations are equal
  CHECK_FALSE(optimise(0, 1));
  CHECK(optimise(1, 1));
  CHECK_FALSE(optimise(1, 2));
  CHECK(optimise(2, 2));
  // a sample without a location makes no pair, whatever min_waves
  CHECK_FALSE(pair<published::GraspOptimise>(silent(), felt(4, 0), {.min_waves = 0}));
  CHECK_FALSE(pair<published::GraspOptimise>(felt(4, 0), silent(), {.min_waves = 0}));
  const auto lift = [](Index before, Index now, Index least) {
    return pair<published::GraspLift>(felt(3, before, 0, 0), felt(4, now, 1, 1),
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
    return pair<published::GraspOptimise>(felt(3, older), felt(4, later), options);
  };
  const auto lift = [&](Index older, Index later, const Options& options) {
    return pair<published::GraspLift>(felt(3, older, 0, 0), felt(4, later, 1, 1), options);
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
  CHECK_FALSE(pair<published::GraspOptimise>(felt(-7, 2), felt(4, 2)));
  CHECK_FALSE(pair<published::GraspOptimise>(felt(4, 2), felt(min_index, 2)));
  CHECK(pair<published::GraspLift>(felt(min_index, 2, 0, 0), felt(4, 3, 1, 1)));
  CHECK_FALSE(pair<published::GraspLift>(felt(4, 2, 0, 0), felt(-7, 3, 1, 1)));
  CHECK(pair<published::GraspOptimise>(felt(max_index, 2), felt(4, 2)));
}

TEMPLATE_TEST_CASE("pre-slip: an alarm begins with a pair and stands until its older sample leaves",
                   "[preslip]",
                   ByScan<published::GraspOptimise>,
                   ByNewest<published::GraspOptimise>) {
  using Detector = typename TestType::template Detector<2>;
  const Detector preslip({.history = 5});
  auto state = preslip.start();
  const auto see = [&](const Sample& sample) { return answer(preslip(all<2>(sample), state)); };
  CHECK(see(felt(3, 5)) == no_alarm);  // no sample to compare with
  CHECK(see(felt(3, 5)) == no_alarm);
  CHECK(see(felt(4, 5)) == fresh(1));
  CHECK(see(silent()) == stands(2));
  CHECK(see(silent()) == stands(3));
  CHECK(see(silent()) == stands(4));
  CHECK(see(silent()) == no_alarm);
  CHECK(see(silent()) == no_alarm);  // only the sample at 4 and silence
  // another pair prolongs the alarm
  CHECK(see(felt(1, 2)) == no_alarm);
  CHECK(see(felt(2, 2)) == fresh(1));
  CHECK(see(felt(2, 3)) == stands(2));
  CHECK(see(felt(2, 2)) == fresh(3));  // with the older sample, which is still stored
  CHECK(see(felt(1, 2)) == fresh(1));
  CHECK(see(felt(2, 3)) == stands(2));
  CHECK(see(felt(1, 2)) == fresh(3));  // not with the previous sample, which is at the same place
  CHECK(see(silent()) == stands(4));
  CHECK(see(silent()) == no_alarm);

  state.reset();
  CHECK(see(felt(3, 5)) == no_alarm);
  CHECK(see(silent()) == no_alarm);
  CHECK(see(silent()) == no_alarm);
  CHECK(see(silent()) == no_alarm);
  CHECK(see(felt(4, 5)) == fresh(4));  // the oldest sample of the history
  state.reset();
  CHECK(see(felt(3, 5)) == no_alarm);  // all samples are forgotten
  CHECK(see(silent()) == no_alarm);
  CHECK(see(silent()) == no_alarm);
  CHECK(see(silent()) == no_alarm);
  CHECK(see(silent()) == no_alarm);
  CHECK(see(felt(4, 5)) == no_alarm);  // the first sample has left
}

TEMPLATE_TEST_CASE("pre-slip: what a lift stirs up and how long it stands",
                   "[preslip]",
                   ByScan<published::GraspLift>,
                   ByNewest<published::GraspLift>) {
  using Detector = typename TestType::template Detector<2>;
  const Detector preslip({.history = 4});
  auto state = preslip.start();
  const auto see = [&](const Sample& sample) {
    return answer(preslip(Hand<2>{silent(5, 5), sample}, state));
  };
  CHECK(see(felt(3, 2, 1, 1)) == no_alarm);
  CHECK(see(felt(4, 2, 2, 2)) == no_alarm);  // not more waves
  CHECK(see(felt(4, 3, 2, 2)) == fresh(2));  // than the first, elsewhere
  CHECK(see(felt(5, 3, 3, 3)) == fresh(2));  // than the second
  CHECK(see(felt(5, 3, 3, 3)) == fresh(3));
  CHECK(see(felt(5, 2, 3, 3)) == no_alarm);
  CHECK(see(silent(3, 3)) == no_alarm);
  CHECK(see(felt(6, 1, 3, 3)) == no_alarm);  // at a silent sample
  CHECK(see(felt(6, 1, 4, 4)) == fresh(2));
  CHECK(see(silent(none, none)) == stands(3));
  CHECK(see(silent(none, none)) == no_alarm);
  CHECK(see(felt(6, 9, 8, 8)) == no_alarm);  // was at this place, or not pressed
  CHECK(see(felt(7, 9, 8, 8)) == no_alarm);
  CHECK(see(felt(7, 10, 9, 9)) == fresh(2));
}

TEMPLATE_TEST_CASE("pre-slip: the shortest history",
                   "[preslip]",
                   ByScan<published::GraspOptimise>,
                   ByNewest<published::GraspOptimise>) {
  const typename TestType::template Detector<1> preslip({.history = 2});
  auto state = preslip.start();
  const auto see = [&](const Sample& sample) { return answer(preslip({sample}, state)); };
  CHECK(see(felt(3, 5)) == no_alarm);
  CHECK(see(felt(4, 5)) == fresh(1));
  CHECK(see(felt(4, 5)) == no_alarm);
  CHECK(see(felt(3, 5)) == fresh(1));
  CHECK(see(silent()) == no_alarm);
  CHECK(see(felt(4, 5)) == no_alarm);
}

TEMPLATE_TEST_CASE("pre-slip: a copied state goes its own way",
                   "[preslip]",
                   ByScan<published::GraspOptimise>,
                   ByNewest<published::GraspOptimise>) {
  const typename TestType::template Detector<1> preslip({.history = 8});
  auto state = preslip.start();
  const Sample nothing = silent(none, none);
  const Sample first = felt(1, 2, 0, 0);
  const Sample second =
      felt(2, std::is_same_v<typename TestType::Rule, published::GraspOptimise> ? 2 : 3, 1, 1);
  CHECK(answer(preslip({first}, state)) == no_alarm);
  auto copy = state;
  CHECK(answer(preslip({second}, state)) == fresh(1));
  CHECK(answer(preslip({nothing}, copy)) == no_alarm);
  CHECK(answer(preslip({second}, copy)) == fresh(2));
  CHECK(answer(preslip({nothing}, state)) == stands(2));
  const auto before = copy;
  copy.reset();
  CHECK(answer(preslip({second}, copy)) == no_alarm);
  copy = before;
  CHECK(answer(preslip({nothing}, copy)) == stands(3));
  auto other = preslip.start();
  CHECK(answer(preslip({second}, other)) == no_alarm);
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
    CHECK(
        test::begins_with(test::refusal([&] { Preslip<published::GraspOptimise>{tolerance(bad)}; }),
                          "PreslipOptions: centroid_tolerance_mm = "));
  }
  CHECK(refusal_of(tolerance(-0.5)) ==
        "PreslipOptions: centroid_tolerance_mm = -0.5, must be finite and >= 0");
  CHECK(refusal_of(tolerance(0)) == "accepted");
}

TEST_CASE("pre-slip: what is written down of itself", "[preslip]") {
  CHECK(Preslip<>({.history = 7}).options().history == 7);
  STATIC_REQUIRE(std::is_same_v<Preslip<>, Preslip<GraspLift, 2, double>>);
  STATIC_REQUIRE(std::is_copy_assignable_v<Preslip<>::State>);
  STATIC_REQUIRE(PreslipResult::none == -1);
  CHECK(std::string(GraspOptimise::name) == "grasp_optimise");
  CHECK(std::string(GraspLift::name) == "grasp_lift");
  CHECK(answer(PreslipResult()) == no_alarm);
}

TEST_CASE("rules take all taxels that vibrate", "[preslip]") {
  using List = std::vector<std::array<Index, 2>>;  // location and waves, strongest first
  const auto listed = [](const List& list, double x_mm = 0) {
    Sample sample = list.empty() ? silent(x_mm) : felt(list[0][0], list[0][1], x_mm);
    for (const auto& one : list) {
      sample.add_vibration({one[1], one[0]});
    }
    return sample;
  };
  const auto optimise = [&](const List& older, const List& later) {
    return is_preslip<GraspOptimise>(Hand<1>{listed(older)}, Hand<1>{listed(later)});
  };
  CHECK(optimise({{3, 5}, {8, 2}}, {{3, 5}, {9, 2}}));        // 9 vibrates as 8 did
  CHECK(optimise({{3, 5}, {8, 5}}, {{3, 5}, {8, 5}}));        // two equal ones suffice
  CHECK(optimise({{3, 5}}, {{8, 2}, {4, 5}}));                // not the strongest
  CHECK_FALSE(optimise({{3, 5}, {8, 2}}, {{3, 5}, {8, 2}}));  // each as before
  CHECK_FALSE(optimise({{3, 5}, {8, 2}}, {{4, 6}, {9, 3}}));  // none equally fast
  CHECK_FALSE(optimise({{3, 5}}, {}));
  // a taxel of another finger is a different one, wherever it is
  const auto two = [&](const List& a, const List& b) { return Hand<2>{listed(a), listed(b)}; };
  CHECK(is_preslip<GraspOptimise>(two({{3, 5}}, {{3, 5}}), two({{3, 5}}, {{3, 5}})));
  CHECK_FALSE(is_preslip<GraspOptimise>(two({{3, 5}}, {{3, 6}}), two({{3, 5}}, {{3, 6}})));
  CHECK_FALSE(is_preslip<GraspOptimise>(two({{3, 5}}, {{3, 5}}), two({{3, 5}}, {})));
  const auto lift = [&](const List& older, const List& later) {
    return is_preslip<GraspLift>(Hand<1>{listed(older, 1)}, Hand<1>{listed(later, 2)});
  };
  CHECK(lift({{3, 5}}, {{3, 5}, {8, 6}}));  // one more, which is faster
  CHECK(lift({}, {{8, 1}}));
  CHECK_FALSE(lift({{3, 5}}, {{3, 6}}));  // the same one, faster
  CHECK_FALSE(lift({{3, 5}}, {{8, 5}, {9, 4}}));
  CHECK_FALSE(lift({{3, 5}}, {}));
  CHECK_FALSE(is_preslip<GraspLift>(Hand<1>{listed({{3, 5}}, 1)},
                                    Hand<1>{listed({{3, 5}, {8, 6}}, 1)}));  // force unchanged
  // more numbers of waves than are stored
  Sample many = felt(0, 1);
  for (Index k = 0; k < 40; ++k) {
    many.add_vibration({k + 1, k});
  }
  CHECK(many.vibration_count == 16);
}

TEST_CASE("a finger that cannot be judged makes no pair", "[preslip]") {
  const Sample older = felt(3, 4, 1, 1), later = felt(5, 6, 2, 2);
  CHECK(pair<GraspLift>(older, later));
  for (const TaxelStatus status :
       {TaxelStatus::filling, TaxelStatus::no_taxels, TaxelStatus::frozen, TaxelStatus::too_weak,
        TaxelStatus::clock_jumps, TaxelStatus::other_size, TaxelStatus::time_not_later}) {
    Sample bad = later, was_bad = older;
    bad.status = was_bad.status = status;
    CHECK_FALSE(pair<GraspLift>(older, bad));
    CHECK_FALSE(pair<GraspLift>(was_bad, later));
    const Preslip<> preslip;
    auto state = preslip.start();
    CHECK(preslip({older, bad}, state).status == PreslipStatus::cannot_tell);
    CHECK(preslip({later, bad}, state).status == PreslipStatus::preslip);  // the other finger slips
    CHECK(preslip({older, older}, state).status == PreslipStatus::steady);
  }
  Sample restless = later;
  restless.has_rested = false;
  CHECK_FALSE(pair<GraspLift>(older, restless));
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
  CHECK(std::string(name_of(TaxelStatus::other_size)) == "other size");
  CHECK(std::string(name_of(TaxelStatus::time_not_later)) == "time not later");
  CHECK(std::string(name_of(static_cast<TaxelStatus>(99))) == "unknown");
}
