// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every motion and every slip, in the image and in space.
#include "fingerpad/slip/stick_ratio.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "fingerpad/published/stick_ratio.hpp"
#include "fingerpad/slip/friction_limit.hpp"
#include "support/allocations.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/refusal.hpp"
#include "support/slipping_dots.hpp"
#include "support/slipping_patch.hpp"

using namespace fingerpad;
using test::ContactFlags;
using test::Digits50;
using test::PointsPx;
using test::refusal;
using test::SlippingDots;
using test::SlippingPatch;
using test::SlippingPattern;

namespace {

using Spatial = test::Image<Point3<double>>;
const Point2<double> missing{test::nan, test::nan};
const Point3<double> missing_mm{test::nan, test::nan, test::nan};
constexpr double degree = 0.017453292519943295;

/// delta_0 of dots with a noise of 1.
const double slip_length = 2 * std::sqrt(56.0) / 18 * std::sqrt(std::log(100.0));
/// U of dots with this noise.
double reference_of(double noise) {
  return 18 * slip_length * noise;
}
/// For a U of 2 in the unit of the dots.
const StickOptions reference_2 = {.noise = 2 / reference_of(1)};

/// Dots of 9 x 9, 20 px apart, displaced by (x, y).
PointsPx shifted(double x, double y = 0, Index rows = 9, Index cols = 9) {
  PointsPx dots(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      dots(i, j) = {100 + 20 * static_cast<double>(j) + x, 100 + 20 * static_cast<double>(i) + y};
    }
  }
  return dots;
}

/// A ratio of 9 x 9 dots, all in contact, frame by frame.
struct Follower {
  StickRatio<> stick;
  ContactFlags all, none;
  ContactFlags most;  ///< all but one: a contact with an outline

  explicit Follower(const StickOptions& options = reference_2, Index rows = 9, Index cols = 9)
      : stick(rows, cols, options), all(rows, cols, 1), none(rows, cols, 0), most(all) {
    most(rows - 1, cols - 1) = 0;
  }
  StickResult<> operator()(const PointsPx& dots) { return stick(dots, all); }
  StickResult<> operator()(const PointsPx& dots, const ContactFlags& contact) {
    return stick(dots, contact);
  }
  DotState state(Index i, Index j) const { return stick.states()(i, j); }
};

}  // namespace

TEST_CASE("stick ratio: what moves as one in the image sticks, and its motion is found") {
  const double turn_rad = 0.05, zoom = 1.03;
  SlippingDots dots;
  StickRatio<> stick(21, 21);
  const auto first = stick(dots.dots, dots.contact);
  CHECK(first.status == StickStatus::unmoved);
  CHECK(first.scale == 1);
  const auto before = dots.dots;
  dots.step({.shift_px = 5, .direction_rad = 0.7, .turn_rad = turn_rad, .zoom = zoom});
  const auto r = stick(dots.dots, dots.contact);
  REQUIRE(r.updated());
  CHECK(r.stick_ratio == 1);
  CHECK(r.stick == 213);
  CHECK((r.slip == 0 && r.unknown == 0 && r.out_of_place == 0));
  CHECK(r.dots_in_contact() == 213);
  CHECK(r.reference_age == 1);
  CHECK(std::atan2(r.motion.rotation.m[1][0], r.motion.rotation.m[0][0]) ==
        Approx(turn_rad).margin(1e-12));
  CHECK(r.scale == Approx(zoom).margin(1e-12));
  double furthest = 0;
  for (Index i = 0; i < 21; ++i) {
    for (Index j = 0; j < 21; ++j) {
      const bool touches = dots.contact(i, j) != 0;
      CHECK(stick.states()(i, j) == (touches ? DotState::stick : DotState::none));
      const Point3<double> then = {before(i, j).x, before(i, j).y, 0};
      const Point3<double> to = r.scale * r.motion.rotation(then) + r.motion.translation_mm;
      CHECK(std::hypot(to.x - dots.dots(i, j).x, to.y - dots.dots(i, j).y) < 1e-9);
      const double moved = std::hypot(dots.dots(i, j).x - then.x, dots.dots(i, j).y - then.y);
      furthest = touches ? std::max(furthest, moved) : furthest;
    }
  }
  CHECK(r.furthest == Approx(furthest).epsilon(1e-12));
}

TEST_CASE("stick ratio: what moves as one in space sticks, and its motion is found") {
  // A ball rolls by 2 degrees about y. In the image no shift, rotation and scale fit its dots.
  for (const auto& motion :
       {test::moved_by({0, 2 * degree, 0}, {0, 0, 28}, {0, 0, 0}),
        test::moved_by({1 * degree, -1 * degree, 3 * degree}, {2, 1, 15}, {0.3, 0.1, 0.2}),
        test::moved_by({0, 0, 0}, {0, 0, 0}, {0, 0, -0.4})}) {
    SlippingPatch patch;
    StickRatio<> stick(21, 21, {.noise = 0.005});
    CHECK(stick(patch.dots, patch.contact).status == StickStatus::unmoved);
    patch.step(motion);
    const auto r = stick(patch.dots, patch.contact);
    REQUIRE(r.updated());
    CHECK(r.stick_ratio == 1);
    CHECK(r.reference_age == 1);
    CHECK((r.slip == 0 && r.unknown == 0 && r.out_of_place == 0));
    CHECK(r.stick == std::count(patch.contact.cells.begin(), patch.contact.cells.end(), 1));
    // the quadric through the dots of a rolled ball is not the rolled quadric
    CHECK(angle_between(r.motion.rotation, motion.rotation) < 2e-4);
    CHECK(norm(r.motion({1, 2, 10}) - motion({1, 2, 10})) < 2e-4);
    CHECK(r.scale == 1);
  }
}

TEST_CASE("stick ratio: dots that stay behind slip, by how much is known") {
  SlippingPattern pattern;
  pattern.shear_pitches = 0;
  SlippingDots truth(pattern);
  StickRatio<float> in_float(21, 21);
  StickRatio<> stick(21, 21);
  (void)stick(truth.dots, truth.contact);
  (void)in_float(truth.dots, truth.contact);
  truth.step({.shift_px = 6, .direction_rad = 1, .stick_share = 0.6});
  const auto r = stick(truth.dots, truth.contact);
  REQUIRE(r.updated());
  for (Index i = 0; i < 21; ++i) {
    for (Index j = 0; j < 21; ++j) {
      CAPTURE(i, j);
      CHECK(stick.states()(i, j) == (truth.contact(i, j) == 0   ? DotState::none
                                     : truth.has_stuck(i, j, 1) ? DotState::stick
                                                                : DotState::slip));
      const Point2<double> slip = stick.slips()(i, j);
      CHECK(is_finite(slip) == (truth.contact(i, j) != 0));
      if (stick.states()(i, j) == DotState::slip) {  // against the motion; beyond the gate exact
        CHECK(slip.x == Approx(-6 * std::cos(1.0)).margin(0.01));
        CHECK(slip.y == Approx(-6 * std::sin(1.0)).margin(0.01));
      }
    }
  }
  CHECK(r.stick_ratio == Approx(truth.stick_ratio(1)));
  CHECK(static_cast<double>(in_float(truth.dots, truth.contact).stick_ratio) ==
        Approx(truth.stick_ratio(1)));
}

TEST_CASE("stick ratio: in space dots that stay behind slip, by how much is known") {
  SlippingPatch patch;
  StickRatio<> stick(21, 21, {.noise = 0.005});
  (void)stick(patch.dots, patch.contact);
  patch.step(test::moved_by({0, 0, 0}, {0, 0, 0}, {0.3, 0.1, 0}), 0.7);
  const auto r = stick(patch.dots, patch.contact);
  REQUIRE(r.updated());
  CHECK(r.stick_ratio == Approx(patch.stick_ratio()).margin(0.1));
  double worst = 0;
  for (Index i = 0; i < 21; ++i) {
    for (Index j = 0; j < 21; ++j) {
      CAPTURE(i, j);
      const Point2<double> slip = stick.slips()(i, j);
      CHECK(is_finite(slip) == (patch.contact(i, j) != 0));
      if (patch.contact(i, j) != 0 && patch.slipped_mm(i, j) > 0.25) {
        CHECK(stick.states()(i, j) == DotState::slip);
        const double lag = patch.slipped_mm(i, j) / std::hypot(0.3, 0.1);
        worst = std::max(worst, std::hypot(slip.x + 0.3 * lag, slip.y + 0.1 * lag));
      }
    }
  }
  CHECK(worst < 0.01);
}

