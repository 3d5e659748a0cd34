// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/slip/spatial_stick_ratio.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "support/slipping_patch.hpp"

using namespace fingerpad;
using test::SlippingPatch;

namespace {

using Dots = test::Image<Point3<double>>;
using Flags = test::Image<std::uint8_t>;
using States = test::Image<DotState>;
const Point3<double> missing{test::nan, test::nan, test::nan};

struct Follower {
  SpatialStickRatio<double> ratio;
  SpatialStickRatio<double>::State state;
  States states{21, 21};

  explicit Follower(const SpatialStickTest& test = {})
      : ratio(21, 21, test), state(ratio.start()) {}
  SpatialStickResult<double> operator()(const Dots& dots, const Flags& contact) {
    return ratio(dots, contact, states, state);
  }
};

constexpr double degree = 0.017453292519943295;

}  // namespace

TEST_CASE("stick ratio in space: what moves as one sticks, and its motion is found",
          "[spatial_stick]") {
  // A ball rolls by 2 degrees about y. In the image no shift, rotation and scale fit its dots.
  for (const auto& motion :
       {test::moved_by({0, 2 * degree, 0}, {0, 0, 28}, {0, 0, 0}),
        test::moved_by({1 * degree, -1 * degree, 3 * degree}, {2, 1, 15}, {0.3, 0.1, 0.2}),
        test::moved_by({0, 0, 0}, {0, 0, 0}, {0, 0, -0.4})}) {
    SlippingPatch patch;
    Follower f;
    CHECK(f(patch.dots, patch.contact).status == StickStatus::no_reference);
    patch.step(motion);
    const auto r = f(patch.dots, patch.contact);
    REQUIRE(r.updated());
    CHECK(r.ok());
    CHECK(r.stick_ratio == 1);
    CHECK(r.reference_age == 1);
    CHECK((r.slip == 0 && r.unknown == 0 && r.out_of_place == 0));
    CHECK(r.stick == std::count(patch.contact.cells.begin(), patch.contact.cells.end(), 1));
    CHECK(angle_between(r.motion.rotation, motion.rotation) < 1e-6);
    CHECK(norm(r.motion({1, 2, 10}) - motion({1, 2, 10})) < 1e-6);
    CHECK(r.ratio_sd < 0.01);
  }
}

TEST_CASE("stick ratio in space: dots that stay behind slip, by how much is known",
          "[spatial_stick]") {
  SlippingPatch patch;
  Follower f;
  (void)f(patch.dots, patch.contact);
  const auto motion = test::moved_by({0, 0, 0}, {0, 0, 0}, {0.3, 0.1, 0});
  patch.step(motion, 0.7);
  const auto r = f(patch.dots, patch.contact);
  REQUIRE(r.updated());
  CHECK(r.stick_ratio == Approx(patch.stick_ratio()).margin(0.1));
  const auto slips = f.state.slips();
  double worst = 0;
  for (Index i = 0; i < 21; ++i) {
    for (Index j = 0; j < 21; ++j) {
      CAPTURE(i, j);
      const DotSlip<double> dot = slips(i, j);
      if (patch.contact(i, j) == 0) {
        CHECK(!is_finite(dot.slip_mm));
        CHECK(f.states(i, j) == DotState::none);
        continue;
      }
      CHECK(dot.sd_mm == Approx(0.005 * std::sqrt(2.0)).epsilon(0.01));
      if (patch.slipped_mm(i, j) > 0.25) {  // beyond the gate nothing is averaged
        CHECK(f.states(i, j) == DotState::slip);
        // against the motion, in the plane: the dot stayed behind
        const double lag = patch.slipped_mm(i, j) / std::hypot(0.3, 0.1);
        worst = std::max(worst, std::hypot(dot.slip_mm.x + 0.3 * lag, dot.slip_mm.y + 0.1 * lag));
      }
    }
  }
  CHECK(worst < 0.01);
}

