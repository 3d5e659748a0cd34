// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/sim/foam_contact.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <type_traits>

#include "support/catch.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double pi = std::numbers::pi;
using Motion = MassSpringDamper<double>::Motion;

void check_motion(const Motion& motion, double position, double velocity) {
  CHECK(motion.position_mm == Approx(position).epsilon(1e-13).margin(1e-15));
  CHECK(motion.velocity_mm_per_s == Approx(velocity).epsilon(1e-13).margin(1e-15));
}
bool is_nan(double x) {
  return x != x;
}
bool is_nan(const Motion& motion) {
  return is_nan(motion.position_mm) && is_nan(motion.velocity_mm_per_s);
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
    CHECK(test::begins_with(test::refusal([&] { expects_valid(parameters); }),
                            owner + ": " + name + " = "));
  }
}

}  // namespace

TEST_CASE("foam contact: friction is a power of the load", "[foam_contact]") {
  const PolymerFriction<double> published;
  CHECK(friction_force(published, 8.0) == Approx(4));
  CHECK(friction_force(published, 27.0) == Approx(9));
  CHECK(friction_force(PolymerFriction<double>{0.5, 2.0 / 3}, 8.0) == Approx(2));
  CHECK(friction_force(PolymerFriction<double>{0.5, 1}, 8.0) == 4);  // Coulomb's law
  CHECK(friction_force(PolymerFriction<double>{0.5, 0.5}, 36.0) == Approx(3));
  CHECK(inverse_friction_coefficient(published, 8.0) == Approx(2));
  CHECK(inverse_friction_coefficient(PolymerFriction<double>{4, 2.0 / 3}, 8.0) == Approx(0.5));
  // the coefficient falls with the load, as the paper reports for compressed areas
  CHECK(friction_force(published, 27.0) / 27 < friction_force(published, 8.0) / 8);
  for (const double nothing : {0.0, -0.0, -1.0, -infinity}) {
    CHECK(friction_force(published, nothing) == 0);
    CHECK(inverse_friction_coefficient(published, nothing) == 0);
  }
  CHECK(is_nan(friction_force(published, none)));
  CHECK(friction_force(published, 1e-300) == Approx(1e-200));  // where mu is 1e100
}

TEST_CASE("foam contact: unless told otherwise, Hertz's sphere is of 10 mm and 0.1 MPa",
          "[foam_contact]") {
  const HertzContact<double> sphere;
  CHECK(sphere.radius_mm == 10);
  CHECK(sphere.reduced_modulus_mpa == 0.1);
  // N = 4/3 E* sqrt(R) depth^(3/2)
  CHECK(hertz_depth(sphere, 4.0 / 3 * 0.1 * std::sqrt(10.0) * 8) == Approx(4));
}

TEST_CASE("foam contact: Hertz's sphere, its area and its stiffness about a mean load",
          "[foam_contact]") {
  const HertzContact<double> sphere{9, 0.25};  // N = depth^(3/2)
  CHECK(hertz_depth(sphere, 8.0) == Approx(4));
  CHECK(hertz_stiffness(sphere, 8.0) == Approx(3));
  CHECK(contact_area(sphere, 8.0) == Approx(36 * pi));
  CHECK(contact_stress(sphere, 8.0) == Approx(8 / (36 * pi)));
  for (const double nothing : {0.0, -8.0}) {
    CHECK(contact_area(sphere, nothing) == 0);
    CHECK(contact_stress(sphere, nothing) == 0);
  }
  CHECK(is_nan(contact_area(sphere, none)));
  CHECK(is_nan(contact_stress(sphere, none)));
  CHECK(hertz_depth(sphere, 0.0) == 0);
  CHECK(hertz_depth(sphere, -8.0) == 0);
  CHECK(hertz_stiffness(sphere, -8.0) == 0);
  CHECK(is_nan(hertz_depth(sphere, none)));
}

