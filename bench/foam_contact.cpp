// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The rider of the foam contact model ("ns/pixel" is per call, or per step). "textbook": the
// underdamped solution by exp, cos and sin as they are. "printed": both integrals of eq. 10 by the
// trapezoidal rule, from 0. Errors: of closed forms, of an undamped rider at times up to 10^4, as a
// share of its amplitude; of steps, the same after 10^5 steps of 0.1; of lifts, in mm at t = 40,
// and the time is that of the whole lift.
#include "fingerpad/foam_contact.hpp"

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "support/run.hpp"

using namespace fingerpad;

namespace {

/// Times as they come.
template <class S>
struct Times {
  std::size_t k = 0;
  S next() { return S(10) * static_cast<S>(k++ % 1000); }
};

template <class S>
S textbook(const Rider<S>& rider, const S& time) {
  const S s = rider.damping_n_s_per_mm / (2 * rider.mass_n_s2_per_mm);
  const S w = std::sqrt(rider.stiffness_n_per_mm / rider.mass_n_s2_per_mm - s * s);
  return std::exp(-s * time) * (std::cos(w * time) + s / w * std::sin(w * time));
}

/// of(rider, time): the position after a start at 1.
template <class S, class Solution>
void add_closed_form(const std::string& name, double damping, const Solution& of) {
  const auto times = std::make_shared<Times<S>>();
  const Rider<S> rider{S(1), static_cast<S>(damping), S(1)};
  bench::add(
      name, 1, [=] { benchmark::DoNotOptimize(of(rider, times->next())); },
      [=](auto& counters) {
        const Rider<S> undamped{S(0.37), S(0), S(2.9)};
        const Rider<long double> truth{static_cast<long double>(undamped.mass_n_s2_per_mm), 0,
                                       static_cast<long double>(undamped.stiffness_n_per_mm)};
        long double worst = 0;
        for (int k = 0; k < 1000; ++k) {
          const S t = S(10) * static_cast<S>(k);
          const auto exact = free_motion(truth, {1, 0}, static_cast<long double>(t)).position_mm;
          worst = std::fmax(worst, std::abs(static_cast<long double>(of(undamped, t)) - exact));
        }
        counters["max_error_share"] = static_cast<double>(worst);
      });
}

template <class S>
void add_closed_forms(const std::string& type) {
  const std::string group = "closed form, " + type + "/";
  const auto ours = [](const Rider<S>& rider, const S& t) {
    return free_motion(rider, {S(1), S(0)}, t).position_mm;
  };
  add_closed_form<S>(group + "textbook, damping ratio 0.5", 1, &textbook<S>);
  add_closed_form<S>(group + "free_motion, damping ratio 0.5", 1, ours);
  add_closed_form<S>(group + "free_motion, damping ratio 20", 40, ours);
}

template <class S, class Words>
void add_steps(const std::string& name, bool jitter) {
  struct Data {
    FirstOrderHold<S, Words> hold{Rider<S>{}, S(0.1)};
    typename FirstOrderHold<S, Words>::State state = hold.start();
    int k = 0;
  };
  const auto d = std::make_shared<Data>();
  bench::add(
      name, 1,
      [=] {
        const S before = static_cast<S>(d->k % 16), after = static_cast<S>(++d->k % 16);
        if (jitter) {
          benchmark::DoNotOptimize(d->hold(before, after, S(0.1), d->state));
        } else {
          benchmark::DoNotOptimize(d->hold(before, after, d->state));
        }
      },
      [](auto& counters) {
        const Rider<S> undamped{S(1), S(0), S(1)};
        const FirstOrderHold<S, Words> hold(undamped, S(0.1));
        auto state = hold.start({S(1), S(0)});
        for (int k = 0; k < 100000; ++k) {
          hold(S(0), S(0), state);
        }
        const long double time = 100000 * static_cast<long double>(S(0.1));
        counters["max_error_share"] = static_cast<double>(
            std::abs(static_cast<long double>(state.motion().position_mm) - std::cos(time)));
      });
}

template <class S>
void add_all_steps(const std::string& type) {
  const std::string group = "steps, " + type + "/";
  add_steps<S, OneWord>(group + "OneWord", false);
  add_steps<S, TwoWords>(group + "TwoWords", false);
  add_steps<S, OneWord>(group + "OneWord, another length each time", true);
  struct Data {
    Creep<S> creep{Burgers<S>{}, S(0.1)};
    typename Creep<S>::State state = creep.start();
    int k = 0;
  };
  const auto d = std::make_shared<Data>();
  bench::add(
      group + "Creep", 1,
      [=] {
        const S before = static_cast<S>(d->k % 16), after = static_cast<S>(++d->k % 16);
        benchmark::DoNotOptimize(d->creep(before, after, d->state));
      },
      [](auto&) {});
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

void add_lift(int steps) {
  const LiftLoad<double> load{2, 0.5, 3, {0.3, 0.05}};
  const double exact = 2.8009407050775539372775000664187;
  const std::string step = ", " + std::to_string(steps) + " steps";
  bench::add(
      "lift/printed" + step, 1, [=] { benchmark::DoNotOptimize(printed_lift(load, 40, steps)); },
      [=](auto& counters) {
        counters["max_error_mm"] = std::abs(printed_lift(load, 40, steps) - exact);
      });
  bench::add(
      "lift/causal_response" + step, 1,
      [=] {
        benchmark::DoNotOptimize(causal_response<OneWord>(Rider<double>{}, load, 40.0, steps));
      },
      [=](auto& counters) {
        const auto motion = causal_response<OneWord>(Rider<double>{}, load, 40.0, steps);
        counters["max_error_mm"] = std::abs(motion.position_mm - exact);
      });
}

}  // namespace

int main(int argc, char** argv) {
  add_closed_forms<double>("double");
  add_closed_forms<float>("float");
  add_all_steps<double>("double");
  add_all_steps<float>("float");
  add_lift(400);
  add_lift(2000);
  add_lift(4000);
  return bench::run(argc, argv);
}
