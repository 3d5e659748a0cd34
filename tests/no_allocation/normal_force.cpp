// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/normal_force.hpp"

#include <limits>

#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"

using namespace fingerpad;

namespace {

template <class Curve_, class Compensation_>
struct Of {
  using Curve = Curve_;
  using Compensation = Compensation_;
};

template <class S>
PolynomialForce<2, S> curve_of(const PolynomialForce<2, S>&) {
  return published_force_of_area<S>();
}
template <class S>
PowerLawForce<S> curve_of(const PowerLawForce<S>&) {
  return {S(2), S(0.4), S(1), S(300)};
}

}  // namespace

TEMPLATE_TEST_CASE("normal force: neither a frame nor many of them allocate",
                   "[normal_force]",
                   (Of<PolynomialForce<2, float>, NoCompensation>),
                   (Of<PolynomialForce<>, ScaledCompensation<>>),
                   (Of<PolynomialForce<2, long double>, PublishedCompensation<long double>>),
                   (Of<PowerLawForce<>, NoCompensation>),
                   (Of<PowerLawForce<float>, PublishedCompensation<float>>)) {
  using Curve = typename TestType::Curve;
  using S = typename Curve::number;
  using Errors = CurveErrors<Curve::parameters, S>;
  const S measures[] = {S(-1),  S(0),   S(5),
                        S(100), S(470), S(1000),
                        S(1e6), S(0.1), std::numeric_limits<S>::quiet_NaN()};
  test::Image<S> samples(200, 4), forces(200, 1), too_small(199, 1);
  for (Index i = 0; i < 200; ++i) {
    samples(i, 0) = measures[i % 9];
    samples(i, 1) = S(0.1) * static_cast<S>(i % 13);
    samples(i, 2) = i % 31 == 0 ? std::numeric_limits<S>::quiet_NaN() : S(1);
    samples(i, 3) = S(0.001) * static_cast<S>(i % 29);
  }
  const long before = test::allocations();
  const NormalForce<Curve, typename TestType::Compensation, Errors> force(
      curve_of(Curve()), {}, Errors{.residual_sd_n = S(1), .measure_sd = S(1)});
  int answers = 0, sources = 0;
  for (Index i = 0; i < 200; ++i) {
    const auto r = force(samples(i, 0), {samples(i, 1), samples(i, 2)}, samples(i, 3));
    answers += r.has_force() ? 1 : 0;
    sources += fused(r, force(S(100))).sources;
  }
  const auto counts = force.for_samples(samples, forces);
  const auto refused = force.for_samples(samples, too_small);
  const long after = test::allocations();
  CHECK(after == before);
  CHECK(answers > 150);
  CHECK(sources == 200 + answers);
  CHECK(counts.ok());
  CHECK(counts.not_finite == 200 - answers);
  CHECK(counts.beyond_range > 0);
  CHECK_FALSE(refused.ok());
}
