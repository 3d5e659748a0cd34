// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Forces and moments against 50 digits, and derivatives.
#include "fingerpad/force/shear.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "fingerpad/adapt/dual.hpp"
#include "support/catch.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"

namespace test {

template <class Real>
Dual<Real> log(const Dual<Real>& a) {
  using std::log;
  return {Real(log(a.v)), Real(a.d / a.v)};
}

}  // namespace test

using namespace fingerpad;
using test::Digits50;

namespace {

template <class S>
RadialShear<3, S> bent() {
  return {{{S(2), S(0.5), S(0.25)}, S(0.75)}, {{S(30), S(3), S(8)}, S(0.25)}};
}

/// Samples that every type holds exactly.
std::vector<std::array<double, 4>> exact_samples() {
  std::vector<std::array<double, 4>> samples;
  test::Random random(3);
  for (int k = 0; k < 150; ++k) {
    std::array<double, 4> s = {std::exp(random.uniform(-2, 6)), random.uniform(-2, 2),
                               random.uniform(-2, 2), random.uniform(-0.5, 0.5)};
    for (double& number : s) {
      number = static_cast<double>(static_cast<float>(number));
    }
    samples.push_back(s);
  }
  return samples;
}

template <class S>
ShearResult<S> answer(const std::array<double, 4>& s) {
  const ShearNormalisation<S> normalisation{S(100), S(0.625), S(1.75)};
  const Shear<RadialShear<3, S>> shear(normalisation, bent<S>());
  return shear(S(s[0]), {S(s[1]), S(s[2])}, S(s[3]));
}

template <class S>
double relative_off(const S& a, const Digits50& b) {
  return static_cast<double>(Digits50(abs(Digits50(Digits50(a) - b)) / abs(b)));
}

}  // namespace

TEST_CASE("tangential forces and moments follow 50 digits", "[shear]") {
  double by_float = 0, by_double = 0, by_long = 0;
  for (const auto& s : exact_samples()) {
    const auto exact = answer<Digits50>(s);
    const auto worst = [&](const auto& r) {
      return (std::max)({relative_off(r.tangential_force_n.x, exact.tangential_force_n.x),
                         relative_off(r.tangential_force_n.y, exact.tangential_force_n.y),
                         relative_off(r.moment_n_mm, exact.moment_n_mm)});
    };
    by_float = (std::max)(by_float, worst(answer<float>(s)));
    by_double = (std::max)(by_double, worst(answer<double>(s)));
    by_long = (std::max)(by_long, worst(answer<long double>(s)));
  }
  INFO(by_float << ' ' << by_double << ' ' << by_long);
  CHECK(by_float < 3e-6);
  CHECK(by_double < 5e-15);
  CHECK(by_long < 3e-18);
}

TEST_CASE("derivatives of forces and moments are those of differences", "[shear]") {
  using Dual = test::Dual<Digits50>;
  // derivatives by measure, displacement and angle; within the range and beyond
  const std::vector<std::array<double, 4>> places = {{80, 0.25, -0.125, 0.0625},
                                                     {400, 1.5, -0.75, -0.5},
                                                     {0.5, -0.1, 0.2, 0.3},
                                                     {80, 0, 0.5, 0.25},
                                                     {80, 0, 0, 0}};
  for (const auto& place : places) {
    for (std::size_t by = 0; by < 4; ++by) {
      const auto at = [&]<class S>(const S& change) {
        std::array<S, 4> s;
        for (std::size_t k = 0; k < 4; ++k) {
          s[k] = k == by ? S(S(place[k]) + change) : S(place[k]);
        }
        const Shear<RadialShear<3, S>> shear({S(100), S(0.625), S(1.75)}, bent<S>());
        const auto r = shear(s[0], {s[1], s[2]}, s[3]);
        return std::array<S, 3>{r.tangential_force_n.x, r.tangential_force_n.y, r.moment_n_mm};
      };
      const Digits50 h("1e-15");
      const auto dual = at(Dual(Digits50(0), Digits50(1)));
      const auto above = at(h), below = at(Digits50(-h));
      for (std::size_t k = 0; k < 3; ++k) {
        const Digits50 slope = (above[k] - below[k]) / (2 * h);
        CAPTURE(place[0], place[1], by, k);
        // at zero displacement |d| d has a corner in its second derivative
        CHECK(std::abs(static_cast<double>(Digits50(dual[k].d - slope))) < 1e-13);
      }
    }
  }
  // no displacement: the first coefficients, by the normalised contact
  const Shear<RadialShear<3, Dual>> shear({Dual(100), Dual(0.625), Dual(1.75)}, bent<Dual>());
  const Dual zero(Digits50(0)), one(Digits50(0), Digits50(1));
  const auto by_x = shear(Dual(100), {one, zero}, zero);
  CHECK(by_x.tangential_force_n.x.d == 2);
  CHECK(by_x.tangential_force_n.y.d == 0);
  CHECK(shear(Dual(100), {zero, zero}, one).moment_n_mm.d == 30);
  // and without contact the slope is zero, too
  CHECK(shear(zero, {one, zero}, one).tangential_force_n.x.d == 0);
  CHECK(shear(zero, {one, zero}, one).moment_n_mm.d == 0);
}

TEST_CASE("derivatives of forces by many seeds at once", "[shear]") {
  // derivatives by the coefficients and exponents of the calibration
  using Ad = fingerpad::Dual<5>;
  const auto seed = [](double number, std::size_t k) { return Ad::parameter(number, k); };
  const ShearNormalisation<Ad> normalisation{Ad(100), seed(0.65, 0), seed(1.7, 1)};
  RadialShear<2, Ad> map;
  map.force = {{seed(2, 2), seed(0.5, 3)}, Ad(5)};
  map.moment = {{seed(30, 4), Ad(1)}, Ad(1)};
  const auto r = Shear(normalisation, map)(Ad(200), {Ad(0.3), Ad(-0.4)}, Ad(0.1));
  const double factor = std::pow(2.0, 0.65), turn = std::pow(2.0, 1.7) * 0.1;
  const double u = 0.5 * factor;  // |d| normalised; the force is 2 u + u^2 / 2 along (0.6, -0.8)
  const auto fx = r.tangential_force_n.x.slopes, fy = r.tangential_force_n.y.slopes;
  CHECK(fx[2] == Approx(0.6 * u).epsilon(1e-13));
  CHECK(fx[3] == Approx(0.6 * u * u).epsilon(1e-13));
  CHECK(fy[3] == Approx(-0.8 * u * u).epsilon(1e-13));
  CHECK(fx[0] == Approx(0.6 * (2 * u + u * u) * std::log(2.0)).epsilon(1e-13));
  CHECK(fx[1] == 0);
  const auto m = r.moment_n_mm.slopes;
  CHECK(m[4] == Approx(turn).epsilon(1e-13));
  CHECK(m[1] == Approx((30 * turn + 2 * turn * turn) * std::log(2.0)).epsilon(1e-13));
  CHECK(m[0] == 0);
}
