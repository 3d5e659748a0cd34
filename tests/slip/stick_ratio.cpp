// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/slip/stick_ratio.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "support/slipping_dots.hpp"

using namespace fingerpad;
using test::ContactFlags;
using test::DotStates;
using test::PointsPx;
using test::refusal;
using test::SlippingDots;
using test::SlippingPattern;
using test::SlipStep;

namespace {

const Point2<double> missing{test::nan, test::nan};
const StickTest test_px{.reference = 2, .store = 0.5, .slip = 0.24, .pitch = 1};

/// Dots of 9 x 9, all in contact, displaced by (x, y).
PointsPx shifted(double x, double y = 0, Index rows = 9, Index cols = 9) {
  PointsPx dots(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      dots(i, j) = {100 + 20 * static_cast<double>(j) + x, 100 + 20 * static_cast<double>(i) + y};
    }
  }
  return dots;
}

/// An estimator in double and its results, frame by frame.
template <class Motion = StickConsensus<>,
          class Reference = UpdatedReference,
          class Denoising = ResidualMean>
struct Follower {
  using Ratio = StickRatio<Motion, Reference, Denoising, double>;
  Ratio ratio;
  typename Ratio::State state;
  DotStates states;
  ContactFlags all;
  ContactFlags most;  ///< all but one: a contact with an outline

  explicit Follower(const StickTest& test = {},
                    const Motion& motion = {},
                    const Reference& reference = {},
                    const Denoising& denoising = {},
                    Index rows = 9,
                    Index cols = 9)
      : ratio(rows, cols, test, motion, reference, denoising),
        state(ratio.start()),
        states(rows, cols),
        all(rows, cols, 1),
        most(all) {
    most(rows - 1, cols - 1) = 0;
  }

  StickRatioResult<double> operator()(const PointsPx& dots) { return (*this)(dots, all); }
  StickRatioResult<double> operator()(const PointsPx& dots, const ContactFlags& contact) {
    return ratio(dots, contact, states, state);
  }
  StickRatioResult<double> at(const PointsPx& dots, double time_s) {
    return ratio(dots, all, states, state, time_s);
  }
};

Index count(const DotStates& states, DotState what) {
  return std::count(states.cells.begin(), states.cells.end(), what);
}

template <class S>
bool same(const StickRatioResult<S>& a, const StickRatioResult<S>& b) {
  return a.accepted() == b.accepted() && a.status == b.status && a.stick == b.stick &&
         a.slip == b.slip && a.unknown == b.unknown && a.out_of_place == b.out_of_place &&
         test::same_bits(a.stick_ratio, b.stick_ratio) && a.reference_age == b.reference_age &&
         test::same_bits(a.furthest_px, b.furthest_px) && a.angle_rad == b.angle_rad &&
         a.scale == b.scale && a.reference_dot == b.reference_dot;
}

}  // namespace

TEST_CASE("stick ratio: names of statuses") {
  CHECK(std::string(name_of(StickStatus::updated)) == "updated");
  CHECK(std::string(name_of(StickStatus::standing)) == "standing");
  CHECK(std::string(name_of(StickStatus::no_reference)) == "no reference");
  CHECK(std::string(name_of(StickStatus::falls_back)) == "falls back");
  CHECK(std::string(name_of(StickStatus::too_few_dots)) == "too few dots");
  CHECK(std::string(name_of(StickStatus::no_contact)) == "no contact");
  CHECK(std::string(name_of(StickStatus::no_dots)) == "no dots");
  CHECK(std::string(name_of(StickStatus::wrong_scale)) == "wrong scale");
  CHECK(std::string(name_of(StickStatus::not_in_order)) == "not in order");
  CHECK(std::string(name_of(StickStatus::jumped)) == "jumped");
  CHECK(std::string(name_of(StickStatus::restarted)) == "restarted");
  CHECK(std::string(name_of(StickStatus::no_outline)) == "no outline of the contact");
}

TEST_CASE("stick ratio: numbers of the states of a dot") {
  CHECK(static_cast<int>(DotState::none) == 0);
  CHECK(static_cast<int>(DotState::unknown) == 1);
  CHECK(static_cast<int>(DotState::slip) == 2);
  CHECK(static_cast<int>(DotState::stick) == 3);
}

TEMPLATE_TEST_CASE("stick ratio: what moves as one sticks, and its motion is found",
                   "[stick_ratio]",
                   StickConsensus<>) {
  const double turn_rad = 0.05, zoom = 1.03;
  SlippingDots dots;
  const StickRatio<TestType, UpdatedReference, ResidualMean, double> ratio(21, 21);
  auto state = ratio.start();
  DotStates states(21, 21);
  CHECK(ratio(dots.dots, dots.contact, states, state).status == StickStatus::no_reference);
  const auto before = dots.dots;
  dots.step({.shift_px = 3, .direction_rad = 0.7, .turn_rad = turn_rad, .zoom = zoom});
  const auto r = ratio(dots.dots, dots.contact, states, state);
  REQUIRE(r.accepted());
  REQUIRE(r.updated());
  CHECK(r.stick_ratio == 1);
  CHECK(r.stick == 213);
  CHECK((r.slip == 0 && r.unknown == 0 && r.out_of_place == 0));
  CHECK(r.dots_in_contact() == 213);
  CHECK(r.reference_age == 1);
  CHECK(r.angle_rad == Approx(turn_rad).margin(1e-12));
  CHECK(r.scale == Approx(1 / zoom).margin(1e-12));
  CHECK(r.reference_dot == DotIndex{10, 10});
  double furthest = 0;
  for (Index i = 0; i < 21; ++i) {
    for (Index j = 0; j < 21; ++j) {
      const bool touches = dots.contact(i, j) != 0;
      CHECK(states(i, j) == (touches ? DotState::stick : DotState::none));
      const double moved =
          std::hypot(dots.dots(i, j).x - before(i, j).x, dots.dots(i, j).y - before(i, j).y);
      furthest = touches ? std::max(furthest, moved) : furthest;
    }
  }
  CHECK(r.furthest_px == Approx(furthest).epsilon(1e-12));
}