TEST_CASE("stick ratio in space: reference, contact and time as in the image", "[spatial_stick]") {
  SlippingPatch patch;
  Follower f;
  const double step_mm = f.ratio.reference_mm() / 3.2;
  const auto motion = test::moved_by({0, 0, 0}, {0, 0, 0}, {step_mm, 0, 0});
  CHECK(f(patch.dots, patch.contact).status == StickStatus::no_reference);
  CHECK(f(patch.dots, patch.contact).status == StickStatus::standing);
  for (int k = 0; k < 3; ++k) {
    patch.step(motion);
    CHECK(f(patch.dots, patch.contact).status == StickStatus::no_reference);
  }
  patch.step(motion);
  CHECK(f(patch.dots, patch.contact).updated());
  // at rest the frame is compared again, so the answer is fresh
  const auto again = f(patch.dots, patch.contact);
  CHECK(again.updated());
  CHECK(again.stick_ratio == 1);
  // backward: beyond the turning point there is no reference
  const auto back = test::moved_by({0, 0, 0}, {0, 0, 0}, {-step_mm, 0, 0});
  patch.step(back);
  CHECK(f(patch.dots, patch.contact).status == StickStatus::no_reference);
  SECTION("lost contact forgets, lost dots do not") {
    const Index stored = f.state.stored_frames();
    CHECK(f(Dots(21, 21, missing), patch.contact).status == StickStatus::no_dots);
    CHECK(f.state.stored_frames() == stored);
    const auto free = f(patch.dots, Flags(21, 21, 0));
    CHECK(free.status == StickStatus::no_contact);
    CHECK(!free.ok());
    CHECK(f.state.stored_frames() == 0);
    CHECK(std::count(f.states.cells.begin(), f.states.cells.end(), DotState::none) == 441);
  }
}

TEST_CASE("stick ratio in space: a mask that flickers, a clock that is late", "[spatial_stick]") {
  SlippingPatch patch;
  Follower f;
  const Flags none(21, 21, 0);
  const auto motion = test::moved_by({0, 0, 0}, {0, 0, 0}, {0.3, 0, 0});
  const auto at = [&](double time_s, const Flags& contact) {
    return f.ratio(patch.dots, contact, f.states, f.state, time_s);
  };
  (void)at(5, patch.contact);
  CHECK(at(5.15, none).status == StickStatus::no_contact);
  patch.step(motion);
  const auto r = at(5.1, patch.contact);  // 0.05 s late
  CHECK(r.updated());
  CHECK(r.reference_age == 2);
  CHECK(at(5.4, none).status == StickStatus::no_contact);
  CHECK(f.state.stored_frames() == 0);
  (void)at(6, patch.contact);
  patch.step(motion);
  CHECK(at(5, patch.contact).status == StickStatus::restarted);
  patch.step(motion);
  CHECK(at(5.01, patch.contact).updated());
}

TEST_CASE("stick ratio in space: dots that fall back to where they are on the free pad",
          "[spatial_stick]") {
  SlippingPatch patch;
  Follower f, knows_no_free;
  (void)f(patch.dots, Flags(21, 21, 0));
  const auto to = test::moved_by({0, 0, 0}, {0, 0, 0}, {0.6, 0, 0.4});
  const auto fro = test::moved_by({0, 0, 0}, {0, 0, 0}, {-0.2, 0, 0});
  const auto aside = test::moved_by({0, 0, 0}, {0, 0, 0}, {0, 0.2, 0});
  for (Follower* of : {&f, &knows_no_free}) {
    (void)(*of)(patch.dots, patch.contact);
  }
  patch.step(to, 0.7);
  const auto before = f(patch.dots, patch.contact);
  REQUIRE(before.updated());
  CHECK(!is_finite(before.back.stick_ratio));
  CHECK(knows_no_free(patch.dots, patch.contact).updated());
  SECTION("back: as one, whether the object carries them or lets them go") {
    const auto states = f.states.cells;
    patch.step(fro);
    const auto r = f(patch.dots, patch.contact);
    CHECK(r.status == StickStatus::falls_back);
    CHECK(r.stick_ratio == before.stick_ratio);  // the last answer is kept
    CHECK(f.states.cells == states);
    CHECK(r.back.stick_ratio == 1);
    CHECK(r.back.reference_age == 1);
    CHECK(knows_no_free(patch.dots, patch.contact).updated());
  }
  SECTION("aside they tell what they always do") {
    patch.step(aside);
    CHECK(f(patch.dots, patch.contact).updated());
  }
}

