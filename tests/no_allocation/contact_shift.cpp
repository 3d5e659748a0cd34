// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/motion/contact_shift.hpp"

#include <cstdint>
#include <type_traits>

#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"

using namespace fingerpad;

namespace {

test::Image<Point2<double>> dots(Index n, double shift) {
  test::Image<Point2<double>> dots(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) {
      dots(i, j) = {1.5 * static_cast<double>(j) + shift, (1.5 + shift) * static_cast<double>(i)};
    }
  }
  return dots;
}

}  // namespace

TEST_CASE("contact shift: a frame allocates nothing", "[contact_shift]") {
  const bool edge = GENERATE(true, false);
  const int passes = GENERATE(0, 10);
  const long before = test::allocations();
  ContactShift estimator(dots(21, 0), {.edge_dots = edge, .robust_passes = passes});
  CHECK(test::allocations() > before);  // all memory is allocated here
  auto copy = estimator;
  test::Image<std::uint8_t> contact(21, 21, 0);
  auto moved = dots(21, 0.1);
  moved(3, 3).x = test::nan;
  long taken = 0;
  Index counted = 0;
  for (Index frame = 0; frame < 21; ++frame) {
    for (Index j = 0; j < 21; ++j) {  // from no contact to all
      contact(frame, j) = 1;
    }
    const long start = test::allocations();
    counted += estimator(moved, contact).dots;
    counted += copy(moved, contact).dots;
    taken += test::allocations() - start;
  }
  CHECK(counted > 500);
  CHECK(taken == 0);
}