TEMPLATE_TEST_CASE("stick ratio: dots that stay behind slip",
                   "[stick_ratio]",
                   StickConsensus<>,
                   StickConsensus<Freedom::translation>) {
  SlippingPattern pattern;
  pattern.shear_pitches = 0;
  SlippingDots truth(pattern);
  const StickRatio<TestType> ratio(21, 21);
  auto state = ratio.start();
  DotStates states(21, 21);
  (void)ratio(truth.dots, truth.contact, states, state);
  truth.step({.shift_px = 4, .direction_rad = 1, .stick_share = 0.6});
  const auto r = ratio(truth.dots, truth.contact, states, state);
  REQUIRE(r.updated());
  for (Index i = 0; i < 21; ++i) {
    for (Index j = 0; j < 21; ++j) {
      CAPTURE(i, j);
      CHECK(states(i, j) == (truth.contact(i, j) == 0   ? DotState::none
                             : truth.has_stuck(i, j, 1) ? DotState::stick
                                                        : DotState::slip));
    }
  }
  CHECK(static_cast<double>(r.stick_ratio) == Approx(truth.stick_ratio(1)));
  CHECK(r.stick == count(states, DotState::stick));
  CHECK(r.slip == count(states, DotState::slip));
}

TEST_CASE("stick ratio: the reference is the newest stored frame further than U") {
  Follower<> f;
  const auto expect = [&](double x, StickStatus status, Index age, double furthest) {
    const auto r = f(shifted(x));
    CAPTURE(x, name_of(r.status), r.reference_age);
    CHECK(r.status == status);
    CHECK(r.furthest_px == Approx(furthest).margin(1e-9));
    if (status == StickStatus::updated) {
      CHECK(r.reference_age == age);
      CHECK(r.stick_ratio == 1);
    }
  };
  expect(0, StickStatus::no_reference, 0, 0);
  expect(0, StickStatus::standing, 0, 0);
  expect(0.4, StickStatus::standing, 0, 0.4);  // not stored
  CHECK(f.state.stored_frames() == 1);
  expect(0.5, StickStatus::standing, 0, 0.5);  // not above U_min
  expect(0.625, StickStatus::no_reference, 0, 0.625);
  CHECK(f.state.stored_frames() == 2);
  expect(1.25, StickStatus::no_reference, 0, 0.625);
  expect(2, StickStatus::no_reference, 0, 0.75);  // 2 from the first, not above U
  expect(2.75, StickStatus::updated, 3, 2.125);   // from 0.625
  expect(5, StickStatus::updated, 1, 2.25);       // fast: one frame is enough
}

TEST_CASE("stick ratio: behind a change of direction there is no reference") {
  Follower<> f;
  for (int k = 0; k <= 8; ++k) {  // 0 to 6
    (void)f(shifted(0.75 * k));
  }
  const auto updated = f(shifted(6.75));
  CHECK(updated.updated());
  CHECK(updated.reference_age == 3);
  // backward: the frames of the way there are as near, and more distant ones are not searched
  CHECK(f(shifted(6)).status == StickStatus::no_reference);
  CHECK(f(shifted(5.3)).status == StickStatus::no_reference);
  const auto kept = f(shifted(4.76));  // 1.99 from the turning point
  CHECK(kept.status == StickStatus::no_reference);
  CHECK(kept.stick_ratio == 1);
  CHECK(kept.reference_age == 3);
  const auto again = f(shifted(4));
  CHECK(again.updated());
  CHECK(again.furthest_px == Approx(2.75));
  CHECK(again.reference_age == 4);
}

TEST_CASE("stick ratio: equal distances are no change of direction") {
  Follower<> f;
  (void)f(shifted(0));
  (void)f(shifted(1.5, 0.5));
  (void)f(shifted(1.5, -0.5));
  const auto r = f(shifted(3, 0));
  CHECK(r.updated());
  CHECK(r.reference_age == 3);
}

TEST_CASE("stick ratio: the oldest frame is forgotten") {
  for (const Index capacity : {3, 4}) {
    Follower<> f({}, {}, {.capacity = capacity});
    StickRatioResult<double> r;
    for (int k = 0; k < 20; ++k) {
      r = f(shifted(0.625 * k));
      CHECK(f.state.stored_frames() == std::min<Index>(k + 1, capacity));
    }
    CHECK(r.updated() == (capacity == 4));  // four steps are 2.5 px
  }
}

TEST_CASE("stick ratio: the threshold grows with the displacement") {
  // delta = 0.24 d_max / 2
  for (const double moved_px : {2.5, 4.0, 10.0}) {
    for (const double share : {0.99, 1.01}) {
      Follower<StickConsensus<Freedom::translation>, UpdatedReference, NoDenoising> f;
      (void)f(shifted(0));
      auto dots = shifted(moved_px);
      dots(2, 6).x -= share * 0.12 * moved_px;
      const auto r = f(dots);
      REQUIRE(r.updated());
      CHECK(r.furthest_px == Approx(moved_px));
      CHECK(f.states(2, 6) == (share < 1 ? DotState::stick : DotState::slip));
      CHECK(r.slip == (share < 1 ? 0 : 1));
      CHECK(r.stick_ratio == Approx(1 - static_cast<double>(r.slip) / 81));
    }
  }
}

TEST_CASE("stick ratio: dots in contact only, and those that were") {
  Follower<> f;
  ContactFlags contact(9, 9, 1);
  for (Index i = 0; i < 9; ++i) {
    contact(i, 8) = 0;
  }
  auto dots = shifted(0);
  (void)f(dots, contact);
  dots = shifted(3);
  for (Index i = 0; i < 9; ++i) {
    dots(i, 8).x += 7;  // not in contact: it has no effect, but would be out of line
  }
  auto r = f(dots, contact);
  CHECK(r.updated());
  CHECK(r.furthest_px == Approx(3));
  CHECK(r.stick == 72);
  CHECK(r.dots_in_contact() == 72);
  CHECK(f.states(4, 8) == DotState::none);
  // New dots are unknown until a reference has them; dots that have left contact have no state.
  contact = ContactFlags(9, 9, 1);
  for (Index i = 0; i < 9; ++i) {
    contact(i, 0) = 0;
  }
  r = f(shifted(6), contact);
  CHECK(r.updated());
  CHECK(r.unknown == 9);
  CHECK(f.states(4, 8) == DotState::unknown);
  CHECK(f.states(4, 0) == DotState::none);
  CHECK(r.stick == 63);
  CHECK(r.stick_ratio == 1);
  r = f(shifted(9), contact);
  CHECK(r.unknown == 0);
  CHECK(r.stick == 72);
}

TEST_CASE("stick ratio: the search begins in the last stick region") {
  // The sticking dots lie on the left. In the second step all others, twice as many, stay behind
  // together; the center of the contact is among them.
  const auto run = [](auto motion) {
    Follower<decltype(motion)> f({}, motion);
    (void)f(shifted(0));
    auto dots = shifted(4);
    const auto hold = [&](Index from_col, double x, double y) {
      for (Index i = 0; i < 9; ++i) {
        for (Index j = from_col; j < 9; ++j) {
          dots(i, j) = shifted(x, y)(i, j);
        }
      }
    };
    hold(6, 0, 0);
    const auto first = f(dots, f.most);
    CHECK(first.updated());
    CHECK(first.stick == 54);
    dots = shifted(8, 0);
    hold(4, 4, 0);
    hold(6, 0, 0);
    return f(dots, f.most);
  };
  const auto tracked = run(StickConsensus<Freedom::translation>());
  CHECK(tracked.reference_dot.col < 4);
  CHECK(tracked.stick == 36);
}