TEST_CASE("foam contact: the oscillator left alone", "[foam_contact]") {
  const Motion at_one{1, 0}, pushed{0, 1};
  SECTION("published, m = c = k = 1") {
    const MassSpringDamper<double> oscillator;
    const double half_s = 2 * pi / std::sqrt(3.0);
    check_motion(free_motion(oscillator, at_one, half_s), -0.163033534821580, 0);
    check_motion(free_motion(oscillator, pushed, half_s), 0, -0.163033534821580);
  }
  SECTION("undamped") {
    const MassSpringDamper<double> oscillator{1, 0, 1};
    check_motion(free_motion(oscillator, at_one, 1.0), std::cos(1.0), -std::sin(1.0));
    check_motion(free_motion(oscillator, pushed, 100.0), std::sin(100.0), std::cos(100.0));
  }
  SECTION("critical: (1 + t) e^-t") {
    const MassSpringDamper<double> oscillator{1, 2, 1};
    check_motion(free_motion(oscillator, at_one, 1.0), 2 / std::exp(1.0), -1 / std::exp(1.0));
    check_motion(free_motion(oscillator, pushed, 3.0), 3 / std::exp(3.0), -2 / std::exp(3.0));
  }
  SECTION("strong: decays 1/2 and 2 per s") {
    const MassSpringDamper<double> oscillator{1, 2.5, 1};
    const double slow = std::exp(-1.5), fast = std::exp(-6.0);
    check_motion(free_motion(oscillator, at_one, 3.0), (4 * slow - fast) / 3,
                 (-2 * slow + 2 * fast) / 3);
    check_motion(free_motion(oscillator, pushed, 3.0), 2 * (slow - fast) / 3,
                 (4 * fast - slow) / 3);
  }
  SECTION("time 0 is the start, times that are none have no answer") {
    for (const double c : {0.0, 1.0, 2.0, 40.0}) {
      const MassSpringDamper<double> oscillator{1, c, 1};
      const auto motion = free_motion(oscillator, {3, -4}, 0.0);
      CHECK(motion.position_mm == 3);
      CHECK(motion.velocity_mm_per_s == -4);
      for (const double time : {-1.0, none, infinity, -infinity}) {
        CHECK(is_nan(free_motion(oscillator, at_one, time)));
        CHECK(is_nan(ramp_response(oscillator, {1, 1}, at_one, time)));
      }
    }
  }
  SECTION("nothing overflows: e^(t/2) of eq. 10 does beyond 1419, in float beyond 177") {
    for (const double time : {1500.0, 1e6, 1e100}) {
      check_motion(free_motion(MassSpringDamper<double>{}, at_one, time), 0, 0);
      check_motion(free_motion(MassSpringDamper<double>{1, 40, 1}, at_one, 40 * time), 0, 0);
    }
    const auto single = free_motion(MassSpringDamper<float>{}, {1, 1}, 1e30F);
    CHECK((single.position_mm == 0 && single.velocity_mm_per_s == 0));
  }
}

TEST_CASE("foam contact: under a ramp load (eq. 9, E039)", "[foam_contact]") {
  const RampLoad<double> load{2, 3};
  check_motion(particular_solution(MassSpringDamper<double>{}, load, 4.0), 11, 3);
  check_motion(particular_solution(MassSpringDamper<double>{1, 2, 4}, load, 4.0), 3.125, 0.75);
  check_motion(printed_particular_solution(load, 4.0), 9, 2);
  CHECK(load(4.0) == 14);
  // from rest, m = k = 1 without damping: A (1 - cos t) + B (t - sin t)
  check_motion(ramp_response(MassSpringDamper<double>{1, 0, 1}, load, {}, 5.0),
               2 * (1 - std::cos(5.0)) + 3 * (5 - std::sin(5.0)),
               2 * std::sin(5.0) + 3 * (1 - std::cos(5.0)));
  // a moving frame carries the oscillator along
  const MassSpringDamper<double> oscillator{1, 2, 4};
  CHECK(frame_load(oscillator, {0.5, 3}) == 8);
}

TEST_CASE("foam contact: residual of the printed solution", "[foam_contact]") {
  const MassSpringDamper<double> oscillator;
  const RampLoad<double> load{1, 3};
  for (const double t : {0.0, 1.0, 2.0, 10.0, 40.0}) {
    const auto printed = printed_particular_solution(load, t);
    const auto corrected = particular_solution(oscillator, load, t);
    const double printed_n = residual(oscillator, printed, 0.0, load(t));
    const double corrected_n = residual(oscillator, corrected, 0.0, load(t));
    INFO("t = " << t << " s, load " << load(t) << " N, residual: printed " << printed_n
                << " N, corrected " << corrected_n << " N");
    CHECK(printed_n == (load.start_n - load.rise_n_per_s) * (t - 1));
    CHECK(corrected_n == 0);
  }
  // correct only where A = B
  CHECK(residual(oscillator, printed_particular_solution<double>({2, 2}, 7.0), 0.0, 16.0) == 0);
}

