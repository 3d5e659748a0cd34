// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/normal_force.hpp"

#include <limits>

#include "fingerpad/published/normal_force.hpp"
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
  return published::force_of_area<S>();
}
template <class S>
PowerLawForce<S> curve_of(const PowerLawForce<S>&) {
  return {S(2), S(0.4), S(1), S(300)};
}

}  // namespace

TEMPLATE_TEST_CASE("normal force: a frame allocates nothing",
                   "[normal_force]",
                   (Of<PolynomialForce<2, float>, NoCompensation>),
                   (Of<PolynomialForce<>, ScaledCompensation<>>),
                   (Of<PolynomialForce<2, long double>, published::Compensation<long double>>),
                   (Of<PowerLawForce<>, NoCompensation>),
                   (Of<PowerLawForce<float>, published::Compensation<float>>)) {
  using Curve = typename TestType::Curve;
  using S = typename Curve::number;
  using Errors = CurveErrors<Curve::parameters, S>;
  const S measures[] = {S(-1),  S(0),   S(5),
                        S(100), S(470), S(1000),
                        S(1e6), S(0.1), std::numeric_limits<S>::quiet_NaN()};
  test::Image<S> samples(200, 4);
  for (Index i = 0; i < 200; ++i) {
    samples(i, 0) = measures[i % 9];
    samples(i, 1) = S(0.1) * static_cast<S>(i % 13);
    samples(i, 2) = i % 31 == 0 ? std::numeric_limits<S>::quiet_NaN() : S(1);
    samples(i, 3) = S(0.001) * static_cast<S>(i % 29);
  }
  const long before = test::allocations();
  const NormalForce<Curve, typename TestType::Compensation> force(
      curve_of(Curve()), {}, Errors{.residual_sd_n = S(1), .measure_sd = S(1)});
  int answers = 0, sources = 0;
  for (Index i = 0; i < 200; ++i) {
    const auto r = force(samples(i, 0), {samples(i, 1), samples(i, 2)}, samples(i, 3));
    answers += r.has_force() ? 1 : 0;
    sources += fused(r, force(S(100))).sources;
  }
  const long after = test::allocations();
  CHECK(after == before);
  CHECK(answers > 150);
  CHECK(sources == 200 + answers);
}