TEST_CASE("stick ratio: the search begins in the last stick region, be it the first dot alone") {
  detail::stick::StickState<double> state({3, 3}, 1);
  const auto dots = shifted(0, 0, 3, 3);
  std::vector<Index> touching = {0, 1, 2, 3, 4, 5, 6, 7, 8};
  const auto* const places = dots.cells.data();
  const detail::stick::FramePair<double> pair = {places, places, touching, {3, 3}, 0};
  CHECK(first_dot(pair, state) == 4);  // none sticks: the middle of the contact
  for (const Index k : touching) {
    std::fill(state.marks.begin(), state.marks.end(), DotState::slip);
    state.marks[static_cast<std::size_t>(k)] = DotState::stick;
    state.stick_center = places[k];
    CHECK(first_dot(pair, state) == k);
  }
}

TEMPLATE_TEST_CASE("stick ratio: noise is averaged over neighbours",
                   "[stick_ratio]",
                   ResidualMean,
                   NoDenoising) {
  // Weights 6, 2, 1 leave sqrt(36 + 4 * 4 + 4 * 1) / 18 of the noise. For the remaining noise s,
  // the share p of the dots with all neighbours exceeds a threshold of 2 s sqrt(ln(1 / p)).
  const bool none = std::is_same_v<TestType, NoDenoising>;
  const double left = none ? 1 : std::sqrt(56.0) / 18;
  const double noise_px = 0.05, p = 0.05;
  StickTest test = test_px;
  test.slip = 2 * noise_px * left * std::sqrt(std::log(1 / p)) * 2 / 3;
  double wrong = 0, all = 0;
  test::Random random(7);
  Follower<StickConsensus<>, UpdatedReference, TestType> f(test, {.max_passes = 10}, {}, {}, 21,
                                                           21);
  for (int k = 0; k < 200; ++k) {
    const auto r = f(noisy(shifted(3.0 * (k % 2), 0, 21, 21), noise_px, random), f.most);
    if (!r.updated()) {
      continue;
    }
    const double threshold_share = r.furthest_px / 3;  // the noisiest dot sets it: a little more
    CHECK(threshold_share < 1.1);
    for (Index i = 2; i < 19; ++i) {
      for (Index j = 2; j < 19; ++j) {
        wrong += f.states(i, j) == DotState::slip ? 1 : 0;
        ++all;
      }
    }
  }
  CHECK(all > 20000);
  CAPTURE(wrong / all);
  CHECK(wrong / all > 0.02);
  CHECK(wrong / all < 0.06);
}

TEST_CASE("stick ratio: a mean of dots leaves the root of the squared weights of the noise") {
  using detail::stick::noise_left_by;
  CHECK(noise_left_by(ResidualMean{{1, 1, 1}}) == Approx(1.0 / 3));  // nine alike
  CHECK(noise_left_by(ResidualMean{{2, 2, 0}}) == Approx(1 / std::sqrt(5.0)));
  CHECK(noise_left_by(ResidualMean{{3, 0, 3}}) == Approx(1 / std::sqrt(5.0)));
  CHECK(noise_left_by(ResidualMean{{5, 0, 0}}) == 1);
  CHECK(noise_left_by(ResidualMean{}) == Approx(0.06 / 0.14).epsilon(0.05));
}

TEST_CASE("stick ratio: doubts of single dots add as variances") {
  // Four of 81 dots are 0.45 px beside the others. The answer of each has the variance p (1 - p),
  // with the logistic curve nearest to the normal distribution.
  const StickTest test = test_px;
  auto now = shifted(3);
  now(2, 2).y += 0.45;
  now(6, 6).y += 0.45;
  now(2, 6).y -= 0.45;
  now(6, 2).y -= 0.45;
  Follower<StickConsensus<Freedom::translation>, UpdatedReference, NoDenoising> f(test);
  (void)f(shifted(0));
  const auto r = f(now);
  REQUIRE(r.slip == 4);
  const double limit_px = test.slip / test.reference * std::hypot(3, 0.45);
  const double sd_px = test.slip / std::sqrt(2 * std::log(100.0));  // 1 % exceed delta_0
  const auto variance = [&](double residual_px) {
    const double p = 1 / (1 + std::exp(1.702 * (residual_px - limit_px) / sd_px));
    return p * (1 - p);
  };
  CHECK(r.ratio_sd == Approx(std::sqrt(4 * variance(0.45) + 77 * variance(0)) / 81));
}

TEST_CASE("stick ratio: copies of a state go on alike, and apart") {
  Follower<> f;
  (void)f(shifted(0));
  (void)f(shifted(3));
  auto copy = f.state;
  const auto a = f(shifted(6));
  DotStates states(9, 9);
  (void)f.ratio(shifted(1), f.all, states, copy);
  auto other = f.state;
  const auto b = f(shifted(9));
  const auto c = f.ratio(shifted(9), f.all, states, other);
  CHECK(same(b, c));
  CHECK(states.cells == f.states.cells);
  CHECK(a.reference_age == 1);
  f.state.reset();
  CHECK(f.state.stored_frames() == 0);
  const auto fresh = f(shifted(0));
  CHECK(fresh.status == StickStatus::no_reference);
  CHECK(std::isnan(fresh.stick_ratio));
  CHECK(fresh.reference_age == 0);
}