TEST_CASE("stick ratio: the reference is the newest stored frame further than U") {
  Follower f;
  const auto expect = [&](double x, Index age, double furthest) {
    const auto r = f(shifted(x));
    CAPTURE(x, name_of(r.status), r.reference_age);
    CHECK(r.status == (age > 0 ? StickStatus::updated : StickStatus::unmoved));
    if (age > 0) {
      CHECK(r.reference_age == age);
      CHECK(r.furthest == Approx(furthest));
      CHECK(r.stick_ratio == 1);
    }
  };
  expect(0, 0, 0);
  expect(0, 0, 0);
  expect(0.4, 0, 0);  // within U / 4: not stored
  expect(0.625, 0, 0);
  expect(1.25, 0, 0);
  expect(1.99, 0, 0);      // from the first: not above U
  expect(2.65, 3, 2.025);  // from 0.625
  expect(5, 1, 2.35);      // fast: one frame is enough
  expect(5.1, 0, 0);       // at rest an image is not compared again
}

TEST_CASE("stick ratio: in space a stored frame further than U / 2 will do, with the limit of U") {
  const double reference_mm = reference_of(0.005);
  for (const double share : {0.45, 0.55, 0.9}) {
    for (const double behind : {0.9, 1.1}) {  // in units of the limit
      CAPTURE(share, behind);
      SlippingPatch patch(0.6, 5.9);
      StickRatio<> stick(21, 21, {.noise = 0.005});
      (void)stick(patch.dots, patch.contact);
      patch.step(test::moved_by({0, 0, 0}, {0, 0, 0}, {share * reference_mm, 0, 0}), 2);
      Spatial dots = patch.dots;
      for (Index i = 9; i < 12; ++i) {
        for (Index j = 13; j < 16; ++j) {
          dots(i, j).x -= behind * reference_mm / 18;
        }
      }
      const auto r = stick(dots, patch.contact);
      CHECK(r.updated() == (share > 0.5));
      if (r.updated()) {
        CHECK(r.furthest == Approx(share * reference_mm).epsilon(0.01));
        CHECK((stick.states()(10, 14) == DotState::slip) == (behind > 1));
      }
    }
  }
}

TEST_CASE("stick ratio: in space a frame at rest is compared again") {
  SlippingPatch patch;
  StickRatio<> stick(21, 21, {.noise = 0.005});
  (void)stick(patch.dots, patch.contact);
  patch.step(test::moved_by({0, 0, 0}, {0, 0, 0}, {0.3, 0.1, 0}), 2);
  CHECK(stick(patch.dots, patch.contact).reference_age == 1);
  patch.step(test::moved_by({0, 0, 0}, {0, 0, 0}, {0.01, 0, 0}), 2);
  const auto r = stick(patch.dots, patch.contact);
  CHECK(r.updated());
  CHECK(r.reference_age == 2);
}

TEST_CASE("stick ratio: behind a change of direction there is no reference") {
  Follower f;
  for (int k = 0; k <= 8; ++k) {  // 0 to 6
    (void)f(shifted(0.75 * k));
  }
  const auto updated = f(shifted(6.75));
  CHECK(updated.updated());
  CHECK(updated.reference_age == 3);
  // backward: the frames of the way there are as near, and more distant ones are not searched
  CHECK(f(shifted(6)).status == StickStatus::unmoved);
  CHECK(f(shifted(5.3)).status == StickStatus::unmoved);
  const auto kept = f(shifted(4.76));  // 1.99 from the turning point
  CHECK(kept.status == StickStatus::unmoved);
  CHECK(kept.stick_ratio == 1);
  CHECK(kept.reference_age == 3);
  const auto again = f(shifted(4));
  CHECK(again.updated());
  CHECK(again.furthest == Approx(2.75));
  CHECK(again.reference_age == 4);
}

TEST_CASE("stick ratio: equal distances are no change of direction") {
  Follower f;
  (void)f(shifted(0));
  (void)f(shifted(1.5, 0.5));
  (void)f(shifted(1.5, -0.5));
  const auto r = f(shifted(3, 0));
  CHECK(r.updated());
  CHECK(r.reference_age == 3);
}

TEST_CASE("stick ratio: the oldest frame is forgotten") {
  // a spiral towards the last place: further back is further away, and only the first beyond U
  for (const int between : {63, 64}) {
    Follower f;
    (void)f(shifted(2.05, 0));
    for (int k = 0; k < between; ++k) {
      const double away = 1.9 - 1.3 * k / between;
      (void)f(shifted(away * std::cos(k + 1.0), away * std::sin(k + 1.0)));
    }
    CHECK(f(shifted(0)).updated() == (between == 63));
  }
}

TEST_CASE("stick ratio: the threshold grows with the displacement") {
  for (const double moved_px : {2.5, 4.0, 10.0}) {
    for (const double share : {0.95, 1.05}) {
      Follower f;
      (void)f(shifted(0));
      auto dots = shifted(moved_px);
      // the dot and those around it are behind by a share of the limit, so that their mean is
      for (Index i = 1; i < 4; ++i) {
        for (Index j = 5; j < 8; ++j) {
          dots(i, j).x -= share * moved_px / 18;
        }
      }
      const auto r = f(dots, f.most);
      REQUIRE(r.updated());
      CHECK(r.furthest == Approx(moved_px));
      CHECK(f.state(2, 6) == (share < 1 ? DotState::stick : DotState::slip));
    }
  }
}

TEST_CASE("stick ratio: dots in contact only, and those that were") {
  Follower f;
  ContactFlags contact(9, 9, 1);
  for (Index i = 0; i < 9; ++i) {
    contact(i, 8) = 0;
  }
  (void)f(shifted(0), contact);
  auto dots = shifted(3);
  for (Index i = 0; i < 9; ++i) {
    dots(i, 8).x += 7;  // not in contact: it has no effect, but would be out of line
  }
  auto r = f(dots, contact);
  CHECK(r.updated());
  CHECK(r.furthest == Approx(3));
  CHECK(r.stick == 72);
  CHECK(r.dots_in_contact() == 72);
  CHECK(f.state(4, 8) == DotState::none);
  // New dots are unknown until a reference has them; dots that have left contact have no state.
  contact = ContactFlags(9, 9, 1);
  for (Index i = 0; i < 9; ++i) {
    contact(i, 0) = 0;
  }
  r = f(shifted(6), contact);
  CHECK(r.updated());
  CHECK(r.unknown == 9);
  CHECK(f.state(4, 8) == DotState::unknown);
  CHECK(f.state(4, 0) == DotState::none);
  CHECK(r.stick == 63);
  CHECK(r.stick_ratio == 1);
  r = f(shifted(9), contact);
  CHECK(r.unknown == 0);
  CHECK(r.stick == 72);
}

TEST_CASE("stick ratio: the search begins in the last stick region") {
  // The sticking dots lie on the left. In the second step all others, twice as many, stay behind
  // together; the center of the contact is among them.
  Follower f;
  (void)f(shifted(0));
  auto dots = shifted(4);
  const auto hold = [&](Index from_col, double x) {
    for (Index i = 0; i < 9; ++i) {
      for (Index j = from_col; j < 9; ++j) {
        dots(i, j) = shifted(x)(i, j);
      }
    }
  };
  hold(6, 0);
  const auto first = f(dots, f.most);
  CHECK(first.updated());
  CHECK(first.stick == 54);
  dots = shifted(8);
  hold(4, 4);
  hold(6, 0);
  CHECK(f(dots, f.most).stick == 36);
}

TEST_CASE("stick ratio: dots that stand still together are not the object") {
  // A patch of 16 dots follows the object; the search begins among the standing dots.
  Follower f;
  (void)f(shifted(0));
  auto dots = shifted(0);
  for (Index i = 0; i < 4; ++i) {
    for (Index j = 0; j < 4; ++j) {
      dots(i, j).x += 3;
    }
  }
  const auto r = f(dots, f.most);
  REQUIRE(r.updated());
  CHECK(f.state(1, 1) == DotState::stick);
  CHECK(f.state(6, 6) == DotState::slip);
  CHECK(r.stick <= 16);
}

