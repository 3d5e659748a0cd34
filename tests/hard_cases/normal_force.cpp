// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Forces against 50 digits: where terms cancel, at the ends of the number range, and derivatives.
#include "fingerpad/force/normal_force.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <vector>

#include "fingerpad/adapt/dual.hpp"
#include "fingerpad/published/normal_force.hpp"
#include "support/catch.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Digits50;

namespace {

/// Numbers that float holds exactly, so every type starts from the same ones.
double any(test::Random& random, double low, double high) {
  return static_cast<double>(static_cast<float>(random.uniform(low, high)));
}

/// A curve, a compensation, errors and a contact in one list of any number type, so that each can
/// be seeded with a derivative.
template <std::size_t N>
using Inputs = std::array<double, N>;

template <class S, std::size_t N>
std::array<S, N> in(const Inputs<N>& inputs) {
  std::array<S, N> out;
  for (std::size_t k = 0; k < N; ++k) {
    out[k] = S(inputs[k]);
  }
  return out;
}

/// measure, displacement, angle, from, to
constexpr std::size_t contact = 6;

struct Polynomial {
  static constexpr std::size_t size = 3;
  template <class S>
  static PolynomialForce<2, S> curve(const S* p, const S& from, const S& to) {
    return {{p[0], p[1], p[2]}, from, to};
  }
  static std::array<double, size> draw(test::Random& random) {
    return {any(random, 0, 2), any(random, 0, 1), any(random, 0, 0.5)};
  }
};
struct Power {
  static constexpr std::size_t size = 2;
  template <class S>
  static PowerLawForce<S> curve(const S* p, const S& from, const S& to) {
    return {p[0], p[1], from, to};
  }
  static std::array<double, size> draw(test::Random& random) {
    return {any(random, 2, 8), any(random, 0.25, 0.75)};
  }
};
struct Plain {
  static constexpr std::size_t size = 0;
  template <class S>
  static NoCompensation compensation(const S*) {
    return {};
  }
  static std::array<double, size> draw(test::Random&) { return {}; }
};
struct Scaled {
  static constexpr std::size_t size = 2;
  template <class S>
  static ScaledCompensation<S> compensation(const S* p) {
    return {p[0], p[1]};
  }
  static std::array<double, size> draw(test::Random& random) {
    return {any(random, 0, 0.1), any(random, 0, 10)};
  }
};
struct Published {
  static constexpr std::size_t size = 8;
  template <class S>
  static published::Compensation<S> compensation(const S* p) {
    return {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}, p[6], p[7]};
  }
  static std::array<double, size> draw(test::Random& random) {
    return {any(random, 0.5, 1.5), any(random, -1, 1), any(random, -3, 3),  any(random, 0.5, 1.5),
            any(random, -9, 9),    any(random, -3, 3), any(random, 0.5, 2), any(random, 0.01, 0.1)};
  }
};

template <class Curve, class Compensation>
struct Of {
  static constexpr std::size_t size = contact + Curve::size + Compensation::size;
  using List = Inputs<size>;
  static constexpr bool is_power = std::is_same_v<Curve, Power>;

  template <class S>
  static auto force(const std::array<S, size>& p) {
    const auto curve = Curve::curve(&p[contact], p[4], p[5]);
    const auto compensation = Compensation::compensation(p.data() + contact + Curve::size);
    using Errors = CurveErrors<Curve::size, S>;
    Errors errors;
    for (std::size_t k = 0; k < Curve::size; ++k) {
      errors.covariance[k][k] = S(0.0625);
    }
    errors.residual_sd_n = S(0.125);
    errors.measure_sd = S(0.25);
    return NormalForce<std::remove_const_t<decltype(curve)>,
                       std::remove_const_t<decltype(compensation)>>(curve, compensation, errors);
  }
  template <class S>
  static NormalForceResult<S> result(const std::array<S, size>& p) {
    return force(p)(p[0], {p[1], p[2]}, p[3]);
  }
  /// Inputs below, within and beyond the range, with and without motion; some within the blend.
  static List draw(test::Random& random) {
    List p{};
    p[4] = any(random, 0.5, 2);
    p[5] = p[4] + any(random, 4, 8);
    p[0] = any(random, 0.05, 1.5) * static_cast<double>(static_cast<float>(p[5]));
    p[0] = static_cast<double>(static_cast<float>(p[0]));
    if (random.whole(0, 3) > 0) {
      p[1] = any(random, -2, 2);
      p[2] = any(random, -2, 2);
    }
    if (random.whole(0, 3) > 0) {
      p[3] = any(random, -0.1, 0.1);
    }
    const auto curve = Curve::draw(random);
    const auto compensation = Compensation::draw(random);
    std::copy(curve.begin(), curve.end(), p.begin() + contact);
    std::copy(compensation.begin(), compensation.end(), p.begin() + contact + Curve::size);
    return p;
  }
};

