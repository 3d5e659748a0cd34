// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The rules of pre-slip over a full history of two fingers; "ns/pixel" is per sample.
//   quiet     nothing vibrates
//   no pair   both fingers always vibrate, with 1 to 8 waves in turn, but at one taxel: the whole
//             history is searched
//   slipping  both fingers vibrate at any taxel with any of 1 to 8 waves: pairs are found soon
// Error: the share of the first 400 samples whose answer differs from that of StackScan in double.
// "detection": patches of foam fingers begin to slip at a known time
// (tests/support/foam_signals.hpp). Error: the delay of the alarm, in windows of 16 samples; an
// earlier alarm counts as none.
// "least force": an object hangs between simulated foam fingers (examples/grip/foam_fingers.hpp),
// which loosen their grip until it slips. Error: the excess of the force at the warning over the
// slipping force, relative to the latter; for a lift, the rounding of its commands against long
// double.
#include "fingerpad/foam/preslip.hpp"

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "bench/support/run.hpp"
#include "examples/grip/foam_fingers.hpp"
#include "fingerpad/foam/holding_force.hpp"
#include "fingerpad/foam/taxel_features.hpp"
#include "fingerpad/published/preslip.hpp"
#include "support/foam_signals.hpp"

using namespace fingerpad;

namespace {

template <class S>
using HandOf = std::array<FingerSample<S>, 2>;
using Hand = HandOf<double>;

/// Search methods.
struct Newest {
  template <class Rule, class S>
  using Estimator = Preslip<Rule, 2, S>;
};
struct Scan {
  template <class Rule, class S>
  using Estimator = published::StackScan<Rule, 2, S>;
};

enum class Scene { quiet, no_pair, slipping };

const char* name_of(Scene scene) {
  return scene == Scene::quiet ? "quiet" : scene == Scene::no_pair ? "no pair" : "slipping";
}

/// The quantities that the rules compare, in S.
template <class S>
HandOf<S> as(const Hand& from) {
  HandOf<S> to;
  for (std::size_t f = 0; f < 2; ++f) {
    to[f].status = from[f].status;
    to[f].center_x_mm = static_cast<S>(from[f].center_x_mm);
    to[f].center_y_mm = static_cast<S>(from[f].center_y_mm);
    to[f].location = from[f].location;
    to[f].waves = from[f].waves;
  }
  return to;
}

template <class S>
std::vector<HandOf<S>> samples(Scene scene) {
  std::vector<HandOf<S>> all;
  std::mt19937 random(1);
  const auto any = [&](Index below) {
    return static_cast<Index>(random() % static_cast<unsigned>(below));
  };
  for (int k = 0; k < 1 << 12; ++k) {
    Hand hand;
    for (auto& sample : hand) {
      sample.center_x_mm = 8 + 0.01 * static_cast<double>(any(100));
      sample.center_y_mm = 20 + 0.01 * static_cast<double>(any(100));
      if (scene != Scene::quiet) {
        sample.location = scene == Scene::no_pair ? 40 : any(162);
        sample.waves = 1 + any(8);
      }
    }
    all.push_back(as<S>(hand));
  }
  return all;
}

/// Answers of Rule and Search for the first samples of a scene.
template <class Rule, class Search, class S>
std::vector<PreslipResult> answers(Scene scene, Index history) {
  const typename Search::template Estimator<Rule, S> preslip({.history = history});
  auto state = preslip.start();
  const auto hands = samples<S>(scene);
  std::vector<PreslipResult> all;
  for (std::size_t k = 0; k < 400; ++k) {
    all.push_back(preslip(hands[k], state));
  }
  return all;
}

template <class Rule>
const std::vector<PreslipResult>& true_answers(Scene scene, Index history) {
  static std::map<std::pair<Scene, Index>, std::vector<PreslipResult>> known;
  auto& all = known[{scene, history}];
  if (all.empty()) {
    all = answers<Rule, Scan, double>(scene, history);
  }
  return all;
}

template <class Rule, class Search, class S = double>
void add(const std::string& rule, const std::string& search, Scene scene, Index history) {
  using Estimator = typename Search::template Estimator<Rule, S>;
  struct Data {
    Estimator preslip;
    typename Estimator::State state = preslip.start();
    std::size_t k = 0;
  };
  const auto hands = std::make_shared<const std::vector<HandOf<S>>>(samples<S>(scene));
  const bench::Memory memory;
  const auto d = std::make_shared<Data>(Data{Estimator({.history = history})});
  const auto step = [=] {
    benchmark::DoNotOptimize(d->preslip((*hands)[d->k % hands->size()], d->state));
    ++d->k;
  };
  bench::add(
      rule + ", " + name_of(scene) + ", history " + std::to_string(history) + "/" + search, 1,
      memory.bytes(),
      [=] {
        while (d->k < static_cast<std::size_t>(history)) {
          step();  // fill the history before timing
        }
        step();
      },
      [=, wrong = -1.0](auto& counters) mutable {
        if (wrong < 0) {
          const auto& truth = true_answers<Rule>(scene, history);
          const auto found = answers<Rule, Search, S>(scene, history);
          wrong = 0;
          for (std::size_t k = 0; k < truth.size(); ++k) {
            const bool same = found[k].alarm == truth[k].alarm &&
                              found[k].is_fresh == truth[k].is_fresh &&
                              found[k].samples_ago == truth[k].samples_ago;
            wrong += same ? 0 : 1 / static_cast<double>(truth.size());
          }
        }
        bench::note_errors(counters, "wrong answers", "of all", {wrong});
      });
}

template <class Rule>
void add_searches(const std::string& rule) {
  for (const Scene scene : {Scene::quiet, Scene::no_pair, Scene::slipping}) {
    for (const Index history : {100, 1000}) {
      add<Rule, Scan>(rule, "published: StackScan", scene, history);
      add<Rule, Newest>(rule, "Preslip", scene, history);
      if (history == 100) {
        add<Rule, Newest, float>(rule, "Preslip, float", scene, history);
      }
    }
  }
}

/// Samples of the foam fingers of each recording.
using Recordings = std::vector<std::vector<Hand>>;

constexpr std::size_t slip_begins = 60;

/// Three patches on each finger begin to slip; place, speed and rate vary.
const Recordings& slips() {
  static const Recordings all = [] {
    std::mt19937 random(17);
    const auto any = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    Recordings recordings;
    for (unsigned n = 0; n < 40; ++n) {
      const double rate_hz = std::array{10.0, 31.0, 100.0, 1000.0}[n % 4];
      test::FoamScene scene;
      scene.drift = any(0, 0.3);
      const double frequency_hz = rate_hz * any(0.08, 0.3);
      for (int p = 0; p < 6; ++p) {
        test::VibratingPatch patch;
        patch.row = static_cast<Index>(any(0, 14));
        patch.col = static_cast<Index>(any(0, 2));
        patch.begin_s = (static_cast<double>(slip_begins) + any(0, 1)) / rate_hz;
        patch.frequency_hz = frequency_hz;
        patch.phase = any(0, 6.28);
        scene.patches[static_cast<std::size_t>(p % 2)].push_back(patch);
      }
      const TaxelFeatures<> features(
          scene.rows, scene.cols,
          TaxelOptions<>{
              .sample_period_s = 1 / rate_hz, .longest_gap_s = 8 / rate_hz, .noise = scene.noise});
      std::array fingers{features.start(), features.start()};
      test::FoamSignal signal(scene, n);
      auto& hands = recordings.emplace_back();
      for (int k = 0; k < 140; ++k) {
        auto& hand = hands.emplace_back();
        for (std::size_t f = 0; f < 2; ++f) {
          hand[f] = features(signal.finger(f, k / rate_hz), k / rate_hz, fingers[f]);
        }
      }
    }
    return recordings;
  }();
  return all;
}

/// Applies a rule to the samples of a recording one after the other.
template <class Estimator>
struct Watching {
  Estimator preslip = Estimator();
  typename Estimator::State state = preslip.start();
  std::size_t k = 0;