TEST_CASE("stick ratio in space, bad input", "[spatial_stick]") {
  const auto motion = test::moved_by({0, 1 * degree, 0}, {0, 0, 28}, {0.1, 0, 0});
  const double infinity = std::numeric_limits<double>::infinity();
  SECTION("missing dots are unknown and poison nothing") {
    for (const Point3<double>& bad :
         {missing, Point3<double>{test::nan, 0, 10}, Point3<double>{0, infinity, 10},
          Point3<double>{0, 0, 1e200}, Point3<double>{0, 0, test::nan}}) {
      SlippingPatch patch;
      Follower f;
      (void)f(patch.dots, patch.contact);
      patch.step(motion);
      Dots dots = patch.dots;
      dots(10, 10) = bad;
      dots(8, 11) = bad;
      const auto r = f(dots, patch.contact);
      REQUIRE(r.updated());
      CHECK(r.stick_ratio == 1);
      CHECK(f.states(10, 10) == DotState::unknown);
      CHECK(r.unknown == 2);
      CHECK(!is_finite(f.state.slips()(10, 10).slip_mm));
    }
  }
  SECTION("exchanged dots are out of place") {
    SlippingPatch patch;
    Follower f;
    (void)f(patch.dots, patch.contact);
    patch.step(motion);
    Dots dots = patch.dots;
    std::swap(dots(10, 10), dots(12, 9));
    const auto r = f(dots, patch.contact);
    REQUIRE(r.updated());
    CHECK(r.out_of_place >= 2);
    CHECK(r.slip == 0);
  }
  SECTION("dots marked as lost by a place, in no order, in another unit") {
    SlippingPatch patch;
    Follower f, shuffled, metres;
    const auto in_metres = [](Dots dots) {
      for (auto& p : dots.cells) {
        p = p / 1000.0;
      }
      return dots;
    };
    (void)f(patch.dots, patch.contact);
    (void)shuffled(patch.dots, patch.contact);
    CHECK(metres(in_metres(patch.dots), patch.contact).status == StickStatus::wrong_scale);
    patch.step(motion);
    Dots dots = patch.dots;
    for (std::size_t k = 0; k < 441; k += 3) {
      dots.cells[k] = {0, 0, 0};
    }
    const auto r = f(dots, patch.contact);
    REQUIRE(r.updated());
    CHECK(r.slip == 0);
    CHECK(r.unknown > 0);
    dots = patch.dots;
    test::Random random(2);
    for (Index k = 440; k > 0; --k) {
      std::swap(dots.cells[static_cast<std::size_t>(k)],
                dots.cells[static_cast<std::size_t>(random.whole(0, k))]);
    }
    CHECK(shuffled(dots, patch.contact).status == StickStatus::not_in_order);
  }
  SECTION("few dots, dots on a line, dots in one place") {
    SlippingPatch patch;
    for (const int kind : {0, 1, 2}) {
      Follower f;
      Flags contact(21, 21, 0);
      Dots before = patch.dots;
      for (Index j = 0; j < 21; ++j) {
        contact(10, j) = 1;
        contact(11, j) = kind == 0 ? 0 : 1;
      }
      if (kind == 0) {
        contact = Flags(21, 21, 0);
        contact(10, 10) = contact(10, 11) = contact(11, 10) = 1;
      }
      if (kind == 2) {
        before = Dots(21, 21, {1, 2, 3});
      }
      (void)f(before, contact);
      for (auto& p : before.cells) {
        p.x += 0.5;
      }
      const auto r = f(before, contact);
      CHECK((!r.updated() || r.stick_ratio == 1));
    }
  }
  SECTION("other sizes and foreign states are refused") {
    SlippingPatch patch;
    Follower f;
    CHECK(!f(Dots(20, 21, missing), patch.contact).accepted());
    CHECK(!f(patch.dots, Flags(21, 20, 1)).accepted());
    auto other = SpatialStickRatio<double>(21, 21, {.capacity = 3}).start();
    const auto refused = f.ratio(patch.dots, patch.contact, f.states, other);
    CHECK(refused.status == StickStatus::refused);
    CHECK(!refused.ok());
    CHECK((refused.dots_in_contact() == 0 && refused.out_of_place == 0));
  }
}

namespace {

/// Dots of the given places in a grid with a border, `columns` wide without it, which do not move.
detail::stick::SpatialPairs<double> pairs_at(const std::vector<Point3<double>>& places,
                                             Index columns) {
  detail::stick::SpatialPairs<double> pairs(places.size());
  const auto padded = [columns](Index row, Index col) {
    return static_cast<std::size_t>((row + 1) * (columns + 2) + col + 1);
  };
  const Index rows = (static_cast<Index>(places.size()) + columns - 1) / columns;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto cell = static_cast<Index>(k);
    pairs.add(cell, padded(cell / columns, cell % columns), padded(rows + 2, 0), places[k],
              places[k]);
  }
  return pairs;
}

/// The weights with which the slip at (0, 0) enters the sums around (-2, -2) to (2, 2).
std::array<double, 25> weights_around() {
  using Slip = detail::stick::SmallSlip<double>;
  std::vector<Slip> room(49, Slip{0, 0, 0, 0});
  room[24] = {0, 0, 0, 1};
  std::array<double, 25> weights;
  for (std::size_t k = 0; k < 25; ++k) {
    weights[k] = detail::stick::sum_around(&room[(k / 5 + 1) * 7 + k % 5 + 1], 7)[3];
  }
  return weights;
}

}  // namespace

