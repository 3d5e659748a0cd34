// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The oscillator's closed form and its steps against 50 digits over times of up to 10^4 and all
// kinds of damping, the lift against quadrature, creep, powers of the load, derivatives.
//
// Errors are relative to the larger of |y| and the sizes of its summands, each taken as its maximum
// within a period at that time; for a velocity also to sqrt(k/m) times the summands that the load
// holds in place. Errors below the smallest normal number are ignored.
#include "fingerpad/sim/foam_contact.hpp"

#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "support/catch.hpp"
#include "support/numbers.hpp"

namespace test {

template <class Real>
Dual<Real> log(const Dual<Real>& a) {
  using std::log;
  return {Real(log(a.v)), Real(a.d / a.v)};
}
template <class Real>
Dual<Real> sin(const Dual<Real>& a) {
  using std::cos;
  using std::sin;
  return {Real(sin(a.v)), Real(a.d * cos(a.v))};
}
template <class Real>
Dual<Real> cos(const Dual<Real>& a) {
  using std::cos;
  using std::sin;
  return {Real(cos(a.v)), Real(-a.d * sin(a.v))};
}

}  // namespace test

using namespace fingerpad;
using test::Digits50;
template <class S>
using Motion = typename MassSpringDamper<S>::Motion;

namespace {

struct Damping {
  double ratio;
  const char* name;
};
constexpr Damping dampings[] = {{0, "0"}, {0.5, "0.5"},           {1 - 1e-9, "1 - 1e-9"},
                                {1, "1"}, {1 + 1e-9, "1 + 1e-9"}, {20, "20"}};

/// "1.2e-16"
std::string brief(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1e", number);
  return text;
}

template <class S>
constexpr double bound() {
  return std::is_same_v<S, float> ? 1e-5 : 1e-12;
}

template <class Wide>
constexpr double wide_epsilon = static_cast<double>(std::numeric_limits<Wide>::epsilon());

/// An oscillator whose damping ratio is as near to `ratio` as the type allows.
template <class S>
MassSpringDamper<S> rider_of(double mass, double stiffness, double ratio) {
  const S m = static_cast<S>(mass), k = static_cast<S>(stiffness);
  const double critical = 2 * std::sqrt(static_cast<double>(m) * static_cast<double>(k));
  return {m, static_cast<S>(ratio * critical), k};
}

/// The textbook's wave and lag in 50 digits, and their maxima within a period.
struct Truth {
  Digits50 wave, lag, max_wave, max_lag;
  Digits50 decay, natural_sq;