template <class S>
double off(const S& a, const Digits50& b) {
  return std::abs(static_cast<double>(Digits50(Digits50(a) - b)));
}
template <class S>
double eps() {
  return static_cast<double>(std::numeric_limits<S>::epsilon());
}

/// Allowed error of a force, in epsilons of the sum of the sizes of its terms. The error of a power
/// is that of its logarithm over the exponent.
template <class Case>
double roundings(const typename Case::List& p) {
  double n = 5;
  if constexpr (Case::is_power) {
    const double held = (std::min)(p[0], p[5]);
    const double c = p[contact], gamma = p[contact + 1];
    const double length = (std::max)(std::abs(std::log(held / c)), std::abs(std::log(p[5] / c)));
    n += 0.5 * (1 + 2 * length) / gamma;
  }
  return n;
}

/// Sum of the sizes of the terms.
double sum_of_sizes(const Inputs<Of<Polynomial, Published>::size>& p, double plain) {
  const double* c = p.data() + contact + Polynomial::size;
  const double d = std::hypot(p[1], p[2]), t = std::abs(p[3]);
  return plain * (1 + std::abs(c[0] - 1) + std::abs(c[3] - 1)) + std::abs(c[1]) * d +
         std::abs(c[2]) + std::abs(c[4]) * t + std::abs(c[5]);
}

template <class Case, class S>
void follows_50_digits(const typename Case::List& p) {
  const auto exact = Case::result(in<Digits50>(p));
  const auto found = Case::result(in<S>(p));
  double size = static_cast<double>(exact.force_n);
  if constexpr (std::is_same_v<Case, Of<Polynomial, Published>>) {
    auto still = p;
    still[1] = still[2] = still[3] = 0;
    size = sum_of_sizes(p, Case::result(still).force_n);
  }
  CAPTURE(p[0], p[1], p[2], p[3]);
  if (size > 1e-3 || !std::is_same_v<Case, Of<Polynomial, Published>>) {
    CHECK(found.status == exact.status);
  }
  CHECK(off(found.force_n, exact.force_n) <= roundings<Case>(p) * eps<S>() * size);
  // gradient and slope have some more roundings and are squared
  if constexpr (!std::is_same_v<Case, Of<Polynomial, Published>>) {
    CHECK(off(found.variance_n2, exact.variance_n2) <=
          4 * roundings<Case>(p) * eps<S>() * static_cast<double>(exact.variance_n2));
  }
}

using PlainPolynomial = Of<Polynomial, Plain>;
using ScaledPolynomial = Of<Polynomial, Scaled>;
using PublishedPolynomial = Of<Polynomial, Published>;
using PlainPower = Of<Power, Plain>;
using ScaledPower = Of<Power, Scaled>;
using PublishedPower = Of<Power, Published>;

}  // namespace

TEMPLATE_TEST_CASE("normal forces follow 50 digits",
                   "[normal_force]",
                   PlainPolynomial,
                   ScaledPolynomial,
                   PublishedPolynomial,
                   PlainPower,
                   ScaledPower) {
  test::Random random(5);
  for (int k = 0; k < 60; ++k) {
    const auto p = TestType::draw(random);
    follows_50_digits<TestType, float>(p);
    follows_50_digits<TestType, double>(p);
    follows_50_digits<TestType, long double>(p);
  }
}

