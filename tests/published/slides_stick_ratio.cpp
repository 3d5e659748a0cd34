// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The slides word for word: each printed form by a behaviour that only it has, and compared with
// the published preset, which is made of the library's parts.
#include "fingerpad/published/slides_stick_ratio.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "fingerpad/published/stick_ratio.hpp"
#include "support/catch.hpp"
#include "support/slipping_dots.hpp"

using namespace fingerpad;
using namespace fingerpad::published;
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

/// Result for `then` and `now`, without an average over neighbours.
template <class Then, class Now>
SlidesResult answer_of(SlidesOptions options, const Then& then, const Now& now) {
  options.weights = {1, 0, 0};
  const SlidesStickRatio ratio(9, 9, options);
  auto state = ratio.start();
  const ContactFlags all(9, 9, 1);
  CHECK_FALSE(ratio(then, all, state).updated);
  return ratio(now, all, state);
}

}  // namespace

TEST_CASE("slides: the mean of four angles, and where it wraps", "[published]") {
  // neighbours to the left, right, above and below, rotated by `angle`
  const auto mean = [](double first, double angle) {
    std::array<Point2<double>, 4> then, now;
    for (std::size_t k = 0; k < 4; ++k) {
      const double at = first + pi / 2 * static_cast<double>(k);
      then[k] = {std::cos(at), std::sin(at)};
      now[k] = {2 * std::cos(at + angle), 2 * std::sin(at + angle)};
    }
    return mean_of_four_angles(then, now);
  };
  CHECK(mean(0.3, 0.2) == Approx(0.2));
  CHECK(mean(0.3, -0.2) == Approx(-0.2));
  // a neighbour at 175 degrees that rotates to 186.5 is measured at -173.5
  CHECK(mean(pi - 0.1, 0.2) == Approx(0.2 - pi / 2));
}

TEST_CASE("slides: a rotation is cancelled, and only where it is asked for", "[published]") {
  const auto rotated = grid_of([](Index i, Index j) {
    const double x = 20.0 * static_cast<double>(j - 4), y = 20.0 * static_cast<double>(i - 4);
    const double c = std::cos(0.08), s = std::sin(0.08);
    return Point2<double>{c * x - s * y - x + 3, s * x + c * y - y};
  });
  SlidesOptions with;
  with.reference = SlidesReference::central;
  // the left neighbour lies along -x: its angle wraps when the pattern rotates the other way
  const auto then = grid_of([](Index, Index j) {
    return Point2<double>{0, 1e-3 * static_cast<double>(4 - j)};
  });
  const SlidesResult cancelled = answer_of(with, then, rotated);
  CHECK(cancelled.ok());
  CHECK(std::abs(cancelled.angle_rad - 0.08) > 1.5);  // it wraps
  SlidesOptions tilted = with;                        // no wrap where no neighbour lies along -x
  const auto turned_by = [](double angle) {
    return grid_of([=](Index i, Index j) {
      const double x = 20.0 * static_cast<double>(j - 4), y = 20.0 * static_cast<double>(i - 4);
      const double c = std::cos(angle), s = std::sin(angle);
      return Point2<double>{c * x - s * y - x, s * x + c * y - y};
    });
  };
  const SlidesResult right = answer_of(tilted, turned_by(0.3), turned_by(0.38));
  CHECK(right.angle_rad == Approx(0.08));
  CHECK(right.stick_ratio == 1);
  tilted.cancels_rotation = false;
  const SlidesResult left = answer_of(tilted, turned_by(0.3), turned_by(0.38));
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
  SlidesOptions options;
  options.cancels_rotation = false;
  options.scale = SlidesScale::across;
  // the motion of 400 px has hardly a part along y, and nothing is stretched across it
  CHECK(answer_of(options, at_rest(), now).scale == Approx(1 / 1.05).margin(2e-3));
  options.scale = SlidesScale::plain;
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
  options.scale = SlidesScale::none;
  CHECK(answer_of(options, at_rest(), now).scale == 1);
}

