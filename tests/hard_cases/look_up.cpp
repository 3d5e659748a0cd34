// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Forces by look-up against 50 digits: where terms cancel, at the ends of the number range, and
// derivatives.
#include "fingerpad/force/look_up.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "fingerpad/adapt/dual.hpp"
#include "support/catch.hpp"
#include "support/curves.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Digits50;

namespace {

/// Numbers that float holds exactly, so every type starts from the same ones.
double any(test::Random& random, double low, double high) {
  return static_cast<double>(static_cast<float>(random.uniform(low, high)));
}

/// A case in one list of any number type, so that each can be seeded with a derivative:
/// measure, displacement, angle, and the parameters of the look-up.
constexpr std::size_t inputs = 10;
using List = std::array<double, inputs>;
template <class S>
std::array<S, inputs> in(const List& list) {
  std::array<S, inputs> out;
  for (std::size_t k = 0; k < inputs; ++k) {
    out[k] = S(list[k]);
  }
  return out;
}

/// Normal force and variance. Parameters: from, to, c_0 to c_3; the second is the variance of the
/// measure.
struct Normal {
  template <class S>
  static std::array<S, 2> result(const std::array<S, inputs>& p) {
    ForceCurve<S> curve;
    curve.from = p[4];
    curve.to = p[5];
    std::copy_n(p.begin() + 6, 4, curve.coefficients.begin());
    for (std::size_t k = 0; k < 4; ++k) {
      curve.covariance[k][k] = S(0.0625);
    }
    curve.residual_sd_n = S(0.125);
    const auto r = NormalForce<S>(curve)(p[0], p[1]);
    return {r.force_n, r.variance_n2};
  }
  /// Below, within and beyond the range.
  static List draw(test::Random& random) {
    const double from = any(random, 0.5, 2), to = from + any(random, 4, 8);
    return {any(random, 0.02, 12),
            any(random, 0, 2),
            0,
            0,
            from,
            to,
            any(random, 0, 2),
            any(random, 0, 1),
            any(random, 0, 0.5),
            any(random, 0, 0.05)};
  }
};

/// Tangential force along x and moment. Parameters: T, R, and the slopes.
struct Sheared {
  template <class S>
  static std::array<S, 2> result(const std::array<S, inputs>& p) {
    ShearMap<S> map;
    map.reference = S(100);
    map.force = {p[6], p[4], S(0.75)};
    map.moment = {p[7], p[5], S(0.25)};
    const auto r = Shear<S>(map)(p[0], {p[1], p[2]}, p[3]);
    return {r.tangential_force_n.x, r.moment_n_mm};
  }
  static List draw(test::Random& random) {
    return {std::exp2(random.whole(-2, 9)),
            any(random, 0.1, 2),
            any(random, -2, 2),
            any(random, -0.5, 0.5),
            any(random, 0.2, 1),
            any(random, 1, 2),
            any(random, 1, 4),
            any(random, 20, 40)};
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

template <class Case, class S>
double worst_off(const List& list) {
  const auto exact = Case::result(in<Digits50>(list));
  const auto found = Case::result(in<S>(list));
  double worst = 0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const double size = std::abs(static_cast<double>(exact[k]));
    worst = (std::max)(worst, size > 0 ? off(found[k], exact[k]) / size / eps<S>() : 0);
  }
  return worst;
}

}  // namespace

TEMPLATE_TEST_CASE("look-ups follow 50 digits", "[normal_force][shear]", Normal, Sheared) {
  test::Random random(5);
  for (int k = 0; k < 60; ++k) {
    const auto p = TestType::draw(random);
    CAPTURE(p[0], p[1], p[2], p[3], p[4], p[5]);
    CHECK(worst_off<TestType, float>(p) < 24);
    CHECK(worst_off<TestType, double>(p) < 24);
    CHECK(worst_off<TestType, long double>(p) < 24);
  }
}

TEMPLATE_TEST_CASE("derivatives of look-ups are those of differences",
                   "[normal_force][shear]",
                   Normal,
                   Sheared) {
  using D = fingerpad::Dual<inputs>;
  test::Random random(7);
  for (int k = 0; k < 14; ++k) {
    auto p = TestType::draw(random);
    switch (k) {  // no motion, no contact, ends of the range
      case 0:
        p[1] = p[2] = p[3] = 0;
        break;
      case 1:
        p[0] = 0;
        break;
      case 2:
        p[0] = -1;
        break;
      case 3:
        p[1] = 0;
        break;
      case 4:
        p[0] = p[4];
        break;
      case 5:
        p[0] = p[5];
        break;
      default:
        break;
    }
    std::array<D, inputs> seeded;
    for (std::size_t i = 0; i < inputs; ++i) {
      seeded[i] = D::parameter(p[i], i);
    }
    const auto r = TestType::result(seeded);
    for (std::size_t i = p[0] == 0 ? 1 : 0; i < inputs; ++i) {  // a power of 0 has no slope
      CAPTURE(k, i, p[0], p[1], p[2], p[3], p[4], p[5]);
      const Digits50 step("1e-15");
      const auto at = [&](const Digits50& change) {
        auto exact = in<Digits50>(p);
        exact[i] += change;
        return TestType::result(exact);
      };
      const auto above = at(step), below = at(Digits50(-step));
      // of the variance, a difference across the end of the range is no derivative
      for (std::size_t n = 0; n < (k > 5 ? 2U : 1U); ++n) {
        const Digits50 slope = (above[n] - below[n]) / (2 * step);
        // by roundoff of double, and of a difference across a change of curvature
        CHECK(off(r[n].slopes[i], slope) <=
              1e-12 * (1 + 100 * std::abs(static_cast<double>(slope))));
      }
    }
  }
}

TEST_CASE("derivatives of shear by many seeds at once, by hand", "[shear]") {
  using Ad = fingerpad::Dual<4>;
  const auto seed = [](double number, std::size_t k) { return Ad::parameter(number, k); };
  ShearMap<Ad> map;
  map.reference = Ad(100);
  map.force = {seed(2, 2), seed(0.65, 0), Ad(5)};
  map.moment = {seed(30, 3), seed(1.7, 1), Ad(1)};
  const auto r = Shear(map)(Ad(200), {Ad(0.3), Ad(-0.4)}, Ad(0.1));
  const double u = 0.5 * std::pow(2.0, 0.65), turn = std::pow(2.0, 1.7) * 0.1;
  const auto fx = r.tangential_force_n.x.slopes, fy = r.tangential_force_n.y.slopes;
  CHECK(fx[2] == Approx(0.6 * u).epsilon(1e-13));
  CHECK(fy[2] == Approx(-0.8 * u).epsilon(1e-13));
  CHECK(fx[0] == Approx(0.6 * 2 * u * std::log(2.0)).epsilon(1e-13));
  CHECK(fx[1] == 0);
  const auto m = r.moment_n_mm.slopes;
  CHECK(m[3] == Approx(turn).epsilon(1e-13));
  CHECK(m[1] == Approx(30 * turn * std::log(2.0)).epsilon(1e-13));
  CHECK(m[0] == 0);
}

TEMPLATE_TEST_CASE("a curve that is flat where it begins", "[normal_force]", float, double) {
  // (m - 8)^2 from its vertex on: the terms are 128 times their sum
  const auto force = []<class S>(S) {
    ForceCurve<S> curve;
    curve.coefficients[0] = S(64);
    curve.coefficients[1] = S(-16);
    curve.coefficients[2] = S(1);
    curve.from = S(8);
    curve.to = S(16);
    return NormalForce<S>(curve);
  };
  using S = TestType;
  for (const S above : {S(0), S(1e-6), S(1e-3), S(0.03), S(0.3), S(1), S(3)}) {
    const S m = S(8) + above;
    const auto r = force(S())(m);
    CHECK(r.force_n >= 0);
    CHECK(off(r.force_n, force(Digits50())(Digits50(m)).force_n) <= 2 * eps<S>() * 256);
  }
}

TEMPLATE_TEST_CASE("the largest and the smallest contacts", "[normal_force]", float, double) {
  using S = TestType;
  const S max = std::numeric_limits<S>::max(), least = std::numeric_limits<S>::denorm_min();
  const S normal = std::numeric_limits<S>::min();
  const ForceCurve<S> curve = test::curve_of_area<S>();
  const NormalForce<S> force(curve);
  ForceCurve<Digits50> exactly;
  std::copy(curve.coefficients.begin(), curve.coefficients.end(), exactly.coefficients.begin());
  exactly.from = Digits50(curve.from);
  exactly.to = Digits50(curve.to);
  const NormalForce<Digits50> exact(exactly);
  for (const S m : {S(1e6), S(1e20), S(1e37), S(max / 16), max}) {
    const auto r = force(m);
    CHECK(r.status == ForceStatus::implausible);
    CHECK(test::relative_error(Digits50(r.force_n), exact(Digits50(m)).force_n) < 8 * eps<S>());
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
  ForceCurve<S> line;
  line.coefficients[1] = S(8);
  line.from = S(1);
  line.to = S(2);
  const NormalForce<S> steep(line);
  CHECK(steep(S(max / 16)).force_n == S(max / 2));
  CHECK(std::isnan(steep(max).force_n));
  CHECK(steep(max).status == ForceStatus::not_finite);
}