  PreslipResult next(const std::vector<Hand>& hands) {
    return preslip(hands[k++ % hands.size()], state);
  }
};

template <class Rule, class Search>
void add_detection(const std::string& name) {
  using Estimator = typename Search::template Estimator<Rule, double>;
  const bench::Memory memory;
  const auto d = std::make_shared<Watching<Estimator>>();
  const long bytes = memory.bytes();
  bench::add(
      "detection/" + name, 1, bytes, [d] { benchmark::DoNotOptimize(d->next(slips().front())); },
      [](auto& counters) {
        std::vector<double> delays;
        for (const std::vector<Hand>& hands : slips()) {
          Watching<Estimator> watching;
          while (watching.k < hands.size() && !watching.next(hands).is_fresh) {
          }
          const bool found = watching.k > slip_begins && watching.k < hands.size();
          const double windows = (static_cast<double>(watching.k - 1) - slip_begins) / 16;
          delays.push_back(found ? windows : test::nan);
        }
        bench::note_errors(counters, "delay", "windows", delays);
      });
}

/// How the grip is loosened; the commands do not depend on warnings.
template <class S>
LoosenOptions<S> loosen_plan() {
  LoosenOptions<S> plan;
  plan.min_force_n = S(1) / S(10);
  plan.step_n = S(1) / S(5);
  plan.settle_samples = 4;
  plan.watch_samples = 36;
  plan.until_slipped = true;
  return plan;
}

struct Loosened {
  Recordings recordings;
  std::vector<double> slip_force_n;
};

/// Eight objects until they slip.
const Loosened& loosened() {
  static const Loosened all = [] {
    Loosened runs;
    for (unsigned seed = 1; seed <= 8; ++seed) {
      const grip::FoamFingersSetup object;
      grip::FoamFingers hand(object, seed);
      const TaxelFeatures features(object.rows, object.cols,
                                   TaxelOptions<>{.pitch_mm = object.pitch_mm,
                                                  .sample_period_s = 1 / object.rate_hz,
                                                  .noise = object.noise_counts});
      const LoosenUntilPreslip loosen(loosen_plan<double>());
      std::array fingers{features.start(), features.start()};
      auto search = loosen.start();
      auto& hands = runs.recordings.emplace_back();
      while (!hand.has_slipped()) {
        hand.advance(loosen(PreslipStatus::steady, search).force_n);
        auto& samples = hands.emplace_back();
        for (std::size_t f = 0; f < 2; ++f) {
          samples[f] = features(hand.readings(f), hand.time_s(), fingers[f]);
        }
      }
      runs.slip_force_n.push_back(search.command().force_n);
    }
    return runs;
  }();
  return all;
}

template <class Rule, class S>
struct Loosening {
  Watching<Preslip<Rule>> watching;
  LoosenUntilPreslip<S> loosen{loosen_plan<S>()};
  typename LoosenUntilPreslip<S>::State search = loosen.start();

