// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Level of the edge against the mean over the ring, integrated in 50 digits.
#include "fingerpad/contact/contact_region.hpp"

#include <boost/math/constants/constants.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;
using detail::edge_share;
using detail::share_at_end;
using test::Digits50;

namespace test {

template <class Real>
Dual<Real> acos(const Dual<Real>& a) {
  using std::acos;
  using std::sqrt;
  const Real sine_sq = Real(1) - a.v * a.v;
  const Real sine = sqrt(sine_sq);
  return {acos(a.v), -a.d / sine};
}

}  // namespace test

namespace {

const Digits50 pi = boost::math::constants::pi<Digits50>();

template <class S, class F>
S integral(const F& f, const S& from, const S& to) {
  return boost::math::quadrature::gauss<S, 60>::integrate(f, from, to);
}

/// Mean curvature on a ring of radius 1 whose center is `offset` outside a straight edge with the
/// gap s^2. By definition it is the mean of gap(ring) - gap(center), doubled because the section of
/// a parabola s^2 has curvature 2.
Digits50 share_by_integration(const Digits50& offset) {
  using std::acos;
  const Digits50 last = offset < 1 ? Digits50(acos(Digits50(-offset))) : pi;  // beyond: in contact
  const auto gap = [&](const Digits50& angle) {
    using std::cos;
    const Digits50 s = offset + cos(angle);
    return Digits50(s * s);
  };
  return Digits50((integral(gap, Digits50(0), last) / pi - offset * offset) * 2);
}

/// The same for a ring centered on the edge of a round contact, in double.
double share_on_round_edge(double ring, double patch) {
  // the gap to first order in slope, per jump; the ring is outside the edge on one side
  const auto gap = [&](double angle) {
    const double rho_sq = patch * patch + ring * ring + 2 * patch * ring * std::cos(angle);
    const double excess = (rho_sq - patch * patch) / (patch * patch);
    return excess > 0 ? patch * patch / 2 * (excess - std::log1p(excess)) : 0.0;
  };
  const double last = std::acos(-ring / (2 * patch));
  return 2 * integral(gap, 0.0, last) / (pi.convert_to<double>() * ring * ring);
}

}  // namespace

TEMPLATE_TEST_CASE(
    "share of the jump against 50 digits", "[contact_region]", float, double, Digits50) {
  using S = TestType;
  // the constant 2 / pi has 20 digits
  const double bound = std::is_same_v<S, float> ? 3e-7 : std::is_same_v<S, double> ? 5e-16 : 1e-16;
  rc::prop("at any offset", [&] {
    const S offset = static_cast<S>(test::uniform(0, 1.5));
    const Digits50 exact = share_by_integration(Digits50(offset));
    const Digits50 error = Digits50(edge_share(offset)) - exact;
    RC_ASSERT(std::abs(static_cast<double>(error)) <= bound);
  });
  CHECK(std::abs(static_cast<double>(edge_share(S(0))) - 0.5) <= bound);
  CHECK(edge_share(S(1)) == S(1));
  CHECK(edge_share(S(40)) == S(1));
  CHECK(edge_share(not_a_number<S>()) == S(1));
}

TEST_CASE("the share rises with the offset", "[contact_region]") {
  rc::prop("monotone", [] {
    const double a = test::uniform(0, 1.1), b = a + test::log_uniform(1e-6, 1);
    RC_ASSERT(edge_share(a) <= edge_share(b) + 1e-15);
  });
}

TEST_CASE("the share's derivative by dual numbers", "[contact_region]") {
  const auto share = [](const auto& offset) { return edge_share(offset); };
  rc::prop("against differences", [&] {
    const Digits50 offset(test::uniform(0.01, 0.99));
    const Digits50 exact = test::slope_by_dual(share, offset);
    const Digits50 nearly = test::slope_by_difference(share, offset, Digits50("1e-16"));
    RC_ASSERT(test::relative_error(nearly, exact) < Digits50("1e-25"));
  });
  // on the edge: 4 / pi, the factor of calibration from noise of curvature to noise of the edge
  CHECK(test::slope_by_dual(share, 0.0) == Approx(4 / pi.convert_to<double>()).epsilon(1e-14));
}

TEST_CASE("a round edge curves away from the ring", "[contact_region]") {
  for (const double ratio : {0.001, 0.01, 0.1, 0.3}) {
    const double exact = share_on_round_edge(ratio, 1);
    const double share = share_at_end(1.0, 0.0, ratio, 1.0);
    CHECK(share == Approx(exact).margin(0.03 * ratio * ratio + 1e-9));  // to first order
  }
}

TEMPLATE_TEST_CASE(
    "a contact ends beyond half of the jump", "[contact_region]", float, double, test::Digits50) {
  using S = TestType;
  rc::prop("for every contact", [] {
    const S jump = static_cast<S>(test::log_uniform(1e-6, 0.4));
    const S gap = static_cast<S>(test::whole(0, 3) == 0 ? 0.0 : test::log_uniform(1e-9, 1));
    const S ring = static_cast<S>(test::log_uniform(0.05, 5));
    const S patch = static_cast<S>(test::log_uniform(0.05, 20));
    const S share = share_at_end(jump, gap, ring, patch);
    RC_ASSERT(!(share < S(0.5) - S(1e-6)));
    RC_ASSERT(!(S(1) < share));
    RC_ASSERT(!(share_at_end(jump, static_cast<S>(S(2) * gap), ring, patch) + S(1e-6) < share));
  });
}
