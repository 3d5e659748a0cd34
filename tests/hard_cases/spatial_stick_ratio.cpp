// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The stick ratio in space in float, double and long double against 50 digits.
#include "fingerpad/slip/spatial_stick_ratio.hpp"

#include <cmath>
#include <vector>

#include "support/catch.hpp"
#include "support/numbers.hpp"
#include "support/slipping_patch.hpp"

using namespace fingerpad;
using test::Digits50;

namespace {

struct Answers {
  std::vector<double> ratios, sds, slips_mm, turns_rad;
  double lateral_mm = 0;
  Index updated = 0;
};

/// Free frames, then a patch that is rolled, dragged and rotated while it begins to slip.
template <class S>
Answers follow() {
  const SpatialStickRatio<S> ratio(21, 21);
  auto state = ratio.start();
  test::Image<DotState> states(21, 21);
  test::Random random(2);
  test::SlippingPatch patch;
  Answers a;
  for (int k = 0; k < 24; ++k) {
    const bool free = k < 10;
    const auto dots = noisy(patch.dots, 0.005, 0.025, random);
    const auto r =
        ratio(dots, free ? test::Image<std::uint8_t>(21, 21, 0) : patch.contact, states, state);
    if (r.updated()) {
      a.ratios.push_back(static_cast<double>(r.stick_ratio));
      a.sds.push_back(static_cast<double>(r.ratio_sd));
      a.slips_mm.push_back(static_cast<double>(state.slips()(10, 13).slip_mm.x));
      a.turns_rad.push_back(static_cast<double>(r.motion.rotation(1, 0)));
      ++a.updated;
    }
    patch.step(free ? test::moved_by({0, 0, 0}, {0, 0, 0}, {0, 0, 0})
                    : test::moved_by({0.002, 0.003, 0.01}, {0, 0, 28}, {0.17, 0.05, 0}),
               1.2 - 0.02 * k);
  }
  a.lateral_mm = state.lateral_mm();
  return a;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = a.size() == b.size() ? 0 : 1e9;
  for (std::size_t k = 0; k < a.size() && k < b.size(); ++k) {
    largest = std::max(largest, std::abs(a[k] - b[k]));
  }
  return largest;
}

template <class S>
void check(const Answers& exact, double tolerance) {
  const Answers a = follow<S>();
  CAPTURE(tolerance, a.updated);
  CHECK(largest_difference(a.ratios, exact.ratios) < 1e-6);  // the same dots stick
  CHECK(largest_difference(a.sds, exact.sds) < tolerance);
  CHECK(largest_difference(a.slips_mm, exact.slips_mm) < tolerance);
  CHECK(largest_difference(a.turns_rad, exact.turns_rad) < tolerance);
  CHECK(a.lateral_mm == Approx(exact.lateral_mm).epsilon(tolerance * 10));
}

}  // namespace

TEST_CASE("stick ratio in space against 50 digits", "[spatial_stick]") {
  const Answers exact = follow<Digits50>();
  REQUIRE(exact.updated > 8);
  check<float>(exact, 2e-4);
  check<double>(exact, 1e-12);
  check<long double>(exact, 1e-12);
}