TEST_CASE("stick ratio: noise makes as many dots slip as was asked") {
  // Weights 6, 2, 1 leave sqrt(36 + 4 * 4 + 4 * 1) / 18 of the noise of a dot with all neighbours.
  const double noise_px = 0.05;
  double wrong = 0, all = 0;
  test::Random random(7);
  Follower f({.noise = noise_px}, 21, 21);
  // noise takes the furthest dot beyond U, by little, so that the limit is hardly above delta_0
  const double moved_px =
      0.9 * 2 * 18 * std::sqrt(56.0) / 18 * noise_px * std::sqrt(std::log(1 / 0.01));
  for (int k = 0; k < 200; ++k) {
    const auto r = f(noisy(shifted(moved_px * (k % 2), 0, 21, 21), noise_px, random), f.most);
    for (Index i = 2; r.updated() && i < 19; ++i) {
      for (Index j = 2; j < 19; ++j) {
        wrong += f.state(i, j) == DotState::slip ? 1 : 0;
        ++all;
      }
    }
  }
  CHECK(all > 20000);
  CAPTURE(wrong / all);
  CHECK(wrong / all > 0.004);
  CHECK(wrong / all < 0.012);
}

TEST_CASE("stick ratio, bad input: missing and NaN dots") {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Point2<double>& p :
       {missing, Point2<double>{test::nan, 100}, Point2<double>{100, test::nan},
        Point2<double>{infinity, 100}, Point2<double>{100, -infinity}, Point2<double>{1e200, 0}}) {
    CAPTURE(p.x, p.y);
    Follower f;
    (void)f(shifted(0));
    auto dots = shifted(3);
    dots(4, 4) = p;
    dots(0, 7) = p;
    auto r = f(dots);
    REQUIRE(r.updated());
    CHECK(r.unknown == 2);  // not found: neither sticks nor slips
    CHECK(f.state(4, 4) == DotState::unknown);
    CHECK(!is_finite(f.stick.slips()(4, 4)));
    CHECK(r.stick == 79);
    CHECK(r.stick_ratio == 1);
    CHECK(r.furthest == Approx(3));
    // after their return they are unknown as long as the reference lacks them
    r = f(shifted(6));
    CHECK(r.updated());
    CHECK(r.unknown == 2);
    r = f(shifted(9));
    CHECK(r.updated());
    CHECK(r.stick == 81);
  }
  SECTION("in space") {
    const auto motion = test::moved_by({0, 1 * degree, 0}, {0, 0, 28}, {0.1, 0, 0});
    for (const Point3<double>& bad :
         {missing_mm, Point3<double>{test::nan, 0, 10}, Point3<double>{0, infinity, 10},
          Point3<double>{0, 0, 1e200}, Point3<double>{0, 0, test::nan}}) {
      SlippingPatch patch;
      StickRatio<> stick(21, 21, {.noise = 0.005});
      (void)stick(patch.dots, patch.contact);
      patch.step(motion);
      patch.dots(10, 10) = bad;
      patch.dots(8, 11) = bad;
      const auto r = stick(patch.dots, patch.contact);
      REQUIRE(r.updated());
      CHECK(r.stick_ratio == 1);
      CHECK(stick.states()(10, 10) == DotState::unknown);
      CHECK(r.unknown == 2);
    }
  }
  SECTION("far away is not found, and makes those beside it doubtful at most") {
    for (const double far : {1e3, 1e9, 1e30, 1e150}) {
      Follower f;
      (void)f(shifted(0));
      auto dots = shifted(3);
      dots(4, 4) = {far, -far};
      const auto r = f(dots);
      REQUIRE(r.updated());
      CHECK((r.unknown >= 1 && r.unknown <= 5));
      CHECK(r.slip == 0);
      CHECK(r.furthest == Approx(3));
    }
  }
  SECTION("too few are no ratio, and the last one stands") {
    for (const Index left : {5, 6}) {
      Follower f;
      (void)f(shifted(0));
      CHECK(f(shifted(3)).stick_ratio == 1);
      auto dots = shifted(6);
      for (Index k = left; k < 81; ++k) {
        dots(k / 9, k % 9) = missing;
      }
      const auto r = f(dots);
      CHECK(r.status == (left < 6 ? StickStatus::too_few_dots : StickStatus::updated));
      CHECK(r.stick_ratio == 1);
      CHECK(r.stick == (left < 6 ? 81 : 6));  // states are kept with the ratio
      CHECK(r.unknown == (left < 6 ? 0 : 75));
    }
  }
}

TEST_CASE("stick ratio, bad input: swapped dots") {
  // Two dots with swapped names are not between their neighbours: they are missing, not slipping,
  // and not the furthest of all.
  const auto run = [](DotIndex a, DotIndex b, Index out_of_place) {
    Follower f;
    (void)f(shifted(0));
    auto dots = shifted(3);
    std::swap(dots(a.row, a.col), dots(b.row, b.col));
    const auto r = f(dots);
    REQUIRE(r.updated());
    CHECK(r.furthest == Approx(3));
    CHECK(r.out_of_place == out_of_place);
    CHECK(r.unknown == out_of_place);
    CHECK(r.slip == 0);
    CHECK(f.state(a.row, a.col) == DotState::unknown);
    CHECK(f.state(b.row, b.col) == DotState::unknown);
    (void)f(shifted(6));
    CHECK(f(shifted(9)).stick == 81);
  };
  run({2, 3}, {6, 6}, 13);  // and the four neighbours of each, and three ends that they point to
  run({4, 4}, {4, 5}, 2);   // the others are still in line
  run({4, 4}, {5, 5}, 4);
}

TEST_CASE("stick ratio, bad input: a misplaced dot at the edge of the pattern") {
  // If it counted, it would be the furthest dot and hide all slip.
  for (const DotIndex dot : {DotIndex{0, 0}, DotIndex{0, 8}, DotIndex{8, 0}, DotIndex{8, 8},
                             DotIndex{0, 4}, DotIndex{8, 4}, DotIndex{4, 0}, DotIndex{4, 8}}) {
    CAPTURE(dot.row, dot.col);
    Follower f;
    (void)f(shifted(0));
    auto dots = shifted(3);
    dots(dot.row, dot.col).y += dot.row < 4 ? -30 : 30;
    const auto r = f(dots);
    REQUIRE(r.updated());
    CHECK(r.out_of_place >= 1);  // and perhaps its neighbours
    CHECK(r.furthest == Approx(3));
    CHECK(r.slip == 0);
    CHECK(f.state(dot.row, dot.col) == DotState::unknown);
  }
}

TEST_CASE("stick ratio, bad input: dots marked as lost by a place") {
  // (0, 0) and (-1, -1) are the marks of finders without NaN; a third of the dots is lost.
  for (const double mark : {0.0, -1.0}) {
    CAPTURE(mark);
    Follower f;
    (void)f(shifted(0));
    auto dots = shifted(3);
    Index lost = 0;
    for (Index k = 0; k < 81; k += 3) {
      dots(k / 9, (k + k / 9) % 9) = {mark, mark};
      ++lost;
    }
    const auto r = f(dots);
    REQUIRE(r.updated());
    CHECK(r.slip == 0);
    CHECK(r.unknown == lost);
    CHECK(r.stick_ratio == 1);
    CHECK(r.furthest == Approx(3));
    CHECK(f(PointsPx(9, 9, {mark, mark})).status == StickStatus::too_few_dots);
    // a single dot at such a position is a dot
    const auto around = [&](double x) { return shifted(x + mark - 180, mark - 180); };
    Follower g;
    (void)g(around(0));
    CHECK(g(around(3)).stick == 81);
    // of several none is; the other dots with x = y remain
    Follower h;
    (void)h(around(-3));
    dots = around(0);
    dots(0, 3) = dots(2, 7) = dots(6, 1) = {mark, mark};
    const auto of_several = h(dots);
    CHECK(of_several.stick == 77);
    CHECK(of_several.unknown == 4);
    CHECK(of_several.out_of_place == 0);
  }
}

