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
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/generators.hpp"

using namespace fingerpad;

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

using Options = PreslipOptions;
template <std::size_t Fingers>
using Hand = std::array<FingerSample<double>, Fingers>;
template <std::size_t Fingers>
using History = std::vector<Hand<Fingers>>;
using Results = std::vector<bool>;  // whether each sample is pre-slip

constexpr std::array<PreslipRule, 4> all_rules = {
    PreslipRule::grasp_lift, PreslipRule::grasp_optimise, PreslipRule::printed_grasp_lift,
    PreslipRule::printed_grasp_optimise};

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

/// Whether b alarms wherever a does.
bool alarms_wherever(const Results& a, const Results& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](bool one, bool more) { return !one || more; });
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

TEST_CASE("pre-slip: the newest sample finds what the stack as printed does", "[preslip][law]") {
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
    for (const PreslipRule rule : all_rules) {
      RC_ASSERT(run(rule, history, options) == run(rule, renamed, options));
    }
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
    for (const PreslipRule rule : all_rules) {
      RC_ASSERT(run(rule, history, options) == run(rule, permuted, options));
    }
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
    for (const PreslipRule rule : all_rules) {
      const Results results = run(rule, history, options);
      RC_ASSERT(results == run(rule, rotated, options));
      RC_ASSERT(results == run(rule, any, options));
    }
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
    for (const PreslipRule rule : all_rules) {
      RC_ASSERT(run(rule, history, options) == run(rule, scaled, scaled_options));
    }
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
    for (const PreslipRule rule : all_rules) {
      RC_ASSERT(run(rule, history, options) == run(rule, faster, options));
    }
  });
}

TEST_CASE("pre-slip: what is not in the history makes no alarm", "[preslip][law]") {
  rc::prop("silence", [] {
    auto history = any_history<2>();
    Options options = any_options();
    options.min_waves = test::whole(1, 2);
    const std::size_t samples = history.size();
    Bits bits;
    for (Index k = 0; k < options.history; ++k) {
      Hand<2> silent;
      for (auto& sample : silent) {
        sample.status = TaxelStatus::vibrating;
        if (bits(0, 4) > 0) {
          sample.add_vibration(bits(0, 3), bits(0, options.min_waves - 1));
        }
        sample.center_x_mm = static_cast<double>(bits(-3, 3)) / 8;
        sample.center_y_mm = static_cast<double>(bits(-3, 3)) / 8;
      }
      history.push_back(silent);
    }
    for (const PreslipRule rule : all_rules) {
      const Results results = run(rule, history, options);
      for (std::size_t k = samples; k < results.size(); ++k) {
        RC_ASSERT(!results[k]);
      }
    }
  });
  rc::prop("what came before the history is forgotten", [] {
    const auto history = any_history<2>();
    const auto past = any_history<2>();
    const Options options = any_options();
    auto all = past;
    all.insert(all.end(), history.begin(), history.end());
    for (const PreslipRule rule : all_rules) {
      const Results alone = run(rule, history, options);
      const Results after = run(rule, all, options);
      for (std::size_t k = static_cast<std::size_t>(options.history) - 1; k < alone.size(); ++k) {
        RC_ASSERT(alone[k] == after[past.size() + k]);
      }
    }
  });
}

TEST_CASE("pre-slip: what can only add an alarm", "[preslip][law]") {
  rc::prop("a longer history", [] {
    const auto history = any_history<2>();
    const Options options = any_options();
    Options longer = options;
    longer.history += test::whole(1, 10);
    for (const PreslipRule rule : all_rules) {
      RC_ASSERT(alarms_wherever(run(rule, history, options), run(rule, history, longer)));
    }
  });
  rc::prop("fewer waves asked for", [] {
    const auto history = any_history<2>();
    const Options options = any_options();
    Options fewer = options;
    fewer.min_waves = test::whole(0, options.min_waves);
    for (const PreslipRule rule : all_rules) {
      RC_ASSERT(alarms_wherever(run(rule, history, options), run(rule, history, fewer)));
    }
  });
  rc::prop("a smaller tolerance", [] {
    const auto history = any_history<2>();
    const Options options = any_options();
    Options smaller = options;
    smaller.centroid_tolerance_mm *= test::uniform(0, 1);
    RC_ASSERT(alarms_wherever(run(PreslipRule::grasp_lift, history, options),
                              run(PreslipRule::grasp_lift, history, smaller)));
  });
  rc::prop("another finger of a lift; never one of grasp-optimise", [] {
    const auto history = any_history<3>();
    const Options options = any_options();
    History<2> two;
    for (const auto& hand : history) {
      two.push_back({hand[0], hand[1]});
    }
    const PreslipRule lift = PreslipRule::printed_grasp_lift;
    const PreslipRule optimise = PreslipRule::printed_grasp_optimise;
    RC_ASSERT(alarms_wherever(run(lift, two, options), run(lift, history, options)));
    RC_ASSERT(alarms_wherever(run(optimise, history, options), run(optimise, two, options)));
  });
}

TEST_CASE("pre-slip: a copy gives the same answers", "[preslip][law]") {
  rc::prop("from any sample on", [] {
    const auto history = any_history<2>();
    const Options options = any_options();
    const std::size_t at =
        static_cast<std::size_t>(test::whole(0, static_cast<std::ptrdiff_t>(history.size()) - 1));
    for (const PreslipRule rule : all_rules) {
      Preslip<> preslip(2, with(rule, options));
      for (std::size_t k = 0; k < at; ++k) {
        (void)preslip(history[k]);
      }
      auto copy = preslip;
      std::vector<PreslipStatus> first;
      for (std::size_t k = at; k < history.size(); ++k) {
        first.push_back(preslip(history[k]));
      }
      for (std::size_t k = at; k < history.size(); ++k) {
        RC_ASSERT(first[k - at] == copy(history[k]));
      }
    }
  });
}
