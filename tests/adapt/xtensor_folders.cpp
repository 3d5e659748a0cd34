// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Compiled with tests/support/xtensor_folders first in the include path. xtensor's headers then are
// in folders, as from 0.26 on, where the adapter must find them.
#include "fingerpad/adapt/xtensor.hpp"

#ifndef FINGERPAD_TEST_XTENSOR_FOLDERS
#error "compile this file with tests/support/xtensor_folders in front of the include path"
#endif

#include <xtensor/containers/xtensor.hpp>

#include "support/catch.hpp"
#include "support/weighted_sum.hpp"

TEST_CASE("xtensor is found where 0.26 keeps its headers", "[xtensor]") {
  xt::xtensor<double, 2> tensor({3, 5});
  STATIC_REQUIRE(fingerpad::strided_grid<decltype(tensor)>);
  test::fill_with_pattern(tensor);
  CHECK(test::weighted_sum(tensor) == test::pattern_sum(3, 5));
}
