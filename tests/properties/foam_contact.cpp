// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every oscillator, every load and every foam.
#include "fingerpad/sim/foam_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/catch.hpp"
#include "support/generators.hpp"

using namespace fingerpad;

namespace {

using Motion = MassSpringDamper<double>::Motion;

/// Any damping: none, critical, nearly critical, far from it.
MassSpringDamper<double> any_oscillator() {
  MassSpringDamper<double> oscillator;
  oscillator.mass_n_s2_per_mm = test::log_uniform(1e-3, 10);
  oscillator.stiffness_n_per_mm = test::log_uniform(1e-2, 100);
  const double critical =
      2 * std::sqrt(oscillator.mass_n_s2_per_mm * oscillator.stiffness_n_per_mm);
  const double some[] = {
      0, 1 - 1e-9, 1, 1 + 1e-9, test::uniform(0, 2), test::log_uniform(1e-3, 50)};
  oscillator.damping_n_s_per_mm = critical * some[test::whole(0, 5)];
  return oscillator;
}
double frequency(const MassSpringDamper<double>& oscillator) {
  return std::sqrt(oscillator.stiffness_n_per_mm / oscillator.mass_n_s2_per_mm);
}
Motion any_motion(const MassSpringDamper<double>& oscillator) {
  return {test::uniform(-2, 2), test::uniform(-2, 2) * frequency(oscillator)};
}
/// From far below a period to many periods.
double any_time(const MassSpringDamper<double>& oscillator) {
  return test::log_uniform(1e-4, 100) / frequency(oscillator);
}

/// Distance of two motions, with the velocity divided by the natural frequency.
double apart(const MassSpringDamper<double>& oscillator, const Motion& a, const Motion& b) {
  return std::abs(a.position_mm - b.position_mm) +
         std::abs(a.velocity_mm_per_s - b.velocity_mm_per_s) / frequency(oscillator);
}
double energy(const MassSpringDamper<double>& oscillator, const Motion& motion) {
  return (oscillator.mass_n_s2_per_mm * motion.velocity_mm_per_s * motion.velocity_mm_per_s +
          oscillator.stiffness_n_per_mm * motion.position_mm * motion.position_mm) /
         2;
}
/// One step of FirstOrderHold.
Motion stepped(const MassSpringDamper<double>& oscillator,
               const Motion& start,
               double before,
               double after,
               double time) {
  const FirstOrderHold<double> hold(oscillator, time);
  auto state = hold.start(start);
  return hold(before, after, state);
}

Burgers<double> any_foam() {
  const auto any = [] { return test::log_uniform(1e-3, 1e3); };
  return {any(), any(), any(), any()};
}

/// The foam without its instantaneous and viscous parts.
Burgers<double> delayed_part_of(Burgers<double> foam) {
  foam.maxwell_modulus_mpa = foam.maxwell_viscosity_mpa_s = std::numeric_limits<double>::infinity();
  return foam;
}

}  // namespace

