// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Grip control: time of a call ("ns/pixel" is per call), and what laws do in a closed loop with
// simulated fingertips (examples/grip): friction 0.4, 0.7 and 1, a load that rises from 0.4 N to
// 3 N by 0.2, 0.5, 1 and 2 N/s, 30 frames/s, gripped at first with twice what the load needs.
// Error: how far the object slid at most; "held": share of the twelve runs in which it slid less
// than 0.5 mm; "needed": mean over those of the least force that would do, as a share of the force
// at the end.
#include "fingerpad/grip_control.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "../examples/grip/camera.hpp"
#include "fingerpad/friction_ratio.hpp"
#include "fingerpad/stick_ratio.hpp"
#include "support/run.hpp"

using namespace fingerpad;

namespace {

/// Ratios as they come: falling, standing, none.
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

template <class S>
void add_call(const std::string& name) {
  struct Data {
    GripControl<S> control;
    typename GripControl<S>::State state = control.start(S(3));
    Calls calls;
  };
  const auto d = std::make_shared<Data>();
  bench::add(
      "call/" + name, 1,
      [d] {
        const auto news = d->calls.k % 4 == 0 ? RatioNews::fresh : RatioNews::unmoved;
        benchmark::DoNotOptimize(d->control(S(d->calls.next()), news, S(0.01), d->state));
        if (d->calls.k % 64 == 0) {
          d->state.reset();
        }
      },
      [](auto&) {});
}

template <class S>
void add_friction(const std::string& name) {
  struct Data {
    FrictionRatio<S> friction;
    typename FrictionRatio<S>::State state = friction.start();
    Calls calls;
  };
  const auto d = std::make_shared<Data>();
  bench::add(
      "call/" + name, 1,
      [d] {
        const Point2<S> force{S(d->calls.next()), S(0.2)};
        benchmark::DoNotOptimize(d->friction(force, S(2), d->calls.k % 50 == 0, d->state));
      },
      [](auto&) {});
}

struct Outcome {
  double slip_mm;
  double needed;  ///< of the force at the end
};

/// With `law`, or with a constant force.
Outcome run(const GripLaw<double>* law, double friction, double rise_n_per_s) {
  constexpr double first_n = 0.4, last_n = 3, frame_s = 1.0 / 30;
  const grip::Fingertip tip{.friction = friction};
  double force_n = 2 * first_n / friction;
  const StickRatio stick_ratio(tip.dots, tip.dots);
  const GripControl control(law != nullptr ? *law : GripLaw<double>());
  auto stick_state = stick_ratio.start();
  auto grip_state = control.start(force_n);
  std::vector<DotState> states(static_cast<std::size_t>(tip.dots * tip.dots));
  const StridedView<DotState> states_out(states.data(), tip.dots, tip.dots, tip.dots);
  grip::Camera camera(tip.dots);
  grip::SlippingLoad load(tip, first_n, force_n);
  const double end_s = (last_n - first_n) / rise_n_per_s + 3;
  for (double time_s = 0; time_s < end_s && load.slip_mm() < 20; time_s += frame_s) {
    load.advance((std::min)(first_n + rise_n_per_s * time_s, last_n), force_n, frame_s);
    camera.look_at(load);
    const auto stick = stick_ratio(camera.dots(), camera.touch(), states_out, stick_state);
    const auto grip =
        control(double(stick.stick_ratio), news_of(stick.status), frame_s, grip_state);
    force_n = law != nullptr ? grip.force_n : force_n;
  }
  return {load.slip_mm(), last_n / friction / force_n};
}

struct Summary {
  double held = 0;
  double needed = 0;
  double slip_mm = 0;
};

Summary all_runs(const GripLaw<double>* law) {
  Summary sum;
  for (const double friction : {0.4, 0.7, 1.0}) {
    for (const double rise : {0.2, 0.5, 1.0, 2.0}) {
      const Outcome o = run(law, friction, rise);
      const bool held = o.slip_mm < 0.5;
      sum.held += held ? 1 : 0;
      sum.needed += held ? o.needed : 0;
      sum.slip_mm = (std::max)(sum.slip_mm, o.slip_mm);
    }
  }
  sum.needed /= (std::max)(sum.held, 1.0);
  sum.held /= 12;
  return sum;
}

void add_loop(const std::string& name, const GripLaw<double>& law, bool constant = false) {
  struct Data {
    GripControl<double> control;
    GripControl<double>::State state = control.start();
    Calls calls = {};
    std::unique_ptr<Summary> summary = nullptr;
  };
  const auto d = std::make_shared<Data>(Data{GripControl<double>(law)});
  bench::add(
      "closed loop/" + name, 1,
      [d] { benchmark::DoNotOptimize(d->control(d->calls.next(), 0.01, d->state)); },
      [=](auto& counters) {
        if (!d->summary) {
          d->summary = std::make_unique<Summary>(all_runs(constant ? nullptr : &law));
        }
        counters["share_held"] = d->summary->held;
        counters["share_needed"] = d->summary->needed;
        counters["max_error_mm"] = d->summary->slip_mm;
      });
}

}  // namespace

int main(int argc, char** argv) {
  add_call<double>("GripControl, double");
  add_call<float>("GripControl, float");
  add_friction<double>("FrictionRatio, double");
  add_friction<float>("FrictionRatio, float");
  add_loop("constant force", {}, true);
  add_loop("default: set point 0.8, gain 60 N/s", {});
  add_loop("gain 10 N/s", {.raise_gain_n_per_s = 10});
  add_loop("gain 20 N/s", {.raise_gain_n_per_s = 20});
  add_loop("gain 30 N/s", {.raise_gain_n_per_s = 30});
  add_loop("set point 0.6", {.set_point = 0.6});
  add_loop("set point 0.7", {.set_point = 0.7});
  add_loop("set point 0.9", {.set_point = 0.9});
  add_loop("a ratio lasts one frame", {.ratio_lasts_s = 0});
  add_loop("one frame, and standing dots are trusted", {.ratio_lasts_s = 0, .sliding_ratio = 0});
  add_loop("lowered by up to 1 N/s above 0.9", {.lower_above = 0.9, .lower_gain_n_per_s = 10});
  return bench::run(argc, argv);
}
