// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Numbers: powers against 50 digits over all exponents and bases, forces likewise, derivatives.
#include "fingerpad/force/shear.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "fingerpad/adapt/autodiff.hpp"
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

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Powers of one base: by a row that fills vectors, and by the rest of a row, which has none.
template <class S>
struct Powers {
  S in_vectors;
  S in_rest;
};

template <class S>
Powers<S> powers(S base, S exponent, S factor = S(1)) {
  std::array<S, 16> x, p, other;
  x.fill(base);
  detail::power_rows(x.data(), x.size(), factor, exponent, S(0), p.data(), other.data());
  // and as the second of the two powers, which share nothing but the logarithm
  std::array<S, 16> q;
  detail::power_rows(x.data(), x.size(), factor, S(1), exponent, other.data(), q.data());
  bool same = true;
  for (std::size_t i = 0; i < x.size(); ++i) {
    same = same && test::same_bits(p[i], p[0]) && test::same_bits(q[i], p[0]);
  }
  Powers<S> both{p[0], S(0)};
  detail::power_rows(x.data(), 1, factor, exponent, exponent, &both.in_rest, other.data());
  REQUIRE((same && test::same_bits(other[0], both.in_rest)));
  return both;
}

/// In epsilons, relative.
template <class S>
double off(S power, const Digits50& exact) {
  const double relative = static_cast<double>(Digits50((Digits50(power) - exact) / exact));
  return std::abs(relative) / static_cast<double>(std::numeric_limits<S>::epsilon());
}

/// The worst errors over bases of every size and exponents for which |t log x| <= `most`, in
/// epsilons: as they are, and per 1 + |t log x|, which is what a rounded logarithm costs.
struct Worst {
  double in_vectors = 0;
  double in_rest = 0;
  double in_vectors_per_log = 0;
  double in_rest_per_log = 0;
};

template <class S>
Worst worst_powers(double decades, double most, int cases) {
  Worst worst;
  test::Random random(7);
  for (int k = 0; k < cases; ++k) {
    const double spread = k % 3 == 0 ? 0.01 : k % 3 == 1 ? 0.1 : 1;
    const S base = static_cast<S>(std::pow(10.0, spread * decades * random.uniform(-1, 1)));
    const double log_base = std::log(static_cast<double>(base));
    if (log_base == 0) {
      continue;
    }
    const double y = most * std::pow(10.0, -4 * random.uniform()) * (k % 2 == 0 ? 1 : -1);
    const S exponent = static_cast<S>(k % 5 == 0 ? random.uniform(-3, 3) : y / log_base);
    const Digits50 exact_log = Digits50(exponent) * log(Digits50(base));
    const double size = std::abs(static_cast<double>(exact_log));
    if (size > most) {
      continue;
    }
    const Digits50 exact = exp(exact_log);
    const auto p = powers(base, exponent);
    const double a = off(p.in_vectors, exact), b = off(p.in_rest, exact);
    worst.in_vectors = (std::max)(worst.in_vectors, a);
    worst.in_rest = (std::max)(worst.in_rest, b);
    worst.in_vectors_per_log = (std::max)(worst.in_vectors_per_log, a / (1 + size));
    worst.in_rest_per_log = (std::max)(worst.in_rest_per_log, b / (1 + size));
  }
  return worst;
}

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

TEST_CASE("powers follow 50 digits", "[shear]") {
  SECTION("in double, over all bases, for exponents that a pad has") {
    const Worst worst = worst_powers<double>(290, 30, 1000);
    INFO(worst.in_vectors << ' ' << worst.in_rest);
    CHECK(worst.in_vectors < 60);  // 1.3e-14, at e^30; 33 measured
    CHECK(worst.in_rest < 40);     // 18 measured
  }
  SECTION("in double, over all that the result can be") {
    const Worst worst = worst_powers<double>(290, 700, 1000);
    INFO(worst.in_vectors << ' ' << worst.in_rest);
    CHECK(worst.in_vectors_per_log < 2);  // 1.4 measured
    CHECK(worst.in_rest_per_log < 1.5);   // 0.9 measured, with glibc
  }
  SECTION("in float, computed in double by vectors: half a last place") {
    const Worst worst = worst_powers<float>(37, 85, 1000);
    INFO(worst.in_vectors << ' ' << worst.in_rest);
    if (detail::native_vector_bytes != 0) {
      CHECK(worst.in_vectors < 0.501);
    }
    CHECK(worst.in_rest_per_log < 1.5);
  }
}

