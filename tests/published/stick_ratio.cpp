// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The printed stick ratio: each step by a behaviour that only it has.
#include "fingerpad/published/stick_ratio.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/ratio_measures.hpp"
#include "support/refusal.hpp"
#include "support/slipping_dots.hpp"

using namespace fingerpad;
using published::StickRatioOptions;
using published::StickScale;
using Printed = published::StickRatio<>;
using test::ContactFlags;
using test::PointsPx;
using test::SlippingDots;

namespace {

constexpr double pi = std::numbers::pi;

/// 9 x 9 dots 20 px apart, displaced by `move(row, col)`.
template <class Move>
PointsPx grid_of(const Move& move) {
  PointsPx dots(9, 9);
  for (Index i = 0; i < 9; ++i) {
    for (Index j = 0; j < 9; ++j) {
      const Point2<double> off = move(i, j);
      dots(i, j) = {100 + 20 * static_cast<double>(j) + off.x,
                    100 + 20 * static_cast<double>(i) + off.y};
    }
  }
  return dots;
}
PointsPx at_rest() {
  return grid_of([](Index, Index) { return Point2<double>{0, 0}; });
}

/// Rotated by `angle` about the central dot.
PointsPx turned(double angle) {
  return grid_of([=](Index i, Index j) {
    const double x = 20.0 * static_cast<double>(j - 4), y = 20.0 * static_cast<double>(i - 4);
    const double c = std::cos(angle), s = std::sin(angle);
    return Point2<double>{c * x - s * y - x, s * x + c * y - y};
  });
}

/// Result for `then` and `now`, without an average over neighbours.
template <class Then, class Now>
published::StickRatioResult<> answer_of(StickRatioOptions options,
                                        const Then& then,
                                        const Now& now) {
  options.S2 = options.S3 = 0;
  Printed ratio(9, 9, options);
  const ContactFlags all(9, 9, 1);
  CHECK_FALSE(ratio(then, all).updated);
  return ratio(now, all);
}

}  // namespace

TEST_CASE("slides: the mean of four angles, and where it wraps", "[published]") {
  // neighbours to the right, below, to the left and above, rotated by `angle` from `first`
  const auto mean = [](double first, double angle, bool wraps) {
    StickRatioOptions options = {.wraps = wraps, .scale = StickScale::none, .follows_stick = false};
    return answer_of(options, turned(first), turned(first + angle)).angle_rad;
  };
  for (const bool wraps : {false, true}) {
    CHECK(mean(0.3, 0.2, wraps) == Approx(0.2));
    CHECK(mean(0.3, -0.2, wraps) == Approx(-0.2));
  }
  // a neighbour at 175 degrees that rotates to 186.5 is measured at -173.5
  CHECK(mean(pi - 0.1, 0.2, true) == Approx(0.2 - pi / 2));
  CHECK(mean(pi - 0.1, 0.2, false) == Approx(0.2));
  // near half a turn the mean of the angles between the directions is one of them by chance
  CHECK(std::abs(mean(0.3, 3.1, false)) == Approx(3.1));
}

TEST_CASE("slides: a rotation is cancelled, and only where it is asked for", "[published]") {
  StickRatioOptions options = {.follows_stick = false};
  const auto right = answer_of(options, turned(0.3), turned(0.38));
  CHECK(right.angle_rad == Approx(0.08));
  CHECK(right.stick_ratio == 1);
  options.cancels_rotation = false;
  const auto left = answer_of(options, turned(0.3), turned(0.38));
  CHECK(left.angle_rad == 0);
  CHECK(left.stick_ratio < 0.5);
}

