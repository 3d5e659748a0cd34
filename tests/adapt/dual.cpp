// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/adapt/dual.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/depth/absorption.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/weighted_sum.hpp"

using namespace fingerpad;
using Gradient = Dual<2>;
using FloatGradient = Dual<3, float>;

static_assert(scalar<Gradient> && scalar<FloatGradient>);
static_assert(std::same_as<scalar_real_t<FloatGradient>, float>);

TEST_CASE("a dual number is a scalar", "[dual]") {
  const Gradient x = Gradient::parameter(2.0, 0);
  CHECK(epsilon<Gradient>() == (std::numeric_limits<double>::epsilon)());
  CHECK(epsilon<FloatGradient>() == (std::numeric_limits<float>::epsilon)());
  CHECK(value(x) == 2);
  CHECK(value(square(x)) == 4);
  CHECK(square(x).slopes[0] == 4);
  CHECK(is_finite(x));
  CHECK_FALSE(is_finite(not_a_number<Gradient>()));
}

TEST_CASE("a grid of dual numbers gives the same sum, and its derivatives", "[dual]") {
  Eigen::Matrix<Gradient, 6, 4> matrix;
  for (Index i = 0; i < 6; ++i) {
    for (Index j = 0; j < 4; ++j) {
      matrix(i, j) = Gradient(test::pattern(i, j), std::array{0.0, 1.0});
    }
  }
  matrix(2, 3).slopes[0] = 1;
  const Gradient sum = test::weighted_sum(matrix);
  CHECK(sum.value == test::pattern_sum(6, 4));
  CHECK(sum.slopes[0] == 1 + 31 * 2 + 17 * 3);  // the weight of that cell
  CHECK(sum.slopes[1] == test::weighted_sum(LazyView(6, 4, [](Index, Index) { return 1.0; })));
}

TEST_CASE("camera and fluid are differentiated in one pass", "[dual]") {
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
      const auto pencil = ray_at_pixel(camera, S(row), S(100));
      return colour_at_depth(fluid, pencil, S(57), S(0.02), S(7)).red;
    };
    const Gradient both = red(Gradient::parameter(n0, 0), Gradient::parameter(c0, 1));
    using D = test::Tangent<double>;
    const D by_index = red(D(n0, 1), D(c0));
    const D by_absorption = red(D(n0), D(c0, 1));
    const auto close = [](double a, double b) { return std::abs(a - b) <= 1e-12 * std::abs(b); };
    RC_ASSERT(close(both.value, by_index.v));
    RC_ASSERT(close(both.slopes[0], by_index.d));
    RC_ASSERT(close(both.slopes[1], by_absorption.d));
  });
}

TEST_CASE("functions of dual numbers have the derivatives of calculus", "[dual]") {
  const auto check = [](const Gradient& y, double value, double by_first, double by_second) {
    CHECK(y.value == value);
    CHECK(y.slopes[0] == Approx(by_first).epsilon(1e-14));
    CHECK(y.slopes[1] == Approx(by_second).epsilon(1e-14));
  };
  // f(x) with x = at + 1 first + 3 second
  const auto follows = [&](const Gradient& y, double value, double slope) {
    check(y, value, slope, 3 * slope);
  };
  for (const double at : {-0.7, -1e-9, 1e-9, 0.3, 0.9}) {
    const Gradient x(at, {1, 3});
    follows(-x, -at, -1);
    follows(abs(x), std::abs(at), at < 0 ? -1 : 1);
    follows(exp(x), std::exp(at), std::exp(at));
    follows(sin(x), std::sin(at), std::cos(at));
    follows(cos(x), std::cos(at), -std::sin(at));
    follows(tan(x), std::tan(at), 1 / (std::cos(at) * std::cos(at)));
    follows(acos(x), std::acos(at), -1 / std::sqrt(1 - at * at));
    follows(atan(x), std::atan(at), 1 / (1 + at * at));
    follows(2 * x * x, 2 * at * at, 4 * at);
    follows(1 / x, 1 / at, -1 / (at * at));
    if (at > 0) {
      follows(sqrt(x), std::sqrt(at), 0.5 / std::sqrt(at));
      follows(log(x), std::log(at), 1 / at);
      follows(pow(x, 2.5), std::pow(at, 2.5), 2.5 * std::pow(at, 1.5));
    }
  }
  const auto [a, b] = seeded(std::array{1.5, -0.5});
  check(a + b, 1, 1, 1);
  check(a - b, 2, 1, -1);
  check(a * b, -0.75, -0.5, 1.5);
  check(a / b, -3, -2, -6);
  check(pow(a, b), std::pow(1.5, -0.5), -0.5 * std::pow(1.5, -1.5),
        std::log(1.5) * std::pow(1.5, -0.5));
  check(atan2(b, a), std::atan2(-0.5, 1.5), 0.5 / 2.5, 1.5 / 2.5);
  Gradient sum = a;
  sum += b;
  sum *= a;
  sum -= b;
  sum /= a;
  check(sum, 2.0 / 1.5, 1 - 0.5 / (1.5 * 1.5), 1 - 1 / 1.5);
  CHECK((b < a && a > b && a >= 1.5 && b != a && a == 1.5));
}

TEST_CASE("the variance of a result is J C J^T", "[dual]") {
  const auto [a, b] = seeded(std::array{2.0, 3.0});
  const Eigen::Matrix2d covariance{{4, 1}, {1, 9}};
  CHECK(carried_variance(a * b, covariance) == 3 * 3 * 4 + 2 * 3 * 2 * 1 + 2 * 2 * 9);
}