TEST_CASE("stick ratio, bad input: missing and NaN dots") {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<Point2<double>> none = {missing,         {test::nan, 100}, {100, test::nan},
                                            {infinity, 100}, {100, -infinity}, {1e200, 0}};
  for (const auto& p : none) {
    CAPTURE(p.x, p.y);
    Follower<> f;
    (void)f(shifted(0));
    auto dots = shifted(3);
    dots(4, 4) = p;
    dots(0, 7) = p;
    auto r = f(dots);
    REQUIRE(r.updated());
    CHECK(r.unknown == 2);  // not found: neither sticks nor slips
    CHECK(f.states(4, 4) == DotState::unknown);
    CHECK(r.stick == 79);
    CHECK(r.stick_ratio == 1);
    CHECK(r.furthest_px == Approx(3));
    // after their return they are unknown as long as the reference lacks them
    r = f(shifted(6));
    CHECK(r.updated());
    CHECK(r.unknown == 2);
    r = f(shifted(9));
    CHECK(r.updated());
    CHECK(r.stick == 81);
  }
  SECTION("far away is not found, and makes those beside it doubtful at most") {
    for (const double far : {1e3, 1e9, 1e30, 1e150}) {
      Follower<> f;
      (void)f(shifted(0));
      auto dots = shifted(3);
      dots(4, 4) = {far, -far};
      const auto r = f(dots);
      REQUIRE(r.updated());
      CHECK((r.unknown >= 1 && r.unknown <= 5));
      CHECK(r.slip == 0);
      CHECK(r.furthest_px == Approx(3));
    }
  }
  SECTION("too few are no ratio, and the last one stands") {
    for (const Index left : {4, 5}) {
      Follower<> f;
      (void)f(shifted(0));
      CHECK(f(shifted(3)).stick_ratio == 1);
      auto dots = shifted(6);
      for (Index k = left; k < 81; ++k) {
        dots(k / 9, k % 9) = missing;
      }
      const auto r = f(dots);
      CHECK(r.status == (left < 5 ? StickStatus::too_few_dots : StickStatus::updated));
      CHECK(r.stick_ratio == 1);
      CHECK(r.stick == (left < 5 ? 81 : 5));  // states are kept with the ratio
      CHECK(r.unknown == (left < 5 ? 0 : 76));
    }
  }
}

TEST_CASE("stick ratio, bad input: swapped dots") {
  // Two dots with swapped names are not between their neighbours: they are missing, not slipping,
  // and not the furthest of all.
  const auto run = [](DotIndex a, DotIndex b, Index out_of_place) {
    Follower<> f;
    (void)f(shifted(0));
    auto dots = shifted(3);
    std::swap(dots(a.row, a.col), dots(b.row, b.col));
    const auto r = f(dots);
    REQUIRE(r.updated());
    CHECK(r.furthest_px == Approx(3));
    CHECK(r.out_of_place == out_of_place);
    CHECK(r.unknown == out_of_place);
    CHECK(r.slip == 0);
    CHECK(f.states(a.row, a.col) == DotState::unknown);
    CHECK(f.states(b.row, b.col) == DotState::unknown);
    (void)f(shifted(6));
    CHECK(f(shifted(9)).stick == 81);
  };
  run({2, 3}, {6, 6}, 10);  // and the four neighbours of each
  run({4, 4}, {4, 5}, 2);   // the others are still in line
  run({4, 4}, {5, 5}, 4);
}

TEST_CASE("stick ratio, bad input: dots marked as lost by a place") {
  // (0, 0) and (-1, -1) are the marks of finders without NaN; a third of the dots is lost.
  for (const Point2<double> mark : {Point2<double>{0, 0}, Point2<double>{-1, -1}}) {
    Follower<> f;
    (void)f(shifted(0));
    auto dots = shifted(3);
    Index lost = 0;
    for (Index k = 0; k < 81; k += 3) {
      dots(k / 9, (k + k / 9) % 9) = mark;
      ++lost;
    }
    const auto r = f(dots);
    REQUIRE(r.updated());
    CHECK(r.slip == 0);
    CHECK(r.unknown == lost);
    CHECK(r.stick_ratio == 1);
    CHECK(r.furthest_px == Approx(3));
    CHECK(f(PointsPx(9, 9, mark)).status == StickStatus::no_dots);
  }
  for (const double mark : {0.0, -1.0}) {
    // a single dot at such a position is a dot
    const auto around = [&](double x) { return shifted(x + mark - 180, mark - 180); };
    Follower<> f;
    (void)f(around(0));
    CHECK(f(around(3)).stick == 81);
    // of several none is; the other dots with x = y remain
    Follower<> g;
    (void)g(around(-3));
    auto dots = around(0);
    dots(0, 3) = dots(2, 7) = dots(6, 1) = {mark, mark};
    const auto r = g(dots);
    CHECK(r.stick == 77);
    CHECK(r.unknown == 4);
    CHECK(r.out_of_place == 0);
  }
}

TEST_CASE("stick ratio, bad input: dots in no order, and in another unit") {
  SECTION("names by chance give no ratio") {
    Follower<> f;
    (void)f(shifted(0));
    CHECK(f(shifted(3)).stick_ratio == 1);
    auto dots = shifted(6);
    test::Random random(2);
    for (Index k = 80; k > 0; --k) {
      std::swap(dots.cells[static_cast<std::size_t>(k)],
                dots.cells[static_cast<std::size_t>(random.whole(0, k))]);
    }
    const auto r = f(dots);
    CHECK(r.status == StickStatus::not_in_order);
    CHECK_FALSE(r.updated());
    CHECK(f(shifted(6)).updated());
  }
  SECTION("thresholds in px for dots in mm or m, or far too large") {
    for (const double unit : {0.08, 8e-5}) {
      Follower<> f(test_px);
      const auto in_unit = [&](double x) {
        auto dots = shifted(x);
        for (auto& p : dots.cells) {
          p = {unit * p.x, unit * p.y};
        }
        return dots;
      };
      (void)f(in_unit(0));
      const auto r = f(in_unit(3));
      CHECK(r.status == StickStatus::wrong_scale);
      CHECK(std::isnan(r.stick_ratio));
    }
    // the ends are a U of half a pitch of 20 px and a delta_0 of a quarter of it
    const auto status = [](double reference_px, double slip_px) {
      Follower<> f({.reference = reference_px, .store = 0.5, .slip = slip_px, .pitch = 1});
      return f(shifted(0)).status;
    };
    CHECK(status(9.9, 0.2) == StickStatus::no_reference);
    CHECK(status(10.1, 0.2) == StickStatus::wrong_scale);
    CHECK(status(2, 4.9) == StickStatus::no_reference);
    CHECK(status(2, 5.1) == StickStatus::wrong_scale);
    CHECK(status(9.9, 4.9) == StickStatus::no_reference);
    CHECK(status(10.1, 4.9) == StickStatus::wrong_scale);
  }
}

TEST_CASE("stick ratio: no answer while dots fall back toward their free places") {
  const ContactFlags none(9, 9, 0);
  for (const bool free_known : {true, false}) {
    Follower<> f;
    if (free_known) {
      CHECK(f(shifted(0), none).status == StickStatus::no_contact);
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
      CHECK((!free_known || r.status == StickStatus::falls_back ||
             r.status == StickStatus::no_reference));
      CHECK((!free_known || r.stick_ratio == ratio));
    }
    CHECK((free_known ? answers == 0 : answers > 3));
    CHECK(f(shifted(-3)).updated());  // beyond the free position it moves away again
  }
  // sideways is not back
  Follower<> f;
  (void)f(shifted(0), none);
  (void)f(shifted(0));
  for (int k = 0; k < 40; ++k) {
    const auto r = f(shifted(12 * std::cos(0.25 * k), 12 * std::sin(0.25 * k)));
    CHECK(r.status == StickStatus::updated);
  }
}