TEST_CASE("stick ratio, bad input: a pattern that jumps by one pitch") {
  for (const Index rows : {-1, 0, 1}) {
    for (const Index cols : {-1, 0, 1}) {
      const double x = 20 * static_cast<double>(cols), y = 20 * static_cast<double>(rows);
      CAPTURE(rows, cols);
      Follower f;
      (void)f(shifted(0));
      CHECK(f(shifted(3)).stick_ratio == 1);
      const bool jumps = rows != 0 || cols != 0;
      const auto r = f(shifted(5.7 + x, 0.4 + y));
      CHECK(r.status == (jumps ? StickStatus::not_in_order : StickStatus::updated));
      CHECK(r.stick_ratio == 1);
      if (jumps) {
        CHECK(f(shifted(5.7 + x, 0.4 + y)).status == StickStatus::not_in_order);
        CHECK(f.state(4, 4) == DotState::stick);  // as before
      }
      const auto again = f(shifted(8));  // in step again
      CHECK(again.updated());
      CHECK(again.stick_ratio == 1);
    }
  }
  SECTION("so does a pattern that turns or grows") {
    SlippingDots dots;
    StickRatio<> stick(21, 21);
    (void)stick(dots.dots, dots.contact);
    dots.step({.shift_px = 19.5, .direction_rad = 0.01, .turn_rad = 0.02, .zoom = 1.01});
    CHECK(stick(dots.dots, dots.contact).status == StickStatus::not_in_order);
  }
  SECTION("rows and columns exchanged, a mirror, two halves exchanged") {
    for (const int kind : {0, 1, 2}) {
      CAPTURE(kind);
      Follower f;
      SlippingPatch patch(1.5, 6);
      StickRatio<> spatial(21, 21, {.noise = 0.005});
      (void)f(shifted(0));
      (void)spatial(patch.dots, patch.contact);
      const auto permuted = [&](const auto& from, Index n) {
        auto to = from;
        for (Index i = 0; i < n; ++i) {
          for (Index j = 0; j < n; ++j) {
            to(i, j) = kind == 0   ? from(j, i)
                       : kind == 1 ? from(i, n - 1 - j)
                                   : from(i, (j + n / 2) % n);
          }
        }
        return to;
      };
      CHECK(f(permuted(shifted(3), 9)).status == StickStatus::not_in_order);
      CHECK(spatial(permuted(patch.dots, 21), patch.contact).status == StickStatus::not_in_order);
    }
  }
  SECTION("fast but not by a pitch is motion") {
    Follower f;
    (void)f(shifted(0));
    const auto by_half = f(shifted(10));
    CHECK(by_half.updated());
    CHECK_FALSE(by_half.far_apart);
    const auto beyond = f(shifted(40));
    CHECK(beyond.updated());
    CHECK(beyond.far_apart);
  }
}

TEST_CASE("stick ratio: an object that carries its dots by a pitch between two frames") {
  // 21 x 21 dots 20 px apart; the dots beside the contact stay, so that no label has changed
  ContactFlags contact(21, 21, 0);
  for (Index k = 0; k < 441; ++k) {
    const Index down = k / 21 - 10, right = k % 21 - 10;
    contact(k / 21, k % 21) = down * down + right * right <= 36 ? 1 : 0;
  }
  const auto frame = [&](double contact_px, double rest_px) {
    PointsPx dots(21, 21);
    for (Index k = 0; k < 441; ++k) {
      const Index i = k / 21, j = k % 21;
      dots(i, j) = {20.0 * static_cast<double>(j) + (contact(i, j) != 0 ? contact_px : rest_px),
                    20.0 * static_cast<double>(i)};
    }
    return dots;
  };
  StickRatio<> stick(21, 21, {.noise = 0.1});
  (void)stick(frame(0, 0), contact);
  const auto carried = stick(frame(18, 0), contact);
  CHECK(carried.updated());
  CHECK(carried.far_apart);
  CHECK(carried.stick_ratio == 1);
  CHECK(carried.ratio_sd == Approx(carried.least_sd()));
  const auto renumbered = stick(frame(38, 20), contact);
  CHECK(renumbered.status == StickStatus::not_in_order);
  CHECK(renumbered.stick_ratio == 1);
  CHECK(renumbered.ratio_sd == Approx(carried.ratio_sd + 0.05));
  const auto at_rest = stick(frame(18.1, 0), contact);
  CHECK_FALSE(at_rest.far_apart);
}

TEST_CASE("stick ratio: the noise is at least a 2000th of a pitch") {
  const auto status = [](double share) {
    Follower f({.noise = 1e-9});
    (void)f(shifted(0));
    return f(shifted(share * reference_of(20.0 / 2000))).status;
  };
  CHECK(status(0.9999) == StickStatus::unmoved);
  CHECK(status(1.0001) == StickStatus::updated);
}

TEST_CASE("stick ratio: dots without neighbours in contact have no pitch") {
  ContactFlags alternating(9, 9, 0);
  for (Index k = 0; k < 81; k += 2) {
    alternating(k / 9, k % 9) = 1;
  }
  Follower f;
  (void)f(shifted(0), alternating);
  CHECK(f(shifted(3), alternating).stick == 41);
}

TEST_CASE("stick ratio: no answer while dots fall back toward their free places") {
  for (const bool free_known : {true, false}) {
    Follower f;
    if (free_known) {
      CHECK(f(shifted(0), f.none).status == StickStatus::no_contact);
    }
    (void)f(shifted(0));
    for (double x = 3; x < 16; x += 3) {
      CHECK(f(shifted(x)).updated());
    }
    auto held = shifted(18);  // two columns stay behind
    for (Index i = 0; i < 9; ++i) {
      held(i, 0) = shifted(15)(i, 0);
      held(i, 1) = shifted(15)(i, 1);
    }
    const double ratio = f(held, f.most).stick_ratio;
    CHECK(ratio == Approx(62.0 / 80));
    int answers = 0;
    for (double x = 15; x > 0; x -= 3) {
      const auto r = f(shifted(x));
      answers += r.updated() ? 1 : 0;
      CHECK(
          (!free_known || r.status == StickStatus::falls_back || r.status == StickStatus::unmoved));
      CHECK((!free_known || r.stick_ratio == ratio));
      if (r.status == StickStatus::falls_back) {  // as one, whether carried or let go
        CHECK(r.back_ratio > 0.7);
        const double changed = (r.back_ratio - ratio) / std::sqrt(3);
        CHECK(r.back_sd == Approx(std::hypot(0.065, 0.9 / 9, changed)));
        CHECK(r.back_age > 0);
      } else {
        CHECK((!is_finite(r.back_ratio) && !is_finite(r.back_sd)));
      }
    }
    CHECK((free_known ? answers == 0 : answers > 3));
    CHECK(f(shifted(-3)).updated());  // beyond the free position it moves away again
  }
  // sideways is not back
  Follower f;
  (void)f(shifted(0), f.none);
  (void)f(shifted(0));
  for (int k = 0; k < 40; ++k) {
    const auto r = f(shifted(12 * std::cos(0.25 * k), 12 * std::sin(0.25 * k)));
    CHECK(r.status == StickStatus::updated);
  }
}

TEST_CASE("stick ratio, bad input: all dots lost for some frames, then back") {
  Follower f;
  const PointsPx blank(9, 9, missing);
  CHECK(f(blank).status == StickStatus::too_few_dots);
  CHECK(std::isnan(f(blank).stick_ratio));
  (void)f(shifted(0));
  auto held = shifted(3);
  for (Index i = 0; i < 9; ++i) {
    held(i, 0) = shifted(0)(i, 0);
  }
  const auto before = f(held, f.most);
  REQUIRE(before.updated());
  REQUIRE(before.slip == 9);
  for (int k = 0; k < 5; ++k) {
    const auto r = f(blank);
    CHECK(r.status == StickStatus::too_few_dots);
    CHECK(r.stick_ratio == before.stick_ratio);
    CHECK(r.slip == 9);  // known states are kept
    CHECK(f.state(3, 0) == DotState::slip);
  }
  // without contact flags, because nothing is found where contact could be
  CHECK(f(blank, f.none).status == StickStatus::too_few_dots);
  const auto after = f(shifted(6), f.most);  // nothing was forgotten
  CHECK(after.updated());
  CHECK(after.reference_age == 7);
}