TEST_CASE("slides: delta fixed or in proportion; N_s / N_c over all dots in contact",
          "[published]") {
  // 4 px along x; row k lags by 0.1 k px
  const auto now = grid_of([](Index i, Index) {
    return Point2<double>{4 - 0.1 * static_cast<double>(i), 0};
  });
  SlidesOptions options;
  options.cancels_rotation = false;
  options.scale = SlidesScale::none;
  options.reference = SlidesReference::central;  // row 4
  // d_max = 4: delta = 0.48, rows 0 to 8 within 0.4
  CHECK(answer_of(options, at_rest(), now).stick_ratio == 1);
  CHECK(answer_of(options, at_rest(), now).furthest_px == Approx(4));
  options.delta = SlidesDelta::fixed;
  // delta = 0.24: rows 2 to 6
  CHECK(answer_of(options, at_rest(), now).stick_ratio == Approx(5.0 / 9));
  options.test.slip = 0.29;  // still rows 2 to 6
  CHECK(answer_of(options, at_rest(), now).stick_ratio == Approx(5.0 / 9));
  // a dot in contact without an answer of its own counts in N_c: none is left out
  options.test.slip = 1e-9;
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
  const auto first_answers = [&](AnswerWhen when) {
    SlidesOptions options;
    options.answers = when;
    options.reference = SlidesReference::central;
    options.cancels_rotation = false;
    options.scale = SlidesScale::none;
    options.weights = {1, 0, 0};
    const SlidesStickRatio ratio(9, 9, options);
    auto state = ratio.start();
    const ContactFlags all(9, 9, 1);
    std::array<Index, 2> ages = {0, 0};
    int answers = 0;
    for (int k = 0; answers < 2; ++k) {
      const SlidesResult r = ratio(frame(k), all, state);
      if (r.ok()) {
        ages[static_cast<std::size_t>(answers++)] = r.reference_age;
      }
    }
    return ages;
  };
  // 3 px of a dot in contact are 2 frames
  CHECK(first_answers(AnswerWhen::contact_moved) == std::array<Index, 2>{2, 2});
  // 2.5 px of the stick region, the middle column, are 5 frames; at the first answer there is none
  // yet
  CHECK(first_answers(AnswerWhen::stick_region_moved) == std::array<Index, 2>{2, 5});
}

TEST_CASE("slides: the reference dot is one of the stick region", "[published]") {
  // the columns on both sides and the dot in the middle stick; the others stay behind
  const auto sticks = [](Index i, Index j) { return j < 3 || j > 5 || (i == 4 && j == 4); };
  const auto frame = [&](int k) {
    return grid_of([&, k](Index i, Index j) {
      return Point2<double>{(sticks(i, j) ? 3.0 : 1.5) * k, 0};
    });
  };
  SlidesOptions options;
  options.cancels_rotation = false;
  options.scale = SlidesScale::none;
  options.weights = {1, 0, 0};
  const SlidesStickRatio ratio(9, 9, options);
  auto state = ratio.start();
  ContactFlags contact(9, 9, 1);
  CHECK_FALSE(ratio(frame(0), contact, state).updated);
  const SlidesResult first = ratio(frame(1), contact, state);
  REQUIRE(first.ok());
  CHECK(first.reference_dot == DotIndex{4, 4});  // of the contact: there was no earlier answer
  CHECK(first.stick_ratio == Approx(55.0 / 81));
  // the middle dot is gone: of the dots in contact its neighbours are the nearest; of the sticking
  // dots those in the column to the left, which comes nearer
  contact(4, 4) = 0;
  const SlidesResult second = ratio(frame(2), contact, state);
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
  SlidesOptions options;
  options.cancels_rotation = false;
  options.scale = SlidesScale::none;
  options.reference = SlidesReference::central;
  const SlidesStickRatio ratio(9, 9, options);
  const ContactFlags all(9, 9, 1);
  const auto slides_ratio = [&](const PointsPx& now) {
    auto state = ratio.start();
    CHECK_FALSE(ratio(at_rest(), all, state).updated);
    return ratio(now, all, state).stick_ratio;
  };
  // d_max = 3.6, delta = 0.43: the mean leaves a third of 0.6 px, which is within it, instead of
  // all
  const auto preset = stick_ratio<double>(9, 9);
  const auto preset_ratio = [&](const PointsPx& now) {
    auto state = preset.start();
    test::DotStates states(9, 9);
    CHECK_FALSE(preset(at_rest(), all, states, state).updated());
    return preset(now, all, states, state).stick_ratio;
  };
  CHECK(slides_ratio(bumped(3, 6)) == 1);
  CHECK(preset_ratio(bumped(3, 6)) == 1);
  for (const auto& [row, col] : {std::pair<Index, Index>{3, 8}, {0, 4}, {8, 2}, {5, 0}}) {
    CAPTURE(row, col);
    CHECK(slides_ratio(bumped(row, col)) == Approx(80.0 / 81));
    CHECK(preset_ratio(bumped(row, col)) == Approx(80.0 / 81));
  }
}