TEST_CASE("stick ratio: thresholds in pitches hold in every unit") {
  for (const double unit : {1.0, 0.08, 8e-5, 40.0}) {
    Follower<> f;
    const auto at = [&](double x) {
      auto dots = shifted(x);
      for (auto& p : dots.cells) {
        p = {unit * p.x, unit * p.y};
      }
      return f(dots);
    };
    CAPTURE(unit);
    CHECK(at(0).status == StickStatus::no_reference);
    CHECK(at(0.49).status == StickStatus::standing);
    CHECK(at(1.99).status == StickStatus::no_reference);
    const auto r = at(2.52);  // from 0, because 0.53 from the previous frame is too little
    CHECK(r.updated());
    CHECK(r.furthest_px == Approx(2.52 * unit));
    CHECK(r.stick_ratio == 1);
  }
}

TEST_CASE("stick ratio, bad input: the unit changes within a contact") {
  for (const double unit : {0.08, 12.5, 0.4, 2.5}) {
    Follower<> f;
    (void)f(shifted(0));
    CHECK(f(shifted(3)).updated());
    auto dots = shifted(6);
    for (auto& p : dots.cells) {
      p = {unit * p.x, unit * p.y};
    }
    const auto r = f(dots);
    CAPTURE(unit);
    CHECK(r.status == StickStatus::wrong_scale);
    CHECK(r.stick_ratio == 1);  // the last answer
    // from now on in this unit
    CHECK(f(dots).status == StickStatus::no_reference);
    for (auto& p : dots.cells) {
      p.x += 3 * unit;
    }
    CHECK(f(dots).updated());
  }
}

TEST_CASE("stick ratio: the pitch may double or halve within a contact, or be unknown") {
  ContactFlags alternating(9, 9, 0);  // without neighbours in contact
  for (Index k = 0; k < 81; k += 2) {
    alternating(k / 9, k % 9) = 1;
  }
  for (const double unit : {0.5, 2.0}) {
    Follower<> f;
    (void)f(shifted(0));
    auto dots = shifted(0);
    for (auto& p : dots.cells) {
      p = {unit * p.x, unit * p.y};
    }
    CHECK(f(dots).status != StickStatus::wrong_scale);
  }
  Follower<> known_later(test_px);
  (void)known_later(shifted(0), alternating);
  CHECK(known_later(shifted(3)).stick == 41);
  Follower<> known_before;
  (void)known_before(shifted(0));
  CHECK(known_before(shifted(3), alternating).stick == 41);
}

TEST_CASE("stick ratio, bad input: a misplaced corner of the pattern") {
  // It lies between no two neighbours; if it counted, it would be the furthest dot and hide all
  // slip.
  for (const DotIndex corner : {DotIndex{0, 0}, DotIndex{0, 8}, DotIndex{8, 0}, DotIndex{8, 8}}) {
    CAPTURE(corner.row, corner.col);
    Follower<> f;
    (void)f(shifted(0));
    auto dots = shifted(3);
    dots(corner.row, corner.col).y += corner.row == 0 ? -30 : 30;
    const auto r = f(dots);
    REQUIRE(r.updated());
    CHECK(r.out_of_place >= 1);  // and perhaps its neighbour
    CHECK(r.furthest_px == Approx(3));
    CHECK(r.slip == 0);
    CHECK(f.states(corner.row, corner.col) == DotState::unknown);
  }
}

TEST_CASE("stick ratio: dots that stand still together are not the object") {
  // A patch of 16 dots follows the object; the search begins among the standing dots.
  Follower<StickConsensus<>> f;
  (void)f(shifted(0));
  auto dots = shifted(0);
  for (Index i = 0; i < 4; ++i) {
    for (Index j = 0; j < 4; ++j) {
      dots(i, j).x += 3;
    }
  }
  const auto r = f(dots, f.most);
  REQUIRE(r.updated());
  CHECK(f.states(1, 1) == DotState::stick);
  CHECK(f.states(6, 6) == DotState::slip);
  CHECK(r.stick <= 16);
}

TEST_CASE("stick ratio, bad input: a pattern that jumps by one pitch") {
  for (const Index rows : {-1, 0, 1}) {
    for (const Index cols : {-1, 0, 1}) {
      const double x = 20 * static_cast<double>(cols), y = 20 * static_cast<double>(rows);
      CAPTURE(rows, cols);
      Follower<> f;
      (void)f(shifted(0));
      CHECK(f(shifted(3)).stick_ratio == 1);
      const Index stored = f.state.stored_frames();
      auto r = f(shifted(3.7 + x, 0.4 + y));
      CHECK(r.status == (rows == 0 && cols == 0 ? StickStatus::updated : StickStatus::jumped));
      CHECK(r.stick_ratio == 1);
      if (rows != 0 || cols != 0) {
        CHECK(f.state.stored_frames() == stored);
        CHECK(f(shifted(3.7 + x, 0.4 + y)).status == StickStatus::jumped);
        CHECK(f.states(4, 4) == DotState::stick);  // as before
      }
      r = f(shifted(6));  // in step again
      CHECK(r.updated());
      CHECK(r.stick_ratio == 1);
    }
  }
  SECTION("so does a pattern that turns or grows") {
    SlippingDots dots;
    const StickRatio ratio(21, 21);
    auto state = ratio.start();
    DotStates states(21, 21);
    (void)ratio(dots.dots, dots.contact, states, state);
    dots.step({.shift_px = 19.5, .direction_rad = 0.01, .turn_rad = 0.02, .zoom = 1.01});
    CHECK(ratio(dots.dots, dots.contact, states, state).status == StickStatus::jumped);
  }
  SECTION("fast but not by a pitch is motion") {
    Follower<> f;
    (void)f(shifted(0));
    CHECK(f(shifted(10)).updated());
    CHECK(f(shifted(40)).updated());
  }
}

TEST_CASE("stick ratio, bad input: all dots lost for some frames, then back") {
  Follower<> f;
  const PointsPx blank(9, 9, missing);
  CHECK(f(blank).status == StickStatus::no_dots);
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
    CHECK(r.accepted());
    CHECK(r.status == StickStatus::no_dots);
    CHECK(r.stick_ratio == before.stick_ratio);
    CHECK(r.slip == 9);  // known states are kept
    CHECK(f.states(3, 0) == DotState::slip);
  }
  // without contact flags, because nothing is found where contact could be
  CHECK(f(blank, ContactFlags(9, 9, 0)).status == StickStatus::no_dots);
  const auto after = f(shifted(6), f.most);  // nothing was forgotten
  CHECK(after.updated());
  CHECK(after.reference_age == 7);
}

