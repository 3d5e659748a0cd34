// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Grip control: time of a call ("ns/pixel" is per call), and the results of laws in 40 closed loops
// with simulated fingertips (tests/support/grip_runs.hpp). Error of a call: rounding, against long
// double. Errors of a loop, over the runs: the slip of the object, and the excess of the mean force
// over the least holding force, relative to the latter, in runs with less than 0.5 mm of slip.
// "friction ratio": F/N of the slides on slip. "friction falls twice": ten loops that differ in
// nothing else.
#include "fingerpad/slip/grip_control.hpp"

#include <array>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "fingerpad/published/friction_ratio.hpp"
#include "support/grip_runs.hpp"

using namespace fingerpad;

namespace {

/// Ratios in a fixed cycle: falling, with missing ones.
struct Calls {
  std::vector<double> ratios;
  std::size_t k = 0;

  Calls() {
    for (int i = 0; i < 64; ++i) {
      ratios.push_back(i % 16 == 9 ? not_a_number<double>() : 1 - 0.012 * i);
    }
  }
  double next() { return ratios[k++ % ratios.size()]; }
};

/// Grip control of one fingertip in an endless sequence of calls.
template <class S>
struct Gripping {
  GripControl<S> first{{}, S(3)}, control = first;
  Calls calls = {};

  S next() {
    const auto update = calls.k % 4 == 0 ? RatioUpdate::fresh : RatioUpdate::unmoved;
    const S force = control(S(calls.next()), update, S(0.01)).force_n;
    if (calls.k % 64 == 0) {
      control = first;
    }
    return force;
  }
};

template <class S>
struct Rubbing {
  published::FrictionRatio<S> friction;
  Calls calls = {};

  S next() {
    const S force = S(calls.next()), normal = S(2) + S(static_cast<double>(calls.k % 7));
    return friction(force, normal, calls.k % 50 == 0);
  }
};

/// `Of<S>` is timed; `Of<long double>` is the truth.
template <template <class> class Of, class S>
void add_call(const std::string& name, const std::string& quantity, const std::string& unit) {
  const bench::Memory memory;
  const auto d = std::make_shared<Of<S>>();
  bench::add(
      name, 1, memory.bytes(), [d] { benchmark::DoNotOptimize(d->next()); },
      [=](auto& counters) {
        Of<S> found;
        Of<long double> truth;
        std::vector<double> errors;
        for (int k = 0; k < 1000; ++k) {
          const long double exact = truth.next(), given = static_cast<long double>(found.next());
          if (is_finite(exact)) {  // no truth for a missing ratio or before a slip
            errors.push_back(static_cast<double>(given - exact));
          }
        }
        bench::note_errors(counters, quantity, unit, errors);
      });
}

constexpr std::array scene_names = {"slow", "fast", "friction changes", "rolls"};

struct Runs {
  std::vector<double> slip_mm, beyond;                        // NaN if the object slid
  std::array<std::vector<double>, scene_names.size()> force;  // by scene, per least holding force
};

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

template <class S>
Runs all_runs(const GripOptions<S>& options, const test::GripVariation& vary) {
  Runs runs;
  for (const test::GripScene scene : test::grip_scenes) {
    if (vary.falls_twice && scene != test::GripScene::changes) {
      continue;
    }
    for (int k = 0; k < test::runs_of_a_grip_scene; ++k) {
      const test::GripRun run = test::run_grip(options, scene, k, vary);
      const bool held = run.slip_mm < 0.5;
      runs.slip_mm.push_back(run.slip_mm);
      runs.beyond.push_back(held ? run.beyond : not_a_number<double>());
      if (held) {
        runs.force[static_cast<std::size_t>(scene)].push_back(1 + run.beyond);
      }
    }
  }
  return runs;
}

template <class S = double>
void add_loop(const std::string& name,
              const GripOptions<S>& options,
              const test::GripVariation& vary = {}) {
  const bench::Memory memory;
  const auto d = std::make_shared<Gripping<S>>(Gripping<S>{GripControl<S>(options, S(3))});
  bench::add(
      "closed loop/" + name, 1, memory.bytes(), [d] { benchmark::DoNotOptimize(d->next()); },
      [=, runs = Runs()](auto& counters) mutable {
        runs = runs.beyond.empty() ? all_runs(options, vary) : runs;
        bench::note_errors(counters, "slip", "mm", runs.slip_mm);
        bench::note_errors(counters, "force beyond need", "share", runs.beyond);
        std::vector<double> all;
        for (std::size_t k = 0; k < scene_names.size(); ++k) {
          const std::vector<double>& of_scene = runs.force[k];
          all.insert(all.end(), of_scene.begin(), of_scene.end());
          bench::note_errors(counters, std::string("mean force, ") + scene_names[k], "of the least",
                             {mean(of_scene)});
        }
        bench::note_errors(counters, "mean force", "of the least", {mean(all)});
      });
}

}  // namespace

int main(int argc, char** argv) {
  const GripOptions<double> options;
  add_loop("constant force", options, {.is_controlled = false});
  add_loop("stick ratio alone", options, {.knows_force = false});
  add_loop("dots and friction", options);
  add_loop<float>("dots and friction, float", {});
  add_loop("margin 0.1", {.slip_margin = 0.1});
  add_loop("margin 0.25", {.slip_margin = 0.25});
  add_loop("friction 0.7 times as large", options, {.friction = 0.7});
  add_loop("load twice as large", options, {.load = 2});
  add_loop("load half as large", options, {.load = 0.5});
  add_loop("taken with 1.5 times the least force", options, {.first = 1.5});
  add_loop("twice the noise of dots", options, {.lateral_mm = 0.01, .depth_mm = 0.05});
  add_loop("twice the noise of forces", options, {.force_share = 0.03});
  add_loop("a gripper that lags by 50 ms", options, {.lag_s = 0.05});
  add_loop("friction that falls twice, taken with 1.5 times", options,
           {.first = 1.5, .falls_twice = true});
  add_loop("friction that falls twice", options, {.falls_twice = true});
  bench::add_streaming("closed loop");
  add_call<Gripping, double>("call/GripControl, double", "force", "N");
  add_call<Gripping, float>("call/GripControl, float", "force", "N");
  add_call<Rubbing, double>("friction ratio/published: FrictionRatio, double", "margin", "of 1");
  add_call<Rubbing, float>("friction ratio/published: FrictionRatio, float", "margin", "of 1");
  return bench::run(argc, argv);
}