TEST_CASE("stick ratio, bad input: time going backwards") {
  Follower f;
  const auto at = [&](double x, double time_s) { return f.stick(shifted(x), f.all, time_s); };
  CHECK(at(0, 10).status == StickStatus::unmoved);
  CHECK(at(3, 10.1).updated());
  CHECK(at(6, 10.1).updated());   // the same time again is not backward
  CHECK(at(9, 10.05).updated());  // a clock that is slightly late
  CHECK(at(12, 9.91).updated());
  const auto r = at(9, 9.85);  // 0.25 s before the latest: another recording
  CHECK(r.status == StickStatus::unmoved);
  CHECK(std::isnan(r.stick_ratio));
  CHECK(r.reference_age == 0);
  CHECK(r.unknown == 81);
  CHECK(at(12, 9.86).reference_age == 1);
  // times that are not numbers are ignored
  CHECK(at(15, test::nan).updated());
  CHECK(at(18, 9.87).updated());
  CHECK(f(shifted(21)).updated());
  CHECK(std::isnan(at(24, -std::numeric_limits<double>::infinity()).stick_ratio));
  CHECK(at(27, -5).updated());
}

TEST_CASE("stick ratio, bad input: a contact mask that drops out for a moment") {
  Follower f;
  const auto at = [&](double x, double time_s, bool touches) {
    return f.stick(shifted(x), touches ? f.all : f.none, time_s);
  };
  (void)at(0, 1.0, true);
  CHECK(at(3, 1.1, true).updated());
  const auto lost = at(4, 1.2, false);
  CHECK(lost.status == StickStatus::no_contact);
  CHECK((std::isnan(lost.stick_ratio) && std::isnan(lost.ratio_sd)));  // nothing touches
  CHECK(lost.dots_in_contact() == 0);
  CHECK(at(3, 1.29, true).stick_ratio == 1);  // kept
  const auto back = at(6, 1.3, true);
  CHECK(back.updated());  // against an earlier frame
  CHECK(back.reference_age == 3);
  CHECK(std::isnan(at(7, 1.51, false).stick_ratio));  // longer than 0.2 s: another contact
  CHECK(at(9, 1.52, true).status == StickStatus::unmoved);
  // without time a lost contact has ended
  CHECK(at(12, test::nan, true).updated());
  CHECK(std::isnan(at(12, test::nan, false).stick_ratio));
}

TEST_CASE("stick ratio, bad input: few dots, dots on a line, dots in one place") {
  const auto run = [](Index rows, Index cols) {
    Follower f(reference_2, rows, cols);
    (void)f(shifted(0, 0, rows, cols));
    return f(shifted(3, 0, rows, cols));
  };
  const auto r = run(1, 1);
  CHECK(r.status == StickStatus::too_few_dots);
  CHECK(std::isnan(r.stick_ratio));
  CHECK(r.unknown == 1);
  CHECK(run(1, 5).status == StickStatus::too_few_dots);
  CHECK(run(1, 9).stick_ratio == 1);  // in the image a line determines the motion
  CHECK(run(9, 1).stick_ratio == 1);
  CHECK(run(2, 3).stick_ratio == 1);
  Follower f;
  (void)f(PointsPx(9, 9, {1, 2}));
  CHECK(!f(PointsPx(9, 9, {4, 2})).updated());
  SECTION("in space") {
    for (const int kind : {0, 1, 2}) {
      ContactFlags contact(21, 21, 0);
      Spatial dots = SlippingPatch().dots;
      for (Index j = 0; j < 21; ++j) {
        contact(10, j) = kind == 0 ? (j == 10 ? 1 : 0) : 1;
        contact(11, j) = kind == 2 ? 1 : 0;
      }
      if (kind == 2) {
        dots = Spatial(21, 21, {1, 2, 3});
      }
      StickRatio<> stick(21, 21, {.noise = 0.005});
      (void)stick(dots, contact);
      for (auto& p : dots.cells) {
        p.x += 0.5;
      }
      CHECK(!stick(dots, contact).updated());
    }
  }
}

TEST_CASE("stick ratio: a contact of all dots lacks an outline once more than a tenth slip") {
  for (const bool covers : {false, true}) {
    for (const Index slipping : {1, 2}) {
      StickOptions options = reference_2;
      options.covers_pattern = covers;
      Follower f(options);
      (void)f(shifted(0));
      auto dots = shifted(3);
      for (Index i = 0; i < 4 * slipping; ++i) {
        for (Index j = 0; j < 2; ++j) {
          dots(i, j) = shifted(0)(i, j);
        }
      }
      const auto r = f(dots);
      CHECK(r.slip == 8 * slipping);
      const bool lacks = slipping == 2 && !covers;
      CHECK(r.status == (lacks ? StickStatus::no_outline : StickStatus::updated));
      CHECK(std::isnan(r.stick_ratio) == lacks);
    }
  }
}

TEST_CASE("stick ratio: all dots that are found, but not up to each side, have an outline") {
  for (int side = 0; side < 4; ++side) {
    CAPTURE(side);
    const auto without_side = [&](PointsPx dots) {
      for (Index k = 0; k < 9; ++k) {
        (side < 2 ? dots(side * 8, k) : dots(k, (side - 2) * 8)) = missing;
      }
      return dots;
    };
    Follower f(reference_2);
    (void)f(without_side(shifted(0)));
    auto dots = shifted(3);
    for (Index i = 3; i < 6; ++i) {
      for (Index j = 1; j < 6; ++j) {
        dots(i, j) = shifted(0)(i, j);
      }
    }
    const auto r = f(without_side(dots));
    CHECK(10 * r.slip > r.stick + r.slip);
    CHECK(r.status == StickStatus::updated);
  }
}

TEST_CASE("stick ratio, bad input: grids of another size are refused") {
  Follower f;
  (void)f(shifted(0));
  (void)f(shifted(3));
  CHECK(!f.stick(shifted(0, 0, 9, 8), f.all).accepted());
  CHECK(!f.stick(shifted(0, 0, 0, 0), f.all).accepted());
  const auto refused = f.stick(shifted(6), ContactFlags(8, 9));
  CHECK(refused.status == StickStatus::refused);
  CHECK((!refused.ok() && !refused.updated() && std::isnan(refused.stick_ratio)));
  CHECK((refused.dots_in_contact() == 0 && refused.out_of_place == 0));
  CHECK(f(shifted(6)).reference_age == 1);  // nothing was changed
}

TEST_CASE("stick ratio: bad parameters are refused by name, value and range") {
  const auto with = [](const StickOptions& o) { return refusal([&] { StickRatio<>(9, 9, o); }); };
  CHECK(with({}) == "accepted");
  CHECK(with({.noise = -1}) == "StickOptions: noise = -1, must be finite and >= 0");
  CHECK(with({.noise = test::nan}) == "StickOptions: noise = nan, must be finite and >= 0");
  CHECK(with({.slip_share = 0.6}) == "StickOptions: slip_share = 0.6, must be in (0, 0.5]");
  CHECK(with({.slip_share = 0}) == "StickOptions: slip_share = 0, must be in (0, 0.5]");
  CHECK(check(StickOptions{}).empty());
  CHECK(refusal([] { StickRatio<>(0, 9); }) == "StickRatio: rows = 0, must be in [1, 1000000]");
  CHECK(refusal([] { StickRatio<>(9, -1); }) == "StickRatio: cols = -1, must be in [1, 1000000]");
}

namespace {

/// Frames of a pad with this noise that is dragged to and fro; two thirds of the contact stick, the
/// rest slips more and more. A share `wrong` of the dots has wrong positions.
void show(StickRatio<>& stick, double noise_mm, int frames, bool touches, double wrong = 0) {
  test::Random random(3);
  SlippingPatch patch;
  for (int k = 0; k < frames; ++k) {
    patch.step(test::moved_by({0, 0, random.uniform(-0.02, 0.02)}, {1, 0, 0},
                              {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 0}),
               0.67);
    Spatial dots = noisy(patch.dots, noise_mm, 0.025, random);
    for (auto& p : dots.cells) {
      p.x += random.uniform() < wrong ? random.uniform(-1, 1) : 0;
    }
    (void)stick(dots, touches ? patch.contact : ContactFlags(21, 21, 0));
  }
}

}  // namespace