TEST_CASE("stick ratio in space: a quadratic surface is found from any number of dots on it",
          "[spatial_stick]") {
  const auto height = [](double x, double y) {
    return 10 + 0.1 * x - 0.2 * y + 0.03 * x * x + 0.02 * x * y - 0.04 * y * y;
  };
  for (std::size_t count = 12; count <= 24; ++count) {
    std::vector<Point3<double>> places;
    for (std::size_t k = 0; k < count; ++k) {
      const double x = 1.5 * static_cast<double>(k % 4), y = 1.5 * static_cast<double>(k / 4);
      places.push_back({x, y, height(x, y)});
    }
    const auto surface = detail::stick::quadric_through(pairs_at(places, 4));
    CAPTURE(count);
    for (const auto& p : places) {
      const Point2<double> slope = surface.slope(p);
      CHECK(slope.x == Approx(0.1 + 0.06 * p.x + 0.02 * p.y).margin(1e-9));
      CHECK(slope.y == Approx(-0.2 + 0.02 * p.x - 0.08 * p.y).margin(1e-9));
    }
  }
}

TEST_CASE("stick ratio in space: the noise that a mean over neighbours leaves", "[spatial_stick]") {
  double sum = 0, squares = 0;
  for (const double weight : weights_around()) {
    sum += weight;
    squares += weight * weight;
  }
  CHECK(detail::stick::neighbour_gain() == Approx(std::sqrt(squares) / sum).epsilon(1e-15));
}

TEST_CASE("stick ratio in space: weights by the dots that slip least", "[spatial_stick]") {
  auto pairs = pairs_at(std::vector<Point3<double>>(11, {0, 0, 0}), 11);
  pairs.for_each([](auto& b, std::size_t k) { b.slip_sq[k] = static_cast<double>(b.cell[k] + 1); });
  std::vector<double> sorted(11);
  detail::stick::weigh_nearest(4, sorted, pairs);
  // the slip of rank 4, from 0, is the standard deviation: its square is 5
  pairs.for_each([](const auto& b, std::size_t k) {
    CHECK(b.weight[k] == Approx(std::exp(-b.slip_sq[k] / 10)));
  });
}

TEST_CASE("stick ratio in space: the doubts of neighbours are correlated as their means are",
          "[spatial_stick]") {
  // A dot at the limit and another one. Means that share neighbours have the correlation r, and
  // answers then have (2 / pi) asin(r) (Sheppard 1899).
  const auto variance_with = [](Index other) {
    constexpr Index columns = 9;
    const double limit = 3;
    detail::stick::SpatialPairs<double> pairs(2);
    for (const Index cell : {Index(0), other}) {
      const auto padded =
          static_cast<std::size_t>((cell / columns + 1) * (columns + 2) + cell % columns + 1);
      pairs.add(cell, padded, 0, {0, 0, 0}, {0, 0, 0});
    }
    pairs.for_each([&](auto& b, std::size_t k) {
      b.mean_sq[k] = limit * limit;
      b.mean_slip.set(k, {limit, 0, 0});
      b.by_u.set(k, {1, 0, 0});
      b.by_v_x[k] = 0;
      b.by_v_y[k] = 1;
      b.total_weight[k] = 18;
    });
    detail::stick::DotDoubts<double> doubts({9, columns});
    return detail::stick::stick_variance(pairs, limit * limit, detail::zero_matrix<double, 6>(),
                                         {0, 0, 0}, doubts);
  };
  const auto weights = weights_around();
  const auto correlation = [&](std::size_t rows, std::size_t cols) {
    double shared = 0, own = 0;
    for (std::size_t i = 0; i < 5; ++i) {
      for (std::size_t j = 0; j < 5; ++j) {
        const double here = weights[5 * i + j];
        own += here * here;
        shared += i + rows < 5 && j + cols < 5 ? here * weights[5 * (i + rows) + j + cols] : 0;
      }
    }
    return shared / own;
  };
  const double apart = variance_with(5);
  REQUIRE(apart > 0);
  const auto expected = [&](std::size_t rows, std::size_t cols) {
    return 1 + 2 / std::numbers::pi * std::asin(correlation(rows, cols));
  };
  CHECK(variance_with(1) / apart == Approx(expected(0, 1)).epsilon(1e-12));
  CHECK(variance_with(9) / apart == Approx(expected(1, 0)).epsilon(1e-12));
  CHECK(variance_with(10) / apart == Approx(expected(1, 1)).epsilon(1e-12));
}

