// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every history: both searches give the rule's result for all pairs, some changes do
// not matter, and others can only add an alarm. RC_PARAMS="max_success=1000000" tries a million
// histories.
#include "fingerpad/foam/preslip.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <type_traits>
#include <utility>
#include <vector>

#include "fingerpad/published/preslip.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"

using namespace fingerpad;

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

using Options = PreslipOptions<double>;
template <std::size_t Fingers>
using Hand = std::array<FingerSample<double>, Fingers>;
template <std::size_t Fingers>
using History = std::vector<Hand<Fingers>>;
using Results = std::vector<PreslipResult>;

/// A fast source of many random integers. Only the seed is RapidCheck's, so a failing case shrinks
/// to a short history with few values.
class Bits {
 public:
  Bits() : bits_(static_cast<std::uint64_t>(test::whole(0, std::ptrdiff_t(1) << 40))) {}
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
  sample.location = bits(0, values.odd) == 0 ? -1 : bits(0, values.locations);
  sample.waves = bits(0, values.odd) == 0 ? 0 : bits(0, values.waves);
  // in quarters of a tolerance: equal, in the cell, at its edge, and beyond it
  sample.center_x_mm = static_cast<double>(bits(-values.places, values.places)) / 16;
  sample.center_y_mm = static_cast<double>(bits(-values.places, values.places)) / 16;
  for (Index k = bits(0, 3); k-- > 0 && sample.location >= 0;) {
    sample.add_vibration({sample.waves, sample.location, false});
    sample.add_vibration({bits(0, values.waves), bits(0, values.locations), bits(0, 4) == 0});
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

template <class Rule, std::size_t Fingers>
Results run(const History<Fingers>& history, const Options& options) {
  const Preslip<Rule, Fingers> preslip(options);
  auto state = preslip.start();
  Results results;
  for (const auto& hand : history) {
    results.push_back(preslip(hand, state));
  }
  return results;
}

bool equal(const PreslipResult& a, const PreslipResult& b) {
  return a.alarm == b.alarm && a.is_fresh == b.is_fresh && a.samples_ago == b.samples_ago;
}
bool equal(const Results& a, const Results& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& one, const auto& other) { return equal(one, other); });
}

/// Result of the predicate for all pairs among the last samples up to number `last`.
template <class Rule, std::size_t Fingers>
PreslipResult by_all_pairs(const History<Fingers>& history,
                           std::size_t first,
                           std::size_t last,
                           const Options& options) {
  const std::size_t length = static_cast<std::size_t>(options.history);
  const std::size_t oldest = (std::max)(first, last + 1 > length ? last + 1 - length : 0);
  PreslipResult result;
  for (std::size_t b = oldest; b <= last; ++b) {
    for (std::size_t a = oldest; a < b; ++a) {
      if (is_preslip<Rule>(history[a], history[b], options)) {
        const auto ago = static_cast<std::int64_t>(last - a);
        result.samples_ago = result.alarm ? (std::min)(result.samples_ago, ago) : ago;
        result.alarm = true;
        result.is_fresh = result.is_fresh || b == last;
      }
    }
  }
  return result;
}

/// Whether both searches agree on a history with resets before the samples of these numbers.
template <class Rule, std::size_t Fingers>
bool searches_agree(const History<Fingers>& history,
                    const std::vector<bool>& resets,
                    const Options& options) {
  const Preslip<Rule, Fingers> newest(options);
  const published::StackScan<Rule, Fingers> whole(options);
  auto of_newest = newest.start();
  auto of_whole = whole.start();
  std::size_t first = 0;
  for (std::size_t k = 0; k < history.size(); ++k) {
    if (resets[k]) {
      of_newest.reset();
      of_whole.reset();
      first = k;
    }
    const PreslipResult truth = by_all_pairs<Rule>(history, first, k, options);
    if (!equal(newest(history[k], of_newest), truth) ||
        !equal(whole(history[k], of_whole), truth)) {
      return false;
    }
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
  RC_ASSERT((searches_agree<published::GraspOptimise, Fingers>(history, resets, options)));
  RC_ASSERT((searches_agree<published::GraspLift, Fingers>(history, resets, options)));
  RC_ASSERT((searches_agree<GraspOptimise, Fingers>(history, resets, options)));
  RC_ASSERT((searches_agree<GraspLift, Fingers>(history, resets, options)));
}

/// Checks a property of the rules as printed, which have one location per finger.
template <class Check>
void for_printed_rules(const Check& check) {
  check(published::GraspOptimise());
  check(published::GraspLift());
}
template <class Check>
void for_all_rules(const Check& check) {
  for_printed_rules(check);
  check(GraspOptimise());
  check(GraspLift());
}

/// Whether b alarms wherever a does, and at least as long.
bool alarms_wherever(const Results& a, const Results& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& one, const auto& more) {
    return !one.alarm ||
           (more.alarm && more.samples_ago <= one.samples_ago && (more.is_fresh || !one.is_fresh));
  });
}