  template <class S>
  Truth(const MassSpringDamper<S>& oscillator, const Digits50& t) {
    const Digits50 m(oscillator.mass_n_s2_per_mm), c(oscillator.damping_n_s_per_mm);
    decay = c / (2 * m);
    natural_sq = Digits50(oscillator.stiffness_n_per_mm) / m;
    const Digits50 split = decay * decay - natural_sq;
    const Digits50 gone = exp(Digits50(-decay * t));
    if (split < 0) {
      const Digits50 w = sqrt(Digits50(-split));
      wave = gone * cos(Digits50(w * t));
      lag = gone * sin(Digits50(w * t)) / w;
      max_wave = gone;
      max_lag = gone * (w * t < 1 ? t : Digits50(1 / w));
    } else {
      const Digits50 r = sqrt(split);
      const Digits50 slow = exp(Digits50((r - decay) * t)), fast = exp(Digits50((-r - decay) * t));
      max_wave = wave = (slow + fast) / 2;
      max_lag = lag = split > 0 ? Digits50((slow - fast) / (2 * r)) : Digits50(t * gone);
    }
  }
};

struct Case {
  RampLoad<double> load;
  Motion<double> start;
};
const std::vector<Case> cases = {
    {{0, 0}, {1, 0}}, {{0, 0}, {0, 1}}, {{1, 0.0625}, {0, 0}}, {{-3, 0}, {0.5, -2}}};

/// y and v of a ramp load, and the scales of their errors.
struct Answer {
  Digits50 y, v, y_scale, v_scale;
};

template <class S>
Answer answer(const MassSpringDamper<S>& oscillator,
              const Truth& w,
              const Case& of,
              const Digits50& t) {
  const Digits50 k(oscillator.stiffness_n_per_mm), c(oscillator.damping_n_s_per_mm);
  const Digits50 rise = Digits50(of.load.rise_n_per_s) / k, held = Digits50(of.load.start_n) / k;
  const Digits50 lagging = c * rise / k;
  const Digits50 y = of.start.position_mm - (held - lagging), v = of.start.velocity_mm_per_s - rise;
  Answer a;
  a.y = rise * t + held - lagging + (w.wave + w.decay * w.lag) * y + w.lag * v;
  a.v = rise + (w.wave - w.decay * w.lag) * v - w.natural_sq * w.lag * y;
  const Digits50 parts = abs(Digits50(rise * t)) + abs(held) + abs(lagging);
  const Digits50 most = w.max_wave + w.decay * w.max_lag;
  a.y_scale = (std::max)(Digits50(abs(a.y)), Digits50(parts + most * abs(y) + w.max_lag * abs(v)));
  a.v_scale =
      abs(rise) + most * abs(v) + w.natural_sq * w.max_lag * abs(y) + sqrt(w.natural_sq) * parts;
  return a;
}

template <class S>
double off(const S& a, const Digits50& b, const Digits50& scale) {
  const Digits50 smallest((std::numeric_limits<S>::min)());
  const Digits50 error = abs(Digits50(Digits50(a) - b));
  return error <= smallest ? 0 : static_cast<double>(Digits50(error / scale));
}

template <class S>
double off_motion(const Motion<S>& a, const Answer& b) {
  return (std::max)(off(a.position_mm, b.y, b.y_scale), off(a.velocity_mm_per_s, b.v, b.v_scale));
}

template <class S>
Motion<S> motion_as(const Motion<double>& m) {
  return {S(m.position_mm), S(m.velocity_mm_per_s)};
}
template <class S>
RampLoad<S> as(const RampLoad<double>& load) {
  return {S(load.start_n), S(load.rise_n_per_s)};
}

const std::pair<double, double> masses_and_springs[] = {{1, 1}, {0.37, 2.9}, {0.0042, 15}};

template <class S>
double worst_closed_form(double ratio) {
  double worst = 0;
  for (const auto& [mass, stiffness] : masses_and_springs) {
    const MassSpringDamper<S> oscillator = rider_of<S>(mass, stiffness, ratio);
    for (const double time :
         {0.0, 1e-6, 0.01, 0.7, 1.0, 3.3, 12.5, 40.0, 86.0, 177.5, 640.0, 1419.5, 3333.3, 1e4}) {
      const S t = static_cast<S>(time);
      const Truth truth(oscillator, Digits50(t));
      for (const Case& of : cases) {
        const Motion<S> motion =
            ramp_response(oscillator, as<S>(of.load), motion_as<S>(of.start), t);
        worst =
            (std::max)(worst, off_motion<S>(motion, answer(oscillator, truth, of, Digits50(t))));
      }
    }
  }
  return worst;
}

/// Worst error up to time 10^4 in steps of 1/8, checked after 8, 64, 512, ... steps and at the end.
template <class S>
double worst_of_steps(double mass, double stiffness, double ratio) {
  double worst = 0;
  const MassSpringDamper<S> oscillator = rider_of<S>(mass, stiffness, ratio);
  const FirstOrderHold<S> hold(oscillator, S(0.125));
  for (const Case& of : {Case{{0, 0}, {1, -1}}, Case{{1, 0.0625}, {0, 0}}}) {
    const RampLoad<S> load = as<S>(of.load);
    auto state = hold.start(motion_as<S>(of.start));
    int look = 8;
    for (int n = 1; n <= 80000; ++n) {
      const S t = S(0.125) * static_cast<S>(n);
      const Motion<S> motion = hold(load(S(t - S(0.125))), load(t), state);
      if (n == look || n == 80000) {
        look *= 8;
        const Truth truth(oscillator, Digits50(t));
        worst =
            (std::max)(worst, off_motion<S>(motion, answer(oscillator, truth, of, Digits50(t))));
      }
    }
  }
  return worst;
}

}  // namespace

TEMPLATE_TEST_CASE("foam contact: the closed form follows 50 digits",
                   "[foam_contact]",
                   double,
                   float) {
  for (const auto& [ratio, name] : dampings) {
    const double worst = worst_closed_form<TestType>(ratio);
    INFO("damping ratio " << name << ": worst error " << brief(worst));
    CHECK(worst < bound<TestType>());
  }
}

