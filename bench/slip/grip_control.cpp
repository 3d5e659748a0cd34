// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Grip control: time of a call ("ns/pixel" is per call), and what laws do in a closed loop with
// simulated fingertips (examples/grip): friction 0.4, 0.7 and 1, a load that rises from 0.4 N to
// 3 N by 0.2, 0.5, 1 and 2 N/s, 30 frames/s, gripped at first with twice what the load needs.
// Errors of a call: rounding, against long double. Errors of a loop, over the twelve runs: how far
// the object slid, and the force at the end beyond the least that would do, as a share of that, of
// the runs in which it slid less than 0.5 mm. "friction ratio": F/N of the slides on slip.
#include "fingerpad/slip/grip_control.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "bench/support/run.hpp"
#include "examples/grip/camera.hpp"
#include "fingerpad/published/friction_ratio.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "fingerpad/slip/stick_ratio.hpp"

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

/// A fingertip's control and calls without end.
template <class S>
struct Gripping {
  GripControl<S> control;
  typename GripControl<S>::State state = control.start(S(3));
  Calls calls = {};

  S next() {
    const auto update = calls.k % 4 == 0 ? RatioUpdate::fresh : RatioUpdate::unmoved;
    const S force = control(S(calls.next()), update, S(0.01), state).force_n;
    if (calls.k % 64 == 0) {
      state.reset();
    }
    return force;
  }
};

template <class S>
struct Rubbing {
  published::FrictionRatio<S> friction;
  typename published::FrictionRatio<S>::State state = friction.start();
  Calls calls = {};

  S next() {
    const Point2<S> force{S(calls.next()), S(0.2)};
    const S normal = S(2) + S(static_cast<double>(calls.k % 7));
    return friction(force, normal, calls.k % 50 == 0, state).margin;
  }
};

/// Of<S>: what is called; Of<long double> is the truth.
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
          if (is_finite(exact)) {  // nothing can be said of a missing ratio, nor before a slip
            errors.push_back(static_cast<double>(given - exact));
          }
        }
        bench::note_errors(counters, quantity, unit, errors);
      });
}

struct Outcome {
  double slip_mm;
  double beyond;  ///< the least force, as a share of it
};

enum class Fed { by_dots, by_dots_and_friction };

/// With `law`, or with a constant force.
template <class S>
Outcome run(const GripLaw<S>* law, double friction, double rise_n_per_s, Fed fed) {
  constexpr double first_n = 0.4, last_n = 3, frame_s = 1.0 / 30;
  const grip::Fingertip tip{.friction = friction};
  double force_n = 2 * first_n / friction;
  const StickRatio stick_ratio(tip.dots, tip.dots);
  const GripControl<S> control(law != nullptr ? *law : GripLaw<S>());
  const FrictionLimit<S> limit;
  auto limit_state = limit.start();
  auto stick_state = stick_ratio.start();
  auto grip_state = control.start(S(force_n));
  std::vector<DotState> states(static_cast<std::size_t>(tip.dots * tip.dots));
  const StridedView<DotState> states_out(states.data(), tip.dots, tip.dots, tip.dots);
  grip::Camera camera(tip.dots);
  grip::SlippingLoad load(tip, first_n, force_n);
  const double end_s = (last_n - first_n) / rise_n_per_s + 3;
  for (double time_s = 0; time_s < end_s && load.slip_mm() < 20; time_s += frame_s) {
    load.advance((std::min)(first_n + rise_n_per_s * time_s, last_n), force_n, frame_s);
    camera.look_at(load);
    const auto stick = stick_ratio(camera.dots(), camera.touch(), states_out, stick_state);
    const auto load_now =
        fed == Fed::by_dots ? ContactLoad<S>{} : ContactLoad<S>{S(force_n), S(load.held_n())};
    const auto slip = limit(load_now, S(stick.stick_ratio), update_of(stick.status), limit_state);
    const auto grip = control(slip, S(frame_s), grip_state);
    force_n = law != nullptr ? double(grip.force_n) : force_n;
  }
  return {load.slip_mm(), force_n * friction / last_n - 1};
}

struct Runs {
  std::vector<double> slip_mm, beyond;
};

template <class S>
Runs all_runs(const GripLaw<S>* law, Fed fed) {
  Runs runs;
  for (const double friction : {0.4, 0.7, 1.0}) {
    for (const double rise : {0.2, 0.5, 1.0, 2.0}) {
      const Outcome o = run(law, friction, rise, fed);
      runs.slip_mm.push_back(o.slip_mm);
      runs.beyond.push_back(o.slip_mm < 0.5 ? o.beyond : not_a_number<double>());
    }
  }
  return runs;
}

template <class S = double>
void add_loop(const std::string& name,
              const GripLaw<S>& law,
              bool constant = false,
              Fed fed = Fed::by_dots) {
  const bench::Memory memory;
  const auto d = std::make_shared<Gripping<S>>(Gripping<S>{GripControl<S>(law)});
  bench::add(
      "closed loop/" + name, 1, memory.bytes(), [d] { benchmark::DoNotOptimize(d->next()); },
      [=, runs = Runs()](auto& counters) mutable {
        runs = runs.beyond.empty() ? all_runs(constant ? nullptr : &law, fed) : runs;
        bench::note_errors(counters, "slip", "mm", runs.slip_mm);
        bench::note_errors(counters, "force beyond need", "share", runs.beyond);
      });
}

}  // namespace

int main(int argc, char** argv) {
  add_loop("constant force", {}, true);
  add_loop("default: set point 0.8, gain 60 N/s", {});
  add_loop("default, dots and friction", {}, false, Fed::by_dots_and_friction);
  add_loop<float>("default, float", {});
  add_loop("gain 10 N/s", {.raise_gain_n_per_s = 10});
  add_loop("gain 20 N/s", {.raise_gain_n_per_s = 20});
  add_loop("gain 30 N/s", {.raise_gain_n_per_s = 30});
  add_loop("set point 0.6", {.set_point = 0.6});
  add_loop("set point 0.7", {.set_point = 0.7});
  add_loop("set point 0.9", {.set_point = 0.9});
  add_loop("a ratio lasts one frame", {.ratio_lasts_s = 0});
  add_loop("one frame, and standing dots are trusted", {.ratio_lasts_s = 0, .sliding_ratio = 0});
  add_loop("lowered by up to 1 N/s above 0.9", {.lower_above = 0.9, .lower_gain_n_per_s = 10});
  bench::add_streaming("closed loop");
  add_call<Gripping, double>("call/GripControl, double", "force", "N");
  add_call<Gripping, float>("call/GripControl, float", "force", "N");
  add_call<Rubbing, double>("friction ratio/published: FrictionRatio, double", "margin", "of 1");
  add_call<Rubbing, float>("friction ratio/published: FrictionRatio, float", "margin", "of 1");
  return bench::run(argc, argv);
}