TEST_CASE("foam contact: loads while a contact point slips (eqs. 6-8)", "[foam_contact]") {
  CHECK(deformation(3.0, 2.0) == 2.25);
  CHECK(deformation(-3.0, 2.0) == 2.25);
  for (const double radius : {0.0, -1.0, none}) {
    CHECK(is_nan(deformation(3.0, radius)));
  }
  const SlipDrag<double> drag{2, 3, 0.5, 0};
  SECTION("the printed z^(2/3), for 2p = 1 and K = 1") {
    const auto load = slip_load(drag, PolymerFriction<double>{}, deformation(8.0, 0.5));
    CHECK(load.start_n == Approx(4 * 2 * 0.5));
    CHECK(load.rise_n_per_s == Approx(4 * 3 * 0.5));
  }
  SECTION("other surfaces and factors") {
    const auto load = slip_load(drag, PolymerFriction<double>{0.5, 2.0 / 3}, deformation(8.0, 4.0));
    CHECK(load.start_n == Approx(4 * 2 * 0.5));
    CHECK(load.rise_n_per_s == Approx(4 * 3 * 0.5));
    const auto coulomb = slip_load(drag, PolymerFriction<double>{0.5, 1}, 8.0);
    CHECK(coulomb.start_n == 2);
  }
  SECTION("a frame that is displaced") {
    const auto load = drag_load(SlipDrag<double>{2, 3, 0.5, 0.25});
    CHECK(load.start_n == 0.25);
    CHECK(load.rise_n_per_s == 1.5);
  }
  SECTION("nothing is pressed: nothing drags") {
    CHECK(slip_load(drag, PolymerFriction<double>{}, 0.0).rise_n_per_s == 0);
  }
}

TEST_CASE("foam contact: loads while lifting (eq. 10)", "[foam_contact]") {
  const LiftLoad<double> load{9, 1, pi / 2, {1, 2}};
  CHECK(load(3.0) == Approx(2 * 7));
  CHECK(load(0.0) == Approx(std::cbrt(9.0)));
  CHECK(is_nan(load(none)));
  // C = |D|: 0 where the sine is -1, never negative
  CHECK(LiftLoad<double>{1, 1, pi / 2, {1, 2}}(3.0) == Approx(0).margin(1e-4));
  CHECK(LiftLoad<double>{1, -1, pi / 2, {1, 2}}(1.0) == Approx(0).margin(1e-4));
  const auto of_contact = lift_load(SlipDrag<double>{2, 3, 0.5, 0}, 0.5, 2.0, 7.0);
  CHECK(of_contact.middle == 16);
  CHECK(of_contact.swing == 8);
  CHECK(of_contact.frequency_rad_per_s == 7);
  CHECK(of_contact.drag.start_n == 1);
  CHECK(of_contact.drag.rise_n_per_s == 1.5);
}

TEST_CASE("foam contact: exact steps", "[foam_contact]") {
  const MassSpringDamper<double> oscillator{1, 0, 1};
  const FirstOrderHold<double> hold(oscillator, pi / 2);
  auto state = hold.start({1, 0});
  SECTION("without load") {
    check_motion(hold(0.0, 0.0, state), 0, -1);
    check_motion(hold(0.0, 0.0, state), -1, 0);
    check_motion(state.motion(), -1, 0);
  }
  SECTION("with loads, from rest") {
    state = hold.start();
    check_motion(hold(1.0, 1.0, state), 1, 1);
    state = hold.start();
    check_motion(hold(0.0, pi / 2, state), pi / 2 - 1, 1);
    state = hold.start();
    check_motion(hold(pi / 2, 0.0, state), 1, pi / 2 - 1);
  }
  SECTION("of another length") {
    check_motion(hold(0.0, 0.0, pi / 3, state), 0.5, -std::sqrt(0.75));
    check_motion(hold(0.0, 0.0, pi / 6, state), 0, -1);
    state = hold.start({1, 0});
    check_motion(hold(2.0, 2.0, 100.0, state), 2 - std::cos(100.0), std::sin(100.0));
  }
  SECTION("that are none") {
    for (const double bad : {none, infinity, -infinity}) {
      CHECK(is_nan(hold(bad, 0.0, state)));
      CHECK(is_nan(hold(0.0, bad, state)));
      CHECK(is_nan(hold(0.0, 0.0, bad, state)));
    }
    for (const double bad : {0.0, -0.1, 1e30, 1e40}) {
      CHECK(is_nan(hold(0.0, 0.0, bad, state)));
    }
    check_motion(state.motion(), 1, 0);
  }
  SECTION("so long that nothing is left of the start") {
    const FirstOrderHold<double> strong({2, 50, 4}, 1e6);
    auto left = strong.start({1e3, -1e3});
    check_motion(strong(8.0, 8.0, left), 2, 0);
    // 2 + 0.25 (t - c/k) at the end of a ramp from 8 to 10^6 + 8
    check_motion(strong(8.0, 8 + 1e6, left), 2 + 0.25 * (1e6 - 12.5), 0.25);
    CHECK(test::refusal([] { FirstOrderHold<double>({2, 50, 4}, 1e200); }) == "accepted");
  }
  SECTION("the state is a value") {
    const auto bookmark = state;
    const auto once = hold(1.0, 2.0, state);
    auto again = bookmark;
    CHECK(hold(1.0, 2.0, again).position_mm == once.position_mm);
    static_assert(std::is_trivially_copyable_v<FirstOrderHold<float>::State>);
    CHECK(hold.oscillator().mass_n_s2_per_mm == 1);
  }
}