TEST_CASE("stick ratio, bad input: time going backwards") {
  Follower<> f;
  CHECK(f.at(shifted(0), 10).status == StickStatus::no_reference);
  CHECK(f.at(shifted(3), 10.1).updated());
  CHECK(f.at(shifted(6), 10.1).updated());   // the same time again is not backward
  CHECK(f.at(shifted(9), 10.05).updated());  // a clock that is slightly late
  CHECK(f.at(shifted(12), 9.91).updated());
  const auto r = f.at(shifted(9), 9.85);  // 0.25 s before the latest
  CHECK(r.status == StickStatus::restarted);
  CHECK(std::isnan(r.stick_ratio));
  CHECK(r.reference_age == 0);
  CHECK(r.unknown == 81);
  CHECK(f.state.stored_frames() == 1);
  CHECK(f.at(shifted(12), 9.86).reference_age == 1);
  // times that are not numbers are ignored
  CHECK(f.at(shifted(15), test::nan).updated());
  CHECK(f.at(shifted(18), std::numeric_limits<double>::infinity()).updated());
  CHECK(f.at(shifted(21), 9.87).updated());
  CHECK(f(shifted(24)).updated());
  CHECK(f.at(shifted(27), -std::numeric_limits<double>::infinity()).status ==
        StickStatus::restarted);
  CHECK(f.at(shifted(30), -5).updated());
}

TEST_CASE("stick ratio, bad input: a contact mask that drops out for a moment") {
  Follower<> f;
  const ContactFlags none(9, 9, 0);
  const auto at = [&](double x, double time_s, bool touches) {
    return f.ratio(shifted(x), touches ? f.all : none, f.states, f.state, time_s);
  };
  (void)at(0, 1.0, true);
  CHECK(at(3, 1.1, true).updated());
  const auto lost = at(4, 1.2, false);
  CHECK(lost.status == StickStatus::no_contact);
  CHECK(lost.stick_ratio == 1);  // kept
  CHECK(lost.dots_in_contact() == 0);
  CHECK(at(4.5, 1.29, false).stick_ratio == 1);
  const auto back = at(6, 1.3, true);
  CHECK(back.updated());  // against an earlier frame
  CHECK(back.reference_age == 3);
  CHECK(std::isnan(at(7, 1.51, false).stick_ratio));  // longer than 0.2 s: another contact
  CHECK(f.state.stored_frames() == 0);
  CHECK(at(9, 1.52, true).status == StickStatus::no_reference);
  // without time a lost contact has ended
  CHECK(at(12, test::nan, true).updated());
  CHECK(std::isnan(at(12, test::nan, false).stick_ratio));
}

TEST_CASE("stick ratio, bad input: an empty contact mask") {
  Follower<> f;
  const ContactFlags none(9, 9, 0);
  auto r = f(shifted(0), none);
  CHECK(r.accepted());
  CHECK(r.status == StickStatus::no_contact);
  CHECK(std::isnan(r.stick_ratio));
  CHECK(r.dots_in_contact() == 0);
  (void)f(shifted(0));
  CHECK(f(shifted(3)).stick_ratio == 1);
  r = f(shifted(6), none);
  CHECK(r.status == StickStatus::no_contact);
  CHECK(std::isnan(r.stick_ratio));  // of another contact
  CHECK(r.reference_age == 0);
  CHECK(!r.reference_dot.exists());
  CHECK(count(f.states, DotState::none) == 81);
  CHECK(f.state.stored_frames() == 0);
  CHECK(f(shifted(9)).status == StickStatus::no_reference);
  CHECK(f(shifted(12)).updated());
}

TEMPLATE_TEST_CASE("stick ratio, bad input: one single dot", "[stick_ratio]", StickConsensus<>) {
  const auto run = [](const StickTest& test, Index rows, Index cols) {
    Follower<TestType> f(test, {}, {}, {}, rows, cols);
    (void)f(shifted(0, 0, rows, cols));
    return f(shifted(3, 0, rows, cols));
  };
  const auto r = run({}, 1, 1);
  CHECK(r.accepted());
  CHECK(r.status == StickStatus::too_few_dots);
  CHECK(std::isnan(r.stick_ratio));
  CHECK(r.unknown == 1);
  const auto alone = run({.min_dots = 1}, 1, 1);  // it moves with itself
  CHECK(alone.updated());
  CHECK(alone.stick_ratio == 1);
  CHECK(alone.angle_rad == 0);
  CHECK(alone.scale == 1);
  CHECK(alone.reference_dot == DotIndex{0, 0});
  CHECK(run({.min_dots = 2}, 1, 2).stick_ratio == 1);
  CHECK(run({.min_dots = 2}, 2, 1).stick_ratio == 1);
  CHECK(run({}, 1, 9).stick_ratio == 1);
  CHECK(run({}, 9, 1).stick_ratio == 1);
  SECTION("in contact, of many") {
    Follower<TestType> f({.min_dots = 1});
    ContactFlags contact(9, 9, 0);
    contact(8, 8) = 1;
    (void)f(shifted(0), contact);
    const auto one = f(shifted(3), contact);
    CHECK(one.updated());
    CHECK(one.stick == 1);
    CHECK(one.reference_dot == DotIndex{8, 8});
  }
}

TEST_CASE(
    "stick ratio: of dots that stand still together, one ahead is found unless scale moves it") {
  // up to a quarter of its displacement may be due to a change of scale
  const auto outrunner = [](double grown) {
    const Point2<double> now = {20, 0}, then = {16, 0};
    const std::vector<Index> touching = {0};
    const detail::stick::FramePair<double> pair = {&now, &then, touching, {1, 1}, 16};
    return furthest_outrunner(pair, detail::stick::Similarity<double>{1 + grown * 4 / 20});
  };
  for (const double sign : {-1.0, 1.0}) {
    CHECK(outrunner(0.249 * sign) == 0);
    CHECK(outrunner(0.251 * sign) == -1);
  }
}

TEST_CASE("stick ratio: the pitch is the mean of all neighbours in contact") {
  // 3 columns of pitch 4, rows 3 and 5 apart: 6 distances along the rows, 3 and 3 across
  std::vector<Point2<double>> dots;
  std::vector<Index> touching;
  for (const double y : {0.0, 3.0, 8.0}) {
    for (const double x : {0.0, 4.0, 8.0}) {
      touching.push_back(static_cast<Index>(dots.size()));
      dots.push_back({x, y});
    }
  }
  const auto mean_sq = [&] { return detail::stick::mean_pitch_sq(touching, dots.data(), {3, 3}); };
  CHECK(mean_sq() == Approx((6 * 16 + 3 * 9 + 3 * 25) / 12.0));
  touching = {4};  // to the right and below
  CHECK(mean_sq() == Approx((16 + 25) / 2.0));
  touching = {8};
  CHECK(mean_sq() == 0);
}