TEST_CASE("the oscillator's motion", "[foam_contact][law]") {
  rc::prop("is linear in start and load", [] {
    const MassSpringDamper<double> oscillator = any_oscillator();
    const Motion a = any_motion(oscillator), b = any_motion(oscillator);
    const double f = test::uniform(-3, 3), g = test::uniform(-3, 3), p = test::uniform(-3, 3);
    const double time = any_time(oscillator), scale = 1 + 3 * 7 / oscillator.stiffness_n_per_mm;
    const Motion start{a.position_mm + p * b.position_mm,
                       a.velocity_mm_per_s + p * b.velocity_mm_per_s};
    const auto of_a = stepped(oscillator, a, f, 0, time), of_b = stepped(oscillator, b, 0, g, time);
    const auto of_both = stepped(oscillator, start, f, p * g, time);
    const Motion sum{of_a.position_mm + p * of_b.position_mm,
                     of_a.velocity_mm_per_s + p * of_b.velocity_mm_per_s};
    RC_ASSERT(apart(oscillator, of_both, sum) < 1e-13 * 10 * scale);
  });
  rc::prop("over two steps is that over their sum", [] {
    const MassSpringDamper<double> oscillator = any_oscillator();
    const Motion start = any_motion(oscillator);
    const double one = any_time(oscillator), two = any_time(oscillator);
    const double f = test::uniform(-3, 3), rise = test::uniform(-3, 3) / (one + two);
    const double middle = f + rise * one, end = f + rise * (one + two);
    const auto halfway = stepped(oscillator, start, f, middle, one);
    const auto in_two = stepped(oscillator, halfway, middle, end, two);
    const auto at_once = stepped(oscillator, start, f, end, one + two);
    // the sum of the times is rounded: 200 rad of phase by 1e-16
    RC_ASSERT(apart(oscillator, in_two, at_once) <
              1e-12 * (1 + 1 / oscillator.stiffness_n_per_mm) * 8);
  });
  rc::prop("by steps of any lengths is the closed form", [] {
    const MassSpringDamper<double> oscillator = any_oscillator();
    const Motion start = any_motion(oscillator);
    const RampLoad<double> load{test::uniform(-3, 3), test::uniform(-1, 1) * frequency(oscillator)};
    const FirstOrderHold<double> hold(oscillator, 1 / frequency(oscillator));
    auto state = hold.start(start);
    double time = 0;
    Motion motion = start;
    for (int k = 0; k < 5; ++k) {
      const double before = time;
      time += any_time(oscillator) / 5;
      motion = hold(load(before), load(time), time - before, state);
    }
    const double lag = oscillator.damping_n_s_per_mm / oscillator.stiffness_n_per_mm;
    const double most =
        4 + (3 + std::abs(load.rise_n_per_s) * (time + lag)) / oscillator.stiffness_n_per_mm;
    RC_ASSERT(apart(oscillator, motion, ramp_response(oscillator, load, start, time)) <
              1e-12 * most);
  });
  rc::prop("never gains energy without a load, and keeps it without damping", [] {
    MassSpringDamper<double> oscillator = any_oscillator();
    const FirstOrderHold<double> hold(oscillator, any_time(oscillator));
    auto state = hold.start(any_motion(oscillator));
    double before = energy(oscillator, state.motion());
    const double first = before;
    for (int k = 0; k < 20; ++k) {
      const double now = energy(oscillator, hold(0.0, 0.0, state));
      RC_ASSERT(now <= before * (1 + 1e-14));
      before = now;
    }
    RC_ASSERT(oscillator.damping_n_s_per_mm > 0 || before > first * (1 - 1e-14));
  });
  rc::prop("comes to rest at load over stiffness", [] {
    MassSpringDamper<double> oscillator = any_oscillator();
    oscillator.damping_n_s_per_mm +=
        0.1 * std::sqrt(oscillator.mass_n_s2_per_mm * oscillator.stiffness_n_per_mm);
    const double load = test::uniform(-3, 3), rest = load / oscillator.stiffness_n_per_mm;
    // the slowest decay has the time c/k, that of the largest mass 20 periods
    const double time = 50 * (oscillator.damping_n_s_per_mm / oscillator.stiffness_n_per_mm) +
                        1000 / frequency(oscillator);
    const Motion start = any_motion(oscillator), still{rest, 0};
    RC_ASSERT(apart(oscillator, stepped(oscillator, start, load, load, time), still) <
              1e-13 * (1 + std::abs(rest)));
    RC_ASSERT(apart(oscillator, stepped(oscillator, still, load, load, time), still) <
              1e-14 * std::abs(rest));
  });
  rc::prop("does not depend on the unit of force or of time", [] {
    const MassSpringDamper<double> oscillator = any_oscillator();
    const Motion start = any_motion(oscillator);
    const double time = any_time(oscillator), force = test::log_uniform(1e-3, 1e3);
    const double slower = test::log_uniform(1e-3, 1e3), f = test::uniform(-1, 1);
    const auto motion = ramp_response(oscillator, {f, f / time}, start, time);
    const MassSpringDamper<double> other{oscillator.mass_n_s2_per_mm * force * slower * slower,
                                         oscillator.damping_n_s_per_mm * force * slower,
                                         oscillator.stiffness_n_per_mm * force};
    const Motion other_start{start.position_mm, start.velocity_mm_per_s / slower};
    const double other_time = time * slower;
    auto same = ramp_response(other, {f * force, f * force / other_time}, other_start, other_time);
    same.velocity_mm_per_s *= slower;
    const double lag = oscillator.damping_n_s_per_mm / oscillator.stiffness_n_per_mm / time;
    RC_ASSERT(apart(oscillator, motion, same) <
              1e-12 * (5 + (3 + lag) / oscillator.stiffness_n_per_mm));
  });
  rc::prop("has no step at critical damping, or anywhere else", [] {
    MassSpringDamper<double> oscillator = any_oscillator();
    const double critical =
        2 * std::sqrt(oscillator.mass_n_s2_per_mm * oscillator.stiffness_n_per_mm);
    oscillator.damping_n_s_per_mm = critical;
    MassSpringDamper<double> near = oscillator;
    const double by = test::log_uniform(1e-14, 1e-6);
    near.damping_n_s_per_mm *= test::whole(0, 1) == 0 ? 1 - by : 1 + by;
    const Motion start = any_motion(oscillator);
    const double time = any_time(oscillator);
    // |dy/d(ratio)| <= w t e^(-w t) (1 + w t) |y| and the like: below 4 for |y|, |v|/w <= 2
    RC_ASSERT(apart(oscillator, free_motion(oscillator, start, time),
                    free_motion(near, start, time)) < 16 * by + 1e-14);
  });
  rc::prop("in a frame that moves with the start stays in it", [] {
    const MassSpringDamper<double> oscillator = any_oscillator();
    const double speed = test::uniform(-2, 2), at = test::uniform(-2, 2),
                 time = any_time(oscillator);
    const double end = at + speed * time;
    const auto motion = stepped(oscillator, {at, speed}, frame_load(oscillator, {at, speed}),
                                frame_load(oscillator, {end, speed}), time);
    const double lag = oscillator.damping_n_s_per_mm / oscillator.stiffness_n_per_mm;
    RC_ASSERT(std::abs(motion.position_mm - end) < 1e-13 * (4 + std::abs(speed) * (time + lag)));
  });
}