  HoldingCommand<S> next(const std::vector<Hand>& hands) {
    const bool alarm = watching.next(hands).is_fresh;
    return loosen(alarm ? PreslipStatus::preslip : PreslipStatus::steady, search);
  }
};

template <class Rule, class S>
void add_loosening(const std::string& name) {
  const bench::Memory memory;
  const auto d = std::make_shared<Loosening<Rule, S>>();
  const long bytes = memory.bytes();
  bench::add(
      "least force/" + name, 1, bytes,
      [d] { benchmark::DoNotOptimize(d->next(loosened().recordings[0])); },
      [](auto& counters) {
        std::vector<double> errors;
        for (std::size_t n = 0; n < loosened().recordings.size(); ++n) {
          Loosening<Rule, S> run;
          for (std::size_t k = 0; k < loosened().recordings[n].size(); ++k) {
            (void)run.next(loosened().recordings[n]);
          }
          const double warned_n = static_cast<double>(run.search.command().preslip_force_n);
          errors.push_back(warned_n / loosened().slip_force_n[n] - 1);
        }
        bench::note_errors(counters, "force at the warning", "share", errors);
      });
}

/// An endless lift with pre-slip in every 25th sample.
template <class S>
struct Lifting {
  static LiftOptions<S> plan() {
    LiftOptions<S> p;
    p.force_step_n = S(1) / S(3);
    p.height_step_mm = S(1) / S(30);
    return p;
  }
  LiftWithRegrip<S> lift{plan()};
  typename LiftWithRegrip<S>::State state = lift.start();
  int k = 0;

  HoldingCommand<S> next() {
    if (is_end(state.command().phase)) {
      state = lift.start();
    }
    return lift(++k % 25 == 0 ? PreslipStatus::preslip : PreslipStatus::steady, state);
  }
};

template <class S>
void add_lift(const std::string& name) {
  const bench::Memory memory;
  const auto d = std::make_shared<Lifting<S>>();
  bench::add(
      "lift/published: LiftWithRegrip, " + name, 1, memory.bytes(),
      [d] { benchmark::DoNotOptimize(d->next()); },
      [](auto& counters) {
        Lifting<S> found;
        Lifting<long double> truth;
        std::vector<double> force, height;
        for (int k = 0; k < 1000; ++k) {
          const auto given = found.next();
          const auto exact = truth.next();
          force.push_back(
              static_cast<double>(static_cast<long double>(given.force_n) - exact.force_n));
          height.push_back(
              static_cast<double>(static_cast<long double>(given.height_mm) - exact.height_mm));
        }
        bench::note_errors(counters, "force", "N", force);
        bench::note_errors(counters, "height", "mm", height);
      });
}

}  // namespace

int main(int argc, char** argv) {
  add_searches<GraspLift>("GraspLift, the default");
  bench::add_streaming("GraspLift, the default, no pair, history 100");
  add_searches<GraspOptimise>("GraspOptimise");
  add_detection<GraspLift, Scan>("published: GraspLift, StackScan");
  add_detection<GraspLift, Newest>("GraspLift, the default");
  add_detection<GraspOptimise, Scan>("published: GraspOptimise, StackScan");
  add_detection<GraspOptimise, Newest>("GraspOptimise");
  add_loosening<GraspOptimise, double>("published: LoosenUntilPreslip, GraspOptimise, double");
  add_loosening<GraspOptimise, float>("published: LoosenUntilPreslip, GraspOptimise, float");
  add_loosening<GraspLift, double>("LoosenUntilPreslip, GraspLift, double");
  add_lift<double>("double");
  add_lift<float>("float");
  return bench::run(argc, argv);
}