TEST_CASE("stick ratio: where the pitch is unknown, thresholds are in the unit of the dots") {
  const auto status = [](double moved_px) {
    Follower<> f({.reference = 2, .store = 0.5, .min_dots = 1}, {}, {}, {}, 1, 1);
    (void)f(shifted(0, 0, 1, 1));
    return f(shifted(moved_px, 0, 1, 1)).status;
  };
  CHECK(status(1.9) == StickStatus::no_reference);
  CHECK(status(2.1) == StickStatus::updated);
}

TEST_CASE("stick ratio: a contact of all dots lacks an outline once more than a tenth slip") {
  const auto status = [](Index slipping) {
    Follower<StickConsensus<>, UpdatedReference, NoDenoising> f({}, {}, {}, {}, 2, 5);
    (void)f(shifted(0, 0, 2, 5));
    auto dots = shifted(3, 0, 2, 5);
    for (Index j = 0; j < slipping; ++j) {
      dots(1, 4 - j).x -= 1;
    }
    const auto r = f(dots);
    CHECK(r.slip == slipping);
    CHECK(r.stick == 10 - slipping);
    return r.status;
  };
  CHECK(status(1) == StickStatus::updated);
  CHECK(status(2) == StickStatus::no_outline);
}

TEST_CASE("stick ratio: the doubt of an answer is half at the limit, and the same in every unit") {
  const auto doubt = [](double slip, double limit, double sd) {
    return detail::stick::doubt_of(slip * slip, limit * limit, sd);
  };
  for (const double unit : {1e-3, 1.0, 20.0}) {
    CAPTURE(unit);
    CHECK(doubt(unit, unit, 0.3 * unit) == Approx(0.5));
    CHECK(doubt(0.7 * unit, unit, 0.3 * unit) == Approx(doubt(1.3 * unit, unit, 0.3 * unit)));
    for (const double slip : {0.0, 0.5, 1.4, 2.0, 2.9}) {
      CHECK(doubt(slip * unit, unit, unit) == Approx(doubt(slip, 1, 1)));
      CHECK(doubt(slip * unit, unit, unit) > 0.1);
    }
    CHECK(doubt(3.01 * unit, unit, unit) == 0);
  }
}

TEST_CASE("stick ratio, bad input: other sizes and foreign states are refused") {
  const StickRatio ratio(9, 9);
  auto state = ratio.start();
  DotStates states(9, 9);
  const ContactFlags all(9, 9, 1);
  (void)ratio(shifted(0), all, states, state);
  (void)ratio(shifted(3), all, states, state);
  const DotStates written = states;
  DotStates other_states(9, 8);
  CHECK(!ratio(shifted(0, 0, 9, 8), all, states, state).accepted());
  CHECK(!ratio(shifted(0, 0, 0, 0), all, states, state).accepted());
  CHECK(!ratio(shifted(6), ContactFlags(8, 9), states, state).accepted());
  CHECK(!ratio(shifted(6), all, other_states, state).accepted());
  auto foreign = StickRatio(9, 8).start();
  CHECK(!ratio(shifted(6), all, states, foreign).accepted());
  auto rotated = StickRatio(8, 9).start();
  CHECK(!ratio(shifted(6), all, states, rotated).accepted());
  auto other_capacity =
      StickRatio(9, 9, {}, StickConsensus<>(), UpdatedReference{.capacity = 63}).start();
  const auto refused = ratio(shifted(6), all, states, other_capacity);
  CHECK(!refused.accepted());
  CHECK(!refused.updated());
  CHECK(std::isnan(refused.stick_ratio));
  CHECK(states.cells == written.cells);
  CHECK(other_states.cells == DotStates(9, 8).cells);
  CHECK(ratio(shifted(6), all, states, state).updated());  // the state is unchanged
}

TEST_CASE("stick ratio: bad parameters are refused by name, value and range") {
  const auto test_with = [](auto member, auto bad) {
    StickTest test;
    test.*member = bad;
    return refusal([&] { StickRatio(9, 9, test); });
  };
  CHECK(test_with(&StickTest::reference, 0.0) ==
        "StickTest: reference = 0, must be finite and > 0");
  CHECK(test_with(&StickTest::reference, -2.0) ==
        "StickTest: reference = -2, must be finite and > 0");
  CHECK(test_with(&StickTest::store, 2.5) == "StickTest: store = 2.5, must be in [0, reference]");
  CHECK(test_with(&StickTest::store, -0.5) == "StickTest: store = -0.5, must be in [0, reference]");
  CHECK(test_with(&StickTest::slip, 0.0) == "StickTest: slip = 0, must be finite and > 0");
  CHECK(test_with(&StickTest::min_dots, Index(0)) == "StickTest: min_dots = 0, must be >= 1");
  for (const double bad : {test::nan, std::numeric_limits<double>::infinity()}) {
    using test::begins_with;
    CHECK(begins_with(test_with(&StickTest::reference, bad), "StickTest: reference = "));
    CHECK(begins_with(test_with(&StickTest::store, bad), "StickTest: store = "));
    CHECK(begins_with(test_with(&StickTest::slip, bad), "StickTest: slip = "));
  }
  CHECK(test_with(&StickTest::store, 0.0) == "accepted");
  CHECK(test_with(&StickTest::store, 0.1) == "accepted");

  CHECK(refusal([] { StickRatio(0, 9); }) == "StickRatio: rows = 0, must be in [1, 1000000]");
  CHECK(refusal([] { StickRatio(9, -1); }) == "StickRatio: cols = -1, must be in [1, 1000000]");

  const auto motion = [](const auto& m) { return refusal([&] { StickRatio(9, 9, {}, m); }); };
  CHECK(motion(StickConsensus<>{.max_passes = -1}) ==
        "StickConsensus: max_passes = -1, must be in [0, 100]");
  CHECK(motion(StickConsensus<>{.max_passes = 101}) ==
        "StickConsensus: max_passes = 101, must be in [0, 100]");
  CHECK(motion(StickConsensus<>{.max_passes = 0}) == "accepted");

  const auto capacity = [](Index n) {
    return refusal(
        [&] { StickRatio(9, 9, {}, StickConsensus<>(), UpdatedReference{.capacity = n}); });
  };
  CHECK(capacity(0) == "UpdatedReference: capacity = 0, must be in [1, 4096]");
  CHECK(capacity(4097) == "UpdatedReference: capacity = 4097, must be in [1, 4096]");
  CHECK(capacity(1) == "accepted");

  const auto denoising = [](const auto& d) {
    return refusal([&] { StickRatio(9, 9, {}, StickConsensus<>(), UpdatedReference(), d); });
  };
  CHECK(denoising(ResidualMean{.weights = {.self = 0}}) ==
        "ResidualMean: weights.self = 0, must be finite and > 0");
  CHECK(denoising(ResidualMean{.weights = {.side = -1}}) ==
        "ResidualMean: weights.side = -1, must be finite and >= 0");
  CHECK(denoising(ResidualMean{.weights = {.diagonal = -1}}) ==
        "ResidualMean: weights.diagonal = -1, must be finite and >= 0");
  CHECK(denoising(ResidualMean{.gate = 0.5}) ==
        "ResidualMean: gate = 0.5, must be finite and >= 1");
  CHECK(denoising(ResidualMean{.gate = test::nan}) ==
        "ResidualMean: gate = nan, must be finite and >= 1");
  CHECK(denoising(NoDenoising()) == "accepted");
}