TEST_CASE("foam contact: the closed form follows 50 digits in other types", "[foam_contact]") {
  for (const Damping& damping : dampings) {
    // no wider number is used here: the phase at the end is 6e5 rad. Near critical damping D
    // cancels, and a wave that has decayed after 11000 rad has an error of half of their square.
    const bool is_critical = std::abs(damping.ratio - 1) < 1e-6;
    const double lost = is_critical ? 11000.0 * 11000 / 2 : 6e5;
    const double epsilon = static_cast<double>(std::numeric_limits<long double>::epsilon());
    CHECK(worst_closed_form<long double>(damping.ratio) / epsilon < 4 * lost);
  }
}

TEMPLATE_TEST_CASE("foam contact: 80000 steps follow 50 digits", "[foam_contact]", double, float) {
  for (const auto& [ratio, name] : dampings) {
    const double worst = (std::max)(worst_of_steps<TestType>(1, 1, ratio),
                                    worst_of_steps<TestType>(0.37, 2.9, ratio));
    INFO("damping ratio " << name << ": worst error " << brief(worst));
    CHECK(worst < bound<TestType>());
  }
}

TEMPLATE_TEST_CASE("foam contact: steps tiny and huge follow 50 digits",
                   "[foam_contact]",
                   double,
                   float) {
  using S = TestType;
  const double epsilon = static_cast<double>(std::numeric_limits<S>::epsilon());
  for (const Damping& damping : dampings) {
    const MassSpringDamper<S> oscillator = rider_of<S>(0.37, 2.9, damping.ratio);
    for (const double length : {1e-12, 1e-7, 1e-3, 0.02, 0.3, 1.0, 7.7, 60.0, 1e3, 1e4, 1e6}) {
      const S step = static_cast<S>(length);
      const Truth truth(oscillator, Digits50(step));
      const FirstOrderHold<S> hold(oscillator, step);
      for (const Case& of : cases) {
        const RampLoad<S> load = as<S>(of.load);
        auto state = hold.start(motion_as<S>(of.start));
        const S end = load(step);
        // the load is linear between its rounded values at both ends
        const Digits50 rise = (Digits50(end) - Digits50(load.start_n)) / Digits50(step);
        const Answer a = answer(oscillator, truth, of, Digits50(step));
        const Digits50 rounding = abs(Digits50(rise - of.load.rise_n_per_s)) * Digits50(step);
        // the fastest rate times the step, in the number in which S is computed
        const double phase = length * (1 + 2 * damping.ratio) * std::sqrt(2.9 / 0.37);
        const double of_phase =
            4 * phase *
            (std::is_same_v<S, float> ? wide_epsilon<double> : wide_epsilon<long double>);
        const Motion<S> motion = hold(load.start_n, end, state);
        CAPTURE(damping.name, length);
        CHECK(abs(Digits50(Digits50(motion.position_mm) - a.y)) <=
              (8 * epsilon + of_phase) * a.y_scale + rounding +
                  Digits50((std::numeric_limits<S>::min)()));
      }
    }
    // for a load on an oscillator at rest even the smallest step has all digits:
    //   f t^2 / 2m and f t / m
    const S step = static_cast<S>(1e-12);
    const FirstOrderHold<S> hold(oscillator, step);
    auto state = hold.start();
    const Motion<S> motion = hold(S(1), S(1), state);
    const Digits50 h(step), m(oscillator.mass_n_s2_per_mm);
    const Digits50 drag = Digits50(oscillator.damping_n_s_per_mm) / m * h;
    CHECK(off(motion.position_mm, Digits50(h * h / (2 * m) * (1 - drag / 3)), Digits50(h * h)) <
          8 * epsilon);
    CHECK(off(motion.velocity_mm_per_s, Digits50(h / m * (1 - drag / 2)), h) < 8 * epsilon);
  }
}

TEMPLATE_TEST_CASE("foam contact: many tiny steps do not lose the spring",
                   "[foam_contact]",
                   double,
                   float) {
  // 1 - h^2/2 rounds to almost 1, so the increment of a step must not be computed as a difference
  // from it. Computed that way, the error is 42000 epsilons in 200000 steps.
  using S = TestType;
  const S step = static_cast<S>(3e-4);
  const FirstOrderHold<S> hold({S(1), S(0), S(1)}, step);
  auto state = hold.start({S(1), S(0)});
  double worst = 0;
  for (int n = 1; n <= 200000; ++n) {
    const S position = hold(S(0), S(0), state).position_mm;
    const long double exact = std::cos(static_cast<long double>(step) * n);
    worst = (std::max)(worst,
                       static_cast<double>(std::abs(static_cast<long double>(position) - exact)));
  }
  CHECK(worst < 1000 * static_cast<double>(std::numeric_limits<S>::epsilon()));
}