TEMPLATE_TEST_CASE("powers of nothing and of no numbers are 0", "[shear]", double, float) {
  using S = TestType;
  for (const double base : {0.0, -0.0, -1e-30, -1.0, -1e30, -infinity, double(test::nan)}) {
    for (const double exponent : {0.65, 2.2, 0.0, -0.65, -300.0}) {
      const auto p = powers(static_cast<S>(base), static_cast<S>(exponent));
      CAPTURE(base, exponent);
      CHECK(p.in_vectors == 0);
      CHECK(p.in_rest == 0);
    }
  }
  CHECK(powers(-std::numeric_limits<S>::denorm_min(), S(0.5)).in_vectors == 0);
}

TEMPLATE_TEST_CASE("powers that are exact", "[shear]", double, float) {
  using S = TestType;
  // exponent 0: one, whatever the base; base 1: one, whatever the exponent
  for (const double any : {1e-30, 0.3, 1.0, 17.0, 1e30}) {
    const auto p = powers(static_cast<S>(any), S(0));
    CHECK(p.in_vectors == 1);
    CHECK(p.in_rest == 1);
  }
  for (const double any : {-50.0, -0.65, 0.0, 1.7, 50.0}) {
    const auto p = powers(S(1), static_cast<S>(any));
    CHECK(p.in_vectors == 1);
    CHECK(p.in_rest == 1);
  }
  // the factor belongs to the base, and 100 * 2^10 / 100 to the 1.7 is 2^17
  const auto p = powers(S(102400), S(1.7), S(1) / S(100));
  CHECK(static_cast<double>(p.in_vectors) == Approx(131072).epsilon(3e-6));
  CHECK(static_cast<double>(p.in_rest) == Approx(131072).epsilon(3e-6));
  if (std::is_same_v<S, double>) {
    CHECK(static_cast<double>(p.in_vectors) == Approx(131072).epsilon(1e-14));
  }
}

TEST_CASE("powers beyond what exponents can be", "[shear]") {
  // Vectors hold the logarithm of the power within 700, so that its bits stay those of a number;
  // the rest of a row gives 0 or infinity. Neither is a power that a pad has.
  SECTION("too small for a number: as good as 0") {
    for (const auto& [base, exponent] : {std::pair{1e-280, 2.2}, {1e280, -2.2}, {0.5, 1e4}}) {
      const auto p = powers(base, exponent);
      CHECK((p.in_vectors >= 0 && p.in_vectors < 1e-303));
      CHECK(p.in_rest < 1e-303);
    }
  }
  SECTION("too large for a number: never of the wrong sign, never NaN") {
    for (const auto& [base, exponent] : {std::pair{1e280, 2.2}, {1e-280, -2.2}, {2.0, 1e4}}) {
      const auto p = powers(base, exponent);
      CHECK(p.in_vectors > 1e303);
      CHECK(p.in_rest > 1e303);
    }
  }
  SECTION("the largest and smallest bases") {
    const double largest = (std::numeric_limits<double>::max)();
    const Digits50 exact = exp(Digits50(0.65) * log(Digits50(largest)));
    const auto p = powers(largest, 0.65);
    CHECK(off(p.in_vectors, exact) < 2 * 462);
    CHECK(off(p.in_rest, exact) < 2 * 462);
    // far below any area: 0 to within 1e-188
    for (const double base : {1e-300, 1e-310, std::numeric_limits<double>::denorm_min()}) {
      const auto q = powers(base, 0.65);
      CHECK((q.in_vectors >= 0 && q.in_vectors < 1e-188));
      CHECK((q.in_rest >= 0 && q.in_rest < 1e-188));
    }
    // of float these are numbers like others in double
    for (const float base : {1e-44F, 1e-39F, 1e38F}) {
      const auto q = powers(base, 0.5F);
      const Digits50 root = sqrt(Digits50(base));
      CHECK(off(q.in_vectors, root) < (detail::native_vector_bytes != 0 ? 0.501 : 60));
      CHECK(off(q.in_rest, root) < 60);
    }
  }
}

TEST_CASE("powers of rows that no vector divides", "[shear]") {
  test::Random random(5);
  for (std::size_t n = 0; n < 40; ++n) {
    std::vector<double> x(n), s(n + 1, 7), t(n + 1, 7);
    for (double& base : x) {
      base = random.uniform(-0.2, 5);
    }
    detail::power_rows(x.data(), n, 0.5, 0.65, -1.7, s.data(), t.data());
    for (std::size_t i = 0; i < n; ++i) {
      CHECK(s[i] == (x[i] > 0 ? Approx(std::pow(0.5 * x[i], 0.65)).epsilon(1e-14) : Approx(0)));
      CHECK(t[i] == (x[i] > 0 ? Approx(std::pow(0.5 * x[i], -1.7)).epsilon(1e-14) : Approx(0)));
    }
    CHECK((s[n] == 7 && t[n] == 7));
  }
}

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
    const auto lazy = answer<test::Lazy50>(s);
    CHECK(relative_off(Digits50(lazy.moment_n_mm), exact.moment_n_mm) < 1e-47);
    CHECK(relative_off(Digits50(lazy.tangential_force_n.x), exact.tangential_force_n.x) < 1e-47);
  }
  INFO(by_float << ' ' << by_double << ' ' << by_long);
  CHECK(by_float < 3e-6);
  CHECK(by_double < 5e-15);
  CHECK(by_long < 3e-18);
}