TEST_CASE("foam contact: the causal integral", "[foam_contact]") {
  // a single step is exact for a ramp
  const MassSpringDamper<double> oscillator{0.5, 0.3, 4};
  const RampLoad<double> ramp{1, 2};
  const auto closed = ramp_response(oscillator, ramp, {}, 3.0);
  check_motion(causal_response(oscillator, ramp, 3.0, 1), closed.position_mm,
               closed.velocity_mm_per_s);
  check_motion(causal_response(oscillator, ramp, 3.0, 50), closed.position_mm,
               closed.velocity_mm_per_s);
  check_motion(causal_response(oscillator, ramp, 0.0, 5), 0, 0);
  for (const double time : {-1.0, none, infinity}) {
    CHECK(is_nan(causal_response(oscillator, ramp, time, 5)));
  }
  CHECK(is_nan(causal_response(oscillator, ramp, 3.0, 0)));
  CHECK(is_nan(causal_response(oscillator, ramp, 0.0, -1)));
}

TEST_CASE("foam contact: creep, recovery, relaxation", "[foam_contact]") {
  const Burgers<double> delayed{infinity, infinity, 2, 4}, flowing{2, 4, infinity, infinity};
  const double gone = 1 - std::exp(-1.0);
  CHECK(creep_compliance(delayed, 0.0) == 0);
  CHECK(creep_compliance(delayed, 2.0) == Approx(gone / 2));
  CHECK(creep_compliance(delayed, 1e300) == 0.5);
  CHECK(creep_compliance(flowing, 0.0) == 0.5);
  CHECK(creep_compliance(flowing, 2.0) == 1);
  CHECK(creep_compliance(Burgers<double>{2, 4, 2, 4}, 2.0) == Approx(1 + gone / 2));
  CHECK(recovery(delayed, 2.0) == Approx(1 - gone));
  CHECK(relaxation_modulus(flowing, 0.0) == 2);
  CHECK(relaxation_modulus(flowing, 2.0) == Approx(2 * (1 - gone)));
  for (const double time : {-1.0, none, infinity, -infinity}) {
    for (const Burgers<double>& foam : {delayed, flowing, Burgers<double>{}}) {
      CHECK(is_nan(creep_compliance(foam, time)));
      CHECK(is_nan(recovery(foam, time)));
      CHECK(is_nan(relaxation_modulus(foam, time)));
    }
  }
}

TEST_CASE("foam contact: strain under a history of stress", "[foam_contact]") {
  const Burgers<double> foam{2, 40, 5, 10};
  const Creep<double> creep(foam, 0.5);
  auto state = creep.start();
  CHECK(state.strain() == 0);
  double strain = 0;
  for (int k = 0; k < 6; ++k) {
    strain = creep(3.0, 3.0, state);
  }
  CHECK(strain == Approx(3 * creep_compliance(foam, 3.0)));
  CHECK(state.strain() == strain);
  const double delayed = state.delayed();
  CHECK(state.elastic() == 1.5);
  CHECK(state.viscous() == Approx(3 * 3.0 / 40));
  // unloaded: the elastic part vanishes at once, the delayed part gradually, the viscous part
  // remains
  strain = creep(0.0, 0.0, 4.0, state);
  CHECK(state.elastic() == 0);
  CHECK(state.delayed() == Approx(delayed * recovery(foam, 4.0)));
  CHECK(strain == Approx(delayed * std::exp(-2.0) + 9.0 / 40));
  // invalid steps
  for (const double bad : {none, infinity, -infinity}) {
    CHECK(is_nan(creep(bad, 1.0, state)));
    CHECK(is_nan(creep(1.0, bad, state)));
    CHECK(is_nan(creep(1.0, 1.0, bad, state)));
  }
  CHECK(is_nan(creep(1.0, 1.0, 0.0, state)));
  CHECK(is_nan(creep(1.0, 1.0, -1.0, state)));
  CHECK(state.strain() == strain);
  CHECK(creep.foam().maxwell_modulus_mpa == 2);
  // without one of the elements
  const Creep<double> elastic({3, infinity, infinity, infinity}, 0.5);
  auto of_elastic = elastic.start();
  CHECK(elastic(1.0, 6.0, of_elastic) == 2);
  // an endless step
  auto fresh = creep.start();
  creep(1.0, 1.0, 1e308, fresh);
  CHECK(fresh.delayed() == 0.2);
}

