// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/slip/slipping_dots.hpp"

#include <algorithm>
#include <limits>
#include <vector>

#include "support/catch.hpp"
#include "support/image.hpp"

using namespace fingerpad;

namespace {

using States = test::Image<DotState>;
using Flags = test::Image<unsigned char>;

/// One dot of each state.
States four_states() {
  States states(2, 2, DotState::none);
  states(0, 1) = DotState::unknown;
  states(1, 0) = DotState::slip;
  states(1, 1) = DotState::stick;
  return states;
}

SpatialStickResult<double> ratio(double share, double sd) {
  SpatialStickResult<double> seen;
  seen.status = StickStatus::updated;
  seen.stick_ratio = share;
  seen.ratio_sd = sd;
  return seen;
}

template <class... Slip>
Index left_out(const SpatialStickResult<double>& seen, const Slip&... slip) {
  Flags slips(2, 2, 2);
  REQUIRE(slipping_dots(seen, slip..., four_states(), slips));
  return std::count(slips.cells.begin(), slips.cells.end(), 1);
}

}  // namespace

TEST_CASE("slipping dots: those whose state says so", "[slipping_dots]") {
  Flags slips(2, 2, 2);
  CHECK(slipping_dots(ratio(0.5, 0.05), four_states(), slips));
  CHECK(slips.cells == std::vector<unsigned char>{0, 0, 1, 0});
}

TEST_CASE("slipping dots: all, unless the ratio is above a fifth by two standard deviations",
          "[slipping_dots]") {
  CHECK(left_out(ratio(0.31, 0.05)) == 1);
  CHECK(left_out(ratio(0.29, 0.05)) == 4);
  CHECK(left_out(ratio(0.21, 0)) == 1);
  CHECK(left_out(ratio(0.19, 0)) == 4);
  CHECK(left_out(ratio(0.9, std::numeric_limits<double>::quiet_NaN())) == 4);
  SECTION("a kept ratio tells nothing of this frame") {
    auto kept = ratio(0.1, 0.05);
    kept.status = StickStatus::standing;
    CHECK(left_out(kept) == 1);
  }
}

TEST_CASE("slipping dots: all while friction shows a slide", "[slipping_dots]") {
  SlipResult<double> slip;
  slip.status = FrictionLimitStatus::held;
  CHECK(left_out(ratio(0.9, 0.05), slip) == 1);
  slip.status = FrictionLimitStatus::sliding;
  CHECK(left_out(ratio(0.9, 0.05), slip) == 4);
  slip.falls_back = true;
  slip.update = RatioUpdate::fresh;
  slip.stick_ratio = 0.9;
  CHECK(left_out(ratio(0.9, 0.05), slip) == 4);
}

TEST_CASE("slipping dots: none if they fall back with an object that carries most of them",
          "[slipping_dots]") {
  auto seen = ratio(0.3, 0.01);
  seen.status = StickStatus::falls_back;
  SlipResult<double> slip;
  slip.status = FrictionLimitStatus::held;
  slip.falls_back = true;
  slip.update = RatioUpdate::fresh;
  slip.stick_ratio = 0.9;
  CHECK(left_out(seen, slip) == 0);
  slip.stick_ratio = 0.5;  // half of them slip: too many for a fit
  CHECK(left_out(seen, slip) == 1);
  slip.stick_ratio = 0.9;
  slip.update = RatioUpdate::missing;  // the load does not say who moves them
  CHECK(left_out(seen, slip) == 1);
  slip.update = RatioUpdate::fresh;
  slip.falls_back = false;
  CHECK(left_out(seen, slip) == 1);
}

TEST_CASE("slipping dots: a grid of another size is refused", "[slipping_dots]") {
  Flags slips(2, 3, 7);
  CHECK_FALSE(slipping_dots(ratio(0.5, 0.05), four_states(), slips));
  CHECK(slips.cells == std::vector<unsigned char>(6, 7));
}
