// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/slip/stick_ratio.hpp"

#include "fingerpad/published/stick_ratio.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/slipping_dots.hpp"

using namespace fingerpad;

namespace {

template <class Motion, class Reference, class Denoising, class S>
struct Of {
  using Ratio = StickRatio<Motion, Reference, Denoising, S>;
};

}  // namespace

TEMPLATE_TEST_CASE("stick ratio: a frame allocates nothing",
                   "[stick_ratio]",
                   (Of<StickConsensus<>, UpdatedReference, ResidualMean, float>),
                   (Of<StickConsensus<>, UpdatedReference, ResidualMean, double>),
                   (Of<StickConsensus<>, UpdatedReference, NoDenoising, long double>)) {
  const typename TestType::Ratio ratio(21, 21);
  const long before_state = test::allocations();
  auto state = ratio.start();
  CHECK(test::allocations() > before_state);  // all memory is allocated here
  test::SlippingDots truth;
  test::Random random(1);
  test::DotStates states(21, 21);
  const test::ContactFlags nothing(21, 21);
  long taken = 0;
  int updated = 0;
  const auto steps = test::steps_of(test::SlipScene::everything, 1);
  for (int k = 0; k < 100; ++k) {
    truth.step(steps[static_cast<std::size_t>(k) % steps.size()]);
    auto dots = noisy(truth.dots, 0.14, random);
    dots(10, 10).x = test::nan;
    if (k == 40) {
      dots = test::PointsPx(21, 21, {test::nan, test::nan});
    }
    const auto& contact = k == 50 ? nothing : truth.contact;
    const double time_s = k == 60 ? -1 : k;  // backward once
    const long before = test::allocations();
    const auto r = ratio(dots, contact, states, state, time_s);
    taken += test::allocations() - before;
    updated += r.updated() ? 1 : 0;
  }
  CHECK(updated > 60);
  CHECK(taken == 0);
  const long before = test::allocations();
  state.reset();
  CHECK(test::allocations() == before);
}

TEMPLATE_TEST_CASE("published stick ratio: a frame allocates nothing",
                   "[stick_ratio][published]",
                   float,
                   double) {
  const long before_all = test::allocations();
  published::StickRatio<TestType> ratio(21, 21, {.capacity = 16});
  CHECK(test::allocations() > before_all);  // all memory is allocated here
  test::SlippingDots truth;
  test::Random random(1);
  const auto steps = test::steps_of(test::SlipScene::everything, 1);
  int updated = 0;
  long taken = 0;
  for (int k = 0; k < 100; ++k) {
    truth.step(steps[static_cast<std::size_t>(k) % steps.size()]);
    const auto dots = noisy(truth.dots, 0.14, random);
    const long before = test::allocations();
    updated += ratio(dots, truth.contact).ok() ? 1 : 0;
    taken += test::allocations() - before;
  }
  CHECK(updated > 60);
  CHECK(taken == 0);
}
