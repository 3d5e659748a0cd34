// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/wrench.hpp"

#include <type_traits>

#include "fingerpad/force/pad_heights.hpp"
#include "fingerpad/published/segment_equilibrium.hpp"
#include "no_allocation/count.hpp"
#include "support/catch.hpp"
#include "support/pressed_pad.hpp"

using namespace fingerpad;

namespace {

template <class W>
W estimator_of(const test::Image<Point3<double>>& border) {
  test::Image<Point3<double>> points = border;
  if constexpr (std::is_same_v<W, Wrench<double>>) {
    return W(points, WrenchOptions<double>{.stress_free_inclination_rad = 1.06});
  } else {
    return W(points);
  }
}

}  // namespace

TEMPLATE_TEST_CASE("wrench: a frame allocates nothing",
                   "[wrench]",
                   Wrench<double>,
                   Wrench<float>,
                   published::SegmentEquilibrium<double>) {
  using S = std::conditional_t<std::is_same_v<TestType, Wrench<float>>, float, double>;
  const test::RoundPad<test::FilmSide> pad;
  const auto rim = rim_of(pad);
  const double tension = pad.tension(pad.radius_mm, test::pressed_mpa);
  const auto load = [&](double at) { return test::RimLoad{tension, 0.1 * tension * std::sin(at)}; };
  const auto as = [](const auto& from) {
    test::Image<Point3<S>> to(from.rows(), from.cols(), {S(0), S(0), S(0)});
    for (std::size_t k = 0; k < from.cells.size(); ++k) {
      to.cells[k] = {S(from.cells[k].x), S(from.cells[k].y), S(from.cells[k].z)};
    }
    return to;
  };
  TestType wrench = estimator_of<TestType>(rim.borders());
  HeightMap<S> map(S(19.5), S(0.5));
  auto dots = as(rim.dots(load));
  long taken = 0;
  int good = 0, refused = 0;
  for (int k = 0; k < 5; ++k) {
    // a growing hole, in the end through a third of the lines
    const double hole_mm = 2 * k * k;
    const auto missing = dots;
    const S pressure = k == 3 ? S(-1) : S(test::pressed_mpa);
    const long before = test::allocations();
    map.fill(
        [&](Index i, Index j) {
          const S x = map.position_mm(j), y = map.position_mm(i);
          const double off = std::hypot(static_cast<double>(x) - 14, static_cast<double>(y));
          return k > 0 && off < hole_mm ? not_a_number<S>() : pad(x, y).height_mm;
        },
        [&](Index i, Index j, const auto&...) {
          return S(pad.in_contact(map.position_mm(j), map.position_mm(i)) ? 1 : 0);
        });
    good += wrench(map, missing, pressure).ok() ? 1 : 0;
    refused += wrench(pad, missing, pressure).ok() ? 0 : 1;
    taken += test::allocations() - before;
    dots(0, 10 + 2 * k).x = not_a_number<S>();
  }
  CHECK(good >= 1);
  CHECK(refused >= 1);
  CHECK(taken == 0);
}

TEST_CASE("pad heights: a frame allocates nothing", "[wrench]") {
  const PadHeights<Camera<float>> heights(480, 640, Camera<float>());
  auto map = heights.map();
  test::Image<float> depth(480, 640, 9.0F);
  test::Image<std::uint8_t> mask(480, 640, 1);
  depth(240, 320) = static_cast<float>(test::nan);
  const long before = test::allocations();
  const bool filled = heights(depth, mask, map);
  const long after = test::allocations();
  CHECK(filled);
  CHECK(after == before);
}
