// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/adapt/autodiff.hpp"

#include <cmath>
#include <limits>

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/depth/absorption.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/weighted_sum.hpp"

using namespace fingerpad;
using Gradient = Eigen::AutoDiffScalar<Eigen::Vector2d>;
using FloatGradient = Eigen::AutoDiffScalar<Eigen::Vector3f>;

static_assert(scalar<Gradient> && scalar<FloatGradient>);
static_assert(std::same_as<scalar_real_t<FloatGradient>, float>);
static_assert(std::same_as<real_of_t<const Gradient&>, Gradient>);

TEST_CASE("AutoDiffScalar is a scalar", "[autodiff]") {
  const Gradient x(2.0, 2, 0);
  CHECK(epsilon<Gradient>() == (std::numeric_limits<double>::epsilon)());
  CHECK(epsilon<FloatGradient>() == (std::numeric_limits<float>::epsilon)());
  CHECK(value(x) == 2);
  CHECK(value(square(x)) == 4);
  CHECK(square(x).derivatives()(0) == 4);
  CHECK(is_finite(x));
  CHECK_FALSE(is_finite(not_a_number<Gradient>()));
}

TEST_CASE("a grid of AutoDiffScalar gives the same sum, and its derivatives", "[autodiff]") {
  Eigen::Matrix<Gradient, 6, 4> matrix;
  for (Index i = 0; i < 6; ++i) {
    for (Index j = 0; j < 4; ++j) {
      matrix(i, j) = Gradient(test::pattern(i, j), Eigen::Vector2d(0, 1));
    }
  }
  matrix(2, 3).derivatives()(0) = 1;
  const Gradient sum = test::weighted_sum(matrix);
  CHECK(sum.value() == test::pattern_sum(6, 4));
  CHECK(sum.derivatives()(0) == 1 + 31 * 2 + 17 * 3);  // the weight of that cell
  CHECK(sum.derivatives()(1) ==
        test::weighted_sum(LazyView(6, 4, [](Index, Index) { return 1.0; })));
}

TEST_CASE("camera and fluid are differentiated in one pass", "[autodiff]") {
  rc::prop("as the tests' own dual number does one after the other", [] {
    const double n0 = test::uniform(1.1, 1.6);
    const double c0 = test::uniform(1e-3, 0.1);
    const double row = test::uniform(0, 480);
    const auto red = [&](const auto& n, const auto& c) {
      using S = std::remove_cvref_t<decltype(n)>;
      Camera<S> camera;
      camera.refractive_index = n;
      Absorption<S> fluid;
      fluid.c_red_per_mm = c;
      const auto pencil = pencil_of(camera, ray_at_pixel(camera, S(row), S(100)));
      return colour_at_depth(fluid, pencil, S(57), S(0.02), S(7)).red;
    };
    const Gradient both = red(Gradient(n0, 2, 0), Gradient(c0, 2, 1));
    using D = test::Dual<double>;
    const D by_index = red(D(n0, 1), D(c0));
    const D by_absorption = red(D(n0), D(c0, 1));
    const auto close = [](double a, double b) { return std::abs(a - b) <= 1e-12 * std::abs(b); };
    RC_ASSERT(close(both.value(), by_index.v));
    RC_ASSERT(close(both.derivatives()(0), by_index.d));
    RC_ASSERT(close(both.derivatives()(1), by_absorption.d));
  });
}

TEST_CASE("AutoDiffScalar has the functions that kernels need", "[autodiff]") {
  for (const double at : {-0.7, -1e-9, 0.0, 0.3, 2.5}) {
    const Gradient x(at, Eigen::Vector2d(1, 3));
    const auto check = [&](const Gradient& y, double value, double slope) {
      CHECK(y.value() == value);
      CHECK(y.derivatives()(0) == Approx(slope));
      CHECK(y.derivatives()(1) == Approx(3 * slope));
    };
    check(atan(x), std::atan(at), 1 / (1 + at * at));
    check(expm1(x), std::expm1(at), std::exp(at));
    check(log1p(x), std::log1p(at), 1 / (1 + at));
    check(atan(x + x), std::atan(2 * at), 2 / (1 + 4 * at * at));  // of an expression, too
  }
}
