// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// What must hold for every history: that all searches give what the rule says of all pairs, what
// does not matter, and what can only add an alarm. RC_PARAMS="max_success=1000000" tries a million
// histories.
#include "fingerpad/foam/preslip.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

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

using SameOptimise = GraspOptimise<SamePair>;
using AnyOptimise = GraspOptimise<AnyPair>;
using Beyond = GraspLift<MovedBeyond, AnyAxis>;
using BeyondBoth = GraspLift<MovedBeyond, BothAxes>;
using Cells = GraspLift<MovedToOtherCell, AnyAxis>;
using CellsBoth = GraspLift<MovedToOtherCell, BothAxes>;

/// Whole numbers, many and quickly. Only the seed is RapidCheck's: a failing case shrinks to a
/// short history over few values.
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

/// Few values of each kind, so that they are often equal.
struct Values {
  Index locations = test::whole(1, 4);
  Index waves = test::whole(0, 5);
  Index places = test::whole(0, 3);
  Index odd = test::whole(4, 40);  // one sample in so many is silent, one is not pressed
};

FingerSample<double> any_sample(const Values& values, Bits& bits) {
  FingerSample<double> sample;
  sample.location = bits(0, values.odd) == 0 ? -1 : bits(0, values.locations);
  sample.waves = bits(0, values.odd) == 0 ? 0 : bits(0, values.waves);
  // in quarters of a tolerance: exact, in the cell, at its edge, and beyond it
  sample.center_x_mm = static_cast<double>(bits(-values.places, values.places)) / 16;
  sample.center_y_mm = static_cast<double>(bits(-values.places, values.places)) / 16;
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
          .max_waves = test::whole(1, 6),
          .centroid_tolerance_mm = static_cast<double>(test::whole(1, 4)) / 16};
}

template <class Rule, class Search, std::size_t Fingers>
Results run(const History<Fingers>& history, const Options& options) {
  const Preslip<Rule, Fingers, Search> preslip(options);
  auto state = preslip.start();
  Results results;
  for (const auto& hand : history) {
    results.push_back(preslip(hand, state));
  }
  return results;
}
template <class Rule, std::size_t Fingers>
Results run(const History<Fingers>& history, const Options& options) {
  return run<Rule, NewestPairs>(history, options);
}

bool equal(const PreslipResult& a, const PreslipResult& b) {
  return a.alarm == b.alarm && a.is_fresh == b.is_fresh && a.samples_ago == b.samples_ago;
}
bool equal(const Results& a, const Results& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& one, const auto& other) { return equal(one, other); });
}

/// What the predicate says of all pairs among the last samples up to number `last`.
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

/// The same where each finger may have its pair.
template <class Rule, std::size_t Fingers>
PreslipResult expected(const History<Fingers>& history,
                       std::size_t first,
                       std::size_t last,
                       const Options& options) {
  if constexpr (!std::is_same_v<Rule, AnyOptimise>) {
    return by_all_pairs<Rule>(history, first, last, options);
  } else {
    PreslipResult result{true, false, 0};
    for (std::size_t f = 0; f < Fingers; ++f) {
      History<1> of_one;
      for (const auto& hand : history) {
        of_one.push_back({hand[f]});
      }
      const PreslipResult one = by_all_pairs<SameOptimise>(of_one, first, last, options);
      if (!one.alarm) {
        return {};
      }
      result.is_fresh = result.is_fresh || one.is_fresh;
      result.samples_ago = (std::max)(result.samples_ago, one.samples_ago);
    }
    return result;
  }
}

