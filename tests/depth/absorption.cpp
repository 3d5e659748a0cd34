// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/depth/absorption.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;
using test::Digits50;
using test::Tangent;

namespace {

template <class S>
Ray<S> pencil(double k, double h_m, double h_s) {
  return {.path_factor = S(k), .meridional_mm = S(h_m), .sagittal_mm = S(h_s)};
}

/// A random pencil: every camera's k lies in [2, 2.6], with heights from a lens to a wide camera.
Ray<double> any_pencil() {
  return {.path_factor = test::uniform(2, 2.6),
          .meridional_mm = test::log_uniform(1, 200),
          .sagittal_mm = test::log_uniform(1, 200)};
}

template <class S, class T>
Ray<S> as(const Ray<T>& p) {
  return {.path_factor = S(p.path_factor),
          .meridional_mm = S(p.meridional_mm),
          .sagittal_mm = S(p.sagittal_mm)};
}

template <class S, class T>
Absorption<S> as(const Absorption<T>& a) {
  return {S(a.c_red_per_mm), S(a.c_green_per_mm), S(a.kappa), S(a.max_depth_mm)};
}

/// The slides' closed form, Q1 (1 - E) - Q2 E with two heights. In 50 digits it loses at most 36 of
/// them where the tests go.
Digits50 published_scattered_light(const Digits50& l, const Digits50& c, const Ray<Digits50>& p) {
  const Digits50& k = p.path_factor;
  const Digits50 product = p.meridional_mm * p.sagittal_mm;
  const Digits50 sum = p.meridional_mm + p.sagittal_mm;
  const Digits50 e = exp(Digits50(-c * k * l));
  const Digits50 q1 = product / k + sum / (c * k * k) + 2 / (c * c * k * k * k);
  const Digits50 q2 = (l * l + sum * l) / k + 2 * l / (c * k * k);
  return Digits50(q1 * (1 - e) - q2 * e);
}

/// Relative error of W in S, in epsilons of S, against the closed form with the same inputs.
template <class S>
double error_in_epsilons(S l, S c, const Ray<S>& p) {
  const Digits50 reference = published_scattered_light(Digits50(l), Digits50(c), as<Digits50>(p));
  const Digits50 error = test::relative_error(Digits50(scattered_light(l, c, p)), reference);
  return static_cast<double>(error) / static_cast<double>(epsilon<S>());
}

/// Random fluid, pencil, scattering, brightness and depth.
struct Sensor {
  Absorption<double> fluid;
  Ray<double> light = any_pencil();
  double brightness = test::whole(0, 9) == 0 ? 0.0 : test::uniform(1, 250);  // some are black dots
  double scattering = test::log_uniform(1e-4, 1);
  double depth_mm = test::log_uniform(1e-6, 14);

  Sensor() {
    fluid.c_red_per_mm = test::log_uniform(1e-4, 0.2);
    fluid.c_green_per_mm = fluid.c_red_per_mm;  // the difference may be zero
    if (test::whole(0, 3) != 0) {
      fluid.c_green_per_mm += test::log_uniform(1e-6, 0.1);
    }
    fluid.kappa = test::uniform(0.5, 2);
  }
};

bool near(double a, double b, double scale, double epsilons) {
  return std::abs(a - b) <= epsilons * epsilon<double>() * scale;
}

}  // namespace

TEMPLATE_TEST_CASE("W is accurate to 4 epsilon", "[absorption]", float, double) {
  using S = TestType;
  rc::prop("at random c in [1e-6, 1] per mm and l in [1e-6, 14] mm", [] {
    const S l = static_cast<S>(test::log_uniform(1.1e-6, 14));
    const S c = static_cast<S>(test::log_uniform(1.1e-6, 1));
    RC_ASSERT(error_in_epsilons(l, c, as<S>(any_pencil())) <= 4);
  });
  SECTION("on a fine sweep of the optical path, across the seam at 4") {
    const auto p = pencil<S>(2.05, 66.5, 68.5);
    double worst = 0;
    for (double t = 1e-11; t < 28; t *= t < 1e-2 ? 1.7 : 1.013) {
      const double l = (std::min)(14.0, t / 2.05);
      worst =
          (std::max)(worst, error_in_epsilons(static_cast<S>(l), static_cast<S>(t / 2.05 / l), p));
    }
    for (double t = 3.999; t < 4.001; t += 2e-5) {
      worst =
          (std::max)(worst, error_in_epsilons(static_cast<S>(t / 2), S(1), pencil<S>(2, 50, 9)));
    }
    INFO(worst);
    CHECK(worst <= 4);
  }
}