template <std::size_t Fingers, class Change>
History<Fingers> changed(History<Fingers> history, const Change& change) {
  for (auto& hand : history) {
    for (std::size_t f = 0; f < Fingers; ++f) {
      change(hand[f], f);
    }
  }
  return history;
}

}  // namespace

TEST_CASE("pre-slip: both searches find what the rule says of all pairs", "[preslip][law]") {
  rc::prop("on one finger", [] { check_searches<1>(); });
  rc::prop("on two fingers", [] { check_searches<2>(); });
  rc::prop("on three fingers", [] { check_searches<3>(); });
}

TEST_CASE("pre-slip: what does not matter", "[preslip][law]") {
  rc::prop("the names of the locations", [] {
    const auto history = any_history<2>();
    const Options options = any_options();
    const Index factor = test::whole(1, 1000), offset = test::whole(0, 1000);
    const auto renamed = changed(history, [&](auto& s, std::size_t f) {
      const auto rename = [&](Index& location) {
        location = location < 0
                       ? location
                       : (f == 0 ? 2000000 - factor * location : factor * location + offset);
      };
      rename(s.location);
      for (auto& one : s.vibrations) {
        rename(one.location);
      }
    });
    for_all_rules([&](auto rule) {
      RC_ASSERT(
          equal(run<decltype(rule)>(history, options), run<decltype(rule)>(renamed, options)));
    });
  });
  rc::prop("the order of the fingers", [] {
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
    for_all_rules([&](auto rule) {
      RC_ASSERT(
          equal(run<decltype(rule)>(history, options), run<decltype(rule)>(permuted, options)));
    });
  });
  rc::prop("where the array is, and which of its axes is which", [] {
    const auto history = any_history<2>();
    const Options options = any_options();
    const auto moved = [&](double x_mm, double y_mm) {
      return changed(history, [=](auto& s, std::size_t f) {
        s.center_x_mm += f == 0 ? x_mm : y_mm;
        s.center_y_mm += f == 0 ? y_mm : -x_mm;
      });
    };
    // exact in binary, so no difference is rounded
    const auto any = moved(static_cast<double>(test::whole(-1000, 1000)) / 64,
                           static_cast<double>(test::whole(-1000, 1000)) / 64);
    const auto rotated =
        changed(history, [](auto& s, std::size_t) { std::swap(s.center_x_mm, s.center_y_mm); });
    for_all_rules([&](auto rule) {
      using Rule = decltype(rule);
      const Results results = run<Rule>(history, options);
      RC_ASSERT(equal(results, run<Rule>(rotated, options)));
      RC_ASSERT(equal(results, run<Rule>(any, options)));
    });
  });
  rc::prop("the unit of length", [] {
    const auto history = any_history<2>();
    Options options = any_options();
    const double unit = std::ldexp(1.0, static_cast<int>(test::whole(-40, 40)));
    const auto scaled = changed(history, [&](auto& s, std::size_t) {
      s.center_x_mm *= unit;
      s.center_y_mm *= unit;
    });
    Options scaled_options = options;
    scaled_options.centroid_tolerance_mm *= unit;
    for_all_rules([&](auto rule) {
      RC_ASSERT(equal(run<decltype(rule)>(history, options),
                      run<decltype(rule)>(scaled, scaled_options)));
    });
  });
  rc::prop("how long a wave is", [] {
    const auto history = any_history<2>();
    Options options = any_options();
    options.min_waves = 1;
    const Index factor = test::whole(1, 16);
    const auto faster = changed(history, [&](auto& s, std::size_t) {
      s.waves = factor * s.waves;
      for (auto& one : s.vibrations) {
        one.waves *= factor;
      }
    });
    for_all_rules([&](auto rule) {
      RC_ASSERT(equal(run<decltype(rule)>(history, options), run<decltype(rule)>(faster, options)));
    });
  });
}