TEST_CASE("stick ratio: noise is measured from frame to frame, touching or not") {
  StickRatio<> stick(21, 21);
  for (const bool touches : {false, true}) {
    for (const double noise_mm : {0.002, 0.005, 0.02}) {
      CAPTURE(touches, noise_mm);
      stick.reset();
      show(stick, noise_mm, 1, touches);
      CHECK(stick.noise() == 0);  // a pair of frames is needed
      show(stick, noise_mm, 2, touches);
      CHECK(stick.noise() == Approx(noise_mm).epsilon(0.15));
      show(stick, noise_mm, 40, touches, 0.02);  // one dot in fifty is wrong
      CHECK(stick.noise() == Approx(noise_mm).epsilon(0.2));
      show(stick, 0.5 * noise_mm, 32, touches);  // the latest 32 frames count
      CHECK(stick.noise() == Approx(0.5 * noise_mm).epsilon(0.15));
    }
  }
  stick.reset();
  CHECK(stick.noise() == 0);
  StickRatio<> given(21, 21, {.noise = 0.005});
  show(given, 0.02, 20, true);
  CHECK(given.noise() == 0.005);
  const PointsPx still = SlippingDots().dots;  // repeated frames show none
  StickRatio<> repeated(21, 21);
  for (int k = 0; k < 20; ++k) {
    (void)repeated(still, ContactFlags(21, 21, 0));
  }
  CHECK(repeated.noise() == 0);
}

TEST_CASE("stick ratio: its standard deviation is smaller with more dots, and grows while kept") {
  for (const double pitch_mm : {1.5, 2.5}) {
    SlippingPatch patch(pitch_mm, 9.05);
    StickRatio<> stick(patch.dots.rows(), patch.dots.cols(), {.noise = 0.005});
    CHECK(std::isnan(stick(patch.dots, patch.contact).ratio_sd));  // no ratio yet
    patch.step(test::moved_by({0, 0, 0}, {0, 0, 28}, {0.25, 0.05, 0}), 0.5);
    const auto r = stick(patch.dots, patch.contact);
    REQUIRE(r.updated());
    const auto dots = static_cast<double>(r.dots_in_contact());
    CHECK(dots > 30);
    const double limit = std::max(r.furthest, 18 * 0.00892) / 18;  // U
    double near = 0;  // dots that slip by less than twice what counts as slip, but count
    for (Index i = 0; i < stick.rows(); ++i) {
      for (Index j = 0; j < stick.cols(); ++j) {
        const double slip = norm(stick.slips()(i, j));
        near += slip >= limit && slip < 2 * limit ? 1 : 0;
      }
    }
    CHECK(r.least_sd() == Approx(std::hypot(0.065, 0.9 / std::sqrt(dots))));
    // no answer before: all stuck
    CHECK(r.ratio_sd ==
          Approx(std::hypot(r.least_sd(), near / dots, (1 - r.stick_ratio) / std::sqrt(3.0))));
    auto lost = patch.dots;
    std::fill(lost.cells.begin(), lost.cells.end(), missing_mm);
    double before = r.ratio_sd;
    for (int k = 0; k < 12; ++k) {
      const auto kept = stick(lost, patch.contact);
      REQUIRE_FALSE(kept.updated());
      CHECK(kept.stick_ratio == r.stick_ratio);
      CHECK(kept.ratio_sd == Approx(std::min(before + 0.05, 0.5)));
      before = kept.ratio_sd;
    }
  }
}

using DotStates = test::Image<DotState>;

namespace {

using Point = Point2<double>;

struct Recording {
  std::vector<PointsPx> dots;
  std::vector<ContactFlags> contact;
  std::size_t size() const { return dots.size(); }
  Index rows() const { return dots[0].rows(); }
  Index cols() const { return dots[0].cols(); }
};

/// An object is dragged, rotated and pressed at random while its stick disc changes at random.
Recording any_recording(double lost_share = 0) {
  SlippingPattern pattern{.rows = 13, .cols = 12, .contact_pitches = test::uniform(3.5, 5.5)};
  pattern.disc_row = test::uniform(-1, 1);
  pattern.disc_col = test::uniform(-1, 1);
  pattern.shear_pitches = test::uniform(0, 2);
  SlippingDots truth(pattern);
  test::Random random(static_cast<std::uint64_t>(test::whole(0, 1 << 30)));
  const double noise_px = test::uniform(0.02, 0.15);
  Recording recording;
  double direction = random.uniform(0, 6.3);
  for (int k = 0; k < 9; ++k) {
    auto dots = noisy(truth.dots, noise_px, random);
    for (Point& p : dots.cells) {
      p = random.uniform() < lost_share ? missing : p;
    }
    recording.dots.push_back(dots);
    recording.contact.push_back(truth.contact);
    direction += random.uniform(-0.4, 0.4) + (random.whole(0, 9) == 0 ? 3 : 0);
    truth.step({.shift_px = random.uniform(0, 3),
                .direction_rad = direction,
                .turn_rad = random.uniform(-0.02, 0.02),
                .zoom = random.uniform(0.99, 1.01),
                .stick_share = random.uniform(0.2, 1.2)});
  }
  return recording;
}

/// Maps the dots and flags of a recording one by one.
template <class MapDots, class MapFlags>
Recording mapped(const Recording& from, const MapDots& map_dots, const MapFlags& map_flags) {
  Recording to;
  for (std::size_t k = 0; k < from.size(); ++k) {
    to.dots.push_back(map_dots(from.dots[k]));
    to.contact.push_back(map_flags(from.contact[k]));
  }
  return to;
}

struct Said {
  std::vector<StickResult<>> results;
  std::vector<DotStates> states;
};

DotStates states_of(const StickRatio<>& stick) {
  DotStates states(stick.rows(), stick.cols());
  for (Index i = 0; i < stick.rows(); ++i) {
    for (Index j = 0; j < stick.cols(); ++j) {
      states(i, j) = stick.states()(i, j);
    }
  }
  return states;
}

Said follow(const Recording& recording) {
  Said said;
  StickRatio<> stick(recording.rows(), recording.cols());
  for (std::size_t k = 0; k < recording.size(); ++k) {
    said.results.push_back(stick(recording.dots[k], recording.contact[k]));
    said.states.push_back(states_of(stick));
  }
  return said;
}

template <class S>
S angle_of(const StickResult<S>& r) {
  using std::atan2;
  return S(atan2(r.motion.rotation.m[1][0], r.motion.rotation.m[0][0]));
}

bool near(double a, double b, double margin = 1e-9) {
  return test::same_bits(a, b) || std::abs(a - b) <= margin * std::max(1.0, std::abs(b));
}

/// `sign` is that of the angle in `b`, `scale` that of its lengths, and `place` maps dots of a to
/// dots of b.
template <class Place>
void must_agree(const Said& a, const Said& b, double sign, double scale, const Place& place) {
  for (std::size_t k = 0; k < a.results.size(); ++k) {
    const auto &x = a.results[k], &y = b.results[k];
    RC_ASSERT(x.status == y.status);
    RC_ASSERT((x.stick == y.stick && x.slip == y.slip && x.unknown == y.unknown));
    RC_ASSERT(x.out_of_place == y.out_of_place);
    RC_ASSERT(test::same_bits(x.stick_ratio, y.stick_ratio));
    RC_ASSERT(x.reference_age == y.reference_age);
    RC_ASSERT(near(x.furthest * scale, y.furthest));
    RC_ASSERT(near(angle_of(x) * sign, angle_of(y)));
    RC_ASSERT(near(x.scale, y.scale));
    for (Index i = 0; i < a.states[k].rows(); ++i) {
      for (Index j = 0; j < a.states[k].cols(); ++j) {
        const DotIndex at = place(i, j);
        RC_ASSERT(a.states[k](i, j) == b.states[k](at.row, at.col));
      }
    }
  }
}

DotIndex same_place(Index row, Index col) {
  return {row, col};
}

}  // namespace

