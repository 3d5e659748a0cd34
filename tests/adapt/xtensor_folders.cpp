// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Compiled with tests/support/xtensor_folders in front of the include path: xtensor's headers then
// lie in folders, as they do from 0.26 on. The adapter must find them there.
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
