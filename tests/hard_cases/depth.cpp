// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Every inverse for depth against the root in fifty digits of the equation with the same inputs.
#include "fingerpad/published/depth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "fingerpad/depth/depth.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;
using test::Digits50;

namespace {

namespace bound_mm {
constexpr double newton_double = 1e-12;  // documented for newton_depth()
// A float colour of 57 grey levels has a resolution of 3.8e-6; F rises by at least 1.3 grey levels
// per mm and is itself rounded to a few such units.
constexpr double newton_float = 2e-5;
constexpr double two_steps_float = 1e-5;     // documented
constexpr double one_step_float = 1e-4;      // documented
constexpr double polynomial_double = 1e-12;  // degree 12: the error of the fit is below this
constexpr double smallest = 1e-6;
constexpr double deepest = 14;
}  // namespace bound_mm

/// The published numbers; delta from 0 to the published 0.0046 per mm.
Absorption<double> fluid_with(double delta_per_mm, double max_depth_mm = 18) {
  Absorption<double> fluid;
  fluid.c_green_per_mm = fluid.c_red_per_mm + delta_per_mm;
  fluid.max_depth_mm = max_depth_mm;
  return fluid;
}
const double published_delta =
    Absorption<double>().c_green_per_mm - Absorption<double>().c_red_per_mm;
const std::vector<double> deltas = {0, 1e-4, published_delta};
constexpr double brightness = 57;
constexpr double scattering = 0.0163;

/// One row of pixels from the axis to the rim of a pad with a base radius of 18.735 mm.
constexpr Index pixels_to_rim = 235;
Camera<double> camera_at_corner() {
  Camera<double> camera;
  camera.center_x_px = 0;
  camera.center_y_px = 0;
  return camera;
}

template <class S>
Pencil<S> as(const Pencil<double>& p) {
  return {S(p.path_factor), {S(p.height.meridional_mm), S(p.height.sagittal_mm)}};
}

/// F in the slides' closed form, independent of the library's series.
struct ExactEquation {
  Digits50 c, delta, k, product, sum, kappa_red, green, g;

  template <class S>
  ExactEquation(const Absorption<S>& fluid,
                const Pencil<Digits50>& p,
                const Digits50& scatter,
                const Colour<S>& colour)
      : c(fluid.c_red_per_mm),
        delta(Digits50(fluid.c_green_per_mm) - Digits50(fluid.c_red_per_mm)),
        k(p.path_factor),
        product(p.height.meridional_mm * p.height.sagittal_mm),
        sum(p.height.meridional_mm + p.height.sagittal_mm),
        kappa_red(Digits50(fluid.kappa) * Digits50(colour.red)),
        green(colour.green),
        g(scatter) {}

  /// From a depth with an error of about 1e-3 mm, five Newton steps give fifty digits.
  Digits50 root(double near) const {
    const Digits50 ck = c * k;
    const Digits50 q1 = (product + (sum + 2 / ck) / ck) / k;
    Digits50 l(near);
    for (int step = 0; step < 5; ++step) {
      const Digits50 decay = exp(Digits50(-ck * l));
      const Digits50 membrane = green * exp(Digits50(delta * k * l));
      const Digits50 q2 = (l * l + sum * l + 2 * l / ck) / k;
      const Digits50 scatter_slope = c * (l * l + sum * l + product) * decay;
      const Digits50 value = membrane - kappa_red + g * (q1 * (1 - decay) - q2 * decay);
      l = l - value / (membrane * delta * k + g * scatter_slope);
    }
    return l;
  }
};

template <class S>
double error_mm(const S& depth, const Digits50& exact) {
  return static_cast<double>(abs(Digits50(Digits50(depth) - exact)));
}

/// Colours in S of a pixel at depth l, and the exact root for these colours.
template <class S>
struct Pixel {
  Absorption<S> fluid;
  Pencil<double> light;
  S g;
  Colour<S> colour;
  Digits50 exact;