TEST_CASE("slides: the scale, plain and across the motion", "[published]") {
  // all dots move along x; the right half is stretched along x by a tenth, and all is scaled by
  // 1.05
  const auto now = grid_of([](Index i, Index j) {
    const double x = 20.0 * static_cast<double>(j - 4), y = 20.0 * static_cast<double>(i - 4);
    const double stretch = j > 4 ? 0.1 * x : 0;
    return Point2<double>{0.05 * x + stretch + 400, 0.05 * y};
  });
  StickRatioOptions options;
  options.cancels_rotation = false;
  options.scale = StickScale::across;
  // the motion of 400 px has hardly a part along y, and nothing is stretched across it
  CHECK(answer_of(options, at_rest(), now).scale == Approx(1 / 1.05).margin(2e-3));
  options.scale = StickScale::plain;
  const double plain = answer_of(options, at_rest(), now).scale;
  CHECK(plain < 1 / 1.05 - 0.01);  // the stretch along the motion counts
  // by hand: sums of |e| over (1, -1), (1, 0), (1, 1), (0, 1)
  double then_sum = 0, now_sum = 0;
  const auto rest = at_rest();
  for (Index i = 0; i < 9; ++i) {
    for (Index j = 0; j < 9; ++j) {
      for (const auto& step : {std::pair<Index, Index>{1, -1}, {1, 0}, {1, 1}, {0, 1}}) {
        const Index k = i + step.first, l = j + step.second;
        if (k < 9 && l >= 0 && l < 9) {
          const auto length = [&](const PointsPx& p) {
            return std::hypot(p(i, j).x - p(k, l).x, p(i, j).y - p(k, l).y);
          };
          then_sum += length(rest);
          now_sum += length(now);
        }
      }
    }
  }
  CHECK(plain == Approx(then_sum / now_sum));
  options.scale = StickScale::none;
  CHECK(answer_of(options, at_rest(), now).scale == 1);
}

TEST_CASE("slides: delta fixed or in proportion; N_s / N_c over all dots in contact",
          "[published]") {
  // 4 px along x; row k lags by 0.1 k px
  const auto now = grid_of([](Index i, Index) {
    return Point2<double>{4 - 0.1 * static_cast<double>(i), 0};
  });
  StickRatioOptions options;
  options.cancels_rotation = false;
  options.scale = StickScale::none;
  options.follows_stick = false;  // row 4
  // d_max = 4: delta = 0.48, rows 0 to 8 within 0.4
  CHECK(answer_of(options, at_rest(), now).stick_ratio == 1);
  CHECK(answer_of(options, at_rest(), now).furthest_px == Approx(4));
  options.delta_grows = false;
  // delta = 0.24: rows 2 to 6
  CHECK(answer_of(options, at_rest(), now).stick_ratio == Approx(5.0 / 9));
  options.delta_0 = 0.29;  // still rows 2 to 6
  CHECK(answer_of(options, at_rest(), now).stick_ratio == Approx(5.0 / 9));
  // a dot in contact without an answer of its own counts in N_c: none is left out
  options.delta_0 = 1e-9;
  CHECK(answer_of(options, at_rest(), now).stick_ratio == Approx(9.0 / 81));  // row 4
}

TEST_CASE("slides: when there is an answer", "[published]") {
  // the middle column sticks to a plate that moves by 1.5 px a frame; all others slip ahead of it
  const auto frame = [](int k) {
    return grid_of([=](Index, Index j) {
      const double by = j == 4 ? 0.5 * k : 1.5 * k;
      return Point2<double>{by, 0};
    });
  };
  const auto first_answers = [&](bool with_stick) {
    StickRatioOptions options;
    options.moves_with_stick = with_stick;
    options.follows_stick = false;
    options.cancels_rotation = false;
    options.scale = StickScale::none;
    options.S2 = options.S3 = 0;
    Printed ratio(9, 9, options);
    const ContactFlags all(9, 9, 1);
    std::array<Index, 2> ages = {0, 0};
    int answers = 0;
    for (int k = 0; answers < 2; ++k) {
      const published::StickRatioResult<> r = ratio(frame(k), all);
      if (r.ok()) {
        ages[static_cast<std::size_t>(answers++)] = r.reference_age;
      }
    }
    return ages;
  };
  // 3 px of a dot in contact are 2 frames
  CHECK(first_answers(false) == std::array<Index, 2>{2, 2});
  // 2.5 px of the stick region, the middle column, are 5 frames; at the first answer there is none
  // yet
  CHECK(first_answers(true) == std::array<Index, 2>{2, 5});
}