TEST_CASE("stick ratio in space: doubts add up alike along both diagonals", "[spatial_stick]") {
  const detail::stick::SharedDoubt shared(6, 2, 1);
  for (const auto& [a, b, part] : {std::tuple{DotIndex{0, 0}, DotIndex{1, 1}, shared.diagonal},
                                   std::tuple{DotIndex{0, 1}, DotIndex{1, 0}, shared.diagonal},
                                   std::tuple{DotIndex{0, 0}, DotIndex{0, 1}, shared.beside},
                                   std::tuple{DotIndex{0, 0}, DotIndex{1, 0}, shared.beside},
                                   std::tuple{DotIndex{0, 0}, DotIndex{2, 0}, 0.0}}) {
    CAPTURE(a.row, a.col, b.row, b.col);
    detail::stick::DotDoubts<double> doubts({3, 2});
    doubts.set(a, 0.3);
    doubts.set(b, 0.5);
    CHECK(doubts.variance(shared) == Approx(0.09 + 0.25 + 2 * part * 0.3 * 0.5).epsilon(1e-14));
  }
}

TEST_CASE("stick ratio in space: the mean of equal slips along the surface is that slip",
          "[spatial_stick]") {
  namespace stick = detail::stick;
  const Point2<double> slope = {0.4, -0.7};
  std::vector<Point3<double>> places;
  for (Index k = 0; k < 20; ++k) {
    const double x = 1.5 * static_cast<double>(k % 4), y = 1.5 * static_cast<double>(k / 4);
    places.push_back({x, y, 10 + slope.x * x + slope.y * y});
  }
  for (const double depth_info : {0.25, 4.0, 100.0}) {
    CAPTURE(depth_info);
    const stick::AxisNoise<double> noise = {9, depth_info};
    for (const auto& [x, y] : {std::pair{0.2, 0.0}, {0.0, 0.3}, {-0.1, 0.2}}) {
      const Point3<double> slip = {x, y, slope.x * x + slope.y * y};
      auto pairs = pairs_at(places, 4);
      stick::set_surface(noise, pairs);
      stick::set_slips(Pose<double>{{}, Point3<double>{0, 0, 0} - slip}, pairs);
      std::vector<stick::SmallSlip<double>> room(6 * 10, {0, 0, 0, 0});
      stick::average_slips(1e9, noise, 6, room, pairs);
      pairs.for_each([&](const auto& b, std::size_t k) {
        CHECK(norm(b.mean_slip[k] - slip) < 1e-12);
        CHECK(b.mean_sq[k] == Approx(b.slip_sq[k]));
      });
    }
  }
}

TEST_CASE("stick ratio in space: a motion changes averaged slips as its derivatives say",
          "[spatial_stick]") {
  namespace stick = detail::stick;
  constexpr double step = 1e-6;
  const Point3<double> center = {0.5, -1, 9}, at = {2, 3, 10.5};
  const Point3<double> by_u = {3, -2, 0.8}, slip = {0.3, 0.2, -0.4};
  const Point2<double> by_v = {1.5, 2.5};
  const auto magnitude = [&](const Point3<double>& m) {
    return std::hypot(dot(by_u, m), by_v.x * m.x + by_v.y * m.y);
  };
  stick::PairBlock<double> b{};
  stick::SlipNoise<double> noise{};
  b.now.fill(at);
  b.mean_slip.fill(slip);
  b.by_u.fill(by_u);
  b.by_v_x.fill(by_v.x);
  b.by_v_y.fill(by_v.y);
  noise.m.fill(magnitude(slip));
  // any symmetric matrix will do
  auto covariance = detail::zero_matrix<double, 6>();
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t j = 0; j < 6; ++j) {
      covariance[i][j] = std::cos(static_cast<double>(i * j)) + (i == j ? 6 : 0);
    }
  }
  stick::MotionEffect<double> of;
  stick::set_effect_of_motion(b, covariance, center, noise, of);
  double variance = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    CAPTURE(i);
    Point3<double> axis = {i % 3 == 0 ? 1.0 : 0.0, i % 3 == 1 ? 1.0 : 0.0, i % 3 == 2 ? 1.0 : 0.0};
    const Point3<double> moved = step * (i < 3 ? cross(axis, at - center) : axis);
    const double slope = (magnitude(slip + moved) - magnitude(slip - moved)) / (2 * step);
    CHECK(of.by[i][3] == Approx(slope).epsilon(1e-7));
    for (std::size_t j = 0; j < 6; ++j) {
      variance += covariance[i][j] * of.by[i][3] * of.by[j][3];
    }
  }
  CHECK(of.variance[3] == Approx(variance).epsilon(1e-13));
}

