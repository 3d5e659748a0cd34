// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Every inverse for depth against the root in fifty digits of the equation with the same inputs.
#include "fingerpad/depth/depth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "fingerpad/published/depth.hpp"
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
constexpr double polynomial_double = 1e-12;  // documented for detail::DepthPolynomial
constexpr double polynomial_float = 1e-5;
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

  Pixel(const Absorption<double>& f,
        double rho_px,
        double l,
        double bright = brightness,
        bool one_height = false)
      : fluid(cast<S>(f)) {
    const auto camera = camera_at_corner();
    light = pencil_of(camera, ray_at_pixel(camera, 0.0, rho_px));
    light.height.sagittal_mm = one_height ? light.height.meridional_mm : light.height.sagittal_mm;
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
double worst_error(const Solve& solve, double bright = brightness, bool one_height = false) {
  double worst = 0;
  for (const double delta : deltas) {
    for (double rho = 0; rho <= static_cast<double>(pixels_to_rim); rho += 78) {
      for (const double l : depths()) {
        const Pixel<S> p(fluid_with(delta), rho, l, bright, one_height);
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

namespace {

/// The printed equations at a pixel with one height.
double printed_quotient(const Pixel<double>& p, double l) {
  const published::Fluid<double> fluid{p.fluid.c_red_per_mm, p.fluid.c_green_per_mm, p.fluid.kappa};
  return published::quotient(fluid, p.light.path_factor, p.light.height.meridional_mm, p.colour.red,
                             p.colour.green, l);
}

}  // namespace

TEST_CASE("the bisection stays within the half-width it states", "[depth]") {
  for (const int halvings : {2, 8, 16, 24}) {
    const double half_width = std::ldexp(18.0, 1 - halvings);
    const double error = worst_error<double>(
        [&](const auto& fluid, const auto& light, const auto& g, const auto& colour) {
          const published::Fluid<double> printed{fluid.c_red_per_mm, fluid.c_green_per_mm,
                                                 fluid.kappa};
          const double l = published::bisect(printed, light.path_factor, light.height.meridional_mm,
                                             g, colour.red, colour.green, fluid.max_depth_mm,
                                             halvings);
          return DepthRoot<double>{l, PixelStatus::ok};
        },
        brightness, true);
    INFO(halvings);
    CHECK(error <= half_width + 1e-9);  // some depths lie midway between two of its values
    CHECK(error > 0.2 * half_width);    // a much smaller error would be suspicious
  }
}

TEST_CASE("the published quotient has no value where the published bisection starts", "[depth]") {
  // E006: at depth 0 it is (b - kappa r) / 0, an infinity with the wrong sign.
  const Pixel<double> p(fluid_with(published_delta), 50, 6, brightness, true);
  CHECK_FALSE(is_finite(printed_quotient(p, 0)));
  CHECK_FALSE(printed_quotient(p, 0) >= p.g);  // the first step would go up, out of the fluid
  CHECK(printed_quotient(p, 1e-3) > p.g);
  CHECK(printed_quotient(p, static_cast<double>(p.exact)) == Approx(p.g).epsilon(1e-10));
}

namespace {

/// One pixel in one row, in a block of others.
template <class S>
DepthRoot<S> in_a_block(
    const detail::DepthPolynomial<S>& rows, int col, S red, S green, const S& per_g) {
  constexpr auto n = static_cast<std::size_t>(detail::DepthPolynomial<S>::block);
  const std::vector<S> reds(n, red), greens(n, green), all_per_g(n, per_g);
  std::vector<S> depth(n, S(-1));
  std::vector<PixelStatus> status(n);
  rows.invert(0, col, reds.data(), greens.data(), all_per_g.data(), depth.data(), status.data());
  return {depth[0], status[0]};
}

}  // namespace

TEST_CASE("a depth beyond either end of the range is refused, never clamped", "[depth]") {
  const auto fluid = fluid_with(published_delta, 10);
  const detail::DepthPolynomial<double> rows(camera_at_corner(), fluid, 235, scattering);
  const auto expect = [&](const Pixel<double>& p, PixelStatus status, bool by_rows = true) {
    std::vector<DepthRoot<double>> roots{newton_depth(p.fluid, p.light, p.g, p.colour)};
    if (by_rows) {
      roots.push_back(in_a_block(rows, 100, p.colour.red, p.colour.green, 1 / p.g));
    }
    for (const auto& root : roots) {
      CHECK(root.status == status);
      CHECK(is_finite(root.depth_mm) == (status == PixelStatus::ok));
    }
  };
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
    // the rows are given no infinite colour: a window leaves such pixels out
    p.colour = {bad, good.green};
    expect(p, PixelStatus::not_a_number, bad != bad);
    p.colour = {good.red, bad};
    expect(p, PixelStatus::not_a_number, bad != bad);
    p.colour = good;
    p.g = bad;
    expect(p, PixelStatus::not_a_number, false);
    p.g = scattering;
  }
  expect(p, PixelStatus::ok);
}

namespace {

/// One row of pixels from the axis to the rim, all at one depth.
template <class S>
class RowSolver {
 public:
  explicit RowSolver(const Absorption<double>& fluid)
      : fluid_(fluid), rows_(camera_at_corner(), fluid, pixels_to_rim, scattering) {}

  /// Worst error with all pixels at depth l.
  double error(double l, double bright) const {
    const auto camera = camera_at_corner();
    const S per_g = S(1) / S(scattering);
    const auto g = static_cast<double>(S(scattering));
    double worst = 0;
    for (int j = 0; j < static_cast<int>(pixels_to_rim); j += 39) {
      const auto light = pencil_of(camera, ray_at_pixel(camera, 0.0, static_cast<double>(j)));
      const auto c = colour_at_depth(fluid_, light, bright, g, l);
      const Colour<S> rounded{S(c.red), S(c.green)};
      const auto root = in_a_block(rows_, j, rounded.red, rounded.green, per_g);
      const ExactEquation f(
          fluid_, as<Digits50>(light), Digits50(g),
          Colour<double>{static_cast<double>(rounded.red), static_cast<double>(rounded.green)});
      const Digits50 exact = f.root(l);
      if (root.status == PixelStatus::below_range && exact < 2 * bound_mm::newton_float) {
        continue;
      }
      worst = (std::max)(
          worst, root.status == PixelStatus::ok ? error_mm(root.depth_mm, exact) : HUGE_VAL);
    }
    return worst;
  }

  double worst(double bright) const {
    double worst = 0;
    for (const double l : depths()) {
      worst = (std::max)(worst, error(l, bright));
    }
    return worst;
  }

 private:
  Absorption<double> fluid_;
  detail::DepthPolynomial<S> rows_;
};

/// Worst error over all differences of absorption, for membranes of the published brightness and
/// darker.
template <class S>
double worst_of_rows(double max_depth_mm) {
  double worst = 0;
  for (const double delta : deltas) {
    const RowSolver<S> solver(fluid_with(delta, max_depth_mm));
    for (const double bright : {brightness, 0.4 * brightness}) {
      worst = (std::max)(worst, solver.worst(bright));
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("depth by polynomials, for ranges of 14.5 and 18 mm", "[depth]") {
  const double max_depth_mm = GENERATE(14.5, 18.0);
  const double single = worst_of_rows<float>(max_depth_mm);
  const double twice = worst_of_rows<double>(max_depth_mm);
  CAPTURE(max_depth_mm, single, twice);
  CHECK(single <= bound_mm::polynomial_float);
  CHECK(twice <= bound_mm::polynomial_double);
}
