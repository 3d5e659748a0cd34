// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A copied state or workspace has all the memory of the first one.
#include <array>

#include "fingerpad/motion/contact_shift.hpp"
#include "fingerpad/slip/spatial_stick_ratio.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"

using namespace fingerpad;

namespace {

constexpr Index side = 9;

template <class Point>
auto lattice(double pitch) {
  return LazyView(side, side, [pitch](Index i, Index j) {
    Point p;
    p.x = static_cast<decltype(p.x)>(pitch * static_cast<double>(j));
    p.y = static_cast<decltype(p.x)>(pitch * static_cast<double>(i));
    if constexpr (requires { p.z; }) {
      p.z = static_cast<decltype(p.x)>(9);
    }
    return p;
  });
}

const LazyView all_touch(side, side, [](Index, Index) { return true; });

/// Memory that two frames take.
template <class Frame>
long taken(const Frame& frame) {
  const long before = test::allocations();
  frame();
  frame();
  return test::allocations() - before;
}

}  // namespace

TEST_CASE("a copy takes no memory in a frame either", "[no_allocation]") {
  std::array<DotState, side * side> cells{};
  StridedView<DotState> states(cells.data(), side, side, side);
  const auto dots_px = lattice<Point2<double>>(20);
  const auto dots_mm = lattice<Point3<double>>(1.5);

  SECTION("stick ratio") {
    const StickRatio<> stick(side, side);
    auto copy = stick.start();
    copy = decltype(copy)(copy);
    CHECK(taken([&] { (void)stick(dots_px, all_touch, states, copy); }) == 0);
  }
  SECTION("stick ratio in space") {
    const SpatialStickRatio<> stick(side, side);
    const auto state = stick.start();
    auto copy = state;
    CHECK(taken([&] { (void)stick(dots_mm, all_touch, states, copy); }) == 0);
  }
  SECTION("shift of the contact") {
    const ContactShift<> shift(dots_mm);
    const auto work = shift.workspace();
    auto copy = work;
    CHECK(taken([&] { (void)shift(dots_mm, all_touch, copy); }) == 0);
  }
}