TEST_CASE("the published equations hold in all of 50 digits", "[normal_force]") {
  // beyond the blend nothing of it remains
  const auto n = [](const char* digits) { return Digits50(digits); };
  const PolynomialForce<2, Digits50> area{
      {n("0.6242"), n("0.0191"), n("0.00008")}, Digits50(18), Digits50(478)};
  const PolynomialForce<2, Digits50> depth{
      {n("0.3435"), n("0.5563"), n("0.776")}, n("0.63"), n("5.62")};
  const published::Compensation<Digits50> by_area{{n("0.748"), n("-0.637"), n("1.7")},
                                                  {n("1.2"), n("0.1"), n("-1.8")}};
  const published::Compensation<Digits50> by_depth{{n("1.2"), n("0.509"), n("-3.5")},
                                                   {n("0.8"), n("-0.06"), n("-0.0518")}};
  const NormalForce a(area, by_area);
  const NormalForce d(depth, by_depth);
  const Digits50 none(0);
  CHECK(off(a(Digits50(250), {Digits50(-3), Digits50(4)}).force_n, n("6.2936016")) < 1e-47);
  CHECK(off(a(Digits50(250), {none, none}, n("0.5")).force_n, n("10.72904")) < 1e-47);
  CHECK(off(d(Digits50(4), {none, Digits50(2)}).force_n, n("15.49964")) < 1e-47);
  CHECK(off(d(Digits50(4), {none, none}, n("-0.5")).force_n, n("11.90596")) < 1e-47);
  CHECK(off(a(Digits50(250)).force_n, n("10.3992")) < 1e-47);
  CHECK(off(d(Digits50(4)).force_n, n("14.9847")) < 1e-47);
}

TEMPLATE_TEST_CASE("a compensation that cancels the force", "[normal_force]", float, double) {
  // 1.2 F + 0.509 d - 3.5 around 0: the error is the roundoff of the terms, and the force is never
  // below 0.
  using S = TestType;
  const auto curve = published::force_of_depth<S>();
  const auto compensation = published::compensation_by_depth<S>();
  const NormalForce force(curve, compensation);
  const auto exactly = [](const published::AffineForce<S>& a) {
    return published::AffineForce<Digits50>{Digits50(a.gain), Digits50(a.per_unit),
                                            Digits50(a.offset_n)};
  };
  const auto& c = curve.coefficients;
  const NormalForce exact(
      PolynomialForce<2, Digits50>{{Digits50(c[0]), Digits50(c[1]), Digits50(c[2])},
                                   Digits50(curve.from),
                                   Digits50(curve.to)},
      published::Compensation<Digits50>{
          exactly(compensation.displaced), exactly(compensation.rotated),
          Digits50(compensation.blend_mm), Digits50(compensation.blend_rad)});
  // zero of the sum along the x axis, in 50 digits
  Digits50 low(2), high(4);
  const Digits50 depth_mm(S(1));
  const auto sum = [&](const Digits50& x) {
    const auto change = published::Compensation<Digits50>{
        exactly(compensation.displaced), {}, Digits50(1), Digits50(1)}(square(x), Digits50(0));
    return Digits50(change.gain * exact(depth_mm).force_n + change.shift_n);
  };
  REQUIRE((sum(low) < 0 && sum(high) > 0));
  for (int k = 0; k < 160; ++k) {
    const Digits50 middle = (low + high) / 2;
    (sum(middle) < 0 ? low : high) = middle;
  }
  for (const double away : {-1e-3, -1e-6, -1e-12, 0.0, 1e-15, 1e-12, 1e-6, 1e-3}) {
    const S x = static_cast<S>(Digits50(low + Digits50(away)));
    const auto r = force(S(1), {x, S(0)});
    const auto e = exact(depth_mm, {Digits50(x), Digits50(0)});
    CHECK(off(r.force_n, e.force_n) <= 8 * eps<S>() * 3.5);
    CHECK(r.force_n >= 0);
    CHECK((r.status == ForceStatus::measured || r.force_n == 0));
  }
}

TEMPLATE_TEST_CASE("a curve that is flat where it begins", "[normal_force]", float, double) {
  // (m - 8)^2 from its vertex on: the terms are 128 times their sum
  using S = TestType;
  const NormalForce force(PolynomialForce<2, S>{{S(64), S(-16), S(1)}, S(8), S(16)});
  const NormalForce exact(PolynomialForce<2, Digits50>{
      {Digits50(64), Digits50(-16), Digits50(1)}, Digits50(8), Digits50(16)});
  for (const S above : {S(0), S(1e-6), S(1e-3), S(0.03), S(0.3), S(1), S(3)}) {
    const S m = S(8) + above;
    const auto r = force(m);
    CHECK(r.force_n >= 0);
    CHECK(off(r.force_n, exact(Digits50(m)).force_n) <= 2 * eps<S>() * 256);
  }
}

