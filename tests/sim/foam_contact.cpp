// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The oscillator against its textbook solution in 50 digits and against the laws of motion; loads,
// friction and creep.
#include "fingerpad/sim/foam_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <type_traits>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::Digits50;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double pi = std::numbers::pi;
using Oscillator = MassSpringDamper<double>;
using Motion = Oscillator::Motion;

void check_motion(const Motion& motion, double position, double velocity) {
  CHECK(motion.position_mm == Approx(position).epsilon(1e-13).margin(1e-14));
  CHECK(motion.velocity_mm_per_s == Approx(velocity).epsilon(1e-13).margin(1e-14));
}

/// The motion after one step.
Motion stepped(
    const Oscillator& oscillator, const Motion& start, double before, double after, double time) {
  return FirstOrderHold<double>(oscillator, time)(before, after, start);
}

/// Any damping: none, critical, nearly critical, far from it.
Oscillator any_oscillator() {
  Oscillator oscillator;
  oscillator.mass_n_s2_per_mm = test::log_uniform(1e-3, 10);
  oscillator.stiffness_n_per_mm = test::log_uniform(1e-2, 100);
  const double critical =
      2 * std::sqrt(oscillator.mass_n_s2_per_mm * oscillator.stiffness_n_per_mm);
  const double some[] = {
      0, 1 - 1e-9, 1, 1 + 1e-9, test::uniform(0, 2), test::log_uniform(1e-3, 50)};
  oscillator.damping_n_s_per_mm = critical * some[test::whole(0, 5)];
  return oscillator;
}
double frequency(const Oscillator& oscillator) {
  return std::sqrt(oscillator.stiffness_n_per_mm / oscillator.mass_n_s2_per_mm);
}
Motion any_motion(const Oscillator& oscillator) {
  return {test::uniform(-2, 2), test::uniform(-2, 2) * frequency(oscillator)};
}
/// From far below a period to many periods.
double any_time(const Oscillator& oscillator) {
  return test::log_uniform(1e-4, 100) / frequency(oscillator);
}
/// What rounding may do: a phase of (1 + 2 damping ratio) w t rad is known to this.
double rounding(const Oscillator& oscillator, double time) {
  const double damped = oscillator.damping_n_s_per_mm / oscillator.mass_n_s2_per_mm;
  return 1e-15 * (1 + (2 * frequency(oscillator) + damped) * time);
}

/// Distance of two motions, with the velocity divided by the natural frequency.
double apart(const Oscillator& oscillator, const Motion& a, const Motion& b) {
  return std::abs(a.position_mm - b.position_mm) +
         std::abs(a.velocity_mm_per_s - b.velocity_mm_per_s) / frequency(oscillator);
}

/// The textbook's position under a ramp load in 50 digits, for a damping that is not critical:
/// y_p and a damped wave, or two decays, with the rest of the start.
Digits50 textbook(const Oscillator& oscillator,
                  const RampLoad<double>& load,
                  const Motion& start,
                  const Digits50& t) {
  const MassSpringDamper<Digits50> o{Digits50(oscillator.mass_n_s2_per_mm),
                                     Digits50(oscillator.damping_n_s_per_mm),
                                     Digits50(oscillator.stiffness_n_per_mm)};
  const RampLoad<Digits50> f{Digits50(load.start_n), Digits50(load.rise_n_per_s)};
  const auto before = particular_solution(o, f, Digits50(0));
  const Digits50 y = start.position_mm - before.position_mm;
  const Digits50 v = start.velocity_mm_per_s - before.velocity_mm_per_s;
  const Digits50 s = o.damping_n_s_per_mm / (2 * o.mass_n_s2_per_mm);
  const Digits50 split = s * s - o.stiffness_n_per_mm / o.mass_n_s2_per_mm;
  const Digits50 root = sqrt(abs(split));
  const Digits50 wave = split < 0 ? cos(Digits50(root * t)) : cosh(Digits50(root * t));
  const Digits50 lag = (split < 0 ? sin(Digits50(root * t)) : sinh(Digits50(root * t))) / root;
  return particular_solution(o, f, t).position_mm +
         exp(Digits50(-s * t)) * (wave * y + lag * (v + s * y));
}