TEST_CASE("W in 50 digits is the published closed form", "[absorption]") {
  rc::prop("to the digits that the closed form keeps", [] {
    const auto p = as<Digits50>(any_pencil());
    const Digits50 l(test::uniform(1, 14));
    const Digits50 c(test::uniform(0.02, 1));
    const Digits50 w = scattered_light(l, c, p);
    RC_ASSERT(test::relative_error(w, published_scattered_light(l, c, p)) < Digits50("1e-44"));
  });
}

TEMPLATE_TEST_CASE("laws of W", "[absorption]", float, double, long double) {
  using S = TestType;
  rc::prop("nothing scatters above depth 0, nor where nothing absorbs", [] {
    const auto p = as<S>(any_pencil());
    RC_ASSERT(scattered_light(S(0), S(test::uniform(0, 1)), p) == S(0));
    RC_ASSERT(scattered_light(S(test::uniform(0, 14)), S(0), p) == S(0));
  });
  rc::prop("it adds up over intervals: below a, and below b as seen through a", [] {
    using std::exp;
    const auto p = as<S>(any_pencil());
    const S a = S(test::uniform(0, 7));
    const S b = S(test::uniform(0, 7));
    const S c = S(test::log_uniform(1e-6, 1));
    auto seen_from_a = p;
    seen_from_a.meridional_mm += a;
    seen_from_a.sagittal_mm += a;
    const S sum = scattered_light(a, c, p) +
                  exp(S(-c * p.path_factor * a)) * scattered_light(b, c, seen_from_a);
    RC_ASSERT(test::relative_error(scattered_light(S(a + b), c, p), sum) <= 20 * epsilon<S>());
  });
  rc::prop("lengths times two and absorption halved make four of it, to the last bit", [] {
    const auto p = as<S>(any_pencil());
    auto q = p;
    q.meridional_mm *= 2;
    q.sagittal_mm *= 2;
    const S l = S(test::uniform(0, 14));
    const S c = S(test::log_uniform(1e-6, 1));
    RC_ASSERT(scattered_light(S(2 * l), S(c / 2), q) == 4 * scattered_light(l, c, p));
  });
  rc::prop("with c to 0 it is c times the volume of the pencil", [] {
    const auto p = as<S>(any_pencil());
    const S h_m = p.meridional_mm;
    const S h_s = p.sagittal_mm;
    const S l = S(test::uniform(0, 14));
    const S c = S(test::log_uniform(1e-30, 1e-24));
    const S volume = c * (h_m * h_s * l + (h_m + h_s) * l * l / 2 + l * l * l / 3);
    RC_ASSERT(test::relative_error(scattered_light(l, c, p), volume) <= 6 * epsilon<S>());
  });
}

TEST_CASE("the slope of W is its derivative", "[absorption]") {
  rc::prop("by the dual number, on both sides of the seam", [] {
    const auto p = any_pencil();
    const double c = test::log_uniform(1e-6, 1);
    const double l = test::uniform(1e-3, 14);
    const auto w = [&](const Tangent<double>& z) {
      return scattered_light(z, Tangent<double>(c), as<Tangent<double>>(p));
    };
    const double slope = scattered_light_slope(l, c, p);
    RC_ASSERT(near(test::slope_by_tangent(w, l), slope, w(l).v / l + slope, 1000));
  });
  rc::prop("by central differences in 50 digits", [] {
    const auto p = as<Digits50>(any_pencil());
    const Digits50 c(test::log_uniform(1e-6, 1));
    const Digits50 l(test::uniform(1e-3, 14));
    const auto w = [&](const Digits50& z) { return scattered_light(z, c, p); };
    const Digits50 by_difference = test::slope_by_difference(w, l, Digits50(l * Digits50("1e-14")));
    const Digits50 slope = scattered_light_slope(l, c, p);
    // the slope falls to 1e-16 of W / l, which is what rounds
    RC_ASSERT(abs(slope - by_difference) < Digits50("1e-25") * (slope + w(l) / l));
  });
}