TEST_CASE("stick ratio in space: the noise along the pad is at least a 2000th of a pitch",
          "[spatial_stick]") {
  // level dots on a pitch of 3 mm; U follows from the noise
  const auto status = [](double moved_mm) {
    Follower f({.lateral_mm = 1e-9});
    const Flags contact(21, 21, 1);
    Dots dots(21, 21);
    StickStatus last = StickStatus::refused;
    for (const double x : {0.0, moved_mm}) {
      for (Index k = 0; k < 441; ++k) {
        dots(k / 21, k % 21) = {3.0 * static_cast<double>(k % 21) + x,
                                3.0 * static_cast<double>(k / 21), 10};
      }
      last = f(dots, contact).status;
    }
    return last;
  };
  const double reference_mm = SpatialStickRatio<double>(21, 21).reference_mm(3.0 / 2000);
  CHECK(status(0.9999 * reference_mm) == StickStatus::no_reference);
  CHECK(status(1.0001 * reference_mm) == StickStatus::updated);
}

TEST_CASE("stick ratio in space: before any frame there is neither a ratio nor a reference",
          "[spatial_stick]") {
  const SpatialStickResult<double> none;
  CHECK((!none.accepted() && !none.ok() && !none.updated()));
  CHECK((none.dots_in_contact() == 0 && none.out_of_place == 0));
  CHECK((none.reference_age == 0 && none.furthest_mm == 0));
  Follower f;
  const auto first = f(SlippingPatch().dots, SlippingPatch().contact);
  CHECK(first.status == StickStatus::no_reference);
  CHECK((first.reference_age == 0 && first.furthest_mm == 0 && !first.ok()));
}

TEST_CASE("stick ratio in space: a pad seen in a mirror moves as the mirrored object",
          "[spatial_stick]") {
  const auto mirrored = [](Point3<double> p, int axis) {
    (axis == 0 ? p.x : axis == 1 ? p.y : p.z) *= -1;
    return p;
  };
  for (const int axis : {0, 1, 2}) {
    CAPTURE(axis);
    SlippingPatch patch;
    Follower f, other;
    test::Random random(5);
    const auto step = test::moved_by({0.01, 0.02, 0.01}, {1, 0, 28}, {0.1, 0.1, 0.02});
    for (int k = 0; k < 4; ++k) {
      const Dots seen = noisy(patch.dots, 0.005, 0.025, random);
      Dots in_mirror = seen;
      for (auto& p : in_mirror.cells) {
        p = mirrored(p, axis);
      }
      const auto r = f(seen, patch.contact), m = other(in_mirror, patch.contact);
      CHECK(r.updated() == (k > 0));
      CHECK(m.status == r.status);
      CHECK(m.stick == r.stick);
      for (const Point3<double>& p : {Point3<double>{0, 0, 10}, {3, 0, 10}, {0, 3, 10}}) {
        CHECK(norm(m.motion(mirrored(p, axis)) - mirrored(r.motion(p), axis)) < 1e-12);
      }
      patch.step(step, 0.7);
    }
  }
}

TEST_CASE("stick ratio in space: bad parameters are refused by name, value and range",
          "[spatial_stick]") {
  const auto with = [](const SpatialStickTest& test) {
    return test::refusal([&] { SpatialStickRatio<double>(9, 9, test); });
  };
  CHECK(with({}) == "accepted");
  CHECK(with({.lateral_mm = 0}) == "SpatialStickTest: lateral_mm = 0, must be finite and > 0");
  CHECK(with({.depth_mm = -1}) == "SpatialStickTest: depth_mm = -1, must be finite and > 0");
  CHECK(with({.slip_share = 0.6}) == "SpatialStickTest: slip_share = 0.6, must be in (0, 0.5]");
  CHECK(with({.false_slip = 0}) == "SpatialStickTest: false_slip = 0, must be in (0, 0.5]");
  CHECK(with({.hold_s = -1}) == "SpatialStickTest: hold_s = -1, must be finite and >= 0");
  CHECK(with({.min_dots = 5}) == "SpatialStickTest: min_dots = 5, must be >= 6");
  CHECK(with({.capacity = 0}) == "SpatialStickTest: capacity = 0, must be in [1, 4096]");
  CHECK(test::refusal([] { SpatialStickRatio<double>(0, 9); }) ==
        "SpatialStickRatio: rows = 0, must be in [1, 1000000]");
}

