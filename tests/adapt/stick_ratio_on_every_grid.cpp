// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Dots and flags in every kind of grid: the same result to the bit. Points of two coordinates are
// in the image in every type, also where p[2] compiles.
#if defined(__GNUC__) && !defined(__clang__)
// The cells of Eigen's points in an xtensor hold anything until they are filled.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <array>
#include <cstdint>
#include <type_traits>

#include "fingerpad/slip/stick_ratio.hpp"
#include "support/catch.hpp"
#include "support/every_grid.hpp"
#include "support/slipping_dots.hpp"

using namespace fingerpad;

namespace {

constexpr Index n = 21;
constexpr std::size_t cells = 21 * 21;

/// Three frames; the first two have been processed.
struct Case {
  test::Image<Point2<float>> dots{n, n};
  test::ContactFlags contact;
  StickRatio<> stick{n, n};
  StickRatio<> after = stick;  ///< the third frame
  StickResult<> result;

  Case() {
    test::SlippingDots truth;
    test::Random random(2);
    for (int k = 0; k < 3; ++k) {
      const auto noisy_dots = noisy(truth.dots, 0.1, random);
      for (std::size_t c = 0; c < cells; ++c) {
        const auto& p = noisy_dots.cells[c];
        dots.cells[c] = {static_cast<float>(p.x), static_cast<float>(p.y)};
      }
      dots(8, 9).y = static_cast<float>(test::nan);
      contact = truth.contact;
      if (k < 2) {
        (void)stick(dots, contact);
      }
      truth.step({.shift_px = 2.5, .direction_rad = 1, .turn_rad = 0.01, .stick_share = 0.6});
    }
    after = stick;
    result = after(dots, contact);
    REQUIRE(result.updated());
    REQUIRE((result.stick > 50 && result.slip > 50 && result.unknown == 1));
  }

  template <class Dots, class Contact>
  bool agrees(const Dots& from, const Contact& flags) const {
    auto copy = stick;
    const auto r = copy(from, flags);
    bool same = r.accepted() && r.status == result.status && r.stick_ratio == result.stick_ratio &&
                r.scale == result.scale && r.furthest == result.furthest;
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) {
        same = same && copy.states()(i, j) == after.states()(i, j);
      }
    }
    return same;
  }
  template <class Dots>
  bool reads_dots(const Dots& from) const {
    return agrees(from, contact);
  }
};

}  // namespace

TEMPLATE_TEST_CASE("dots that stick are read from every grid, as points of every type",
                   "[adapt][stick_ratio]",
                   Point2<float>,
                   Eigen::Vector2f,
                   cv::Vec2f,
                   cv::Point2f,
                   cv::Point2d,
                   (std::array<float, 2>)) {
  using P = TestType;
  using X = std::remove_cvref_t<decltype(point_traits<P>::x(std::declval<const P&>()))>;
  const Case c;
  test::Image<P> points(n, n);
  for (std::size_t k = 0; k < cells; ++k) {
    points.cells[k] = P{static_cast<X>(c.dots.cells[k].x), static_cast<X>(c.dots.cells[k].y)};
  }
  test::from_every_grid<P>(points, [&](const auto& from) { CHECK(c.reads_dots(from)); });
}

TEST_CASE("dots in tensors and vectors are read without a copy", "[adapt][stick_ratio]") {
  const Case c;
  CHECK(c.reads_dots(grid_of(c.dots.cells, n, n)));
}

TEMPLATE_TEST_CASE("flags of contact are read from every grid, as cells of every type",
                   "[adapt][stick_ratio]",
                   bool,
                   std::uint8_t,
                   int,
                   float,
                   double,
                   Touch) {
  using T = TestType;
  const Case c;
  T yes = T(1), no = T(0);
  if constexpr (std::is_same_v<T, Touch>) {
    yes = Touch::contact;
    no = Touch::unknown;
  } else if constexpr (std::is_floating_point_v<T>) {
    yes = T(-1);
    no = static_cast<T>(test::nan);
  } else if constexpr (!std::is_same_v<T, bool>) {
    yes = T(255);
  }
  // a vector of bool keeps bits
  test::Image<std::conditional_t<std::is_same_v<T, bool>, std::uint8_t, T>> flags(n, n, no);
  for (std::size_t k = 0; k < cells; ++k) {
    flags.cells[k] = c.contact.cells[k] != 0 ? yes : no;
  }
  test::from_every_grid<T>(flags, [&](const auto& from) { CHECK(c.agrees(c.dots, from)); });
}