TEST_CASE("creep of any foam", "[foam_contact][law]") {
  rc::prop("grows with time, and in proportion to the stress", [] {
    const Burgers<double> foam = any_foam();
    const double t = test::log_uniform(1e-6, 1e6), later = t * test::uniform(1, 3);
    RC_ASSERT(creep_compliance(foam, later) >= creep_compliance(foam, t));
    RC_ASSERT(creep_compliance(delayed_part_of(foam), t) <=
              (1 + 1e-15) / foam.kelvin_voigt_modulus_mpa);
    const Creep<double> creep(foam, t);
    auto one = creep.start(), many = creep.start();
    const double factor = test::uniform(-5, 5);
    for (int k = 0; k < 5; ++k) {
      const double a = test::uniform(-1, 1), b = test::uniform(-1, 1);
      creep(a, b, one);
      creep(factor * a, factor * b, many);
    }
    const double size = std::abs(one.elastic()) + 5 * creep_compliance(foam, 5 * t);
    RC_ASSERT(std::abs(many.strain() - factor * one.strain()) < 1e-13 * size);
  });
  rc::prop("over two steps is that over their sum", [] {
    const Burgers<double> foam = any_foam();
    const double one = test::log_uniform(1e-6, 1e6), two = test::log_uniform(1e-6, 1e6);
    const double f = test::uniform(0, 1), end = test::uniform(0, 1);
    const double middle = f + (end - f) * (one / (one + two));
    const Creep<double> creep(foam, one);
    auto in_two = creep.start(), at_once = creep.start();
    creep(f, middle, in_two);
    creep(middle, end, two, in_two);
    creep(f, end, one + two, at_once);
    RC_ASSERT(std::abs(in_two.delayed() - at_once.delayed()) <=
              1e-14 * (f + end) / foam.kelvin_voigt_modulus_mpa);
    RC_ASSERT(std::abs(in_two.viscous() - at_once.viscous()) <= 1e-14 * at_once.viscous());
  });
  rc::prop("ends when the stress does, but for what has flown", [] {
    const Burgers<double> foam = any_foam();
    const double delay = foam.kelvin_voigt_viscosity_mpa_s / foam.kelvin_voigt_modulus_mpa;
    const Creep<double> creep(foam, delay);
    auto state = creep.start();
    creep(1.0, 2.0, state);
    const double flown = state.viscous(), delayed = state.delayed();
    creep(0.0, 0.0, test::uniform(0.01, 1) * delay, state);
    RC_ASSERT(state.viscous() == flown);
    RC_ASSERT(state.delayed() < delayed);
    RC_ASSERT(state.delayed() > 0);
    creep(0.0, 0.0, 1000 * delay, state);
    RC_ASSERT(std::abs(state.strain() - flown) < 1e-15 * (flown + delayed));
  });
  rc::prop("of a Maxwell element under the stress that relaxes in it stands still", [] {
    Burgers<double> foam = any_foam();
    foam.kelvin_voigt_modulus_mpa = 1e12 * foam.maxwell_modulus_mpa;  // practically rigid
    const double time = foam.maxwell_viscosity_mpa_s / foam.maxwell_modulus_mpa;
    const int steps = 200;
    const Creep<double> creep(foam, 3 * time / steps);
    auto state = creep.start();
    for (int k = 0; k < steps; ++k) {
      const auto stress = [&](int at) { return relaxation_modulus(foam, 3 * time * at / steps); };
      // for a strain of 1: chords of an exponential lie above it by h^2/12 of the relaxing part
      const double strain = creep(stress(k), stress(k + 1), state);
      RC_ASSERT(std::abs(strain - 1) < 3e-5);
    }
  });
}

TEST_CASE("friction of any polymer", "[foam_contact][law]") {
  rc::prop("grows with the load, and by 1 / mu", [] {
    const PolymerFriction<double> friction{test::log_uniform(1e-2, 1e2), test::uniform(0.2, 1)};
    const double load = test::log_uniform(1e-6, 1e6);
    const double force = friction_force(friction, load);
    RC_ASSERT(friction_force(friction, 1.01 * load) > force);
    RC_ASSERT(std::abs(force * inverse_friction_coefficient(friction, load) - load) < 1e-13 * load);
  });
  rc::prop("area times stress is the load", [] {
    const HertzContact<double> area{test::log_uniform(1e-2, 1e2), test::log_uniform(1e-2, 1e2)};
    const double load = test::log_uniform(1e-6, 1e6);
    RC_ASSERT(std::abs(contact_area(area, load) * contact_stress(area, load) - load) <
              1e-13 * load);
  });
  rc::prop("a lift's load is never negative while the slip goes on", [] {
    const double swing = test::uniform(-3, 3);
    const LiftLoad<double> load{std::abs(swing) + test::uniform(0, 1),
                                swing,
                                test::log_uniform(0.1, 100),
                                {test::uniform(0, 1), test::uniform(0, 1)}};
    expects_valid(load);
    RC_ASSERT(load(test::uniform(0, 1e4)) >= 0);
  });
}