  Pixel(const Absorption<double>& f, double rho_px, double l, double bright = brightness)
      : fluid(cast<S>(f)) {
    const auto camera = camera_at_corner();
    light = pencil_of(camera, ray_at_pixel(camera, 0.0, rho_px));
    // rounding of the pencil is no error of the solver
    light = as<double>(Pencil<double>{static_cast<double>(S(light.path_factor)),
                                      {static_cast<double>(S(light.height.meridional_mm)),
                                       static_cast<double>(S(light.height.sagittal_mm))}});
    g = S(scattering);
    const auto c = colour_at_depth(f, light, bright, scattering, l);
    colour = {S(c.red), S(c.green)};
    exact = ExactEquation(fluid, as<Digits50>(light), Digits50(g), colour).root(l);
  }
};

/// Depths from 1e-6 to 14 mm, dense at both ends of the scale.
std::vector<double> depths() {
  std::vector<double> l;
  for (double x = bound_mm::smallest; x < 1; x *= 30) {
    l.push_back(x);
  }
  for (double x = 1; x < bound_mm::deepest; x += 3.25) {
    l.push_back(x);
  }
  l.push_back(bound_mm::deepest);
  return l;
}

/// Worst error of a solver over all deltas, radii and depths.
template <class S, class Solve>
double worst_error(const Solve& solve, double bright = brightness) {
  double worst = 0;
  for (const double delta : deltas) {
    for (double rho = 0; rho <= static_cast<double>(pixels_to_rim); rho += 78) {
      for (const double l : depths()) {
        const Pixel<S> p(fluid_with(delta), rho, l, bright);
        const DepthRoot<S> root = solve(p.fluid, as<S>(p.light), p.g, p.colour);
        if (root.status == PixelStatus::below_range && p.exact < 2 * bound_mm::newton_float) {
          continue;  // a float colour cannot resolve such a depth
        }
        const double error =
            root.status == PixelStatus::ok ? error_mm(root.depth_mm, p.exact) : HUGE_VAL;
        worst = (std::max)(worst, error);
      }
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("Newton's depth is the root to roundoff", "[depth]") {
  const auto solve = [](const auto& fluid, const auto& light, const auto& g, const auto& colour) {
    return newton_depth(fluid, light, g, colour);
  };
  CHECK(worst_error<double>(solve) <= bound_mm::newton_double);
  CHECK(worst_error<double>(solve, 0.4 * brightness) <= bound_mm::newton_double);
  CHECK(worst_error<float>(solve) <= bound_mm::newton_float);
  rc::prop("at random depth, radius and difference of absorption, from any start", [] {
    const double delta = test::whole(0, 4) == 0 ? 0 : test::log_uniform(1e-12, published_delta);
    const double l = test::log_uniform(bound_mm::smallest, bound_mm::deepest);
    const Pixel<double> p(fluid_with(delta), test::uniform(0, 235), l);
    const double start = test::whole(0, 3) == 0 ? not_a_number<double>() : test::uniform(-5, 30);
    const auto root = newton_depth(p.fluid, p.light, p.g, p.colour, start);
    RC_ASSERT(root.status == PixelStatus::ok);
    RC_ASSERT(error_mm(root.depth_mm, p.exact) <= bound_mm::newton_double);
  });
}

TEST_CASE("Newton's depth also has no bound of its own in 50 digits", "[depth]") {
  const Pixel<Digits50> p(fluid_with(published_delta), 100, 6);
  const auto root = newton_depth(p.fluid, as<Digits50>(p.light), p.g, p.colour);
  CHECK(error_mm(root.depth_mm, p.exact) <= 1e-44);
}

TEST_CASE("the bisection stays within the half-width it states", "[depth]") {
  for (const int halvings : {2, 8, 16, 24}) {
    const double half_width = std::ldexp(18.0, 1 - halvings);
    const double error = worst_error<double>(
        [&](const auto& fluid, const auto& light, const auto& g, const auto& colour) {
          return published::bisect_depth(fluid, light, g, colour, halvings);
        });
    INFO(halvings);
    CHECK(error <= half_width + 1e-9);  // some depths lie midway between two of its values
    CHECK(error > 0.2 * half_width);    // a much smaller error would be suspicious
  }
}

TEST_CASE("the published quotient has no value where the published bisection starts", "[depth]") {
  // E006: at depth 0 it is (b - kappa r) / 0, an infinity with the wrong sign.
  const Pixel<double> p(fluid_with(published_delta), 50, 6);
  const double at_start = published::quotient(p.fluid, p.light, p.colour, 0.0);
  CHECK_FALSE(is_finite(at_start));
  CHECK_FALSE(at_start >= p.g);  // the first step would go up, out of the fluid
  CHECK(published::quotient(p.fluid, p.light, p.colour, 1e-3) > p.g);
  const auto exact = static_cast<double>(p.exact);
  CHECK(published::quotient(p.fluid, p.light, p.colour, exact) == Approx(p.g).epsilon(1e-10));
}

TEST_CASE("a depth beyond either end of the range is refused, never clamped", "[depth]") {
  const auto solvers = [](const Pixel<double>& p) {
    return std::vector<DepthRoot<double>>{newton_depth(p.fluid, p.light, p.g, p.colour),
                                          published::bisect_depth(p.fluid, p.light, p.g, p.colour)};
  };
  const auto expect = [&](const Pixel<double>& p, PixelStatus status) {
    for (const auto& root : solvers(p)) {
      CHECK(root.status == status);
      CHECK(is_finite(root.depth_mm) == (status == PixelStatus::ok));
    }
  };
  const auto fluid = fluid_with(published_delta, 10);
  expect(Pixel<double>(fluid, 100, 10 - 1e-9), PixelStatus::ok);
  expect(Pixel<double>(fluid, 100, 10 + 1e-9), PixelStatus::above_range);
  expect(Pixel<double>(fluid, 100, 17), PixelStatus::above_range);
  expect(Pixel<double>(fluid, 100, 1e-9), PixelStatus::ok);

  Pixel<double> p(fluid, 100, 5);
  const Colour<double> good = p.colour;
  const double infinity = std::numeric_limits<double>::infinity();
  p.colour.green = p.fluid.kappa * good.red;  // exactly at depth 0
  expect(p, PixelStatus::ok);
  p.colour.green *= 1 + 1e-12;
  expect(p, PixelStatus::below_range);
  for (const double bad : {not_a_number<double>(), infinity, -infinity}) {
    p.colour = {bad, good.green};
    expect(p, PixelStatus::not_a_number);
    p.colour = {good.red, bad};
    expect(p, PixelStatus::not_a_number);
    p.colour = good;
    p.g = bad;
    expect(p, PixelStatus::not_a_number);
    p.g = scattering;
  }
  expect(p, PixelStatus::ok);
}

namespace {

/// Row solver of an exponential-free policy over one row of pixels, with its references.
template <class Inverse, class S>
class RowSolver {
 public:
  explicit RowSolver(const Absorption<double>& fluid)
      : fluid_(fluid), rows_(camera_at_corner(), fluid, reference(), Inverse{}) {}

  /// Worst error with all pixels at depth l.
  double error(double l, double bright) const {
    std::vector<S> red, green, depth(std::size_t(pixels_to_rim), S(-1));
    std::vector<PixelStatus> status(std::size_t(pixels_to_rim), PixelStatus::outside_pad);
    const auto g = static_cast<double>(S(scattering));
    const auto camera = camera_at_corner();
    std::vector<Pencil<double>> light;
    for (Index j = 0; j < pixels_to_rim; ++j) {
      light.push_back(pencil_of(camera, ray_at_pixel(camera, 0.0, static_cast<double>(j))));
      const auto c = colour_at_depth(fluid_, light.back(), bright, g, l);
      red.push_back(S(c.red));
      green.push_back(S(c.green));
    }
    rows_.invert(0, pixels_to_rim, red.data(), green.data(), depth.data(), status.data());
    double worst = 0;
    for (std::size_t j = 0; j < red.size(); j += 39) {
      const ExactEquation f(
          fluid_, as<Digits50>(light[j]), Digits50(g),
          Colour<double>{static_cast<double>(red[j]), static_cast<double>(green[j])});
      const Digits50 exact = f.root(l);
      if (status[j] == PixelStatus::below_range && exact < 2 * bound_mm::newton_float) {
        continue;
      }
      worst =
          (std::max)(worst, status[j] == PixelStatus::ok ? error_mm(depth[j], exact) : HUGE_VAL);
    }
    return worst;
  }

  double worst(double bright = brightness) const {
    double worst = 0;
    for (const double l : depths()) {
      worst = (std::max)(worst, error(l, bright));
    }
    return worst;
  }

 private:
  static DepthReference<S> reference() {
    DepthReference<S> r;
    r.rows = 1;
    r.cols = pixels_to_rim;
    r.depth_mm.assign(std::size_t(pixels_to_rim), S(1));
    r.scattering.coefficient[0] = S(scattering);
    r.scattering.rho_max_mm = S(18.735);
    r.pixels_used = pixels_to_rim;
    return r;
  }
  Absorption<double> fluid_;
  detail::DepthRows<Inverse, AstigmaticHeights, S, RadialScattering<S>> rows_;
};

/// Worst error over all differences of absorption, for membranes of the published brightness and
/// darker.
template <class S, int Order, int Degree, int Radial = 3>
double worst_of_rows(double max_depth_mm = 18) {
  double worst = 0;
  for (const double delta : deltas) {
    const RowSolver<ExponentialFree<Order, Degree, Radial>, S> solver(
        fluid_with(delta, max_depth_mm));
    worst = (std::max)(worst, (std::max)(solver.worst(), solver.worst(0.4 * brightness)));
  }
  return worst;
}

}  // namespace

TEST_CASE("the exponential-free depth in float", "[depth]") {
  // The error of a single Newton step depends on the range beyond the depths: 2.8e-4 for 18 mm.
  CHECK((worst_of_rows<float, 2, 6>(14.5)) <= bound_mm::one_step_float);
  CHECK((worst_of_rows<float, 3, 6>()) <= bound_mm::one_step_float);
  CHECK((worst_of_rows<float, 4, 6>()) <= bound_mm::two_steps_float);
  CHECK((worst_of_rows<float, 9, 6>()) <= bound_mm::two_steps_float);
}

TEST_CASE("the exponential-free depth in double", "[depth]") {
  CHECK((worst_of_rows<double, 9, 12, 8>()) <= bound_mm::polynomial_double);
  CHECK((worst_of_rows<double, 8, 12, 8>()) <= bound_mm::polynomial_double);
}
