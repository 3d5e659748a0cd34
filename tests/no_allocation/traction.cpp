// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/traction.hpp"

#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/traction_scenes.hpp"

using namespace fingerpad;

TEST_CASE("traction: a frame allocates nothing", "[traction]") {
  const auto free = test::stress_free_dots();
  auto s = test::traction_scene("drag");
  const TractionField given(free, GivenModulus{0.5});
  const TractionField balanced(free);
  const long before_maps = test::allocations();
  auto maps = given.maps();
  CHECK(test::allocations() > before_maps);
  test::Cells<float> pressure(21, 21);
  test::Dots load(21, 21);
  long taken = 0;
  for (int k = 0; k < 5; ++k) {
    s.dots(8 + k, 9).x = not_a_number<double>();
    const long before = test::allocations();
    (void)given(s.dots, s.contact, k == 3 ? -1.0 : s.pressure_mpa, maps);
    (void)balanced(s.dots, s.contact, s.pressure_mpa, maps, pressure, load);
    taken += test::allocations() - before;
  }
  CHECK(taken == 0);
}
