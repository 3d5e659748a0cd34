// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The foam contact model; "ns/pixel" is per call or per step. "textbook": the underdamped solution
// by plain exp, cos and sin. "printed": both integrals of eq. 10 by the trapezoidal rule, from 0;
// eq. 9 with its constants exchanged. Errors:
//   closed form        relative to the amplitude, at 1000 times: up to 10^4 without damping, up to
//   20
//                      with the damping of the row
//   ramp load          mm, at 1000 times up to 40
//   steps              relative, at each 100th of 10^5 steps of 0.1, of an undamped oscillator or
//   of
//                      the strain of a held stress
//   lift               mm, at ten times up to 40; the time is that of the whole lift
//   friction and area  relative, over loads from 10^-6 to 100 N
#include "fingerpad/sim/foam_contact.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "bench/support/run.hpp"

using namespace fingerpad;

namespace {

using Long = long double;
template <class S>
using Motion = typename MassSpringDamper<S>::Motion;

template <class S>
std::string in(const std::string& name) {
  return name + (sizeof(S) == sizeof(float) ? ", float" : ", double");
}

/// Error relative to `of`.
template <class S>
double off(const S& found, Long truth, Long of = 1) {
  return static_cast<double>((static_cast<Long>(found) - truth) / of);
}

/// Times in a fixed cycle.
template <class S>
struct Times {
  std::size_t k = 0;
  S next() { return S(10) * static_cast<S>(k++ % 1000); }
};

template <class S>
S textbook(const MassSpringDamper<S>& oscillator, const S& time) {
  const S s = oscillator.damping_n_s_per_mm / (2 * oscillator.mass_n_s2_per_mm);
  const S w = std::sqrt(oscillator.stiffness_n_per_mm / oscillator.mass_n_s2_per_mm - s * s);
  return std::exp(-s * time) * (std::cos(w * time) + s / w * std::sin(w * time));
}

/// `of(oscillator, time)` is the position after a start at 1.
template <class S, class Solution>
void add_closed_form(const std::string& name, double damping, const Solution& of) {
  const auto times = std::make_shared<Times<S>>();
  const MassSpringDamper<S> oscillator{S(1), static_cast<S>(damping), S(1)};
  bench::add(
      "closed form/" + in<S>(name), 1, sizeof(oscillator),
      [=] { benchmark::DoNotOptimize(of(oscillator, times->next())); },
      [=](auto& counters) {
        const MassSpringDamper<S> undamped{S(0.37), S(0), S(2.9)};
        const auto errors = [&](const MassSpringDamper<S>& of_rider, double step) {
          const MassSpringDamper<Long> truth{static_cast<Long>(of_rider.mass_n_s2_per_mm),
                                             static_cast<Long>(of_rider.damping_n_s_per_mm),
                                             static_cast<Long>(of_rider.stiffness_n_per_mm)};
          std::vector<double> all;
          for (int k = 0; k < 1000; ++k) {
            const S t = static_cast<S>(step * k);
            const auto exact = free_motion(truth, {1, 0}, static_cast<Long>(t)).position_mm;
            all.push_back(off(of(of_rider, t), exact));
          }
          return all;
        };
        bench::note_errors(counters, "undamped", "share", errors(undamped, 10));
        bench::note_errors(counters, "damped", "share", errors(oscillator, 0.02));
      });
}

template <class S>
void add_closed_forms() {
  const auto ours = [](const MassSpringDamper<S>& oscillator, const S& t) {
    return free_motion(oscillator, {S(1), S(0)}, t).position_mm;
  };
  add_closed_form<S>("published: textbook, damping ratio 0.5", 1, &textbook<S>);
  add_closed_form<S>("free_motion, damping ratio 0.5", 1, ours);
  add_closed_form<S>("free_motion, damping ratio 20", 40, ours);
}

/// y = y_c + y_p as printed, from rest.
template <class S>
S printed_response(const RampLoad<S>& load, const S& time) {
  const Motion<S> at_start = printed_particular_solution(load, S(0));
  return printed_particular_solution(load, time).position_mm +
         free_motion(MassSpringDamper<S>{}, {-at_start.position_mm, -at_start.velocity_mm_per_s},
                     time)
             .position_mm;
}

template <class S>
S response(const RampLoad<S>& load, const S& time) {
  return ramp_response(MassSpringDamper<S>{}, load, Motion<S>{}, time).position_mm;
}

template <class S, class Solution>
void add_ramp(const std::string& name, const Solution& of) {
  const RampLoad<S> load{S(2), S(0.5)};
  const auto times = std::make_shared<Times<S>>();
  bench::add(
      "ramp load/" + in<S>(name), 1, sizeof(load),
      [=] { benchmark::DoNotOptimize(of(load, times->next())); },
      [=](auto& counters) {
        std::vector<double> errors;
        for (int k = 0; k < 1000; ++k) {
          const S t = S(0.04) * static_cast<S>(k);
          errors.push_back(
              off(of(load, t), response(RampLoad<Long>{2, 0.5L}, static_cast<Long>(t))));
        }
        bench::note_errors(counters, "position", "mm", errors);
      });
}

/// `step(before, after)` is timed. `run()` starts afresh and returns a function that gives the
/// answer of each next step; `truth(answer, time)` is its error.
template <class S, class Step, class Run, class Truth>
void add_steps(
    const std::string& name, long bytes, const Step& step, const Run& run, const Truth& truth) {
  bench::add(
      "steps/" + in<S>(name), 1, bytes,
      [step, k = 0]() mutable {
        const S before = static_cast<S>(k % 16), after = static_cast<S>(++k % 16);
        benchmark::DoNotOptimize(step(before, after));
      },
      [=](auto& counters) {
        const auto next = run();
        std::vector<double> errors;
        for (int k = 1; k <= 100000; ++k) {
          const S found = next();
          if (k % 100 == 0) {
            errors.push_back(truth(found, k * static_cast<Long>(S(0.1))));
          }
        }
        bench::note_errors(counters, "answer", "share", errors);
      });
}

template <class S>
void add_hold(const std::string& name, bool jitter) {
  using Hold = FirstOrderHold<S>;
  struct Data {
    Hold hold;
    typename Hold::State state = hold.start({S(1), S(0)});

    S next(const S& before, const S& after, bool jitter) {
      return (jitter ? hold(before, after, S(0.1), state) : hold(before, after, state)).position_mm;
    }
  };
  const bench::Memory memory;
  const auto d = std::make_shared<Data>(Data{Hold(MassSpringDamper<S>{}, S(0.1))});
  add_steps<S>(
      name, memory.bytes(),
      [=](const S& before, const S& after) { return d->next(before, after, jitter); },
      [=] {
        const auto undamped =
            std::make_shared<Data>(Data{Hold(MassSpringDamper<S>{S(1), S(0), S(1)}, S(0.1))});
        return [=] { return undamped->next(S(0), S(0), jitter); };
      },
      [](const S& found, Long time) { return off(found, std::cos(time)); });
}

template <class S>
void add_creep() {
  struct Data {
    Creep<S> creep{Burgers<S>{}, S(0.1)};
    typename Creep<S>::State state = creep.start();
  };
  const bench::Memory memory;
  const auto d = std::make_shared<Data>();
  add_steps<S>(
      "Creep", memory.bytes(),
      [=](const S& before, const S& after) { return d->creep(before, after, d->state); },
      [] {
        const auto held = std::make_shared<Data>();
        return [=] { return held->creep(S(1), S(1), held->state); };
      },
      [](const S& found, Long time) {
        const Long truth = 1 + time + 1 - std::exp(-time);
        return off(found, truth, truth);
      });
}

template <class S>
void add_all_steps() {
  add_hold<S>("FirstOrderHold, the default", false);
  add_hold<S>("FirstOrderHold, another length each time", true);
  add_creep<S>();
}

/// Eq. 10 as printed, with a lower limit of 0: two integrals by the trapezoidal rule.
double printed_lift(const LiftLoad<double>& load, double time, int steps) {
  const double w = std::sqrt(3.0) / 2, h = time / steps;
  double with_sine = 0, with_cosine = 0;
  for (int k = 0; k <= steps; ++k) {
    const double t = h * k, weight = k == 0 || k == steps ? h / 2 : h;
    const double grown = weight * std::exp(t / 2) * load(t);
    with_sine += grown * std::sin(w * t);
    with_cosine += grown * std::cos(w * t);
  }
  return std::exp(-time / 2) / w *
         (std::sin(w * time) * with_cosine - std::cos(w * time) * with_sine);
}

/// The causal integral by 4-point Gauss quadrature in steps of 0.01. At 40 it is 2.8009407050775539
/// (50 digits).
double true_lift(const LiftLoad<double>& load, double time) {
  const double w = std::sqrt(3.0) / 2, half = 0.005;
  double sum = 0;
  for (int k = 0; k < std::lround(time / (2 * half)); ++k) {
    const double middle = (2 * k + 1) * half;
    for (const auto& [at, weight] : {std::array{0.8611363115940526, 0.3478548451374538},
                                     {0.3399810435848563, 0.6521451548625461}}) {
      for (const double u : {middle - half * at, middle + half * at}) {
        sum += weight * half * std::exp((u - time) / 2) * std::sin(w * (time - u)) * load(u);
      }
    }
  }
  return sum / w;
}

/// `of(load, time, steps)` is the position.
template <class Lift>
void add_lift(const std::string& name, int steps, const Lift& of) {
  const LiftLoad<double> load{2, 0.5, 3, {0.3, 0.05}};
  bench::add(
      "lift, " + std::to_string(steps) + " steps/" + name, 1, sizeof(load),
      [=] { benchmark::DoNotOptimize(of(load, 40.0, steps)); },
      [=](auto& counters) {
        std::vector<double> errors;
        for (int k = 1; k <= 10; ++k) {
          const double time = 4.0 * k;
          errors.push_back(of(load, time, steps * k / 10) - true_lift(load, time));
        }
        bench::note_errors(counters, "position", "mm", errors);
      });
}

void add_causal(const std::string& name, int steps) {
  add_lift(name, steps, [](const LiftLoad<double>& load, double time, int count) {
    return causal_response(MassSpringDamper<double>{}, load, time, count).position_mm;
  });
}

void add_lifts(int steps) {
  add_lift("published: printed, trapezoidal rule", steps, &printed_lift);
  add_causal("causal_response, the default", steps);
}

/// `of(load)` and `truth(load)` are compared at loads of all sizes.
template <class S, class Of, class Truth>
void add_power(const std::string& name, const Of& of, const Truth& truth) {
  const auto loads = std::make_shared<std::vector<S>>();
  for (int k = 0; k < 1000; ++k) {
    loads->push_back(static_cast<S>(std::pow(10.0, -6 + 0.008 * k)));
  }
  bench::add(
      "friction and area/" + in<S>(name), 1, 0,
      [=, k = std::size_t(0)]() mutable {
        benchmark::DoNotOptimize(of((*loads)[k]));
        k = k + 1 < loads->size() ? k + 1 : 0;
      },
      [=](auto& counters) {
        std::vector<double> errors;
        for (const S& load : *loads) {
          const Long exact = truth(static_cast<Long>(load));
          errors.push_back(off(of(load), exact, exact));
        }
        bench::note_errors(counters, "answer", "share", errors);
      });
}

template <class S>
void add_powers() {
  const PolymerFriction<S> friction{S(0.75)};
  const HertzContact<S> hertz{S(10), S(0.125)};
  const Long beta = static_cast<Long>(friction.exponent);
  const auto true_friction = [=](Long load) { return 0.75L * std::pow(load, beta); };
  add_power<S>(
      "published: (K N^(beta-1)) N",
      [=](const S& load) {
        return friction.factor * std::pow(load, friction.exponent - S(1)) * load;
      },
      true_friction);
  add_power<S>(
      "friction_force", [=](const S& load) { return friction_force(friction, load); },
      true_friction);
  add_power<S>(
      "contact_area, HertzContact", [=](const S& load) { return contact_area(hertz, load); },
      [](Long load) {
        return std::acos(-1.0L) * std::pow(3 * load * 10 / (4 * 0.125L), 2 / 3.0L);
      });
}

}  // namespace

int main(int argc, char** argv) {
  add_all_steps<double>();
  add_all_steps<float>();
  bench::add_streaming("steps");
  add_closed_forms<double>();
  add_closed_forms<float>();
  add_ramp<double>("published: eq. 9 as printed", &printed_response<double>);
  add_ramp<double>("ramp_response", &response<double>);
  add_ramp<float>("ramp_response", &response<float>);
  for (const int steps : {400, 2000, 4000}) {
    add_lifts(steps);
  }
  add_powers<double>();
  add_powers<float>();
  return bench::run(argc, argv);
}