/// Checks that every value of `bad` in this field is refused with a message that names owner and
/// field.
template <class Parameters>
void check_refused(const std::string& owner,
                   double Parameters::*field,
                   const std::string& name,
                   std::initializer_list<double> bad) {
  for (const double given : bad) {
    Parameters parameters;
    parameters.*field = given;
    CAPTURE(owner, name, given);
    CHECK(test::begins_with(check(parameters), owner + ": " + name + " = "));
  }
}

}  // namespace

TEST_CASE("foam contact: friction is a power of the load", "[foam_contact]") {
  const PolymerFriction<double> published;
  CHECK(friction_force(published, 8.0) == Approx(4));
  CHECK(friction_force(published, 27.0) == Approx(9));
  CHECK(friction_force(PolymerFriction<double>{0.5, 2.0 / 3}, 8.0) == Approx(2));
  CHECK(friction_force(PolymerFriction<double>{0.5, 1}, 8.0) == 4);  // Coulomb's law
  CHECK(inverse_friction_coefficient(published, 8.0) == Approx(2));
  CHECK(inverse_friction_coefficient(PolymerFriction<double>{4, 2.0 / 3}, 8.0) == Approx(0.5));
  for (const double nothing : {0.0, -0.0, -1.0, -infinity}) {
    CHECK(friction_force(published, nothing) == 0);
    CHECK(inverse_friction_coefficient(published, nothing) == 0);
  }
  CHECK(std::isnan(friction_force(published, none)));
  CHECK(friction_force(published, 1e-300) == Approx(1e-200));  // where mu is 1e100
}

TEMPLATE_TEST_CASE("foam contact: friction follows 50 digits", "[foam_contact]", double, float) {
  using S = TestType;
  const PolymerFriction<S> friction{S(0.7), S(0.625)};
  for (const double load : {1e-37, 1e-20, 1e-6, 0.02, 1.0, 4.0, 300.0, 1e20}) {
    const S n = static_cast<S>(load);
    const Digits50 exact = Digits50(friction.factor) * pow(Digits50(n), Digits50(0.625));
    const Digits50 error = abs(Digits50(friction_force(friction, n)) - exact);
    CHECK(error < 2 * Digits50(std::numeric_limits<S>::epsilon()) * exact);
  }
}

TEST_CASE("foam contact: worked steps of the oscillator", "[foam_contact]") {
  const Motion at_one{1, 0}, pushed{0, 1};
  SECTION("published, m = c = k = 1") {
    const double half_s = 2 * pi / std::sqrt(3.0);
    check_motion(stepped({}, at_one, 0, 0, half_s), -0.163033534821580, 0);
    check_motion(stepped({}, pushed, 0, 0, half_s), 0, -0.163033534821580);
  }
  SECTION("undamped, from rest: A (1 - cos t) + B (t - sin t)") {
    check_motion(stepped({1, 0, 1}, at_one, 0, 0, 1), std::cos(1.0), -std::sin(1.0));
    check_motion(stepped({1, 0, 1}, pushed, 0, 0, 100), std::sin(100.0), std::cos(100.0));
    check_motion(stepped({1, 0, 1}, {}, 2, 17, 5),
                 2 * (1 - std::cos(5.0)) + 3 * (5 - std::sin(5.0)),
                 2 * std::sin(5.0) + 3 * (1 - std::cos(5.0)));
  }
  SECTION("critical: (1 + t) e^-t") {
    check_motion(stepped({1, 2, 1}, at_one, 0, 0, 1), 2 / std::exp(1.0), -1 / std::exp(1.0));
    check_motion(stepped({1, 2, 1}, pushed, 0, 0, 3), 3 / std::exp(3.0), -2 / std::exp(3.0));
  }
  SECTION("so long that nothing is left of the start") {
    check_motion(stepped({2, 50, 4}, {1e3, -1e3}, 8, 8, 1e6), 2, 0);
    // 2 + 0.25 (t - c/k) at the end of a ramp from 8 to 10^6 + 8
    check_motion(stepped({2, 50, 4}, {2, 0}, 8, 8 + 1e6, 1e6), 2 + 0.25 * (1e6 - 12.5), 0.25);
  }
  SECTION("so short that f t^2 / 2m and f t / m are all") {
    const Motion motion = stepped({0.5, 3, 7}, {}, 1, 1, 1e-12);
    CHECK(motion.position_mm == Approx(1e-24).epsilon(1e-11));
    CHECK(motion.velocity_mm_per_s == Approx(2e-12).epsilon(1e-11));
  }
  SECTION("a load that is missing") {
    CHECK(std::isnan(stepped({}, at_one, none, 0, 1).position_mm));
  }
}