TEST_CASE("many samples at once follow 50 digits", "[shear]") {
  const auto samples = exact_samples();
  const Index n = static_cast<Index>(samples.size());
  const auto worst = [&]<class S>(S) {
    const ShearNormalisation<S> normalisation{S(100), S(0.625), S(1.75)};
    const Shear<RadialShear<3, S>> shear(normalisation, bent<S>());
    const LazyView in(n, 4, [&](Index i, Index j) {
      return S(samples[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)]);
    });
    test::Image<S> out(n, 3);
    REQUIRE(shear.for_samples(in, out).ok());
    double most = 0;
    for (Index i = 0; i < n; ++i) {
      const auto exact = answer<Digits50>(samples[static_cast<std::size_t>(i)]);
      most = (std::max)({most, relative_off(out(i, 0), exact.tangential_force_n.x),
                         relative_off(out(i, 1), exact.tangential_force_n.y),
                         relative_off(out(i, 2), exact.moment_n_mm)});
    }
    return most;
  };
  CHECK(worst(0.0F) < 3e-6);
  CHECK(worst(0.0) < 1e-14);
  CHECK(worst(0.0L) < 3e-18);
  CHECK(worst(Digits50(0)) < 1e-47);
}

TEST_CASE("derivatives of forces and moments are those of differences", "[shear]") {
  using Dual = test::Dual<Digits50>;
  // by the measure, the displacement and the angle; within the range and beyond
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
        // at no displacement |d| d has a corner in its second derivative
        CHECK(std::abs(static_cast<double>(Digits50(dual[k].d - slope))) < 1e-13);
      }
    }
  }
  // nothing displaced: the first coefficients, by what the contact is normalised
  const Shear<RadialShear<3, Dual>> shear({Dual(100), Dual(0.625), Dual(1.75)}, bent<Dual>());
  const Dual zero(Digits50(0)), one(Digits50(0), Digits50(1));
  const auto by_x = shear(Dual(100), {one, zero}, zero);
  CHECK(by_x.tangential_force_n.x.d == 2);
  CHECK(by_x.tangential_force_n.y.d == 0);
  CHECK(shear(Dual(100), {zero, zero}, one).moment_n_mm.d == 30);
  // and no contact has no slope either
  CHECK(shear(zero, {one, zero}, one).tangential_force_n.x.d == 0);
  CHECK(shear(zero, {one, zero}, one).moment_n_mm.d == 0);
}

TEST_CASE("derivatives of forces by many seeds at once", "[shear]") {
  // by the coefficients and exponents of the calibration
  using Ad = Eigen::AutoDiffScalar<Eigen::Matrix<double, 5, 1>>;
  const auto seed = [](double number, int k) { return Ad(number, 5, k); };
  const ShearNormalisation<Ad> normalisation{Ad(100), seed(0.65, 0), seed(1.7, 1)};
  RadialShear<2, Ad> map;
  map.force = {{seed(2, 2), seed(0.5, 3)}, Ad(5)};
  map.moment = {{seed(30, 4), Ad(1)}, Ad(1)};
  const auto r = Shear(normalisation, map)(Ad(200), {Ad(0.3), Ad(-0.4)}, Ad(0.1));
  const double factor = std::pow(2.0, 0.65), turn = std::pow(2.0, 1.7) * 0.1;
  const double u = 0.5 * factor;  // |d| normalised; the force is 2 u + u^2 / 2 along (0.6, -0.8)
  const auto fx = r.tangential_force_n.x.derivatives(), fy = r.tangential_force_n.y.derivatives();
  CHECK(fx(2) == Approx(0.6 * u).epsilon(1e-13));
  CHECK(fx(3) == Approx(0.6 * u * u).epsilon(1e-13));
  CHECK(fy(3) == Approx(-0.8 * u * u).epsilon(1e-13));
  CHECK(fx(0) == Approx(0.6 * (2 * u + u * u) * std::log(2.0)).epsilon(1e-13));
  CHECK(fx(1) == 0);
  const auto m = r.moment_n_mm.derivatives();
  CHECK(m(4) == Approx(turn).epsilon(1e-13));
  CHECK(m(1) == Approx((30 * turn + 2 * turn * turn) * std::log(2.0)).epsilon(1e-13));
  CHECK(m(0) == 0);
}
