// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every history: the stack as printed and the newest sample's pairs give the same
// alarms, some changes do not matter, and others can only add an alarm.
// RC_PARAMS="max_success=1000000" tries a million histories.
#include "fingerpad/foam/preslip.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "fingerpad/foam/holding_force.hpp"
#include "support/allocations.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr Index nowhere = FingerSample<>::no_location;
constexpr Index max_index = (std::numeric_limits<Index>::max)();
constexpr Index min_index = (std::numeric_limits<Index>::min)();

using Sample = FingerSample<double>;
template <std::size_t Fingers, class S = double>
using Hand = std::array<FingerSample<S>, Fingers>;
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

template <class Fingers>
bool holds(PreslipRule rule, const Fingers& older, const Fingers& later, Options options = {}) {
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

TEST_CASE("grasp-lift: every clause of the rule is needed", "[preslip]") {
  const PreslipRule rule = PreslipRule::grasp_lift;
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
  CHECK(holds(PreslipRule::grasp_lift, older, Hand<2>{pair_of_0, older[1]}));
  CHECK(holds(PreslipRule::grasp_lift, older, Hand<2>{older[0], pair_of_0}));
  CHECK(holds(PreslipRule::grasp_lift, older, Hand<2>{pair_of_0, felt(nowhere, 0, none, none)}));
  CHECK(holds(PreslipRule::grasp_lift, older, Hand<2>{felt(nowhere, 0, none, none), pair_of_0}));
  CHECK_FALSE(holds(PreslipRule::grasp_lift, older, older));
  // location and waves of one finger, centroid of the other
  CHECK_FALSE(holds(PreslipRule::grasp_lift, older, Hand<2>{felt(5, 6, 1, 1), felt(7, 4, 2, 2)}));
  CHECK_FALSE(holds(PreslipRule::grasp_lift, older, Hand<2>{felt(5, 4, 2, 2), felt(7, 6, 2, 2)}));
}

TEST_CASE("centroids differ from beyond the tolerance on", "[preslip]") {
  const double tolerance = 0.25;
  const Options options{.centroid_tolerance_mm = tolerance};
  const auto moved = [&](double x_mm, double y_mm) {
    return pair(PreslipRule::grasp_lift, felt(3, 4, 1, 1), felt(5, 6, 1 + x_mm, 1 + y_mm), options);
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
  CHECK_FALSE(pair(PreslipRule::grasp_lift, felt(3, 4, 0, 1), felt(5, 6, -0.0, 1), exact));
  CHECK(pair(PreslipRule::grasp_lift, felt(3, 4, 0, 1), felt(5, 6, 5e-324, 1), exact));
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
    return pair(PreslipRule::grasp_lift, felt(3, before, 0, 0), felt(4, now, 1, 1),
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
    return pair(PreslipRule::grasp_lift, felt(3, older, 0, 0), felt(4, later, 1, 1), options);
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
  CHECK(pair(PreslipRule::grasp_lift, felt(min_index, 2, 0, 0), felt(4, 3, 1, 1)));
  CHECK_FALSE(pair(PreslipRule::grasp_lift, felt(4, 2, 0, 0), felt(-7, 3, 1, 1)));
  CHECK(pair(PreslipRule::printed_grasp_optimise, felt(max_index, 2), felt(4, 2)));
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
  CHECK(test::refusal([] { Preslip<>(0); }) == "Preslip: fingers = 0, must be in [1, 100]");
  CHECK(test::refusal([] { Preslip<>(101); }) == "Preslip: fingers = 101, must be in [1, 100]");
}

TEST_CASE("grasp-optimise takes all taxels that vibrate", "[preslip]") {
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
}

namespace {

template <std::size_t Fingers>
using History = std::vector<Hand<Fingers>>;
using Results = std::vector<bool>;  // whether each sample is pre-slip

constexpr std::array<PreslipRule, 3> all_rules = {
    PreslipRule::grasp_lift, PreslipRule::grasp_optimise, PreslipRule::printed_grasp_optimise};

/// A fast source of many random integers. Only the seed is RapidCheck's, so a failing case shrinks
/// to a short history with few values.
class Bits {
 public:
  Bits() : bits_(static_cast<std::uint64_t>(test::whole(0, std::ptrdiff_t(1) << 40))) {}
  explicit Bits(std::uint64_t seed) : bits_(seed) {}
  Index operator()(Index low, Index high) {
    const auto count = static_cast<std::uint64_t>(high - low + 1);
    return low + static_cast<Index>(bits_() % count);
  }

 private:
  std::mt19937_64 bits_;
};

/// Few values of each kind, so equal ones are frequent.
struct Values {
  Index locations = test::whole(1, 4);
  Index waves = test::whole(0, 5);
  Index places = test::whole(0, 3);
  Index odd = test::whole(4, 40);  // one sample in `odd` is silent, one is not pressed
};

FingerSample<double> any_sample(const Values& values, Bits& bits) {
  FingerSample<double> sample;
  sample.status = TaxelStatus::vibrating;
  if (bits(0, values.odd) != 0) {
    const Index waves = bits(0, values.odd) == 0 ? 0 : bits(0, values.waves);
    sample.add_vibration(bits(0, values.locations), waves);
  }
  // in quarters of a tolerance: equal, in the cell, at its edge, and beyond it
  sample.center_x_mm = static_cast<double>(bits(-values.places, values.places)) / 16;
  sample.center_y_mm = static_cast<double>(bits(-values.places, values.places)) / 16;
  for (Index k = bits(0, 3); k-- > 0 && sample.location >= 0;) {
    sample.add_vibration(bits(0, values.locations), bits(0, values.waves));
  }
  if (bits(0, values.odd) == 0) {
    (bits(0, 1) == 0 ? sample.center_x_mm : sample.center_y_mm) = none;
  }
  return sample;
}

template <std::size_t Fingers>
History<Fingers> any_history(Index max_samples = 40) {
  const Values values;
  History<Fingers> history(static_cast<std::size_t>(test::whole(1, max_samples)));
  Bits bits;
  for (Hand<Fingers>& hand : history) {
    for (auto& sample : hand) {
      sample = any_sample(values, bits);
    }
  }
  return history;
}

Options any_options() {
  return {.history = test::whole(2, 14),
          .min_waves = test::whole(0, 2),
          .centroid_tolerance_mm = static_cast<double>(test::whole(1, 4)) / 16};
}

Options with(PreslipRule rule, Options options) {
  options.rule = rule;
  return options;
}

template <std::size_t Fingers>
Results run(PreslipRule rule, const History<Fingers>& history, const Options& options) {
  Preslip<> preslip(Fingers, with(rule, options));
  Results results;
  for (const auto& hand : history) {
    results.push_back(preslip(hand) == PreslipStatus::preslip);
  }
  return results;
}

struct Pair {
  std::size_t older;
  std::size_t later;
};
/// The scan of the stack as printed, with E042: index 1 runs from the oldest sample up, and index 2
/// from the newest sample down to index 1.
template <std::size_t Fingers>
std::vector<Pair> pairs_in_stack(const History<Fingers>& history,
                                 std::size_t oldest,
                                 std::size_t last,
                                 const Options& options) {
  std::vector<Pair> pairs;
  for (std::size_t index_1 = oldest; index_1 < last; ++index_1) {
    for (std::size_t index_2 = last; index_2 > index_1; --index_2) {
      if (is_preslip(history[index_1], history[index_2], options)) {
        pairs.push_back({index_1, index_2});
      }
    }
  }
  return pairs;
}

/// Whether the newest sample is pre-slip where it makes a pair in the stack, and the stack holds
/// one first in a sample that is pre-slip; with resets before the samples of these numbers.
template <std::size_t Fingers>
bool searches_agree(const History<Fingers>& history,
                    const std::vector<bool>& resets,
                    const Options& options) {
  Preslip<> newest(Fingers, options);
  const auto length = static_cast<std::size_t>(options.history);
  std::size_t first = 0;
  bool had_pair = false;
  for (std::size_t k = 0; k < history.size(); ++k) {
    if (resets[k]) {
      newest.reset();
      first = k;
      had_pair = false;
    }
    const std::size_t oldest = (std::max)(first, k + 1 > length ? k + 1 - length : 0);
    const auto pairs = pairs_in_stack(history, oldest, k, options);
    const bool is_new =
        std::any_of(pairs.begin(), pairs.end(), [k](const Pair& pair) { return pair.later == k; });
    const bool alarms = newest(history[k]) == PreslipStatus::preslip;
    if (alarms != is_new || (!pairs.empty() && !had_pair && !alarms)) {
      return false;
    }
    had_pair = !pairs.empty();
  }
  return true;
}

template <std::size_t Fingers>
void check_searches() {
  const History<Fingers> history = any_history<Fingers>();
  const Options options = any_options();
  const Index often = test::whole(5, 200);
  std::vector<bool> resets(history.size(), false);
  Bits bits;
  for (std::size_t k = 0; k < resets.size(); ++k) {
    resets[k] = bits(0, often) == 0;
  }
  for (const PreslipRule rule : all_rules) {
    RC_ASSERT(searches_agree(history, resets, with(rule, options)));
  }
}

}  // namespace

TEST_CASE("pre-slip: the newest sample finds what the stack as printed does", "[preslip][law]") {
  rc::prop("on one finger", [] { check_searches<1>(); });
  rc::prop("on two fingers", [] { check_searches<2>(); });
  rc::prop("on three fingers", [] { check_searches<3>(); });
}

TEST_CASE("pre-slip: the order of the fingers does not matter", "[preslip][law]") {
  rc::prop("for any history", [] {
    const auto history = any_history<3>();
    const Options options = any_options();
    std::array<std::size_t, 3> order{0, 1, 2};
    const auto turns = test::whole(1, 5);
    for (int k = 0; k < turns; ++k) {
      std::next_permutation(order.begin(), order.end());
    }
    auto permuted = history;
    for (std::size_t k = 0; k < history.size(); ++k) {
      for (std::size_t f = 0; f < 3; ++f) {
        permuted[k][f] = history[k][order[f]];
      }
    }
    for (const PreslipRule rule : all_rules) {
      RC_ASSERT(run(rule, history, options) == run(rule, permuted, options));
    }
  });
}

namespace {

constexpr double largest = (std::numeric_limits<double>::max)();

template <class S = double>
FingerSample<S> felt(Index location, Index waves, double x_mm = 0, double y_mm = 0) {
  FingerSample<S> sample;
  sample.status = TaxelStatus::vibrating;
  if (location >= 0) {
    sample.add_vibration(location, waves);
  }
  sample.location = location;
  sample.waves = waves;
  sample.center_x_mm = S(x_mm);
  sample.center_y_mm = S(y_mm);
  return sample;
}

}  // namespace

TEST_CASE("pre-slip: the newest sample is compared with all others at the ends of the range",
          "[preslip]") {
  const double ends[] = {0,    -0.0,     5e-324, -5e-324,     1e-300,  0.05,  -0.05,     0.0500001,
                         0.15, 1e8,      -1e8,   1e8 + 0.049, 1e8 - 1, 1e300, -largest,  largest,
                         none, infinity, 1,      -infinity,   1e9,     -1e9,  123456.75, 5e7};
  const Index far[] = {(std::numeric_limits<Index>::min)(), -2, -1, 0, 1, 2, 63, 64, 65, 70,
                       (std::numeric_limits<Index>::max)()};
  for (const double tolerance_mm : {5e-324, 1e-300, 0.1, 1.0, 1e300, largest}) {
    for (const PreslipRule rule : {PreslipRule::grasp_lift, PreslipRule::printed_grasp_optimise}) {
      CAPTURE(tolerance_mm, name_of(rule));
      const Options options{.rule = rule, .history = 9, .centroid_tolerance_mm = tolerance_mm};
      Preslip<> preslip(2, options);
      Bits bits(11);
      std::vector<Hand<2>> history;
      int differ = 0;
      for (int k = 0; k < 2000; ++k) {
        Hand<2> now;
        for (auto& sample : now) {
          sample = felt(far[bits(0, 10)], far[bits(0, 10)], ends[bits(0, 23)], ends[bits(0, 23)]);
        }
        bool pairs = false;
        for (std::size_t ago = 1; ago < 9 && ago <= history.size(); ++ago) {
          pairs = pairs || is_preslip(history[history.size() - ago], now, options);
        }
        differ += (preslip(now) == PreslipStatus::preslip) == pairs ? 0 : 1;
        history.push_back(now);
      }
      CHECK(differ == 0);
    }
  }
}

TEMPLATE_TEST_CASE("pre-slip: the same answers in any number",
                   "[preslip]",
                   float,
                   long double,
                   test::Digits50,
                   test::Tangent<double>) {
  using S = TestType;
  const auto check = [](PreslipRule rule) {
    const Options options{.rule = rule, .history = 12, .centroid_tolerance_mm = 0.125};
    Preslip<S> preslip(2, options);
    Preslip<> reference(2, options);
    Bits bits(5);
    int alarms = 0, differ = 0;
    Hand<2, S> last;
    Hand<2> reference_last;
    for (int k = 0; k < 400; ++k) {
      Hand<2, S> now;
      Hand<2> reference_now;
      for (std::size_t f = 0; f < 2; ++f) {
        const Index location = bits(-1, 2), waves = bits(0, 3);
        const double x = bits(0, 9) == 0 ? none : static_cast<double>(bits(-3, 3)) / 16;
        const double y = static_cast<double>(bits(-3, 3)) / 16;
        now[f] = felt<S>(location, waves, x, y);
        reference_now[f] = felt(location, waves, x, y);
      }
      const PreslipStatus status = reference(reference_now);
      differ += preslip(now) == status ? 0 : 1;
      differ += is_preslip(last, now, options) == is_preslip(reference_last, reference_now, options)
                    ? 0
                    : 1;
      alarms += status == PreslipStatus::preslip ? 1 : 0;
      last = now;
      reference_last = reference_now;
    }
    CHECK(differ == 0);
    CHECK(alarms > 10);
    CHECK(alarms < 400);
  };
  check(PreslipRule::printed_grasp_optimise);
  check(PreslipRule::grasp_lift);
}

TEST_CASE("searches for the holding force: nothing is allocated", "[holding_force]") {
  const long before = test::allocations();
  LoosenUntilPreslip<> loosen;
  LiftWithRegrip<> lift;
  for (int k = 0; k < 300; ++k) {
    const auto signal = k % 40 == 39 ? PreslipStatus::preslip : PreslipStatus::steady;
    (void)loosen(k > 200 ? signal : PreslipStatus::steady);
    (void)lift(signal);
  }
  CHECK(test::allocations() == before);
  CHECK(loosen.command().phase == SearchPhase::found);
  CHECK(lift.command().steps > 0);
}