TEST_CASE("foam contact: bad parameters are refused by name", "[foam_contact]") {
  using R = MassSpringDamper<double>;
  check_refused("MassSpringDamper", &R::mass_n_s2_per_mm, "mass_n_s2_per_mm",
                {0, -1, none, infinity});
  check_refused("MassSpringDamper", &R::damping_n_s_per_mm, "damping_n_s_per_mm",
                {-1e-9, none, infinity});
  check_refused("MassSpringDamper", &R::stiffness_n_per_mm, "stiffness_n_per_mm",
                {0, -1, none, infinity});
  using F = PolymerFriction<double>;
  check_refused("PolymerFriction", &F::factor, "factor", {0, -1, none, infinity});
  check_refused("PolymerFriction", &F::exponent, "exponent", {0, -1, 1.01, none, infinity});
  using H = HertzContact<double>;
  check_refused("HertzContact", &H::radius_mm, "radius_mm", {0, -1, none, infinity});
  check_refused("HertzContact", &H::reduced_modulus_mpa, "reduced_modulus_mpa",
                {0, -1, none, infinity});
  using D = SlipDrag<double>;
  check_refused("SlipDrag", &D::damping_n_s_per_mm, "damping_n_s_per_mm", {-1, none, infinity});
  check_refused("SlipDrag", &D::stiffness_n_per_mm, "stiffness_n_per_mm", {-1, none, infinity});
  check_refused("SlipDrag", &D::speed_mm_per_s, "speed_mm_per_s", {none, infinity, -infinity});
  check_refused("SlipDrag", &D::frame_mm, "frame_mm", {none, infinity});
  using L = LiftLoad<double>;
  check_refused("LiftLoad", &L::middle, "middle", {0.99, -2, none, infinity});
  check_refused("LiftLoad", &L::swing, "swing", {none, infinity, -infinity});
  check_refused("LiftLoad", &L::swing, "middle", {2.01, -2.01});
  check_refused("LiftLoad", &L::frequency_rad_per_s, "frequency_rad_per_s", {none, infinity});
  using B = Burgers<double>;
  check_refused("Burgers", &B::maxwell_modulus_mpa, "maxwell_modulus_mpa", {0, -1, none});
  check_refused("Burgers", &B::maxwell_viscosity_mpa_s, "maxwell_viscosity_mpa_s", {0, -1, none});
  check_refused("Burgers", &B::kelvin_voigt_modulus_mpa, "kelvin_voigt_modulus_mpa", {0, none});
  check_refused("Burgers", &B::kelvin_voigt_viscosity_mpa_s, "kelvin_voigt_viscosity_mpa_s",
                {0, none});
  CHECK(test::refusal([] {
          expects_valid(LiftLoad<double>{1, 1, 1, {none, 1}});
        }) == "LiftLoad: drag.start_n = nan, must be finite");
  CHECK(test::refusal([] {
          expects_valid(LiftLoad<double>{1, 1, 1, {1, infinity}});
        }) == "LiftLoad: drag.rise_n_per_s = inf, must be finite");
  for (const double step : {0.0, -1.0, none, infinity, 1e30, 1e40}) {
    const std::string said = test::refusal([&] { FirstOrderHold<double>({1, 0, 1}, step); });
    CHECK(test::begins_with(said, "FirstOrderHold: step_s = "));
  }
  for (const double step : {0.0, -1.0, none, infinity}) {
    CHECK(test::begins_with(test::refusal([&] { Creep<double>({}, step); }), "Creep: step_s = "));
  }
  CHECK(test::begins_with(test::refusal([] {
                            FirstOrderHold<double>({1, -1, 1}, 1);
                          }),
                          "MassSpringDamper: damping_n_s_per_mm = "));
  CHECK(test::begins_with(test::refusal([] {
                            Creep<double>({0, 1}, 1);
                          }),
                          "Burgers: maxwell_modulus_mpa = "));
}