namespace {

/// Frames of a free pad, then of one dragged slowly until little sticks. Returns the mean error of
/// the ratio from U on, kept answers included.
double slow_error(double noise_px, double scale, bool free_frames_first, const StickTest& test) {
  double error = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    test::Random random(seed);
    test::SlippingDots truth;
    const StickRatio<> ratio(21, 21, test);
    auto state = ratio.start();
    test::DotStates states(21, 21);
    const auto look = [&](const test::ContactFlags& contact) {
      auto dots = noisy(truth.dots, noise_px, random);
      for (auto& p : dots.cells) {
        p = scale * p;
      }
      return ratio(dots, contact, states, state);
    };
    for (int k = 0; k < (free_frames_first ? 20 : 0); ++k) {
      (void)look(test::ContactFlags(21, 21, 0));
    }
    for (int k = 0; k < 160; ++k) {
      truth.step({.shift_px = 0.1, .stick_share = 1.05 - 0.7 * k / 160});
      const auto r = look(truth.contact);
      const double found = r.ok() ? static_cast<double>(r.stick_ratio) : 1;
      error += k < 60 ? 0 : std::abs(found - truth.stick_ratio(1)) / 600;
    }
  }
  return error;
}

}  // namespace

TEST_CASE("stick ratio: thresholds follow the noise of the free frames") {
  // 0.14 px exceed the noise for which U_min is made: without the free frames every frame is
  // stored, and none of them is far enough away for a comparison.
  CAPTURE(slow_error(0.14, 1, true, {}), slow_error(0.14, 1, false, {}));
  CAPTURE(slow_error(0.03, 1, true, {}), slow_error(0.03, 1, false, {}));
  CHECK(slow_error(0.14, 1, true, {}) < 0.1);
  CHECK(slow_error(0.14, 1, false, {}) > 0.08);
  CHECK(slow_error(0.14, 1, true, {.free_frames = 0}) > 0.08);
  // dots in mm
  CHECK(slow_error(0.14, 0.08, true, {}) == Approx(slow_error(0.14, 1, true, {})).margin(0.01));
  // less noise of the dots: slip is detected sooner
  CHECK(slow_error(0.03, 1, true, {}) < slow_error(0.03, 1, false, {}));
  // repeated frames show no noise
  CHECK(slow_error(0, 1, true, {}) == Approx(slow_error(0, 1, false, {})).margin(1e-6));
}

TEST_CASE("stick ratio: at rest the last reference is asked again, if that is asked for") {
  const StickRatio asked(9, 9, {}, StickConsensus<>(), UpdatedReference{.at_rest = true});
  auto state = asked.start();
  test::DotStates states(9, 9);
  const auto look = [&](double x) {
    return asked(shifted(x), test::ContactFlags(9, 9, 1), states, state);
  };
  (void)look(0);
  CHECK(look(0.2).status == StickStatus::standing);  // no frame is far enough away
  CHECK(look(2.5).updated());
  const Index stored = state.stored_frames();
  const auto rests = look(2.6);
  CHECK(rests.updated());
  CHECK(rests.reference_age == 3);
  CHECK(rests.stick_ratio == 1);
  CHECK(state.stored_frames() == stored);  // standing frames are not stored
}

TEST_CASE("stick ratio: its standard deviation is the scatter of its answers", "[figures]") {
  constexpr int answers = 150;
  for (const double noise_px : {0.06, 0.14}) {
    for (const double share : {0.5, 0.7, 0.9}) {
      test::SlippingDots truth(test::SlippingPattern{.contact_pitches = 6});
      const auto before = truth.dots;
      truth.step({.shift_px = 3, .stick_share = share});
      test::Random random(7);
      const StickRatio<> ratio(21, 21);
      test::DotStates states(21, 21);
      const auto see = [&](const test::PointsPx& exact, const ContactFlags& contact, auto& state) {
        auto dots = exact;
        for (auto& p : dots.cells) {
          const double x = random.normal(), y = random.normal();
          p = {p.x + noise_px * x, p.y + noise_px * y};
        }
        return ratio(dots, contact, states, state);
      };
      double sum = 0, squares = 0, told = 0;
      std::vector<std::array<double, 2>> all;
      for (int k = 0; k < answers; ++k) {
        auto state = ratio.start();
        for (int frame = 0; frame < 9; ++frame) {
          (void)see(before, ContactFlags(21, 21, 0), state);
        }
        (void)see(before, truth.contact, state);
        const auto r = see(truth.dots, truth.contact, state);
        REQUIRE(r.updated());
        const double of = static_cast<double>(r.stick_ratio);
        sum += of;
        squares += of * of;
        told += square(static_cast<double>(r.ratio_sd));
        all.push_back({of, static_cast<double>(r.ratio_sd)});
      }
      const double mean = sum / answers;
      const double scatter = std::sqrt(squares / answers - square(mean));
      const double sd = std::sqrt(told / answers);
      const auto near =
          static_cast<double>(std::count_if(all.begin(), all.end(), [&](const auto& answer) {
            return std::abs(answer[0] - mean) < 2 * answer[1];
          }));
      INFO(noise_px << " px, " << share << ": scatter " << scatter << ", told " << sd
                    << ", within two of these " << near);
      CHECK(sd > 0.8 * scatter);  // measured: 0.87 to 1.34
      CHECK(sd < 1.5 * scatter);
      CHECK(near > 0.85 * answers);  // measured: 0.90 to 1; of a normal distribution 0.95
    }
  }
}
