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
  TractionField given(free, {.mu_t_n_per_mm = 0.5});
  TractionField balanced(free);
  long taken = 0;
  for (int k = 0; k < 5; ++k) {
    s.dots(8 + k, 9).x = not_a_number<double>();
    const long before = test::allocations();
    (void)given(s.dots, s.contact, k == 3 ? -1.0 : s.pressure_mpa);
    (void)balanced(s.dots, s.contact, s.pressure_mpa);
    taken += test::allocations() - before;
  }
  CHECK(taken == 0);
}
