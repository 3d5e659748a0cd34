// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/force/pad_heights.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/pressed_pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::FilmSide;
using test::RoundPad;

namespace {
constexpr double pi = std::numbers::pi;
}

namespace {
/// A tilted bowl over the plate as the camera sees it.
struct Bowl {
  Camera<double> camera{
      .center_x_px = test::uniform(75, 85), .center_y_px = test::uniform(55, 65), .pitch_mm = 0.3};
  double top_mm = test::uniform(5, 10), radius_mm = test::uniform(18, 40);
  double along_x = test::uniform(-0.1, 0.1), along_y = test::uniform(-0.1, 0.1);

  double height(double x, double y) const {
    return top_mm + along_x * x + along_y * y - (x * x + y * y) / (2 * radius_mm);
  }
  /// A ray is steep, so the height at its end hardly depends on where it ends.
  double depth(Index i, Index j) const {
    double mm = top_mm;
    for (int k = 0; k < 20; ++k) {
      const auto p = point_at(camera, static_cast<double>(i), static_cast<double>(j), mm);
      mm = height(p.x, p.y);
    }
    return mm > 0 ? mm : test::nan;
  }
};
}  // namespace

TEST_CASE("heights in plan are those that a camera has seen along its rays", "[wrench]") {
  rc::prop("and neither lost pixels nor wild ones change what is seen beside them", [] {
    const Bowl bowl;
    test::Image<double> depth(120, 160);
    const test::Image<std::uint8_t> mask(120, 160, 255);
    for (Index i = 0; i < depth.rows(); ++i) {
      for (Index j = 0; j < depth.cols(); ++j) {
        depth(i, j) = bowl.depth(i, j);
      }
    }
    const PadHeights<Camera<double>> heights(120, 160, bowl.camera, 15.0);
    auto whole = heights.map(), torn = heights.map();
    RC_ASSERT(heights(depth, mask, whole));
    const Index row = test::whole(40, 80), col = test::whole(60, 100);
    const double seen_mm = depth(row, col);
    const auto hole =
        point_at(bowl.camera, static_cast<double>(row), static_cast<double>(col), seen_mm);
    const double wild = test::whole(0, 3) == 0 ? test::nan : test::uniform(-1000, 1000);
    for (Index i = row - 3; i <= row + 3; ++i) {
      for (Index j = col - 3; j <= col + 3; ++j) {
        depth(i, j) = wild;
      }
    }
    RC_ASSERT(heights(depth, mask, torn));
    for (Index i = 0; i < whole.side(); ++i) {
      for (Index j = 0; j < whole.side(); ++j) {
        const double x = whole.position_mm(j), y = whole.position_mm(i);
        const double truth = bowl.height(x, y);
        const double found = whole.node(i, j).height_mm;
        if (truth > 0.5) {
          RC_ASSERT(std::abs(found - truth) < 0.003);
          RC_ASSERT((truth < 1.5 || std::hypot(x, y) > 14 || whole.in_contact(x, y)));
          if (std::hypot(x - hole.x, y - hole.y) > 3) {
            RC_ASSERT(std::abs(torn.node(i, j).height_mm - found) < 0.001);
          }
        }
      }
    }
  });
}

TEST_CASE("a position is in contact if two of the four pixels around it are", "[wrench]") {
  const OrthographicCamera<double> camera{
      .center_x_px = 30.5, .center_y_px = 20.5, .pitch_mm = 0.25};
  const PadHeights heights(42, 62, camera, 4.0);
  const test::Image<double> depth(42, 62, 2.0);
  auto map = heights.map();
  for (int marked = 0; marked < 16; ++marked) {
    test::Image<std::uint8_t> mask(42, 62, 0);
    int count = 0;
    for (Index k = 0; k < 4; ++k) {
      const bool touches = (marked >> k & 1) != 0;
      mask(16 + k / 2, 36 + k % 2) = touches;
      count += touches ? 1 : 0;
    }
    REQUIRE(heights(depth, mask, map));
    CAPTURE(marked);
    CHECK(map.in_contact(1.5, -1.0) == (count >= 2));
    CHECK_FALSE(map.in_contact(-1.0, 1.5));
  }
}

TEST_CASE("heights on a mesh: every node has its height, and all but the border a slope",
          "[wrench]") {
  PadHeights<>::Map map(1.0, 0.5);
  REQUIRE(map.side() == 7);
  const auto plane = [&](Index i, Index j) {
    return 3 + 2 * map.position_mm(j) - 5 * map.position_mm(i);
  };
  map.fill(plane, [](const auto&...) { return 0.0; });
  for (Index i = 0; i < 7; ++i) {
    for (Index j = 0; j < 7; ++j) {
      CAPTURE(i, j);
      const auto& node = map.node(i, j);
      const bool inside = i > 0 && i < 6 && j > 0 && j < 6;
      CHECK(node.height_mm == plane(i, j));
      CHECK(is_finite(node.along_x) == inside);
      CHECK(is_finite(node.along_y) == inside);
      CHECK((!inside || (node.along_x == 2 && node.along_y == -5)));
    }
  }
}

TEST_CASE("heights on a mesh end before its last nodes", "[wrench]") {
  PadHeights<>::Map map(2, 0.5);
  map.fill([](Index, Index) { return 1.0; }, [](Index, Index, double) { return 1.0; });
  const double last = 0.5 * static_cast<double>(map.side() / 2);
  CHECK(map(last - 1e-9, 0.0).height_mm == 1);
  CHECK(map(0.0, last - 1e-9).height_mm == 1);
  CHECK(std::isnan(map(last, 0.0).height_mm));
  CHECK(std::isnan(map(0.0, last).height_mm));
}

TEST_CASE("heights on a mesh stand for the shape", "[wrench]") {
  const RoundPad<FilmSide> pad;
  PadHeights<>::Map map(19.5, 0.25);
  CHECK(map.side() == 2 * 79 + 1);
  CHECK(map.position_mm(79) == 0);
  map.fill([&](Index i,
               Index j) { return pad.height(std::hypot(map.position_mm(i), map.position_mm(j))); },
           [&](Index i, Index j, const auto&...) {
             return pad.in_contact(map.position_mm(j), map.position_mm(i)) ? 1.0 : 0.0;
           });
  test::Random random(8);
  for (int k = 0; k < 300; ++k) {
    const double r = random.uniform(0, 17), at = random.uniform(0, 2 * pi);
    const double x = r * std::cos(at), y = r * std::sin(at);
    const auto found = map(x, y);
    const auto truth = pad(x, y);
    const double kink = std::abs(r - 8) < 0.5 ? 1 : 0.1;
    CHECK(std::abs(found.height_mm - truth.height_mm) < 0.02);
    CHECK(std::abs(found.along_x - truth.along_x) < 0.2 * kink);
    CHECK(std::abs(found.along_y - truth.along_y) < 0.2 * kink);
    CHECK((std::abs(r - 8) < 0.3 || map.in_contact(x, y) == (r < 8)));
  }
  CHECK(map(19.8, 0).height_mm != map(19.8, 0).height_mm);
  CHECK(map(test::nan, 0).height_mm != map(test::nan, 0).height_mm);
  CHECK_FALSE(map.in_contact(1e300, 0));
  CHECK(test::begins_with(test::refusal([] { PadHeights<>::Map(19.0, 0.0); }),
                          "HeightMap: spacing_mm = 0"));
  CHECK(test::begins_with(test::refusal([] { PadHeights<>::Map(0.1, 0.5); }),
                          "HeightMap: half_width_mm = 0.1"));
}