TEST_CASE("slides: every frame beyond U from the reference has an answer", "[published][law]") {
  rc::prop("from 0.01 to 3 px a frame", [] {
    const double step_px = test::log_uniform(0.01, 3), turn = test::uniform(-3, 3);
    const StickRatioOptions options = {.U = test::uniform(0.7, 3)};
    Printed ratio(9, 9, options);
    const ContactFlags all(9, 9, 1);
    for (int k = 0; k < 400 && k * step_px < 8; ++k) {
      const double by = k * step_px;
      const auto r = ratio(grid_of([=](Index, Index) {
                             return Point2<double>{by * std::cos(turn), by * std::sin(turn)};
                           }),
                           all);
      const double age = static_cast<double>(r.reference_age);
      // the first frame is stored, and one whenever U_min has been moved since the last
      RC_ASSERT(r.ok() == (by > options.U + 1e-9 || (by > options.U - 1e-9 && r.ok())));
      RC_ASSERT(!r.ok() || r.stick_ratio == 1);
      RC_ASSERT(!r.ok() || std::abs(r.furthest_px - age * step_px) < 1e-9);
      RC_ASSERT(!r.ok() || r.furthest_px < options.U + options.U_min + 2 * step_px);
    }
  });
  // 0.101 px a frame: 2 px are 20 frames, and each of the 100 that follow has an answer
  Printed ratio(9, 9);
  const ContactFlags all(9, 9, 1);
  int answers = 0;
  for (int k = 0; k < 120; ++k) {
    answers += ratio(grid_of([=](Index, Index) { return Point2<double>{0.101 * k, 0}; }), all).ok();
  }
  CHECK(answers == 100);
}

TEST_CASE("slides: d_max is that of the dot that has moved most, whichever it is", "[published]") {
  const StickRatioOptions options = {.cancels_rotation = false, .scale = StickScale::none};
  for (Index k = 0; k < 81; ++k) {
    const auto now = grid_of([&](Index i, Index j) {
      return Point2<double>{0, 9 * i + j == k ? -3.0 : 0.5};
    });
    CHECK(answer_of(options, at_rest(), now).furthest_px == 3);
  }
}

TEST_CASE("slides: a frame is stored by its distance from the newest stored one", "[published]") {
  StickRatioOptions options;
  options.moves_with_stick = options.follows_stick = false;
  Printed ratio(9, 9, options);
  const ContactFlags all(9, 9, 1);
  const auto moved = [](double by) {
    return grid_of([=](Index, Index) { return Point2<double>{by, 0}; });
  };
  // out, back to the first place, and out again: the reference is the frame in the first place
  for (const double by : {0.0, 4.0, 0.0}) {
    (void)ratio(moved(by), all);
  }
  const published::StickRatioResult<> out = ratio(moved(4), all);
  CHECK(out.ok());
  CHECK(out.reference_age == 1);
}

TEST_CASE("slides: the reference dot may be any but those of the border", "[published]") {
  const StickRatioOptions options = {.S2 = 0, .S3 = 0};
  const auto moved = grid_of([](Index, Index) { return Point2<double>{3, 0}; });
  for (Index k = 0; k < 81; ++k) {
    const DotIndex only = {k / 9, k % 9};
    const bool is_inside = only.row % 8 != 0 && only.col % 8 != 0;
    ContactFlags contact(9, 9);
    contact(only.row, only.col) = 1;
    Printed ratio(9, 9, options);
    (void)ratio(at_rest(), contact);
    CHECK(ratio(moved, contact).reference_dot == (is_inside ? only : DotIndex{4, 4}));
  }
}

TEST_CASE("slides: the reference dot is one of the stick region", "[published]") {
  // the columns on both sides and the dot in the middle stick; the others stay behind
  const auto sticks = [](Index i, Index j) { return j < 3 || j > 5 || (i == 4 && j == 4); };
  const auto frame = [&](int k) {
    return grid_of([&, k](Index i, Index j) {
      return Point2<double>{(sticks(i, j) ? 3.0 : 1.5) * k, 0};
    });
  };
  StickRatioOptions options;
  options.cancels_rotation = false;
  options.scale = StickScale::none;
  options.S2 = options.S3 = 0;
  Printed ratio(9, 9, options);
  ContactFlags contact(9, 9, 1);
  CHECK_FALSE(ratio(frame(0), contact).updated);
  const published::StickRatioResult<> first = ratio(frame(1), contact);
  REQUIRE(first.ok());
  CHECK(first.reference_dot == DotIndex{4, 4});  // of the contact: there was no earlier answer
  CHECK(first.stick_ratio == Approx(55.0 / 81));
  // the middle dot is gone: of the dots in contact its neighbours are the nearest; of the sticking
  // dots those in the column to the left, which comes nearer
  contact(4, 4) = 0;
  const published::StickRatioResult<> second = ratio(frame(2), contact);
  REQUIRE(second.ok());
  CHECK(second.reference_dot == DotIndex{4, 2});
  CHECK(second.stick_ratio == Approx(54.0 / 80));
}