/// All searches through a history with resets before the samples of these numbers.
template <class Rule, std::size_t Fingers, class... Searches>
bool searches_agree(const History<Fingers>& history,
                    const std::vector<bool>& resets,
                    const Options& options) {
  const std::tuple<Preslip<Rule, Fingers, Searches>...> detectors{
      Preslip<Rule, Fingers, Searches>(options)...};
  auto states =
      std::apply([](const auto&... d) { return std::make_tuple(d.start()...); }, detectors);
  std::size_t first = 0;
  for (std::size_t k = 0; k < history.size(); ++k) {
    if (resets[k]) {
      std::apply([](auto&... state) { (state.reset(), ...); }, states);
      first = k;
    }
    const PreslipResult truth = expected<Rule>(history, first, k, options);
    const bool all = std::apply(
        [&](const auto&... d) {
          return std::apply(
              [&](auto&... state) { return (equal(d(history[k], state), truth) && ...); }, states);
        },
        detectors);
    if (!all) {
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
  const auto agree = [&]<class Rule, class... Searches>(Rule, Searches...) {
    return searches_agree<Rule, Fingers, Searches...>(history, resets, options);
  };
  RC_ASSERT(agree(SameOptimise(), AllPairs(), NewestPairs(), ConstantTime()));
  RC_ASSERT(agree(AnyOptimise(), AllPairs(), NewestPairs(), ConstantTime()));
  RC_ASSERT(agree(Beyond(), AllPairs(), NewestPairs()));
  RC_ASSERT(agree(BeyondBoth(), AllPairs(), NewestPairs()));
  RC_ASSERT(agree(Cells(), AllPairs(), NewestPairs(), ConstantTime()));
  RC_ASSERT(agree(CellsBoth(), AllPairs(), NewestPairs(), ConstantTime()));
}

/// One property for all rules.
template <class Check>
void for_all_rules(const Check& check) {
  check(SameOptimise());
  check(AnyOptimise());
  check(Beyond());
  check(BeyondBoth());
  check(Cells());
  check(CellsBoth());
}

/// Whether b alarms wherever a does, and for as long.
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

TEST_CASE("pre-slip: all searches find what the rule says of all pairs", "[preslip][law]") {
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
      s.location = s.location < 0
                       ? s.location
                       : (f == 0 ? 2000000 - factor * s.location : factor * s.location + offset);
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
    // exact in binary, so that no difference is rounded
    const auto any = moved(static_cast<double>(test::whole(-1000, 1000)) / 64,
                           static_cast<double>(test::whole(-1000, 1000)) / 64);
    const auto cells =
        moved(options.centroid_tolerance_mm * static_cast<double>(test::whole(-1000, 1000)),
              options.centroid_tolerance_mm * static_cast<double>(test::whole(-1000, 1000)));
    const auto rotated =
        changed(history, [](auto& s, std::size_t) { std::swap(s.center_x_mm, s.center_y_mm); });
    for_all_rules([&](auto rule) {
      using Rule = decltype(rule);
      const Results results = run<Rule>(history, options);
      RC_ASSERT(equal(results, run<Rule>(rotated, options)));
      RC_ASSERT(equal(results, run<Rule>(cells, options)));
      RC_ASSERT((Rule::Centroid::is_rounded || equal(results, run<Rule>(any, options))));
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
    options.max_waves = 100;
    options.min_waves = 1;
    const Index factor = test::whole(1, 16);
    const auto faster = changed(history, [&](auto& s, std::size_t) { s.waves = factor * s.waves; });
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
  rc::prop("a pair for each finger, one axis of both, fewer waves asked for", [] {
    const auto history = any_history<2>();
    const Options options = any_options();
    RC_ASSERT(
        alarms_wherever(run<SameOptimise>(history, options), run<AnyOptimise>(history, options)));
    RC_ASSERT(alarms_wherever(run<BeyondBoth>(history, options), run<Beyond>(history, options)));
    RC_ASSERT(alarms_wherever(run<CellsBoth>(history, options), run<Cells>(history, options)));
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
    RC_ASSERT(alarms_wherever(run<Beyond>(history, options), run<Beyond>(history, smaller)));
    RC_ASSERT(
        alarms_wherever(run<BeyondBoth>(history, options), run<BeyondBoth>(history, smaller)));
    // cells of which an odd number makes a larger one
    Options larger = options;
    larger.centroid_tolerance_mm *= static_cast<double>(2 * test::whole(0, 3) + 1);
    RC_ASSERT(alarms_wherever(run<Cells>(history, larger), run<Cells>(history, options)));
    RC_ASSERT(alarms_wherever(run<CellsBoth>(history, larger), run<CellsBoth>(history, options)));
  });
  rc::prop("another finger of a lift; never one of grasp-optimise", [] {
    const auto history = any_history<3>();
    const Options options = any_options();
    History<2> two;
    History<1> one;
    for (const auto& hand : history) {
      two.push_back({hand[0], hand[1]});
      one.push_back({hand[1]});
    }
    for_all_rules([&](auto rule) {
      using Rule = decltype(rule);
      const Results few = run<Rule>(two, options), many = run<Rule>(history, options);
      const bool is_lift = detail::is_lift<Rule>;
      if constexpr (std::is_same_v<Rule, AnyOptimise>) {
        for (std::size_t k = 0; k < few.size(); ++k) {
          RC_ASSERT((!many[k].alarm || few[k].alarm));
        }
      } else {
        RC_ASSERT((is_lift ? alarms_wherever(few, many) : alarms_wherever(many, few)));
      }
    });
    RC_ASSERT(equal(run<SameOptimise>(one, options), run<AnyOptimise>(one, options)));
  });
}

TEST_CASE("pre-slip: a copied state gives the same answers", "[preslip][law]") {
  rc::prop("from any sample on", [] {
    const auto history = any_history<2>();
    const Options options = any_options();
    const std::size_t at =
        static_cast<std::size_t>(test::whole(0, static_cast<std::ptrdiff_t>(history.size()) - 1));
    const auto check = [&](auto rule, auto search) {
      const Preslip<decltype(rule), 2, decltype(search)> preslip(options);
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
    };
    check(SameOptimise(), AllPairs());
    check(SameOptimise(), NewestPairs());
    check(SameOptimise(), ConstantTime());
    check(AnyOptimise(), ConstantTime());
    check(Cells(), NewestPairs());
    check(CellsBoth(), ConstantTime());
  });
}

TEMPLATE_TEST_CASE_SIG("the latest sample that differs in every coordinate is found",
                       "[preslip][law]",
                       ((std::size_t Coordinates), Coordinates),
                       1,
                       2,
                       3) {
  rc::prop("as by looking at all of them", [] {
    using Latest = detail::LatestDiffering<Coordinates>;
    using Point = typename Latest::Point;
    const Index values = test::whole(1, 5), samples = test::whole(1, 120);
    const Index stays = test::whole(0, 3);  // coordinates that change seldom hide old samples
    Bits bits;
    Latest latest;
    RC_ASSERT(latest(Point{}) == Latest::none);
    std::vector<std::pair<Point, std::int64_t>> all;
    Point point{};
    for (Index k = 0; k < samples; ++k) {
      for (auto& coordinate : point) {
        coordinate = bits(0, stays) == 0 ? bits(0, values) : coordinate;
      }
      latest.add(point, 7 + 3 * k);
      all.emplace_back(point, 7 + 3 * k);
      for (int asked = 0; asked < 8; ++asked) {
        Point question{};
        for (auto& coordinate : question) {
          coordinate = bits(-1, values + 1);
        }
        std::int64_t truth = Latest::none;
        for (const auto& [before, number] : all) {
          bool differs = true;
          for (std::size_t d = 0; d < Coordinates; ++d) {
            differs = differs && before[d] != question[d];
          }
          truth = differs ? number : truth;
        }
        RC_ASSERT(latest(question) == truth);
      }
      if (bits(0, 200) == 0) {
        latest.clear();
        all.clear();
      }
    }
  });
}

namespace {
/// What a table remembers of a key: how often it was added.
struct Count {
  Index added = 0;
  void clear() { added = 0; }
};
}  // namespace

TEMPLATE_TEST_CASE_SIG(
    "the table of waves is a map", "[preslip][law]", ((std::size_t Fingers), Fingers), 1, 2, 3) {
  rc::prop("with any keys, in any order", [] {
    using Table = detail::WaveTable<Fingers, Count>;
    using Key = typename Table::Key;
    const Index samples = test::whole(1, 16);
    const Index waves = test::whole(0, 3) > 0 ? test::whole(0, 12) : 65536;
    const Index steps = test::whole(1, 300);
    Bits bits;
    Table table(static_cast<std::size_t>(samples));
    std::map<Key, std::pair<Index, Index>> truth;  // samples it has now, and had since it was new
    std::vector<Key> held, seen;
    const auto check = [&](const Key& key) {
      const Count* const found = table.find(key);
      const auto at = truth.find(key);
      RC_ASSERT((found != nullptr) == (at != truth.end()));
      RC_ASSERT((found == nullptr || found->added == at->second.second));
    };
    for (Index k = 0; k < steps; ++k) {
      const bool full = static_cast<Index>(held.size()) == samples;
      if (held.empty() || (!full && bits(0, 1) == 0)) {
        Key key{};
        for (auto& w : key) {
          w = bits(0, waves);
        }
        ++table.add(key).added;
        ++truth[key].first;
        ++truth[key].second;
        held.push_back(key);
        seen.push_back(key);
      } else {
        const auto at = held.begin() + bits(0, static_cast<Index>(held.size()) - 1);
        const Key key = *at;
        held.erase(at);
        table.remove(key);
        if (--truth[key].first == 0) {
          truth.erase(key);
        }
        std::for_each(held.begin(), held.end(), check);
      }
      check(seen[static_cast<std::size_t>(bits(0, static_cast<Index>(seen.size()) - 1))]);
      check(seen.back());
    }
    table.clear();
    std::for_each(seen.begin(), seen.end(),
                  [&](const Key& key) { RC_ASSERT(table.find(key) == nullptr); });
  });
}
