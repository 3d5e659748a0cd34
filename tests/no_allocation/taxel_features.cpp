// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/foam/taxel_features.hpp"

#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"

using namespace fingerpad;

TEST_CASE("taxel features: a sample allocates nothing", "[taxel_features]") {
  const TaxelFeatures<> features(16, 4);
  const long before = test::allocations();
  auto state = features.start();
  CHECK(test::allocations() > before);  // all memory is allocated here
  test::Image<double> taxels(16, 4, 100);
  const test::Image<double> other(4, 16, 100);
  Index vibrating = 0;
  const long at_start = test::allocations();
  for (int k = 0; k < 100; ++k) {
    taxels(3, 2) = k % 4 < 2 ? 200 : 100;
    taxels(5, 1) = k == 50 ? test::nan : 100;
    const double time_s = k / 30.0 + (k > 70 ? 10 : 0);  // one jump
    vibrating += features(taxels, time_s, state).is_vibrating() ? 1 : 0;
    features(other, time_s, state);
    features(taxels, test::nan, state);
  }
  state.reset();
  CHECK(test::allocations() == at_start);
  CHECK(vibrating == 71 - 15 + 29 - 15);
}