TEST_CASE("foam contact: the oscillator's motion follows 50 digits", "[foam_contact]") {
  const RampLoad<double> load{1, 0.0625};
  const Motion start{1, -1};
  for (const double ratio : {0.0, 0.5, 1 - 1e-9, 1 + 1e-9, 20.0}) {
    for (const auto& [mass, stiffness] : {std::pair(1.0, 1.0), {0.37, 2.9}, {0.0042, 15.0}}) {
      const Oscillator oscillator{mass, 2 * ratio * std::sqrt(mass * stiffness), stiffness};
      double worst = 0, worst_of_steps = 0;
      for (const double time : {1e-6, 0.01, 0.7, 3.3, 40.0, 1419.5, 1e4}) {
        const Motion motion = stepped(oscillator, start, load(0), load(time), time);
        const Digits50 exact = textbook(oscillator, load, start, Digits50(time));
        const double size = std::abs(particular_solution(oscillator, load, time).position_mm) + 1;
        worst = std::max(worst, std::abs(static_cast<double>(motion.position_mm - exact)) / size /
                                    rounding(oscillator, time));
      }
      const FirstOrderHold<double> hold(oscillator, 0.125);
      Motion motion = start;
      for (int n = 1; n <= 80000; ++n) {
        motion = hold(load(0.125 * (n - 1)), load(0.125 * n), motion);
        if (n % 16000 == 0) {
          const double t = 0.125 * n;
          const Digits50 exact = textbook(oscillator, load, start, Digits50(t));
          const double size = std::abs(particular_solution(oscillator, load, t).position_mm) + 1;
          worst_of_steps = std::max(
              worst_of_steps, std::abs(static_cast<double>(motion.position_mm - exact)) / size);
        }
      }
      INFO("damping ratio " << ratio << ", m = " << mass << ": " << worst
                            << " times the rounding of the phase; 80000 steps " << worst_of_steps);
      CHECK(worst < 0.2);
      CHECK(worst_of_steps < 1e-11);
    }
  }
}

TEMPLATE_TEST_CASE("foam contact: many tiny steps do not lose the spring",
                   "[foam_contact]",
                   double,
                   float) {
  // Steps that multiplied by 1 - h^2/2 would be off by 42000 epsilons.
  using S = TestType;
  const S step = static_cast<S>(3e-4);
  const FirstOrderHold<S> hold({S(1), S(0), S(1)}, step);
  typename MassSpringDamper<S>::Motion motion{S(1), S(0)};
  double worst = 0;
  for (int n = 1; n <= 200000; ++n) {
    motion = hold(S(0), S(0), motion);
    const long double exact = std::cos(static_cast<long double>(step) * n);
    const auto here = static_cast<long double>(motion.position_mm);
    worst = std::max(worst, static_cast<double>(std::abs(here - exact)));
  }
  CHECK(worst < 2000 * static_cast<double>(std::numeric_limits<S>::epsilon()));
}