TEST_CASE("stick ratio in space: noise makes as many dots slip as was asked", "[spatial_stick]") {
  // All dots stick. The threshold is for 1 % of dots; the averaged slips of neighbours are
  // correlated.
  double slip = 0, all = 0, sd = 0, sum = 0, squares = 0;
  int frames = 0;
  test::Random random(5);
  for (int n = 0; n < 60; ++n) {
    SlippingPatch patch;
    Follower f;
    (void)f(noisy(patch.dots, 0.005, 0.025, random), patch.contact);
    patch.step(test::moved_by({0, 0.6 * degree, 0}, {0, 0, 28}, {0, 0, 0}));  // just beyond U
    const auto r = f(noisy(patch.dots, 0.005, 0.025, random), patch.contact);
    if (r.updated()) {
      slip += static_cast<double>(r.slip);
      all += static_cast<double>(r.slip + r.stick);
      sd += square(r.ratio_sd);
      sum += r.stick_ratio;
      squares += square(r.stick_ratio);
      ++frames;
    }
  }
  REQUIRE(frames > 30);
  const double scatter = std::sqrt(squares / frames - square(sum / frames));
  CAPTURE(slip / all, std::sqrt(sd / frames), scatter);
  CHECK(slip / all < 0.03);
  // dots that noise brings near the limit are known to stick by all the others
  CHECK(std::sqrt(sd / frames) > scatter);
  CHECK(std::sqrt(sd / frames) < 1.25 * scatter);
}

TEST_CASE("stick ratio in space: its standard deviation is the scatter of its answers",
          "[spatial_stick][figures]") {
  constexpr int answers = 100;
  test::Random random(5);
  for (const double share : {0.7, 0.9}) {
    double sum = 0, squares = 0, told = 0;
    for (int n = 0; n < answers; ++n) {
      SlippingPatch patch(1.5, 9.05);
      Follower f;
      (void)f(noisy(patch.dots, 0.005, 0.025, random), patch.contact);
      patch.step(test::moved_by({0, 0, 0}, {0, 0, 28}, {0.25, 0.05, 0}), share);
      const auto r = f(noisy(patch.dots, 0.005, 0.025, random), patch.contact);
      REQUIRE(r.updated());
      sum += r.stick_ratio;
      squares += square(r.stick_ratio);
      told += square(r.ratio_sd);
    }
    const double scatter = std::sqrt(squares / answers - square(sum / answers));
    CAPTURE(share, scatter, std::sqrt(told / answers));
    CHECK(std::sqrt(told / answers) > 0.75 * scatter);  // measured: 0.95 to 1.5
    CHECK(std::sqrt(told / answers) < 1.75 * scatter);
  }
}

namespace {

/// Variance of the answers for one contact whose dots are found again and again, and the mean
/// square of their standard deviations.
struct Spread {
  double scatter_sq = 0, told_sq = 0, contacts = 0;

  Spread& operator+=(const Spread& other) {
    scatter_sq += other.scatter_sq;
    told_sq += other.told_sq;
    contacts += other.contacts;
    return *this;
  }
  double told() const { return std::sqrt(told_sq / contacts); }
  double scatter() const { return std::sqrt(scatter_sq / contacts); }
};

/// A random motion, hardly beyond U, of a patch of which a disc sticks; `noise` is a factor of the
/// usual noise. `rim`: as in SlippingPatch::step().
Spread spread_of(
    double noise, double pitch_mm, double stick_share, double rim, test::Random& random) {
  constexpr int answers = 40;
  const double lateral_mm = 0.005 * noise, depth_mm = 0.025 * noise;
  const auto any = [&](double size) { return random.uniform(-size, size) * noise; };
  const auto motion = test::moved_by({any(0.001), any(0.001), any(0.003)}, {0, 0, 10},
                                     {noise * random.uniform(0.19, 0.23), any(0.05), any(0.05)});
  SlippingPatch patch(pitch_mm, 9.05);
  const Dots before = patch.dots;
  patch.step(motion, stick_share, rim);
  double sum = 0, squares = 0, told = 0;
  for (int n = 0; n < answers; ++n) {
    Follower f({.lateral_mm = lateral_mm, .depth_mm = depth_mm});
    (void)f(noisy(before, lateral_mm, depth_mm, random), patch.contact);
    const auto r = f(noisy(patch.dots, lateral_mm, depth_mm, random), patch.contact);
    REQUIRE(r.updated());
    sum += r.stick_ratio;
    squares += square(r.stick_ratio);
    told += square(r.ratio_sd);
  }
  return {squares / answers - square(sum / answers), told / answers, 1};
}

}  // namespace

TEST_CASE("stick ratio in space: its standard deviation holds for few and for many dots that stick",
          "[spatial_stick][figures]") {
  // Contacts by the share of their area that sticks; 113 dots, and 41. Measured: 0.7 to 1.53.
  struct Share {
    double from, to;
  };
  test::Random random(11);
  for (const double noise : {0.5, 1.0, 2.0}) {
    for (const double pitch_mm : {1.5, 2.5}) {
      for (const Share& share : {Share{0.05, 0.1}, Share{0.1, 0.2}, Share{0.2, 0.5},
                                 Share{0.5, 0.9}, Share{0.9, 1}, Share{4, 4}}) {
        Spread spread;
        for (int contacts = 0; contacts < 10; ++contacts) {
          const double area = random.uniform(share.from, share.to);
          spread += spread_of(noise, pitch_mm, std::sqrt(area), 3, random);
        }
        CAPTURE(noise, pitch_mm, share.from, share.to, spread.told(), spread.scatter());
        CHECK(spread.told() > 0.6 * spread.scatter());
        CHECK(spread.told() < 1.7 * spread.scatter());
      }
    }
  }
}