TEST_CASE("stick and slip do not depend on how the image is held", "[stick_ratio][law]") {
  rc::prop("shifted, rotated, mirrored, enlarged with the thresholds", [] {
    const Recording recording = any_recording(test::whole(0, 1) == 0 ? 0 : 0.05);
    const Said said = follow(recording);
    const double shift_x = test::uniform(-500, 500), shift_y = test::uniform(-500, 500);
    const double turn = test::uniform(-3.2, 3.2), scale = test::log_uniform(0.01, 100);
    const bool mirror = test::whole(0, 1) == 1;
    const double cosine = scale * std::cos(turn), sine = scale * std::sin(turn);
    const Recording seen = mapped(
        recording,
        [&](PointsPx dots) {
          for (Point& p : dots.cells) {
            const double x = mirror ? -p.x : p.x;
            p = {cosine * x - sine * p.y + shift_x, sine * x + cosine * p.y + shift_y};
          }
          return dots;
        },
        [](const ContactFlags& flags) { return flags; });
    must_agree(said, follow(seen), mirror ? -1 : 1, scale, same_place);
  });
}

TEST_CASE("stick and slip do not depend on how the dots are numbered", "[stick_ratio][law]") {
  rc::prop("from below, from the right, by columns", [] {
    const Recording recording = any_recording(test::whole(0, 1) == 0 ? 0 : 0.05);
    const Said said = follow(recording);
    const auto check = [&](bool swaps, const auto& place) {
      const auto map = [&](const auto& grid) {
        using Grid = std::decay_t<decltype(grid)>;
        Grid out = swaps ? Grid(grid.cols(), grid.rows()) : Grid(grid.rows(), grid.cols());
        for (Index i = 0; i < grid.rows(); ++i) {
          for (Index j = 0; j < grid.cols(); ++j) {
            const DotIndex at = place(i, j);
            out(at.row, at.col) = grid(i, j);
          }
        }
        return out;
      };
      const Recording other = mapped(recording, map, map);
      must_agree(said, follow(other), 1, 1, place);
    };
    const Index rows = recording.rows(), cols = recording.cols();
    check(false, [&](Index i, Index j) { return DotIndex{rows - 1 - i, j}; });
    check(false, [&](Index i, Index j) { return DotIndex{i, cols - 1 - j}; });
    check(true, [](Index i, Index j) { return DotIndex{j, i}; });
  });
}

TEST_CASE("a dot that begins to slip never raises the ratio", "[stick_ratio][law]") {
  // Without noise; the slip is beyond the gate of the denoising, never of the dots around the
  // middle, where the search begins, and never more than the motion, so that d_max is unchanged.
  rc::prop("clear slip of one dot more lowers it by that dot", [] {
    SlippingDots truth({.rows = 13, .cols = 13, .contact_pitches = 5.9});
    const auto before = truth.dots;
    truth.step({.shift_px = test::uniform(4.5, 6), .direction_rad = test::uniform(-3, 3)});
    auto dots = truth.dots;
    std::vector<DotIndex> outer;
    Index all = 0;
    for (Index i = 0; i < 13; ++i) {
      for (Index j = 0; j < 13; ++j) {
        const double pitches = std::hypot(i - 6, j - 6);
        all += truth.contact(i, j);
        if (truth.contact(i, j) != 0 && pitches > 3) {
          outer.push_back({i, j});
        }
      }
    }
    for (Index slipping = 0; outer.size() > 40; ++slipping) {
      StickRatio<> stick(13, 13, {.noise = 0.06});
      (void)stick(before, truth.contact);
      const auto r = stick(dots, truth.contact);
      RC_ASSERT(r.updated());
      RC_ASSERT(r.slip == slipping);
      RC_ASSERT(r.stick == all - slipping);
      const auto pick = outer.begin() + test::whole(0, std::ssize(outer) - 1);
      const double behind = test::uniform(0.8, 1);
      Point& p = dots(pick->row, pick->col);
      const Point& from = before(pick->row, pick->col);
      p = {p.x + behind * (from.x - p.x), p.y + behind * (from.y - p.y)};
      outer.erase(pick);
    }
  });
}

TEST_CASE("stick ratio: nothing is worse than a status", "[stick_ratio][law]") {
  rc::prop("whatever the dots, the flags, the times and the sizes", [] {
    const Index rows = test::whole(1, 8), cols = test::whole(1, 8);
    const auto bad = [](double good) {
      const double infinity = std::numeric_limits<double>::infinity();
      const double max = std::numeric_limits<double>::max();
      return *rc::gen::element(good, good, good, good, good, good, good, good, 0.0, 1e-310, 1e5,
                               1e9, 1e20, max, -max, std::nan(""), infinity, -infinity);
    };
    const StickOptions options{.noise = test::uniform(0.02, 0.2)};
    StickRatio<> stick(rows, cols, options);
    StickRatio<float> in_float(rows, cols, options);
    double drift = 0;
    for (int k = 0; k < 8; ++k) {
      const bool other = test::whole(0, 15) == 0;
      PointsPx dots(rows + (other ? 1 : 0), cols);
      ContactFlags flags(dots.rows(), cols);
      const auto kind = test::whole(0, 4);
      const auto touching = test::whole(0, 130), wild = test::whole(0, 2);
      drift += test::uniform(-2, 4);
      for (Index i = 0; i < dots.rows(); ++i) {
        for (Index j = 0; j < cols; ++j) {
          const double x = 20 * static_cast<double>(j) + drift, y = 20 * static_cast<double>(i);
          dots(i, j) = kind == 0   ? Point{3, 4}
                       : kind == 1 ? Point{x, x}
                       : wild == 0 ? Point{bad(x), bad(y)}
                                   : Point{x + test::uniform(-1, 1), y + test::uniform(-1, 1)};
          flags(i, j) = test::whole(0, 99) < touching ? 1 : 0;
        }
      }
      const double time_s = bad(static_cast<double>(k));
      const auto check = [&](auto& of) {
        const auto r = of(dots, flags, time_s);
        RC_ASSERT(r.accepted() == !other);
        if (other) {
          return;
        }
        Index none = 0;
        std::array<Index, 4> count = {};
        for (Index i = 0; i < rows; ++i) {
          for (Index j = 0; j < cols; ++j) {
            const DotState state = of.states()(i, j);
            ++count[static_cast<std::size_t>(state)];
            none += flags(i, j) == 0 ? 1 : 0;
            RC_ASSERT((state != DotState::none) == (flags(i, j) != 0));
          }
        }
        RC_ASSERT((count[0] == none && count[1] == r.unknown && count[2] == r.slip &&
                   count[3] == r.stick));
        const double q = static_cast<double>(r.stick_ratio);
        RC_ASSERT((std::isnan(q) || (q >= 0 && q <= 1)));
        RC_ASSERT((r.out_of_place >= 0 && r.out_of_place <= rows * cols));
        RC_ASSERT((is_finite(r.scale) && is_finite(r.motion.translation_mm)));
        RC_ASSERT((r.reference_age >= 0 && r.reference_age <= k));
        if (r.updated()) {
          RC_ASSERT(r.stick + r.slip >= 6);
          RC_ASSERT(q ==
                    Approx(static_cast<double>(r.stick) / static_cast<double>(r.stick + r.slip)));
          RC_ASSERT(r.reference_age >= 1);
          RC_ASSERT((is_finite(r.furthest) && static_cast<double>(r.furthest) > 0));
          RC_ASSERT((is_finite(r.ratio_sd) && static_cast<double>(r.ratio_sd) >= 0));
        }
      };
      check(stick);
      check(in_float);
    }
  });
}

namespace {

/// An object is dragged, rolled, rotated and pressed at random while its stick disc changes at
/// random.
std::vector<Spatial> any_recording(SlippingPatch& patch) {
  test::Random random(static_cast<std::uint64_t>(test::whole(0, 1 << 30)));
  std::vector<Spatial> frames;
  const auto small = [&](double size) { return random.uniform(-size, size); };
  for (int k = 0; k < 8; ++k) {
    frames.push_back(noisy(patch.dots, 0.005, 0.025, random));
    patch.step(test::moved_by({small(0.01), small(0.01), small(0.02)}, {small(3), small(3), 28},
                              {small(0.2), small(0.2), small(0.1)}),
               random.uniform(0.3, 1.3));
  }
  return frames;
}

}  // namespace