TEST_CASE("foam contact: laws of the oscillator", "[foam_contact][law]") {
  rc::prop("linear in start and load", [] {
    const Oscillator oscillator = any_oscillator();
    const Motion a = any_motion(oscillator), b = any_motion(oscillator);
    const double f = test::uniform(-3, 3), g = test::uniform(-3, 3), p = test::uniform(-3, 3);
    const double time = any_time(oscillator);
    const Motion start{a.position_mm + p * b.position_mm,
                       a.velocity_mm_per_s + p * b.velocity_mm_per_s};
    const auto of_a = stepped(oscillator, a, f, 0, time), of_b = stepped(oscillator, b, 0, g, time);
    const Motion sum{of_a.position_mm + p * of_b.position_mm,
                     of_a.velocity_mm_per_s + p * of_b.velocity_mm_per_s};
    RC_ASSERT(apart(oscillator, stepped(oscillator, start, f, p * g, time), sum) <
              1e-12 * (1 + 21 / oscillator.stiffness_n_per_mm));
  });
  rc::prop("over two steps that over their sum", [] {
    const Oscillator oscillator = any_oscillator();
    const Motion start = any_motion(oscillator);
    const double one = any_time(oscillator), two = any_time(oscillator), whole = one + two;
    const double f = test::uniform(-3, 3), rise = test::uniform(-3, 3) / whole;
    const double middle = f + rise * one, end = f + rise * whole;
    const auto halfway = stepped(oscillator, start, f, middle, one);
    RC_ASSERT(apart(oscillator, stepped(oscillator, halfway, middle, end, two),
                    stepped(oscillator, start, f, end, whole)) <
              20 * rounding(oscillator, whole) * (1 + 6 / oscillator.stiffness_n_per_mm));
  });
  rc::prop("in a frame that moves with the start it stays in it", [] {
    const Oscillator oscillator = any_oscillator();
    const double speed = test::uniform(-2, 2), at = test::uniform(-2, 2);
    const double time = any_time(oscillator), end = at + speed * time;
    const auto motion = stepped(oscillator, {at, speed}, frame_load(oscillator, {at, speed}),
                                frame_load(oscillator, {end, speed}), time);
    const double lag = oscillator.damping_n_s_per_mm / oscillator.stiffness_n_per_mm;
    RC_ASSERT(std::abs(motion.position_mm - end) <
              10 * rounding(oscillator, time) * (4 + std::abs(speed) * (time + lag)));
  });
}

TEST_CASE("foam contact: the particular solution and the printed one (E039)", "[foam_contact]") {
  const RampLoad<double> load{1, 3};
  // m y'' + c y' + k y - (A + B t), in N; y'' is 0
  const auto residual = [&](const Oscillator& o, const Motion& motion, double t) {
    return frame_load(o, motion) - load(t);
  };
  for (const double t : {0.0, 1.0, 2.0, 10.0, 40.0}) {
    const Motion printed{load.start_n * (t - 1) + load.rise_n_per_s, load.start_n};
    const double printed_n = residual({}, printed, t);
    const double corrected_n = residual({}, particular_solution({}, load, t), t);
    INFO("t = " << t << " s, load " << load(t) << " N, residual: printed " << printed_n
                << " N, corrected " << corrected_n << " N");
    CHECK(printed_n == (load.start_n - load.rise_n_per_s) * (t - 1));  // right only where A = B
    CHECK(corrected_n == 0);
    const Oscillator other{1, 2, 4};
    CHECK(residual(other, particular_solution(other, load, t), t) == 0);
  }
}

TEST_CASE("foam contact: loads while a contact point slips (eqs. 6-8)", "[foam_contact]") {
  const RampLoad<double> drag{2 * 0.5, 3 * 0.5};
  const double deformation = 8 * 8 / (2 * 0.5);  // z^2 / 2p
  SECTION("the printed z^(2/3), for 2p = 1 and K = 1") {
    const auto load = slip_load(drag, PolymerFriction<double>{}, deformation);
    CHECK(load.start_n == Approx(4 * 2 * 0.5));
    CHECK(load.rise_n_per_s == Approx(4 * 3 * 0.5));
  }
  SECTION("another factor of friction") {
    const auto load = slip_load(drag, PolymerFriction<double>{0.5, 2.0 / 3}, deformation / 8);
    CHECK(load.start_n == Approx(4 * 2 * 0.5));
    CHECK(slip_load(drag, PolymerFriction<double>{0.5, 1}, 8.0).start_n == 2);
  }
  SECTION("nothing is pressed: nothing drags") {
    CHECK(slip_load(drag, PolymerFriction<double>{}, 0.0).rise_n_per_s == 0);
  }
}