TEST_CASE("stick ratio in space: the scatter where most dots stand still as one",
          "[.][spatial_sd]") {
  test::Random random(11);
  for (const double pitch_mm : {1.5, 2.5}) {
    for (const double area : {0.05, 0.1, 0.15, 0.2, 0.3, 0.5}) {
      Spread spread;
      for (int contacts = 0; contacts < 10; ++contacts) {
        spread += spread_of(1, pitch_mm, std::sqrt(area), 1, random);
      }
      WARN("dots " << pitch_mm << " mm apart, " << area << " sticks: " << spread.told() << " for "
                   << spread.scatter());
    }
  }
}

namespace {

/// Free frames of a pad with this noise, shaken and rotated; then a share `wrong` of its dots has
/// wrong positions.
template <class Ratio>
void show_free(const Ratio& ratio,
               typename Ratio::State& state,
               double noise_mm,
               int frames,
               double wrong = 0,
               double depth_noise_mm = 0.025) {
  test::Random random(3);
  SlippingPatch patch;
  States states(21, 21);
  for (int k = 0; k < frames; ++k) {
    patch.step(test::moved_by({0, 0, random.uniform(-0.02, 0.02)}, {1, 0, 0},
                              {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 0}));
    Dots dots = noisy(patch.dots, noise_mm, depth_noise_mm, random);
    for (auto& p : dots.cells) {
      p.x += random.uniform() < wrong ? random.uniform(-1, 1) : 0;
    }
    (void)ratio(dots, Flags(21, 21, 0), states, state);
  }
}

}  // namespace

TEST_CASE("stick ratio in space: noise is measured in the free frames", "[spatial_stick]") {
  const SpatialStickRatio<double> ratio(21, 21);
  for (const double noise_mm : {0.002, 0.005, 0.02}) {
    auto state = ratio.start();
    show_free(ratio, state, noise_mm, 8);
    CHECK(state.lateral_mm() == 0.005);  // too few to measure noise
    state.reset();
    show_free(ratio, state, noise_mm, 20);
    CHECK(state.lateral_mm() == Approx(noise_mm).epsilon(0.05));
    show_free(ratio, state, noise_mm, 100, 0.02);  // one dot in fifty is wrong
    CHECK(state.lateral_mm() == Approx(noise_mm).epsilon(0.15));
    state.reset();
    CHECK(state.lateral_mm() == 0.005);
  }
  auto state = ratio.start();
  show_free(ratio, state, 0, 20);  // a shaken pad has no noise
  CHECK(state.lateral_mm() < 1e-9);
  const SpatialStickRatio<double> given(21, 21, {.free_frames = 0});
  auto unmeasured = given.start();
  show_free(given, unmeasured, 0.02, 20);
  CHECK(unmeasured.lateral_mm() == 0.005);
  CHECK(test::refusal([] { SpatialStickRatio<double>(9, 9, {.free_frames = -1}); }) ==
        "SpatialStickTest: free_frames = -1, must be >= 0");
}

TEST_CASE("stick ratio in space: with the noise of the free frames it says what it says when told",
          "[spatial_stick]") {
  // Four times the noise of the defaults: all dots stick, and few are taken for slipping.
  constexpr double noise_mm = 0.02;
  const SpatialStickRatio<double> measured(21, 21), unmeasured(21, 21, {.free_frames = 0});
  const auto slipping = [&](const SpatialStickRatio<double>& ratio) {
    double slip = 0, all = 0;
    test::Random random(6);
    States states(21, 21);
    for (int n = 0; n < 20; ++n) {
      auto state = ratio.start();
      show_free(ratio, state, noise_mm, 12);
      SlippingPatch patch;
      for (int k = 0; k < 2; ++k) {
        const auto r =
            ratio(noisy(patch.dots, noise_mm, 0.025, random), patch.contact, states, state);
        slip += r.updated() ? static_cast<double>(r.slip) : 0;
        all += r.updated() ? static_cast<double>(r.slip + r.stick) : 0;
        patch.step(test::moved_by({0, 0, 0}, {0, 0, 0}, {0.72, 0, 0}));
      }
    }
    REQUIRE(all > 500);
    return slip / all;
  };
  CHECK(slipping(measured) < 0.03);
  CHECK(slipping(unmeasured) > 0.1);
}
