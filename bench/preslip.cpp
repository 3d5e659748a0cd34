// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The rules of pre-slip over a full history of two fingers; "ns/pixel" is per sample.
//   quiet     nothing vibrates
//   no pair   both fingers vibrate always, by turns with 1 to 8 waves, but at one place: the whole
//             history is gone through
//   slipping  both vibrate at any place with any of 1 to 8 waves: pairs are found soon
// "alarms": the share of the samples with one.
#include "fingerpad/preslip.hpp"

#include <array>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "support/run.hpp"

using namespace fingerpad;

namespace {

using Hand = std::array<FingerSample<double>, 2>;
using Cells = GraspLift<MovedToOtherCell>;
using CellsBoth = GraspLift<MovedToOtherCell, BothAxes>;

enum class Scene { quiet, no_pair, slipping };

const char* name_of(Scene scene) {
  return scene == Scene::quiet ? "quiet" : scene == Scene::no_pair ? "no pair" : "slipping";
}

std::vector<Hand> samples(Scene scene) {
  std::vector<Hand> all(1 << 12);
  std::mt19937 random(1);
  const auto any = [&](Index below) {
    return static_cast<Index>(random() % static_cast<unsigned>(below));
  };
  for (Hand& hand : all) {
    for (auto& sample : hand) {
      sample.center_x_mm = 8 + 0.01 * static_cast<double>(any(100));
      sample.center_y_mm = 20 + 0.01 * static_cast<double>(any(100));
      if (scene != Scene::quiet) {
        sample.location = scene == Scene::no_pair ? 40 : any(162);
        sample.waves = 1 + any(8);
      }
    }
  }
  return all;
}

template <class Rule, class Search>
void add(const std::string& rule, const std::string& search, Scene scene, Index history) {
  struct Data {
    Preslip<Rule, 2, Search> preslip;
    typename Preslip<Rule, 2, Search>::State state = preslip.start();
    std::vector<Hand> hands;
    std::size_t k = 0;
    std::size_t alarms = 0;

    void step() {
      alarms += preslip(hands[k % hands.size()], state).alarm ? 1U : 0U;
      ++k;
    }
  };
  const auto d = std::make_shared<Data>(
      Data{.preslip = Preslip<Rule, 2, Search>({.history = history}), .hands = samples(scene)});
  const std::string name =
      rule + ", " + name_of(scene) + ", history " + std::to_string(history) + "/" + search;
  benchmark::RegisterBenchmark(name.c_str(), [d, history](benchmark::State& state) {
    while (d->k < static_cast<std::size_t>(history)) {
      d->step();  // the history is filled before the time is taken
    }
    for (auto _ : state) {
      d->step();
      benchmark::ClobberMemory();
    }
    state.counters["pixels/s"] =
        benchmark::Counter(1, benchmark::Counter::kIsIterationInvariantRate);
    state.counters["alarms"] = static_cast<double>(d->alarms) / static_cast<double>(d->k);
  })->Unit(benchmark::kMicrosecond);
}

template <class Rule, bool WithConstantTime>
void add_searches(const std::string& rule) {
  for (const Scene scene : {Scene::quiet, Scene::no_pair, Scene::slipping}) {
    for (const Index history : {100, 1000, 10000}) {
      if (history < 10000) {
        add<Rule, AllPairs>(rule, "published: AllPairs", scene, history);
      }
      add<Rule, NewestPairs>(rule, "NewestPairs", scene, history);
      if constexpr (WithConstantTime) {
        add<Rule, ConstantTime>(rule, "ConstantTime", scene, history);
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  add_searches<GraspOptimise<>, true>("GraspOptimise<>");
  add_searches<GraspOptimise<AnyPair>, true>("GraspOptimise<AnyPair>");
  add_searches<GraspLift<>, false>("GraspLift<>, the default");
  add_searches<Cells, true>("GraspLift<MovedToOtherCell>");
  add_searches<CellsBoth, true>("GraspLift<MovedToOtherCell, BothAxes>");
  return bench::run(argc, argv);
}