TEMPLATE_TEST_CASE("the largest and the smallest contacts", "[normal_force]", float, double) {
  using S = TestType;
  const S max = std::numeric_limits<S>::max(), least = std::numeric_limits<S>::denorm_min();
  const S normal = std::numeric_limits<S>::min();
  const auto curve = published::force_of_area<S>();
  const NormalForce force(curve);
  const auto& c = curve.coefficients;
  const NormalForce exact(PolynomialForce<2, Digits50>{
      {Digits50(c[0]), Digits50(c[1]), Digits50(c[2])}, Digits50(curve.from), Digits50(curve.to)});
  for (const S m : {S(1e6), S(1e20), S(1e37), S(max / 16), max}) {
    const auto r = force(m);
    const Digits50 e = exact(Digits50(m)).force_n;
    CHECK(r.status == ForceStatus::implausible);
    CHECK(test::relative_error(Digits50(r.force_n), e) < 8 * eps<S>());
  }
  for (const S m :
       {least, S(2 * least), normal, S(normal * 3), S(1e-30), S(1e-20), S(1e-10), S(1e-6)}) {
    const auto r = force(m);
    const Digits50 e = exact(Digits50(m)).force_n;
    CHECK(r.status == ForceStatus::below_range);
    CHECK(r.force_n >= 0);
    CHECK(off(r.force_n, e) <=
          20 * eps<S>() * static_cast<double>(e) + 4 * static_cast<double>(least));
  }
  // overflow is no answer
  const NormalForce steep(PolynomialForce<1, S>{{S(0), S(8)}, S(1), S(2)});
  CHECK(steep(S(max / 16)).force_n == S(max / 2));
  CHECK(std::isnan(steep(max).force_n));
  CHECK(steep(max).status == ForceStatus::not_finite);
  // powers
  const NormalForce power(PowerLawForce<S>{S(2), S(0.25), S(0.5), S(8)});
  for (const S r : {least, normal, S(1e-30), S(1e-5)}) {
    CHECK(power(r).status == ForceStatus::below_range);
    CHECK(power(r).force_n >= 0);
    CHECK(power(r).force_n <= S(1e-20));
  }
  const NormalForce exact_power(
      PowerLawForce<Digits50>{Digits50(2), Digits50(0.25), Digits50(0.5), Digits50(8)});
  for (const S r : {S(1e5), S(1e20), S(1e35)}) {
    CHECK(test::relative_error(Digits50(power(r).force_n), exact_power(Digits50(r)).force_n) <
          60 * eps<S>());
  }
}

TEST_CASE("exponents at both ends of their range", "[normal_force]") {
  // The error of the force is that of the logarithm of the radius over the exponent.
  for (const double exponent : {1.0 / 512, 1.0 / 64, 0.125, 1.0, 2.0}) {
    const PowerLawForce<> curve{4, exponent, 3, 5};
    const PowerLawForce<Digits50> exact{Digits50(4), Digits50(exponent), Digits50(3), Digits50(5)};
    const NormalForce force(curve);
    for (const double radius : {3.0, 3.9, 4 - 1e-9, 4.0, 4 + 1e-9, 4.03125, 4.9, 5.0}) {
      CAPTURE(exponent, radius);
      const double n = 4 + 2 * (1 + std::abs(std::log(radius / 4))) / exponent;
      const Digits50 e = NormalForce(exact)(Digits50(radius)).force_n;
      CHECK(test::relative_error(Digits50(force(radius).force_n), e) < n * eps<double>());
      // and back: the roundoff of the force is multiplied by the exponent
      const double again = curve.radius_mm(force(radius).force_n);
      CHECK(std::abs(again - radius) < (4 + n * exponent) * eps<double>() * radius);
    }
  }
}