TEST_CASE("slides: the mean over neighbours leaves the border", "[published]") {
  const auto bumped = [](Index row, Index col) {
    return grid_of([=](Index i, Index j) {
      return Point2<double>{3 + (i == row && j == col ? 0.6 : 0.0), 0};
    });
  };
  const Printed begun(
      9, 9, {.cancels_rotation = false, .scale = StickScale::none, .follows_stick = false});
  const ContactFlags all(9, 9, 1);
  const auto ratio_of = [&](const PointsPx& now) {
    Printed ratio = begun;
    CHECK_FALSE(ratio(at_rest(), all).updated);
    return ratio(now, all).stick_ratio;
  };
  // d_max = 3.6, delta = 0.43: the mean leaves a third of 0.6 px, which is within it, instead of
  // all
  for (Index row = 0; row < 9; ++row) {
    for (Index col = 0; col < 9; ++col) {
      const bool border = row == 0 || col == 0 || row == 8 || col == 8;
      CAPTURE(row, col);
      CHECK(ratio_of(bumped(row, col)) == Approx(border ? 80.0 / 81 : 1));
    }
  }
}

TEST_CASE("slides: dots that are not found count nowhere", "[published]") {
  // For a dot without its right neighbour the mean over the others lies 2.4 px to its left, ten
  // thresholds: it would slip whenever the neighbour appears or disappears.
  const auto run = [](bool lost_at_first, bool lost_now) {
    SlippingDots truth;
    Printed ratio(21, 21, {.cancels_rotation = false, .scale = StickScale::none});
    const auto frame = [&](bool lost) {
      auto dots = truth.dots;
      dots(10, 12) = lost ? Point2<double>{test::nan, test::nan} : dots(10, 12);
      return ratio(dots, truth.contact);
    };
    (void)frame(lost_at_first);
    truth.step({.shift_px = 3});
    return frame(lost_now);
  };
  for (const auto& r : {run(false, false), run(true, true), run(true, false), run(false, true)}) {
    CHECK(r.ok());
    CHECK(r.stick_ratio == 1);
  }
}

TEST_CASE("conventional stick ratio: the first reference stays, and delta", "[published]") {
  const auto moved = [](double x) {
    return grid_of([=](Index, Index) { return Point2<double>{x, 0}; });
  };
  const ContactFlags all(9, 9, 1);
  Printed ratio(9, 9, published::conventional_stick_ratio);
  CHECK_FALSE(ratio(moved(0), all).ok());
  for (int k = 1; k < 9; ++k) {
    auto dots = moved(k);
    dots(2, 6).x -= 0.25;
    dots(6, 2).x -= 0.23;
    const auto r = ratio(dots, all);
    CHECK(r.ok());
    CHECK(r.reference_age == k);
    CHECK(r.furthest_px == Approx(k));
    CHECK(r.reference_dot == DotIndex{4, 4});
    CHECK(r.stick_ratio == Approx(80.0 / 81));  // of any displacement
  }
  // a frame without contact ends the contact, and the next one is the reference
  CHECK_FALSE(ratio(moved(9), ContactFlags(9, 9)).ok());
  CHECK_FALSE(ratio(moved(20), all).ok());
  CHECK(ratio(moved(21), all).furthest_px == Approx(1));
}

TEST_CASE("slides: a press has its scale where something moves", "[published]") {
  // q = 0 at the middle alone (E036)
  SlippingDots truth;
  Printed ratio(21, 21);
  CHECK_FALSE(ratio(truth.dots, truth.contact).ok());
  truth.step({.zoom = 1.05});
  const auto r = ratio(truth.dots, truth.contact);
  REQUIRE(r.ok());
  CHECK(r.stick_ratio == 1);
  CHECK(r.scale == Approx(1 / 1.05).margin(2e-3));
  CHECK(std::abs(r.angle_rad) < 1e-12);
}