TEST_CASE("foam contact: loads while lifting (eq. 10)", "[foam_contact]") {
  const LiftLoad<double> load{9, 1, pi / 2, {1, 2}};
  CHECK(load(3.0) == Approx(2 * 7));
  CHECK(load(0.0) == Approx(std::cbrt(9.0)));
  CHECK(std::isnan(load(none)));
  // C = |D|: 0 where the sine is -1, never negative
  CHECK(LiftLoad<double>{1, 1, pi / 2, {1, 2}}(3.0) == Approx(0).margin(1e-4));
  CHECK(LiftLoad<double>{1, -1, pi / 2, {1, 2}}(1.0) == Approx(0).margin(1e-4));
  rc::prop("never negative while the slip goes on", [] {
    const double swing = test::uniform(-3, 3);
    const LiftLoad<double> any{test::uniform(0, 4),
                               swing,
                               test::log_uniform(0.1, 100),
                               {test::uniform(0, 1), test::uniform(0, 1)}};
    RC_ASSERT(any(test::uniform(0, 1e4)) >= 0);
  });
}

TEST_CASE("foam contact: the causal integral (E041)", "[foam_contact]") {
  SECTION("a ramp needs one step") {
    const Oscillator oscillator{0.5, 0.3, 4};
    const RampLoad<double> ramp{1, 2};
    const Motion one = causal_response(oscillator, ramp, 3.0, 1);
    check_motion(causal_response(oscillator, ramp, 3.0, 50), one.position_mm,
                 one.velocity_mm_per_s);
  }
  SECTION("the lift follows quadrature, with the square of the step") {
    // (2/sqrt3) Int_0^40 e^(-(40-u)/2) sin(w (40-u)) cbrt(C + D sin(a u)) (A + B u) du by
    // Gauss-Legendre quadrature in 40 digits
    const auto error = [](const LiftLoad<double>& load, int steps, double exact) {
      return causal_response(Oscillator{}, load, 40.0, steps).position_mm - exact;
    };
    const LiftLoad<double> gentle{2, 0.5, 3, {0.3, 0.05}}, strong{2, 1, 3, {1, 1}};
    for (const int steps : {400, 2000, 4000}) {
      const double step = 40.0 / steps;
      const double of = error(gentle, steps, 2.8009407050775539);
      INFO("h = " << step << ": " << of << " mm");
      CHECK(std::abs(of) < 1.8e-2 * step * step);
      CHECK(std::abs(error(strong, steps, 48.763874197811346)) < 0.7 * step * step);
    }
    CHECK(error(gentle, 1000, 2.8009407050775539) / error(gentle, 4000, 2.8009407050775539) ==
          Approx(16).epsilon(0.01));
  }
}

TEST_CASE("foam contact: bad parameters are refused by name", "[foam_contact]") {
  using O = MassSpringDamper<double>;
  check_refused("MassSpringDamper", &O::mass_n_s2_per_mm, "mass_n_s2_per_mm",
                {0, -1, none, infinity});
  check_refused("MassSpringDamper", &O::damping_n_s_per_mm, "damping_n_s_per_mm",
                {-1e-9, none, infinity});
  check_refused("MassSpringDamper", &O::stiffness_n_per_mm, "stiffness_n_per_mm",
                {0, -1, none, infinity});
  for (const double step : {0.0, -1.0, none, infinity}) {
    const std::string said = test::refusal([&] { FirstOrderHold<double>({1, 0, 1}, step); });
    CHECK(test::begins_with(said, "FirstOrderHold: step_s = "));
  }
  CHECK(test::begins_with(test::refusal([] {
                            FirstOrderHold<double>({1, -1, 1}, 1);
                          }),
                          "MassSpringDamper: damping_n_s_per_mm = "));
}
