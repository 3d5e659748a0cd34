// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// A copied state or workspace has all the memory of the original.
#include <array>
#include <cmath>
#include <cstdint>

#include "fingerpad/contact/contact_region.hpp"
#include "fingerpad/foam/taxels.hpp"
#include "fingerpad/gel/gel_slide.hpp"
#include "fingerpad/motion/contact_shift.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/allocations.hpp"
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

/// Allocations of two frames.
template <class Frame>
long taken(const Frame& frame) {
  const long before = test::allocations();
  frame();
  frame();
  return test::allocations() - before;
}

}  // namespace

TEST_CASE("a copy takes no memory in a frame either", "[no_allocation]") {
  const auto dots_px = lattice<Point2<double>>(20);
  const auto dots_mm = lattice<Point3<double>>(1.5);

  SECTION("stick ratio") {
    const StickRatio<> stick(side, side);
    auto copy = stick;
    copy = StickRatio<>(copy);
    CHECK(taken([&] { (void)copy(dots_px, all_touch); }) == 0);
  }
  SECTION("stick ratio in space") {
    const StickRatio<> stick(side, side);
    auto copy = stick;
    CHECK(taken([&] { (void)copy(dots_mm, all_touch); }) == 0);
  }
  SECTION("shift of the contact") {
    const ContactShift<> shift(dots_mm);
    auto copy = shift;
    CHECK(taken([&] { (void)copy(dots_mm, all_touch); }) == 0);
  }
  const auto seen = [](Index i, Index j) {
    const double x = static_cast<double>(j - 32), y = static_cast<double>(i - 32);
    return 100 * (1 + 0.3 * std::sin(x / 3) * std::cos(y / 2)) * (x * x + y * y < 400 ? 0.5 : 1);
  };
  const LazyView frame(64, 64, seen);
  SECTION("slide of the contact") {
    const GelSlide slide(64, 64, dots_px, {.cell_px = 1});
    const LazyView touch(64, 64, [](Index i, Index j) { return std::hypot(i - 32, j - 32) < 20; });
    auto copy = slide;
    bool found = true;
    CHECK(taken([&] { found = copy(frame, touch, dots_px).ok() && found; }) == 0);
    CHECK(found);
  }
  SECTION("features of the taxels") {
    const TaxelFeatures<> finger(side, side);
    auto copy = finger;
    CHECK(taken([&] {
            copy.reset();
            FingerSample<> felt;
            for (int k = 0; k < 20; ++k) {
              const LazyView taxels(side, side, [k](Index i, Index) {
                return 500.0 + (k % 4 < 2 ? 100 : 0) + static_cast<double>(i);
              });
              felt = copy(taxels, 0.03 * k);
            }
            CHECK(felt.status == TaxelStatus::vibrating);
          }) == 0);
  }
}

TEST_CASE("copies share what is constant of the pad", "[copies]") {
  const long before = test::bytes_taken();
  const ContactRegion<> region(Camera<double>(), 64, 64);
  const long made = test::bytes_taken();
  const ContactRegion<> copy = region;
  // two places on the ray of each pixel, which took twice that while their vector grew
  const long rays = 64 * 64 * 4 * static_cast<long>(sizeof(double));
  CHECK(test::bytes_taken() - made < made - before - rays * 3 / 2);
}