TEST_CASE("published stick ratio: it does not depend on how the image is held",
          "[published][law]") {
  rc::prop("shifted, rotated, mirrored, enlarged with the thresholds", [] {
    SlippingDots truth({.rows = 13, .cols = 13, .contact_pitches = 5.9});
    const double turn = test::uniform(-3.2, 3.2), scale = test::log_uniform(0.1, 10);
    const double mirror = test::whole(0, 1) == 1 ? -1 : 1;
    const double c = scale * std::cos(turn), s = scale * std::sin(turn);
    Printed ratio(13, 13),
        held(13, 13, {.U = 2 * scale, .U_min = 0.5 * scale, .delta_0 = 0.24 * scale});
    for (int k = 0; k < 8; ++k) {
      auto seen = truth.dots;
      for (auto& p : seen.cells) {
        p = {mirror * c * p.x - s * p.y + 100, mirror * s * p.x + c * p.y - 50};
      }
      const auto a = ratio(truth.dots, truth.contact);
      const auto b = held(seen, truth.contact);
      RC_ASSERT(a.updated == b.updated);
      RC_ASSERT(a.stick_ratio == b.stick_ratio);
      RC_ASSERT(a.reference_age == b.reference_age);
      RC_ASSERT(a.reference_dot == b.reference_dot);
      RC_ASSERT(std::abs(scale * a.furthest_px - b.furthest_px) < 1e-9 * scale);
      RC_ASSERT(std::abs(mirror * a.angle_rad - b.angle_rad) < 1e-9);
      RC_ASSERT(std::abs(a.scale - b.scale) < 1e-9);
      truth.step({.shift_px = test::uniform(0.5, 3),
                  .direction_rad = test::uniform(-3, 3),
                  .turn_rad = test::uniform(-0.03, 0.03),
                  .zoom = test::uniform(0.98, 1.02),
                  .stick_share = test::uniform(0.4, 0.9)});
    }
  });
}

TEST_CASE("slides: what is refused", "[published]") {
  const auto said = [](const StickRatioOptions& options) {
    return test::refusal([&] { const Printed r(9, 9, options); });
  };
  CHECK_THROWS_AS(Printed(2, 9), parameter_error);
  CHECK(said({.U = 0}) == "published::StickRatio: U = 0, must be finite and > 0");
  CHECK(said({.U = 0, .delta_grows = false}) == "accepted");
  CHECK(said({.U_min = -1}) == "published::StickRatio: U_min = -1, must be finite and >= 0");
  CHECK(said({.delta_0 = 0}) == "published::StickRatio: delta_0 = 0, must be finite and > 0");
  CHECK(said({.S1 = 0}) == "published::StickRatio: S1 = 0, must be finite and > 0");
  CHECK(said({.S2 = test::nan}) == "published::StickRatio: S2 = nan, must be finite and >= 0");
  CHECK(said({.S3 = -0.5}) == "published::StickRatio: S3 = -0.5, must be finite and >= 0");
  CHECK(said({.capacity = 0}) == "published::StickRatio: capacity = 0, must be in [1, 1000000]");
  Printed ratio(9, 9);
  CHECK_FALSE(ratio(PointsPx(9, 8), ContactFlags(9, 8, 1)).accepted);
  CHECK(ratio(at_rest(), ContactFlags(9, 9, 1)).accepted);
  Printed copy = ratio;
  const auto moved = grid_of([](Index, Index) { return Point2<double>{3, 0}; });
  CHECK(ratio(moved, ContactFlags(9, 9, 1)).reference_age == 1);
  CHECK(copy(moved, ContactFlags(9, 9, 1)).reference_age == 1);
}

TEST_CASE("S and D by hand", "[published]") {
  using test::measures_of;
  const auto falls = measures_of({1, 0.9, 0.9, 0.5, 0});
  CHECK(falls.sum == Approx(3.3));
  CHECK(falls.decreases == Approx(1));
  CHECK(falls.rises == 0);  // all of D could be measured
  CHECK(falls.steps == 5);

  const auto shakes = measures_of({1, 0.5, 0.75, 0.25, 0.5});
  CHECK(shakes.decreases == 1);
  CHECK(shakes.rises == 0.5);
  // contact is lost in between: nothing is compared across the gap
  const auto two = measures_of({test::nan, 1, 0.25, test::nan, test::nan, 1, 0.5, test::nan});
  CHECK(two.sum == 2.75);
  CHECK(two.decreases == 1.25);
  CHECK(two.rises == 0);
  CHECK(two.steps == 4);
}