TEST_CASE("slides: what is refused", "[published]") {
  CHECK_THROWS_AS(SlidesStickRatio(2, 9), parameter_error);
  CHECK_THROWS_AS(SlidesStickRatio(9, 9, {.capacity = 0}), parameter_error);
  const SlidesStickRatio ratio(9, 9);
  auto state = ratio.start();
  CHECK_FALSE(ratio(PointsPx(9, 8), ContactFlags(9, 8, 1), state).accepted);
  auto lost = at_rest();
  lost(2, 2).x = test::nan;
  CHECK_FALSE(ratio(lost, ContactFlags(9, 9, 1), state).accepted);
  CHECK(ratio(at_rest(), ContactFlags(9, 9, 1), state).accepted);
}

TEST_CASE("the published stick ratio is the slides'", "[published]") {
  // Frame by frame on all synthetic scenes with noise. The preset's angle is that of summed
  // products (E034), and without motion it has alpha = 1 (E036), so a dot at the threshold may fall
  // on either side.
  Index frames = 0, wrapped = 0, other_references = 0, other_frames = 0;
  double worst_angle = 0, worst_scale = 0;
  for (const test::SlipScene scene : test::all_slip_scenes) {
    for (int n = 0; n < 4; ++n) {
      test::SlippingPattern pattern;
      test::Random random(static_cast<std::uint64_t>(1 + n));
      SlippingDots truth(pattern);
      const auto preset = stick_ratio<double>(21, 21);
      const SlidesStickRatio slides(21, 21);
      auto preset_state = preset.start();
      auto slides_state = slides.start();
      test::DotStates states(21, 21);
      const auto show = [&] {
        const auto seen = noisy(truth.dots, 0.06, random);
        const auto a = preset(seen, truth.contact, states, preset_state);
        const SlidesResult b = slides(seen, truth.contact, slides_state);
        REQUIRE(b.accepted);
        if (a.status == StickStatus::standing) {  // the slides still answer at rest
          return;
        }
        REQUIRE(a.updated() == b.updated);
        if (!b.updated) {
          return;
        }
        ++frames;
        CHECK(a.reference_age == b.reference_age);
        if (std::abs(b.angle_rad) > 0.5) {  // a neighbour along -x has wrapped
          ++wrapped;
          return;
        }
        const double dots = static_cast<double>(a.stick + a.slip);
        const double off = std::abs(a.stick_ratio - b.stick_ratio) * dots;
        other_frames += a.reference_dot == b.reference_dot && off > 0.5 ? 1 : 0;
        other_references += a.reference_dot == b.reference_dot ? 0 : 1;
        if (a.reference_dot == b.reference_dot) {
          worst_angle = (std::max)(worst_angle, std::abs(a.angle_rad - b.angle_rad));
          worst_scale = (std::max)(worst_scale, std::abs(a.scale - b.scale));
        }
      };
      show();
      for (const test::SlipStep& step : steps_of(scene, 2.4 * n)) {
        truth.step(step);
        show();
      }
    }
  }
  INFO(frames << " frames; wrapped " << wrapped << ", other reference dots " << other_references
              << ", other ratios " << other_frames << "; angle " << worst_angle << ", scale "
              << worst_scale);
  CHECK(frames > 700);
  CHECK(wrapped > 100);  // E034: the pattern is along x, and so is every left neighbour
  CHECK(other_references <= frames / 20);
  CHECK(other_frames <= frames / 50);
  CHECK(worst_angle < 1e-3);
  CHECK(worst_scale < 1e-3);
}