TEST_CASE("the forward model", "[absorption]") {
  rc::prop("solves the depth equation, however bright the membrane is", [] {
    const Sensor s;
    const auto colour = colour_at_depth(s.fluid, s.light, s.brightness, s.scattering, s.depth_mm);
    const auto f = depth_equation(s.fluid, s.light, s.scattering, colour, s.depth_mm);
    // rounding of the exponents counts: up to c k l of it
    const double path = s.fluid.c_green_per_mm * s.light.path_factor * s.depth_mm;
    RC_ASSERT(near(f.first, 0, s.fluid.kappa * colour.red, 8 + 4 * path));
  });
  rc::prop("is the product of brightness and absorption plus what the fluid scatters", [] {
    const Sensor s;
    const auto lit = colour_at_depth(s.fluid, s.light, s.brightness, s.scattering, s.depth_mm);
    const auto dark = colour_at_depth(s.fluid, s.light, 0.0, s.scattering, s.depth_mm);
    const auto path = s.light.path_factor * s.depth_mm;
    const auto& a = s.fluid;
    const double w = scattered_light(s.depth_mm, a.c_red_per_mm, s.light);
    RC_ASSERT(dark.green == 0.0);
    RC_ASSERT(near(dark.red, s.scattering * w / a.kappa, dark.red, 4));
    RC_ASSERT(near(lit.green, s.brightness * std::exp(-a.c_green_per_mm * path), lit.green, 16));
    const double membrane = s.brightness * std::exp(-a.c_red_per_mm * path) / a.kappa;
    RC_ASSERT(near(lit.red, membrane + dark.red, lit.red, 16));
  });
  rc::prop("at depth 0 shows the membrane's own colour", [] {
    const Sensor s;
    const auto c = colour_at_depth(s.fluid, s.light, s.brightness, s.scattering, 0.0);
    RC_ASSERT(c.green == s.brightness);
    RC_ASSERT(c.red == s.brightness / s.fluid.kappa);
  });
}

TEST_CASE("what a change of light or a grey level is worth in depth", "[absorption]") {
  const Absorption<> fluid;
  const Camera<> camera;
  const auto ray = ray_at_pixel(camera, camera.center_y_px + 20, camera.center_x_px);
  const double brightness = 57, scattering = 0.0163;
  for (const auto& [depth_mm, noise_mm] : {std::pair(1.0, 0.56), {6.0, 0.68}, {12.0, 0.87}}) {
    CAPTURE(depth_mm);
    const auto seen = colour_at_depth(fluid, ray, brightness, scattering, depth_mm);
    const auto change_mm = [&, depth = depth_mm](double red, double green) {
      return newton_depth(fluid, ray, scattering, {red, green}).depth_mm - depth;
    };
    // a lamp a tenth darker makes the depth a tenth smaller
    CHECK(change_mm(0.9 * seen.red, 0.9 * seen.green) / depth_mm == Approx(-0.093).margin(0.011));
    // one per cent of white balance
    CHECK(change_mm(1.01 * seen.red, seen.green) == Approx(0.255).margin(0.04));
    CHECK(change_mm(seen.red, 0.99 * seen.green) == Approx(0.19).margin(0.03));
    // one grey level of noise in both colours
    const double step = 0.01;
    CHECK(
        std::hypot(change_mm(seen.red + step, seen.green), change_mm(seen.red, seen.green + step)) /
            step ==
        Approx(noise_mm).epsilon(0.01));
  }
}

TEST_CASE("the depth equation", "[absorption]") {
  rc::prop("rises strictly, so that it has one root at most", [] {
    const Sensor s;
    const auto colour = colour_at_depth(s.fluid, s.light, s.brightness, s.scattering, s.depth_mm);
    const double l = test::uniform(0, 14);
    const auto low = depth_equation(s.fluid, s.light, s.scattering, colour, l);
    const auto high = depth_equation(s.fluid, s.light, s.scattering, colour, l + 0.01);
    RC_ASSERT(low.second > 0);
    // in exact arithmetic; in double the rounding of kappa red may hide it where F hardly rises
    const auto exact = [&](double z) {
      const Colour<Digits50> c{Digits50(colour.red), Digits50(colour.green)};
      return depth_equation(as<Digits50>(s.fluid), as<Digits50>(s.light), Digits50(s.scattering), c,
                            Digits50(z));
    };
    RC_ASSERT(exact(l).first < exact(l + 0.01).first);
    const double scale = s.fluid.kappa * colour.red + std::abs(high.first);
    RC_ASSERT(near(low.first, static_cast<double>(exact(l).first), scale, 32));
    RC_ASSERT(near(low.second, static_cast<double>(exact(l).second), low.second, 32));
  });
  rc::prop("has the slope of its value", [] {
    const Sensor s;
    using D = Tangent<double>;
    const auto colour = colour_at_depth(s.fluid, s.light, s.brightness, s.scattering, s.depth_mm);
    const auto f = depth_equation(as<D>(s.fluid), as<D>(s.light), D(s.scattering),
                                  Colour<D>{D(colour.red), D(colour.green)}, D(s.depth_mm, 1));
    RC_ASSERT(near(f.first.d, f.second.v, std::abs(f.second.v) + s.brightness / s.depth_mm, 1000));
  });
}