TEST_CASE("in space, stick and slip do not depend on where the pad is seen from its axis",
          "[stick_ratio][law]") {
  rc::prop("shifted, rotated about z, mirrored", [] {
    SlippingPatch patch;
    const auto frames = any_recording(patch);
    const double angle = test::uniform(-3, 3), x = test::uniform(-30, 30),
                 y = test::uniform(-30, 30), z = test::uniform(-5, 5);
    const bool mirror = test::whole(0, 1) == 1;
    StickRatio<> stick(21, 21, {.noise = 0.005}), other = stick;
    for (const Spatial& dots : frames) {
      Spatial seen = dots;
      for (auto& p : seen.cells) {
        const double px = mirror ? -p.x : p.x;
        p = {std::cos(angle) * px - std::sin(angle) * p.y + x,
             std::sin(angle) * px + std::cos(angle) * p.y + y, p.z + z};
      }
      const auto a = stick(dots, patch.contact), b = other(seen, patch.contact);
      RC_ASSERT(a.status == b.status);
      RC_ASSERT(a.reference_age == b.reference_age);
      RC_ASSERT((a.stick == b.stick && a.slip == b.slip && a.unknown == b.unknown));
      RC_ASSERT(states_of(stick).cells == states_of(other).cells);
      const bool none = std::isnan(a.furthest) && std::isnan(b.furthest);
      RC_ASSERT((none || std::abs(a.furthest - b.furthest) < 1e-9));
    }
  });
}

namespace {

constexpr double pi = std::numbers::pi;

/// What a recording gives, in doubles.
struct Answers {
  std::vector<StickStatus> status;
  std::vector<double> ratios, sds, angles, scales, furthest, slips;

  template <class S>
  void add(const StickRatio<S>& stick, const StickResult<S>& r) {
    status.push_back(r.status);
    if (r.updated()) {
      ratios.push_back(static_cast<double>(r.stick_ratio));
      sds.push_back(static_cast<double>(r.ratio_sd));
      angles.push_back(static_cast<double>(angle_of(r)));
      scales.push_back(static_cast<double>(r.scale));
      furthest.push_back(static_cast<double>(r.furthest));
      const Index middle = stick.rows() / 2;
      slips.push_back(static_cast<double>(stick.slips()(middle, middle + 2).x));
    }
  }
};

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = a.size() == b.size() ? 0 : 1e9;
  for (std::size_t k = 0; k < a.size() && k < b.size(); ++k) {
    largest = std::max(largest, std::abs(a[k] - b[k]));
  }
  return largest;
}

void check(const Answers& a, const Answers& exact, double tolerance) {
  CAPTURE(tolerance);
  CHECK(a.status == exact.status);
  CHECK(largest_difference(a.ratios, exact.ratios) < 1e-6);  // the same dots stick
  CHECK(largest_difference(a.sds, exact.sds) < 100 * tolerance);
  CHECK(largest_difference(a.angles, exact.angles) < tolerance);
  CHECK(largest_difference(a.scales, exact.scales) < tolerance);
  CHECK(largest_difference(a.furthest, exact.furthest) < 10 * tolerance);
  CHECK(largest_difference(a.slips, exact.slips) < 100 * tolerance);
}

/// Free frames, then dots in the image that are dragged, turned and enlarged while they begin to
/// slip; positions that float holds exactly.
template <class S>
Answers in_image() {
  SlippingDots truth({.rows = 11, .cols = 11, .contact_pitches = 5.2});
  test::Random random(3);
  StickRatio<S> stick(11, 11);
  Answers answers;
  for (int k = 0; k < 20; ++k) {
    auto dots = noisy(truth.dots, 0.06, random);
    for (auto& p : dots.cells) {
      p = {static_cast<double>(static_cast<float>(p.x)),
           static_cast<double>(static_cast<float>(p.y))};
    }
    answers.add(stick, stick(dots, k < 10 ? ContactFlags(11, 11, 0) : truth.contact));
    if (k >= 10) {
      truth.step({.shift_px = 2.5,
                  .direction_rad = random.uniform(-0.5, 0.5),
                  .turn_rad = random.uniform(-0.03, 0.03),
                  .zoom = random.uniform(0.98, 1.02),
                  .stick_share = random.uniform(0.4, 0.9)});
    }
  }
  return answers;
}

/// Free frames, then a patch that is rolled, dragged and rotated while it begins to slip.
template <class S>
Answers in_space() {
  StickRatio<S> stick(21, 21, {.noise = 0.005});
  test::Random random(2);
  test::SlippingPatch patch;
  Answers answers;
  for (int k = 0; k < 24; ++k) {
    const bool free = k < 10;
    const auto dots = noisy(patch.dots, 0.005, 0.025, random);
    answers.add(stick, stick(dots, free ? ContactFlags(21, 21, 0) : patch.contact));
    patch.step(free ? test::moved_by({0, 0, 0}, {0, 0, 0}, {0, 0, 0})
                    : test::moved_by({0.002, 0.003, 0.01}, {0, 0, 28}, {0.17, 0.05, 0}),
               1.2 - 0.02 * k);
  }
  return answers;
}

/// One frame after another.
StickResult<> between(const PointsPx& before, const PointsPx& after, const ContactFlags& contact) {
  StickRatio<> stick(contact.rows(), contact.cols(), {.noise = 0.06});
  (void)stick(before, contact);
  return stick(after, contact);
}

}  // namespace

TEST_CASE("stick ratios follow 50 digits", "[stick_ratio]") {
  const Answers image = in_image<Digits50>(), space = in_space<Digits50>();
  CHECK(image.ratios.size() >= 6);
  CHECK(space.ratios.size() >= 6);
  check(in_image<double>(), image, 1e-12);
  check(in_image<long double>(), image, 1e-12);
  check(in_image<float>(), image, 2e-5);
  check(in_space<double>(), space, 1e-10);
  check(in_space<float>(), space, 2e-4);
}

TEST_CASE("angles near half a turn do not wrap", "[stick_ratio]") {
  const SlippingPattern pattern{.rows = 11, .cols = 11, .contact_pitches = 5.2};
  for (const double angle : {pi - 1e-6, pi - 0.01, -pi + 1e-6, -pi + 0.01, 3.0, -3.0, pi / 2}) {
    SlippingDots truth(pattern);
    const PointsPx before = truth.dots;
    truth.step({.shift_px = 3, .direction_rad = 1, .turn_rad = angle});
    const auto r = between(before, truth.dots, truth.contact);
    REQUIRE(r.updated());
    CHECK(angle_of(r) == Approx(angle).margin(1e-10));
    CHECK(r.scale == Approx(1).margin(1e-9));
    CHECK(r.stick_ratio == 1);
  }
}

TEMPLATE_TEST_CASE(
    "stick ratio: a frame allocates nothing", "[stick_ratio]", float, double, long double) {
  const long before_all = test::allocations();
  StickRatio<TestType> stick(21, 21, {.noise = 0.14});
  CHECK(test::allocations() > before_all);  // all memory is allocated here
  test::SlippingDots truth;
  test::Random random(1);
  const test::ContactFlags nothing(21, 21);
  long taken = 0;
  int updated = 0;
  const auto steps = test::steps_of(test::SlipScene::everything, 1);
  for (int k = 0; k < 100; ++k) {
    truth.step(steps[static_cast<std::size_t>(k) % steps.size()]);
    auto dots = noisy(truth.dots, 0.14, random);
    dots(10, 10).x = test::nan;
    if (k == 40) {
      dots = test::PointsPx(21, 21, {test::nan, test::nan});
    }
    const auto& contact = k == 50 ? nothing : truth.contact;
    const double time_s = k == 60 ? -1 : k;  // backward once
    const long before = test::allocations();
    const auto r = stick(dots, contact, time_s);
    taken += test::allocations() - before;
    updated += r.updated() ? 1 : 0;
  }
  CHECK(updated > 60);
  CHECK(taken == 0);
  const StickRatio<TestType> fresh(21, 21, {.noise = 0.14});
  const long before = test::allocations();
  stick.reset();
  stick = fresh;
  CHECK(test::allocations() == before);
}
