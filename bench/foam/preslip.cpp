// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The rules of pre-slip over a full history of two fingers; "ns/pixel" is per sample.
//   quiet     nothing vibrates
//   no pair   both fingers always vibrate, with 1 to 8 waves in turn, but at one taxel: the whole
//             history is searched
//   slipping  both fingers vibrate at any taxel with any of 1 to 8 waves: pairs are found soon
// Error: the share of the first 400 samples whose answer differs from the rule on all pairs with
// the newest sample, in double. "detection": patches of foam fingers begin to slip at a known time
// (tests/support/foam_signals.hpp). Error: the delay of the alarm, in windows of 16 samples; an
// earlier alarm counts as none.
// "least force": an object hangs between simulated foam fingers
// (bench/trials/grip/foam_fingers.hpp), which loosen their grip until it slips. Error: the excess
// of the force at the warning over the slipping force, relative to the latter; for a lift, the
// rounding of its commands against long double.
#include "fingerpad/foam/preslip.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "bench/trials/grip/foam_fingers.hpp"
#include "fingerpad/foam/holding_force.hpp"
#include "fingerpad/foam/taxels.hpp"
#include "support/foam_signals.hpp"

using namespace fingerpad;

namespace {

template <class S>
using HandOf = std::array<FingerSample<S>, 2>;
using Hand = HandOf<double>;

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
    if (from[f].is_vibrating()) {
      to[f].add_vibration(from[f].location, from[f].waves);
    }
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
      sample.status = scene == Scene::quiet ? TaxelStatus::quiet : TaxelStatus::vibrating;
      if (scene != Scene::quiet) {
        const Index location = scene == Scene::no_pair ? 40 : any(162);
        sample.add_vibration(location, 1 + any(8));
      }
    }
    all.push_back(as<S>(hand));
  }
  return all;
}

/// Whether each of the first samples of a scene is pre-slip.
template <class S>
std::vector<bool> answers(Scene scene, const PreslipOptions& options) {
  Preslip<S> preslip(2, options);
  const auto hands = samples<S>(scene);
  std::vector<bool> all;
  for (std::size_t k = 0; k < 400; ++k) {
    all.push_back(preslip(hands[k]) == PreslipStatus::preslip);
  }
  return all;
}

/// The same by the rule alone.
std::vector<bool> true_answers(Scene scene, const PreslipOptions& options) {
  const auto hands = samples<double>(scene);
  std::vector<bool> all;
  for (std::size_t k = 0; k < 400; ++k) {
    const auto kept = static_cast<std::size_t>(options.history) - 1;
    bool pairs = false;
    for (std::size_t older = k > kept ? k - kept : 0; older < k; ++older) {
      pairs = pairs || is_preslip(hands[older], hands[k], options);
    }
    all.push_back(pairs);
  }
  return all;
}

template <class S = double>
void add(const std::string& name, PreslipRule rule, Scene scene, Index history) {
  const PreslipOptions options{.rule = rule, .history = history};
  struct Data {
    Preslip<S> preslip;
    Index k = 0;
  };
  const auto hands = std::make_shared<const std::vector<HandOf<S>>>(samples<S>(scene));
  const bench::Memory memory;
  const auto d = std::make_shared<Data>(Data{Preslip<S>(2, options)});
  const auto step = [=] {
    const auto at = static_cast<std::size_t>(d->k) % hands->size();
    benchmark::DoNotOptimize(d->preslip((*hands)[at]));
    ++d->k;
  };
  bench::add(
      name, 1, memory.bytes(),
      [=] {
        while (d->k < history) {
          step();  // fill the history before timing
        }
        step();
      },
      [=, wrong = -1.0](auto& counters) mutable {
        if (wrong < 0) {
          const auto truth = true_answers(scene, options), found = answers<S>(scene, options);
          wrong = 0;
          for (std::size_t k = 0; k < truth.size(); ++k) {
            wrong += found[k] == truth[k] ? 0 : 1 / static_cast<double>(truth.size());
          }
        }
        bench::note_errors(counters, "wrong answers", "of all", {wrong});
      });
}

