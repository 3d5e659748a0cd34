// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/published/stick_ratio.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using published::measures_of;
using published::RatioMeasures;

namespace {

RatioMeasures measures(const std::vector<double>& ratios) {
  return measures_of(std::span<const double>(ratios));
}

}  // namespace

TEST_CASE("S and D by hand", "[stick]") {
  const RatioMeasures falls = measures({1, 0.9, 0.9, 0.5, 0});
  CHECK(falls.sum == Approx(3.3));
  CHECK(falls.decreases == Approx(1));
  CHECK(falls.rises == 0);  // all of D could be measured
  CHECK(falls.steps == 5);
  CHECK(falls.sum_per_step() == Approx(0.66));
  CHECK(falls.decreases_per_step() == Approx(0.2));
  CHECK(falls.rises_per_step() == 0);

  const RatioMeasures shakes = measures({1, 0.5, 0.75, 0.25, 0.5});
  CHECK(shakes.decreases == 1);
  CHECK(shakes.rises == 0.5);
  // contact is lost in between: nothing is compared across the gap
  const RatioMeasures two = measures({test::nan, 1, 0.25, test::nan, test::nan, 1, 0.5, test::nan});
  CHECK(two.sum == 2.75);
  CHECK(two.decreases == 1.25);
  CHECK(two.rises == 0);
  CHECK(two.steps == 4);

  const RatioMeasures none = measures({test::nan});
  CHECK(none.steps == 0);
  CHECK(none.sum == 0);
  CHECK(std::isnan(none.sum_per_step()));
  const std::vector<float> single = {0.5F, 0.75F};
  CHECK(measures_of(std::span<const float>(single)).rises == 0.25);
}

TEST_CASE("S and D: laws", "[stick]") {
  rc::prop("D' is D less the net drop; mirrored, D and D' change places", [] {
    std::vector<double> ratios;
    for (std::ptrdiff_t k = test::whole(1, 60); k > 0; --k) {
      ratios.push_back(test::uniform(0, 1));
    }
    const RatioMeasures m = measures(ratios);
    RC_ASSERT(std::abs(m.rises - (m.decreases - (ratios.front() - ratios.back()))) < 1e-13);
    RC_ASSERT(m.rises >= 0);
    auto rotated = ratios;
    std::reverse(rotated.begin(), rotated.end());
    RC_ASSERT(std::abs(measures(rotated).rises - m.decreases) < 1e-13);
    for (double& r : rotated) {
      r = 1 - r;
    }
    RC_ASSERT(std::abs(measures(rotated).rises - m.rises) < 1e-13);
    RC_ASSERT(std::abs(measures(rotated).sum + m.sum - static_cast<double>(m.steps)) < 1e-13);

    auto kept = ratios;  // an answer that is kept for some frames
    const auto at = static_cast<std::size_t>(test::whole(0, m.steps - 1));
    kept.insert(kept.begin() + static_cast<std::ptrdiff_t>(at), 3, ratios[at]);
    RC_ASSERT(measures(kept).decreases == m.decreases);
    RC_ASSERT(measures(kept).rises == m.rises);
    RC_ASSERT(std::abs(measures(kept).sum - m.sum - 3 * ratios[at]) < 1e-13);

    std::sort(ratios.rbegin(), ratios.rend());
    RC_ASSERT(measures(ratios).rises == 0);
  });
}
