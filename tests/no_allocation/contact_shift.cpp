// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/published/contact_shift.hpp"

#include <cstdint>
#include <type_traits>

#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using fingerpad::published::central_dot;
using fingerpad::published::OneDot;

namespace {

template <class Dots_, class Mean_>
struct Way {
  using Dots = Dots_;
  using Mean = Mean_;
};

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

TEMPLATE_TEST_CASE("contact shift: a frame allocates nothing",
                   "[contact_shift]",
                   (Way<EdgeDots, PlainMean>),
                   (Way<EdgeDots, HuberMean>),
                   (Way<ContactDots, PlainMean>),
                   (Way<ContactDots, HuberMean>),
                   (Way<OneDot, HuberMean>)) {
  const auto estimator_of = [](Index n) {
    typename TestType::Dots choice{};
    if constexpr (std::is_same_v<typename TestType::Dots, OneDot>) {
      choice = central_dot(n, n);
    }
    return ContactShift(dots(n, 0), choice, typename TestType::Mean());
  };
  const auto estimator = estimator_of(21), smaller = estimator_of(5);
  const long before = test::allocations();
  auto workspace = estimator.workspace();
  CHECK(test::allocations() > before);  // all memory is allocated here
  auto too_small = smaller.workspace();
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
    counted += estimator(moved, contact, workspace).dots;
    // insufficient memory does not grow
    counted += estimator(moved, contact, too_small).dots;
    taken += test::allocations() - start;
  }
  CHECK(counted > 500);
  CHECK(taken == 0);
}