void add_rule(const std::string& name, PreslipRule rule, PreslipRule printed) {
  for (const Scene scene : {Scene::quiet, Scene::no_pair, Scene::slipping}) {
    for (const Index history : {100, 1000}) {
      const std::string group =
          name + ", " + name_of(scene) + ", history " + std::to_string(history) + "/";
      add(group + "published: the printed rule", printed, scene, history);
      add(group + "Preslip", rule, scene, history);
      if (history == 100) {
        add<float>(group + "Preslip, float", rule, scene, history);
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
      const TaxelFeatures<> finger(
          scene.rows, scene.cols,
          {.sample_period_s = 1 / rate_hz, .longest_gap_s = 8 / rate_hz, .noise = scene.noise});
      std::array fingers{finger, finger};
      test::FoamSignal signal(scene, n);
      auto& hands = recordings.emplace_back();
      for (int k = 0; k < 140; ++k) {
        auto& hand = hands.emplace_back();
        for (std::size_t f = 0; f < 2; ++f) {
          hand[f] = fingers[f](signal.finger(f, k / rate_hz), k / rate_hz);
        }
      }
    }
    return recordings;
  }();
  return all;
}

/// Applies a rule to the samples of a recording one after the other.
struct Watching {
  explicit Watching(PreslipRule rule) : preslip(2, {.rule = rule}) {}

  bool alarms(const std::vector<Hand>& hands) {
    return preslip(hands[k++ % hands.size()]) == PreslipStatus::preslip;
  }

  Preslip<> preslip;
  std::size_t k = 0;
};

void add_detection(const std::string& name, PreslipRule rule) {
  const bench::Memory memory;
  const auto d = std::make_shared<Watching>(rule);
  const long bytes = memory.bytes();
  bench::add(
      "detection/" + name, 1, bytes, [d] { benchmark::DoNotOptimize(d->alarms(slips().front())); },
      [rule](auto& counters) {
        std::vector<double> delays;
        for (const std::vector<Hand>& hands : slips()) {
          Watching watching(rule);
          while (watching.k < hands.size() && !watching.alarms(hands)) {
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
      const TaxelFeatures<> finger(object.rows, object.cols,
                                   {.pitch_mm = object.pitch_mm,
                                    .sample_period_s = 1 / object.rate_hz,
                                    .noise = object.noise_counts});
      std::array fingers{finger, finger};
      LoosenUntilPreslip loosen(loosen_plan<double>());
      auto& hands = runs.recordings.emplace_back();
      while (!hand.has_slipped()) {
        hand.advance(loosen(PreslipStatus::steady).force_n);
        auto& samples = hands.emplace_back();
        for (std::size_t f = 0; f < 2; ++f) {
          samples[f] = fingers[f](hand.readings(f), hand.time_s());
        }
      }
      runs.slip_force_n.push_back(loosen.command().force_n);
    }
    return runs;
  }();
  return all;
}

template <class S>
struct Loosening {
  explicit Loosening(PreslipRule rule) : watching(rule) {}

  HoldingCommand<S> next(const std::vector<Hand>& hands) {
    return loosen(watching.alarms(hands) ? PreslipStatus::preslip : PreslipStatus::steady);
  }

  Watching watching;
  LoosenUntilPreslip<S> loosen{loosen_plan<S>()};
};

template <class S>
void add_loosening(const std::string& name, PreslipRule rule) {
  const bench::Memory memory;
  const auto d = std::make_shared<Loosening<S>>(rule);
  const long bytes = memory.bytes();
  bench::add(
      "least force/" + name, 1, bytes,
      [d] { benchmark::DoNotOptimize(d->next(loosened().recordings[0])); },
      [rule](auto& counters) {
        std::vector<double> errors;
        for (std::size_t n = 0; n < loosened().recordings.size(); ++n) {
          Loosening<S> run(rule);
          for (std::size_t k = 0; k < loosened().recordings[n].size(); ++k) {
            (void)run.next(loosened().recordings[n]);
          }
          const double warned_n = static_cast<double>(run.loosen.command().preslip_force_n);
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
  int k = 0;

  HoldingCommand<S> next() {
    if (is_end(lift.command().phase)) {
      lift = LiftWithRegrip<S>(plan());
    }
    return lift(++k % 25 == 0 ? PreslipStatus::preslip : PreslipStatus::steady);
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
  using enum PreslipRule;
  add_rule("GraspLift, the default", grasp_lift, printed_grasp_lift);
  bench::add_streaming("GraspLift, the default, no pair, history 100");
  add_rule("GraspOptimise", grasp_optimise, printed_grasp_optimise);
  add_detection("published: GraspLift", printed_grasp_lift);
  add_detection("GraspLift, the default", grasp_lift);
  add_detection("published: GraspOptimise", printed_grasp_optimise);
  add_detection("GraspOptimise", grasp_optimise);
  add_loosening<double>("published: LoosenUntilPreslip, GraspOptimise, double", grasp_optimise);
  add_loosening<float>("published: LoosenUntilPreslip, GraspOptimise, float", grasp_optimise);
  add_loosening<double>("LoosenUntilPreslip, GraspLift, double", grasp_lift);
  add_lift<double>("double");
  add_lift<float>("float");
  return bench::run(argc, argv);
}