TEMPLATE_TEST_CASE("foam contact: the lift follows quadrature", "[foam_contact]", double, float) {
  // (2/sqrt3) Int_0^40 e^(-(40-u)/2) sin(w (40-u)) cbrt(C + D sin(a u)) (A + B u) du by
  // Gauss-Legendre quadrature in 40 digits
  using S = TestType;
  const bool single = std::is_same_v<S, float>;
  const LiftLoad<S> gentle{S(2), S(0.5), S(3), {S(0.3), S(0.05)}};
  const LiftLoad<S> strong{S(2), S(1), S(3), {S(1), S(1)}};
  const double of_gentle = 2.8009407050775539372775000664187,
               of_strong = 48.763874197811345788827258595392;
  const auto error = [](const LiftLoad<S>& load, int steps, double exact) {
    return static_cast<double>(
               causal_response(MassSpringDamper<S>{}, load, S(40), steps).position_mm) -
           exact;
  };
  std::string seen;
  for (const int steps : {400, 2000, 4000}) {
    const double of = error(gentle, steps, of_gentle), step = 40.0 / steps;
    seen += " h = " + brief(step) + ": " + brief(of) + " mm;";
    CHECK(std::abs(of) < 1.8e-2 * step * step + (single ? 5e-6 : 0));
    CHECK(std::abs(error(strong, steps, of_strong)) < 0.7 * step * step + (single ? 1e-4 : 0));
  }
  INFO(seen);
  CHECK(seen.size() > 0);
  if (!single) {  // the error falls with the square of the step
    CHECK(error(gentle, 1000, of_gentle) / error(gentle, 4000, of_gentle) ==
          Approx(16).epsilon(0.01));
  }
}

TEMPLATE_TEST_CASE("foam contact: creep follows 50 digits", "[foam_contact]", double, float) {
  using S = TestType;
  const S e = std::numeric_limits<S>::epsilon();
  const S rigid = std::numeric_limits<S>::infinity();
  const Burgers<S> both{S(1.7), S(53), S(0.37), S(2.9)};
  const Burgers<S> element{rigid, rigid, S(0.37), S(2.9)}, flowing{S(1.7), S(53), rigid, rigid};
  for (const double time : {0.0, 1e-30, 1e-9, 1e-4, 0.1, 3.0, 7.8, 8.0, 40.0, 1e3, 1e9}) {
    const S t = static_cast<S>(time);
    const Digits50 modulus(element.kelvin_voigt_modulus_mpa),
        eta(element.kelvin_voigt_viscosity_mpa_s), at(t);
    const Digits50 delays = modulus * at / eta;
    const Digits50 exact = -expm1(Digits50(-delays)) / modulus;
    CAPTURE(time);
    const S strain = creep_compliance(element, t);
    CHECK(abs(Digits50(strain) - exact) <= 8 * Digits50(e) * exact);
    const Digits50 left = exp(Digits50(-delays));
    const Digits50 scale = left * (1 + delays);  // from rounding the exponent
    CHECK(abs(Digits50(recovery(element, t)) - left) <=
          4 * Digits50(e) * scale + Digits50((std::numeric_limits<S>::min)()));
    const Digits50 steady =
        1 / Digits50(flowing.maxwell_modulus_mpa) + at / Digits50(flowing.maxwell_viscosity_mpa_s);
    CHECK(abs(Digits50(creep_compliance(flowing, t)) - steady) <= 2 * Digits50(e) * steady);
    if (time > 0) {
      // a stress that rises from 0 to 1 within one step of any length
      const Creep<S> creep(both, t);
      auto state = creep.start();
      creep(S(0), S(1), state);
      const Digits50 risen = (delays + expm1(Digits50(-delays))) / (delays * modulus);
      // the difference above cancels even in 50 digits for a tiny time
      const Digits50 small = delays / 2 / modulus * (1 - delays / 3);
      const Digits50 delayed = time < 1e-8 ? small : risen;
      CHECK(abs(Digits50(state.delayed()) - delayed) <= 16 * Digits50(e) * delayed);
      const Digits50 viscous = at / (2 * Digits50(flowing.maxwell_viscosity_mpa_s));
      CHECK(abs(Digits50(state.viscous()) - viscous) <= 4 * Digits50(e) * viscous);
    }
  }
}