TEMPLATE_TEST_CASE("derivatives of the normal force are those of differences",
                   "[normal_force]",
                   PlainPolynomial,
                   ScaledPolynomial,
                   PublishedPolynomial,
                   PlainPower,
                   ScaledPower,
                   PublishedPower) {
  constexpr std::size_t n = TestType::size;
  using D = fingerpad::Dual<n>;
  test::Random random(7);
  for (int k = 0; k < 14; ++k) {
    auto p = TestType::draw(random);
    switch (k) {  // ends of the range, of the blend, of contact, and no motion
      case 0:
        p[1] = p[2] = p[3] = 0;
        break;
      case 1:
        p[0] = p[4];
        break;
      case 2:
        p[0] = p[5];
        break;
      case 3:
        p[0] = 0;
        break;
      case 4:
        p[1] = p[2] = 0;
        break;
      case 5:
        p[3] = 0;
        break;
      case 6:
        p[0] = -1;
        break;
      default:
        break;
    }
    std::array<D, n> seeded;
    for (std::size_t i = 0; i < n; ++i) {
      seeded[i] = D::parameter(p[i], i);
    }
    const auto r = TestType::result(seeded);
    CHECK(r.force_n.value == TestType::result(p).force_n);
    for (std::size_t i = 0; i < n; ++i) {
      CAPTURE(k, i, p[0], p[1], p[2], p[3], p[4], p[5]);
      const Digits50 step("1e-15");
      const auto at = [&](const Digits50& change) {
        auto exact = in<Digits50>(p);
        exact[i] += change;
        return TestType::result(exact);
      };
      const auto above = at(step), below = at(Digits50(-step));
      const Digits50 slope = (above.force_n - below.force_n) / (2 * step);
      const double found = r.force_n.slopes[i];
      // by roundoff of double, and of a difference across a change of curvature
      CHECK(off(found, slope) <= 1e-12 * (1 + 10 * std::abs(static_cast<double>(slope))));
    }
  }
}

TEST_CASE("normal forces in the tests' own dual number", "[normal_force]") {
  using Dual = test::Dual<Digits50>;
  const Digits50 step("1e-16");
  test::Random random(8);
  for (int k = 0; k < 10; ++k) {
    const auto p = PublishedPolynomial::draw(random);
    for (std::size_t i = 0; i < p.size(); ++i) {
      auto seeded = in<Dual>(p);
      seeded[i].d = Digits50(1);
      auto above = in<Digits50>(p), below = above;
      above[i] += step;
      below[i] -= step;
      const Digits50 slope = (PublishedPolynomial::result(above).force_n -
                              PublishedPolynomial::result(below).force_n) /
                             (2 * step);
      CHECK(off(PublishedPolynomial::result(seeded).force_n.d, slope) < 1e-26);
    }
  }
}

TEST_CASE("slopes and gradients of curves are derivatives", "[normal_force]") {
  using D = fingerpad::Dual<4>;
  test::Random random(9);
  const auto close = [](double a, double b) {
    return std::abs(a - b) <= 1e-13 * (1 + std::abs(b));
  };
  for (int k = 0; k < 50; ++k) {
    const double m = random.uniform(0.1, 20);
    const auto c = Polynomial::draw(random);
    const PolynomialForce<2> polynomial{c, 1, 10};
    const PolynomialForce<2, D> polynomial_d{
        {D::parameter(c[0], 0), D::parameter(c[1], 1), D::parameter(c[2], 2)}, D(1.0), D(10.0)};
    const D force = polynomial_d.force_n(D::parameter(m, 3));
    CHECK(close(polynomial.slope(m), force.slopes[3]));
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(close(polynomial.gradient(m)[i], force.slopes[i]));
    }
    const auto q = Power::draw(random);
    const PowerLawForce<> power{q[0], q[1], 1, 10};
    const PowerLawForce<D> power_d{D::parameter(q[0], 0), D::parameter(q[1], 1), D(1.0), D(10.0)};
    const D by_power = power_d.force_n(D::parameter(m, 3));
    CHECK(close(power.slope(m), by_power.slopes[3]));
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(close(power.gradient(m)[i], by_power.slopes[i]));
    }
    const D radius = power_d.radius_mm(D::parameter(m, 3));
    const D again = power_d.force_n(radius);  // the identity, in every parameter
    CHECK(close(again.value, m));
    CHECK(close(again.slopes[3], 1));
    CHECK(std::abs(again.slopes[0]) < 1e-12 * m);
    CHECK(std::abs(again.slopes[1]) < 1e-11 * m);
  }
}