TEST_CASE("pre-slip: alarms begin with the newest sample and end with the history",
          "[preslip][law]") {
  rc::prop("nothing else begins or ends one", [] {
    const auto history = any_history<2>();
    const Options options = any_options();
    for_all_rules([&](auto rule) {
      PreslipResult before;
      for (const PreslipResult& now : run<decltype(rule)>(history, options)) {
        RC_ASSERT(now.alarm == (now.samples_ago != PreslipResult::none));
        RC_ASSERT((!now.alarm || (now.samples_ago >= 1 && now.samples_ago < options.history)));
        RC_ASSERT((now.alarm || !now.is_fresh));
        RC_ASSERT((now.is_fresh || !now.alarm || before.alarm));
        RC_ASSERT((!before.alarm || now.alarm || before.samples_ago == options.history - 1));
        RC_ASSERT((now.is_fresh || !now.alarm || now.samples_ago == before.samples_ago + 1));
        before = now;
      }
    });
  });
  rc::prop("silence never begins one, and outlasts any", [] {
    auto history = any_history<2>();
    Options options = any_options();
    options.min_waves = test::whole(1, 2);
    const std::size_t samples = history.size();
    Bits bits;
    for (Index k = 0; k < options.history; ++k) {
      Hand<2> silent;
      for (auto& sample : silent) {
        sample.status = TaxelStatus::vibrating;
        sample.location = bits(-1, 3);
        sample.waves = bits(0, options.min_waves - 1);
        sample.center_x_mm = static_cast<double>(bits(-3, 3)) / 8;
        sample.center_y_mm = static_cast<double>(bits(-3, 3)) / 8;
      }
      history.push_back(silent);
    }
    for_all_rules([&](auto rule) {
      const Results results = run<decltype(rule)>(history, options);
      for (std::size_t k = samples; k < results.size(); ++k) {
        RC_ASSERT(!results[k].is_fresh);
      }
      RC_ASSERT(!results.back().alarm);
    });
  });
  rc::prop("what came before the history is forgotten", [] {
    const auto history = any_history<2>();
    const auto past = any_history<2>();
    const Options options = any_options();
    auto all = past;
    all.insert(all.end(), history.begin(), history.end());
    for_all_rules([&](auto rule) {
      const Results alone = run<decltype(rule)>(history, options);
      const Results after = run<decltype(rule)>(all, options);
      for (std::size_t k = static_cast<std::size_t>(options.history) - 1; k < alone.size(); ++k) {
        RC_ASSERT(equal(alone[k], after[past.size() + k]));
      }
    });
  });
}

TEST_CASE("pre-slip: what can only add an alarm", "[preslip][law]") {
  rc::prop("a longer history, which changes none that stands", [] {
    const auto history = any_history<2>();
    const Options options = any_options();
    Options longer = options;
    longer.history += test::whole(1, 10);
    for_all_rules([&](auto rule) {
      const Results a = run<decltype(rule)>(history, options);
      const Results b = run<decltype(rule)>(history, longer);
      for (std::size_t k = 0; k < a.size(); ++k) {
        RC_ASSERT((!a[k].alarm || (b[k].alarm && b[k].samples_ago == a[k].samples_ago)));
        RC_ASSERT((!b[k].alarm || a[k].alarm || b[k].samples_ago >= options.history));
      }
    });
  });
  rc::prop("fewer waves asked for", [] {
    const auto history = any_history<2>();
    const Options options = any_options();
    Options fewer = options;
    fewer.min_waves = test::whole(0, options.min_waves);
    for_all_rules([&](auto rule) {
      RC_ASSERT(alarms_wherever(run<decltype(rule)>(history, options),
                                run<decltype(rule)>(history, fewer)));
    });
  });
  rc::prop("a smaller tolerance", [] {
    const auto history = any_history<2>();
    const Options options = any_options();
    Options smaller = options;
    smaller.centroid_tolerance_mm *= test::uniform(0, 1);
    RC_ASSERT(alarms_wherever(run<GraspLift>(history, options), run<GraspLift>(history, smaller)));
  });
  rc::prop("another finger of a lift; never one of grasp-optimise", [] {
    const auto history = any_history<3>();
    const Options options = any_options();
    History<2> two;
    for (const auto& hand : history) {
      two.push_back({hand[0], hand[1]});
    }
    for_printed_rules([&](auto rule) {
      using Rule = decltype(rule);
      const Results few = run<Rule>(two, options), many = run<Rule>(history, options);
      RC_ASSERT((std::is_same_v<Rule, published::GraspOptimise> ? alarms_wherever(many, few)
                                                                : alarms_wherever(few, many)));
    });
  });
}

TEST_CASE("pre-slip: a copied state gives the same answers", "[preslip][law]") {
  rc::prop("from any sample on", [] {
    const auto history = any_history<2>();
    const Options options = any_options();
    const std::size_t at =
        static_cast<std::size_t>(test::whole(0, static_cast<std::ptrdiff_t>(history.size()) - 1));
    for_all_rules([&](auto rule) {
      const Preslip<decltype(rule)> preslip(options);
      auto state = preslip.start();
      for (std::size_t k = 0; k < at; ++k) {
        (void)preslip(history[k], state);
      }
      auto copy = state;
      Results first;
      for (std::size_t k = at; k < history.size(); ++k) {
        first.push_back(preslip(history[k], state));
      }
      for (std::size_t k = at; k < history.size(); ++k) {
        RC_ASSERT(equal(first[k - at], preslip(history[k], copy)));
      }
    });
  });
}