TEMPLATE_TEST_CASE("foam contact: friction follows 50 digits", "[foam_contact]", double, float) {
  using S = TestType;
  const double e = static_cast<double>(std::numeric_limits<S>::epsilon());
  const PolymerFriction<S> friction{S(0.7), S(0.625)};
  for (const double load : {1e-37, 1e-20, 1e-6, 0.02, 1.0, 4.0, 300.0, 1e20}) {
    const S n = static_cast<S>(load);
    const Digits50 exact_n(n), power = exp(Digits50(Digits50(0.625) * log(exact_n)));
    CHECK(off(friction_force(friction, n), Digits50(Digits50(friction.factor) * power),
              Digits50(Digits50(friction.factor) * power)) < 2 * e);
  }
}

TEST_CASE("foam contact: derivatives are those of differences", "[foam_contact]") {
  using Dual = test::Dual<Digits50>;
  const Digits50 h("1e-15");
  const auto check = [&](const auto& f, double at) {
    const Digits50 x(at);
    const Digits50 slope = (f(Digits50(x + h)) - f(Digits50(x - h))) / (2 * h);
    const Digits50 dual = f(Dual(x, Digits50(1))).d;
    CAPTURE(at);
    CHECK(std::abs(static_cast<double>(Digits50(dual - slope))) <
          1e-20 + 1e-20 * std::abs(static_cast<double>(slope)));
  };
  // by the damping, across the critical value (2), and by the stiffness, after short and long times
  for (const double time : {0.25, 3.0, 20.0}) {
    for (const double c : {0.01, 0.5, 1.99, 2.0, 2.01, 7.0}) {
      const auto motion_by = [&]<class S>(const S& damping, const S& stiffness) {
        const MassSpringDamper<S> oscillator{S(1), damping, stiffness};
        const auto closed = ramp_response(oscillator, {S(1), S(2)}, {S(1), S(-1)}, S(time));
        const FirstOrderHold<S> hold(oscillator, S(time));
        auto state = hold.start({S(1), S(-1)});
        const auto stepped = hold(S(1), S(S(1) + S(S(2) * S(time))), state);
        return std::pair{closed, stepped};
      };
      const auto by_c = [&]<class S>(const S& x) { return motion_by(x, S(1)); };
      const auto by_k = [&]<class S>(const S& x) { return motion_by(S(c), x); };
      check([&](const auto& x) { return by_c(x).first.position_mm; }, c);
      check([&](const auto& x) { return by_c(x).second.position_mm; }, c);
      check([&](const auto& x) { return by_k(x).first.velocity_mm_per_s; }, 1);
      check([&](const auto& x) { return by_k(x).second.velocity_mm_per_s; }, 1);
    }
  }
  for (const double load : {0.01, 1.0, 30.0}) {
    check([]<class S>(const S& n) { return friction_force(PolymerFriction<S>{}, n); }, load);
    check([]<class S>(const S& n) { return contact_stress(HertzContact<S>{}, n); }, load);
    check([]<class S>(const S& t) { return creep_compliance(Burgers<S>{}, t); }, load);
    // the stiffness is the slope of the load
    const HertzContact<Dual> hertz{Dual(Digits50(3)), Dual(Digits50("0.2"))};
    const Dual depth = hertz_depth(hertz, Dual(Digits50(load), Digits50(1)));
    const Digits50 stiffness = hertz_stiffness(hertz, Dual(Digits50(load))).v;
    CHECK(std::abs(static_cast<double>(Digits50(depth.d * stiffness - 1))) < 1e-40);
  }
  // no pressure: no force and no slope, where a coefficient would be unbounded
  for (const double load : {0.0, -2.0}) {
    const Dual none = friction_force(PolymerFriction<Dual>{}, Dual(Digits50(load), Digits50(1)));
    CHECK((none.v == 0 && none.d == 0));
    const Dual stress = contact_stress(HertzContact<Dual>{}, Dual(Digits50(load), Digits50(1)));
    CHECK((stress.v == 0 && stress.d == 0));
  }
}
