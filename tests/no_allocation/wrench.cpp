// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/wrench.hpp"

#include "fingerpad/force/pad_heights.hpp"
#include "fingerpad/published/wrench.hpp"
#include "no_allocation/count.hpp"
#include "support/by_modulus.hpp"
#include "support/catch.hpp"
#include "support/pressed_pad.hpp"

using namespace fingerpad;

namespace {

/// With the inclination of the stress-free membrane.
struct CarriedRow : OneRow {
  CarriedRow() : OneRow{1.06} {}
};

template <class Solver, class Row, class Law, class Lines, class S>
struct Of {
  using W = test::WrenchBy<Solver, Row, Law, Lines, S>;
  static constexpr Index rows = Row::rows;
  using Number = S;
  static Row row() { return {}; }
};

}  // namespace

TEMPLATE_TEST_CASE(
    "wrench: a frame allocates nothing",
    "[wrench]",
    (Of<LeastSquares, OneRow, ClampedRim, StraightLines, double>),
    (Of<LeastSquares, OneRow, published::Direction, published::SteepestLines, float>),
    (Of<BalancedRim, OneRow, ClampedRim, StraightLines, double>),
    (Of<BalancedRim, CarriedRow, ClampedRim, published::SteepestLines, float>),
    (Of<published::ClosedForm, TwoRows, ClampedRim, StraightLines, double>),
    (Of<test::KnownModulus, OneRow, ClampedRim, StraightLines, float>),
    (Of<published::Iteration, OneRow, published::Direction, published::SteepestLines, double>)) {
  using S = typename TestType::Number;
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
  const typename TestType::W wrench(as(rim.borders()), WrenchOptions<S>(), {}, TestType::row());
  const long before_workspace = test::allocations();
  auto workspace = wrench.workspace();
  CHECK(test::allocations() > before_workspace);
  detail::membrane::HeightMap<S> map(S(19.5), S(0.5));
  auto dots = as(rim.dots(load, TestType::rows));
  const WrenchNoise<S> noise{S(0.005), S(0.1), S(1e-5)};
  long taken = 0;
  int good = 0, refused = 0;
  for (int k = 0; k < 5; ++k) {
    dots(0, 10 + 2 * k).x = not_a_number<S>();
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
    const auto r = wrench(map, missing, pressure, workspace, noise);
    const auto other = wrench(pad, missing, pressure, workspace);
    taken += test::allocations() - before;
    good += r.status == WrenchStatus::ok ? 1 : 0;
    refused += other.status == WrenchStatus::ok ? 0 : 1;
  }
  CHECK(good >= 2);
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
