// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/foam/taxels.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"

using namespace fingerpad;

TEST_CASE("taxel features: a sample allocates nothing", "[taxel_features]") {
  const long before = test::allocations();
  TaxelFeatures<> finger(16, 4);
  CHECK(test::allocations() > before);  // all memory is allocated here
  test::Image<double> taxels(16, 4, 100);
  const test::Image<double> other(4, 16, 100);
  Index vibrating = 0;
  const long at_start = test::allocations();
  for (int k = 0; k < 100; ++k) {
    taxels(3, 2) = k % 4 < 2 ? 200 : 100;
    taxels(5, 1) = k == 50 ? test::nan : 100;
    const double time_s = k / 30.0 + (k > 70 ? 10 : 0);  // one jump
    vibrating += finger(taxels, time_s).is_vibrating() ? 1 : 0;
    finger(other, time_s);
    finger(taxels, test::nan);
  }
  finger.reset();
  CHECK(test::allocations() == at_start);
  CHECK(vibrating == 71 - 15 + 29 - 15);
}
