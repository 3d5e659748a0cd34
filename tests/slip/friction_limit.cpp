// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/slip/friction_limit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

#include "fingerpad/adapt/dual.hpp"
#include "fingerpad/gel/gel_slide.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/catch.hpp"
#include "support/refusal.hpp"
#include "support/slipping_patch.hpp"

using namespace fingerpad;

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

ContactLoad<double> pull(double tangential_n, double normal_n = 4) {
  return {normal_n, tangential_n};
}

}  // namespace

TEST_CASE("friction limit: the load of a contact from force, moment and dots", "[friction_limit]") {
  // a flat patch about (0, 0, 10); its mean distance from the middle is 2/3 of its radius
  const test::SlippingPatch patch(0.6, 5.9, std::numeric_limits<double>::infinity());
  const Point3<double> force{0.3, 0.4, -2};
  // a moment of 1.5 about the normal through (0, 0, 10), plus the moment of the force about Q
  const Point3<double> arm{0, 0, 10};
  const Point3<double> moment = cross(arm, force) + Point3<double>{0, 0, 1.5};
  const auto load = contact_load(force, moment, patch.dots, patch.contact);
  CHECK(load.normal_n == Approx(2));
  CHECK(load.tangential_n == Approx(0.5));
  // a disc that slides and turns is close to an ellipse (Howe, Cutkosky, 1996)
  const double ellipse = std::hypot(0.25, 1.5 / (2.0 / 3 * 5.9 * 2));
  CHECK(friction_of(load) > ellipse);
  CHECK(friction_of(load) == Approx(ellipse).epsilon(0.08));
  SECTION("it turns with the pad") {
    const auto turn = test::moved_by({0.2, -0.3, 0.5}, {1, 2, 3}, {0, 0, 1});
    auto dots = patch.dots;
    for (auto& p : dots.cells) {
      p = turn(p);
    }
    const auto f = turn.rotation(force);
    const auto m = turn.rotation(moment) + cross(turn.translation_mm, f);
    const auto other = contact_load(f, m, dots, patch.contact);
    CHECK(other.normal_n == Approx(2));
    CHECK(other.tangential_n == Approx(0.5));
    CHECK(other.friction == Approx(load.friction));
  }
  SECTION("a domed contact has the load of its plan") {
    auto dots = patch.dots;
    for (auto& p : dots.cells) {
      p.z -= (p.x * p.x + p.y * p.y) / 20;
    }
    CHECK(contact_load(force, moment, dots, patch.contact).friction == Approx(load.friction));
  }
  SECTION("forces along the contact and the moment about its normal are enough") {
    const Point2<double> along{0.3, 0.4};
    const auto same = contact_load(2.0, along, 1.5, patch.dots, patch.contact);
    CHECK(same.normal_n == Approx(2));
    CHECK(same.friction == Approx(load.friction));
    CHECK(contact_load(2.0, along, none, patch.dots, patch.contact).friction == Approx(0.25));
    const Point2<double> unknown{none, none};
    CHECK(!is_finite(friction_of(contact_load(2.0, unknown, 1.5, patch.dots, patch.contact))));
  }
  SECTION("what is missing has no load") {
    const test::Image<std::uint8_t> free(21, 21, 0);
    CHECK(!is_finite(contact_load(force, moment, patch.dots, free).normal_n));
    CHECK(!is_finite(contact_load(force, moment, patch.dots, test::Image<int>(2, 2)).normal_n));
    CHECK(!is_finite(friction_of(ContactLoad<double>{})));
    CHECK(!is_finite(friction_of(pull(1, -2))));
    CHECK(std::isnan(friction_of(pull(1, 0))));
    CHECK(friction_of(ContactLoad<double>{2, 1}) == 0.5);  // the forces alone
  }
}

TEST_CASE("friction limit: dots on a line lie in a level surface", "[friction_limit]") {
  test::Image<Point3<double>> dots(1, 3);
  for (Index j = 0; j < 3; ++j) {  // 5, 0 and 5 mm from their middle
    dots(0, j) = {3.0 * static_cast<double>(j), 4.0 * static_cast<double>(j), 10};
  }
  const Point3<double> force{0, 0, -2}, middle{3, 4, 10};
  const Point3<double> moment = cross(middle, force) + Point3<double>{7, 8, 2};
  const auto load = contact_load(force, moment, dots, test::Image<int>(1, 3, 1));
  CHECK(load.normal_n == Approx(2));
  CHECK(load.friction == Approx(0.3).epsilon(0.001));  // two of the three dots have an arm
}

TEST_CASE("friction limit: L is the friction of whatever slides and turns about any point") {
  // A disc, a rod, half a disc and two patches on the tilted plate z = 10 + x / 4.
  const auto touches = [](int shape, double x, double y) {
    const double sq = x * x + y * y;
    return shape == 0   ? sq < 36
           : shape == 1 ? std::abs(y) < 1.5 && std::abs(x) < 8
           : shape == 2 ? sq < 36 && y > 0
                        : square(std::abs(x) - 5) + y * y < 4;
  };
  for (int shape = 0; shape < 4; ++shape) {
    double worst = 0;
    for (const double away : {0.3, 0.7, 2.2, 3.6, 5.3, 9.1, 1e6}) {
      for (const double toward : {0.1, 1.6, 2.5}) {
        test::Image<Point3<double>> dots(21, 21);
        test::Image<std::uint8_t> contact(21, 21);
        const double n = std::sqrt(1 + square(0.25));
        const Point3<double> normal{-0.25 / n, 0, 1 / n}, along{1 / n, 0, 0.25 / n};
        const Point3<double> pole =
            away * (std::cos(toward) * along) + away * std::sin(toward) * Point3<double>{0, 1, 0};
        Point3<double> force{0, 0, 0}, moment{0, 0, 0};
        for (Index k = 0; k < 441; ++k) {
          const double x = static_cast<double>(k % 21 - 10), y = static_cast<double>(k / 21 - 10);
          const Point3<double> arm = x * along + y * Point3<double>{0, 1, 0};
          const Point3<double> at = Point3<double>{0, 0, 10} + arm;
          dots(k / 21, k % 21) = at;
          contact(k / 21, k % 21) = touches(shape, x, y) ? 1 : 0;
          const Point3<double> slide = cross(normal, arm - pole);
          if (touches(shape, x, y) && norm(slide) > 0) {
            const Point3<double> pull = 0.6 * normalized(slide) - normal;
            force += pull;
            moment += cross(at, pull);
          }
        }
        worst = std::max(worst,
                         std::abs(contact_load(force, moment, dots, contact).friction / 0.6 - 1));
      }
    }
    CAPTURE(shape);
    CHECK(worst < 0.02);
  }
}

TEST_CASE("friction limit: without tangential force L is 0 and has a slope", "[friction_limit]") {
  const auto [tangential] = seeded(std::array{0.0});
  using Dual = std::remove_cvref_t<decltype(tangential)>;
  const Dual friction = friction_of(ContactLoad<Dual>{Dual(4.0), tangential});
  CHECK(friction.value == 0);
  CHECK(std::isfinite(friction.slopes[0]));
}

TEST_CASE("friction limit: learnt when the dots slide, answers when they do not",
          "[friction_limit]") {
  FrictionLimit<double> limit;
  auto r = limit(pull(1), 0.9, RatioUpdate::fresh);
  CHECK(r.status == FrictionLimitStatus::no_limit);
  CHECK(r.evidence == SlipEvidence::dots);
  CHECK(r.stick_ratio == 0.9);
  CHECK(r.friction == 0.25);
  CHECK(!is_finite(r.margin));

  r = limit(pull(2.2), 0.1, RatioUpdate::fresh);
  CHECK(r.status == FrictionLimitStatus::sliding);
  CHECK(r.evidence == SlipEvidence::both);
  CHECK(r.stick_ratio == 0);
  CHECK(r.limit == 0.55);
  CHECK(r.margin == Approx(0).margin(1e-12));

  // the dots rest and agree with one another; friction continues
  r = limit(pull(2.2), 0.95, RatioUpdate::fresh);
  CHECK(r.status == FrictionLimitStatus::sliding);
  CHECK(r.evidence == SlipEvidence::friction);
  CHECK(r.stick_ratio == 0);
  r = limit(pull(2.15), none, RatioUpdate::missing);
  CHECK(r.stick_ratio == 0);
  CHECK(r.update == RatioUpdate::fresh);
  CHECK(r.ok());

  // the load falls: the dots count again
  r = limit(pull(1.5), 0.95, RatioUpdate::unmoved);
  CHECK(r.status == FrictionLimitStatus::held);
  CHECK(r.evidence == SlipEvidence::dots);
  CHECK(r.stick_ratio == 0.95);
  CHECK(r.update == RatioUpdate::unmoved);
  CHECK(r.margin == Approx(1 - 1.5 / 2.2));

  // a frame without force leaves the result of the dots unchanged
  r = limit(ContactLoad<double>{}, 0.4, RatioUpdate::fresh);
  CHECK(r.status == FrictionLimitStatus::no_load);
  CHECK(r.stick_ratio == 0.4);
  CHECK(!limit(pull(1, 0.01), none, RatioUpdate::missing).ok());
  limit.reset();
  CHECK(!is_finite(limit.limit()));
}

TEST_CASE("friction limit: a gel's imprint in place of the dots", "[friction_limit]") {
  FrictionLimit<double> limit;
  SlideResult slide;
  slide.status = SlideStatus::updated;
  slide.evidence = 0.25;
  auto r = limit(pull(1), slide);
  CHECK(r.evidence == SlipEvidence::imprint);
  CHECK(r.update == RatioUpdate::fresh);
  CHECK(r.stick_ratio == 0.75);
  CHECK(r.status == FrictionLimitStatus::no_limit);
  CHECK(limit(ContactLoad<double>{}, slide).stick_ratio == 0.75);

  slide.evidence = 1.5;  // the alarm teaches the limit
  r = limit(pull(2.2), slide);
  CHECK(r.evidence == SlipEvidence::both);
  CHECK(r.stick_ratio == 0);
  CHECK(r.limit == 0.55);

  slide.status = SlideStatus::not_found;  // an old alarm is no answer, but friction is
  r = limit(pull(2.2), slide);
  CHECK(r.evidence == SlipEvidence::friction);
  CHECK(r.stick_ratio == 0);
  r = limit(pull(1), slide);
  CHECK(r.evidence == SlipEvidence::none);
  CHECK(r.update == RatioUpdate::missing);
  CHECK(!r.ok());
  slide.status = SlideStatus::no_contact;
  CHECK(limit(ContactLoad<double>{}, slide).update == RatioUpdate::no_contact);
}

TEST_CASE("friction limit: what it learns", "[friction_limit]") {
  FrictionLimit<double> limit;
  const auto slide = [&](double tangential_n) {
    (void)limit(pull(tangential_n), 0.1, RatioUpdate::fresh);
    return limit.limit();
  };
  SECTION("it rises soon, by no more than max_rise, and falls slowly") {
    CHECK(slide(2) == 0.5);
    CHECK(slide(4) == Approx(0.5 * 1.15 * 0.95));  // what noise leaves of 1.15
    const double before = limit.limit();
    CHECK(slide(4 * 0.97 * before) == Approx(before * 0.997));
    CHECK(slide(4 * 0.9 * limit.limit()) == limit.limit());  // below: the limit is kept
  }
  SECTION("noise of 1.5 % makes no bias to speak of, and misses next to no slide") {
    test::Random random(3);
    (void)slide(2.2);
    int missed = 0;
    for (int k = 0; k < 3000; ++k) {
      const double noise = 1 + 0.015 * random.normal();
      missed += limit(pull(2.2 * noise), k % 3 == 0 ? 0.1 : 0.7, RatioUpdate::fresh).status ==
                        FrictionLimitStatus::sliding
                    ? 0
                    : 1;
    }
    CHECK(limit.limit() == Approx(0.55).epsilon(0.025));
    CHECK(missed < 60);
  }
  SECTION("answers that are kept teach nothing") {
    (void)limit(pull(2), 0.1, RatioUpdate::unmoved);
    CHECK(!is_finite(limit.limit()));
    (void)limit(pull(0), 0.1, RatioUpdate::fresh);
    CHECK(!is_finite(limit.limit()));  // no load
  }
  SECTION("hardly any friction is none") {
    CHECK(!is_finite(slide(4 * 0.99e-6)));
    CHECK(slide(4 * 1.05e-6) == Approx(1.05e-6));
  }
  SECTION("a limit that the object holds beyond is forgotten") {
    (void)slide(1);
    const auto r = limit(pull(1.6), 0.9, RatioUpdate::fresh);
    CHECK(r.status == FrictionLimitStatus::no_limit);
    CHECK(r.stick_ratio == 0.9);
    (void)slide(2);
    // but not where dots may all be carried along
    CHECK(limit(pull(2.1), 0.9, RatioUpdate::fresh).stick_ratio == 0);
    CHECK(limit(pull(3), 0.3, RatioUpdate::fresh).stick_ratio == 0);
  }
}

TEST_CASE("friction limit: the standard deviation knows the noise of the load") {
  // L of a slide is normal about the limit with 0.0295 of it, L of a hold even up to the limit. The
  // dots err by 0.1 in a hold; a slide may carry any share of them. Where L is near the limit,
  // either may be true, and the answer is that of one.
  const double noise = std::sqrt(2.0) * 0.05 / 2.4;
  test::Random random(4);
  double within_two = 0, within_five = 0, all = 0, mean_sd = 0;
  for (int k = 0; k < 20000; ++k) {
    const bool slides = k % 2 == 0;
    const double truth = slides ? 0.2 * random.uniform() : random.uniform();
    const double of_limit = slides ? 1 + noise * random.normal() : random.uniform();
    FrictionLimit<double> limit;
    (void)limit(pull(2.2), 0.1, RatioUpdate::fresh);
    const StickResult<double> seen{
        .status = StickStatus::updated,
        .stick_ratio =
            slides ? random.uniform(0.21, 1) : std::clamp(truth + 0.1 * random.normal(), 0.21, 1.0),
        .ratio_sd = 0.1};
    const auto r = limit(pull(2.2 * of_limit), seen);
    const double error = std::abs(r.stick_ratio - truth);
    within_two += error < 2 * r.ratio_sd ? 1 : 0;
    within_five += error < 5 * r.ratio_sd ? 1 : 0;
    mean_sd += r.ratio_sd / 20000;
    ++all;
  }
  CAPTURE(within_two / all, within_five / all, mean_sd);
  CHECK(within_two / all > 0.93);
  CHECK(within_five / all > 0.998);
  CHECK(mean_sd < 0.2);
}

TEST_CASE("friction limit: fast reversals of an object that slides and carries all dots alike") {
  // The dots tell 1. The load changes in every frame, and L stays at the limit, to its noise.
  test::Random random(5);
  test::SlippingPatch patch;
  StickRatio<> stick(21, 21, {.noise = 0.005});
  FrictionLimit<double> limit;
  for (int k = 0; k < 3; ++k) {
    (void)limit(pull(2.2), 0.1, RatioUpdate::fresh);
  }
  int told_to_stick = 0, beyond = 0;
  for (int k = 0; k < 400; ++k) {
    const double normal_n = random.uniform(2, 6), noise = 1 + 0.021 * random.normal();
    const auto seen = stick(noisy(patch.dots, 0.005, 0.025, random), patch.contact);
    const auto r = limit(pull(0.55 * normal_n * noise, normal_n), seen);
    told_to_stick += r.ok() && r.stick_ratio > 0.5 ? 1 : 0;
    beyond += r.ok() && r.stick_ratio > 2 * r.ratio_sd ? 1 : 0;
    const double away = k % 4 < 2 ? 0.3 : -0.3;
    patch.step(test::moved_by({0, 0, 0}, {0, 0, 0}, {away, 0.1 * away, 0}));
  }
  CAPTURE(told_to_stick, beyond);
  CHECK(told_to_stick < 12);  // in 1 of 120 frames L lies below 0.95 of its mean
  CHECK(beyond <= 1);
}

TEST_CASE("friction limit: no object bears more than its limit", "[friction_limit]") {
  StickResult<double> seen{.status = StickStatus::updated, .stick_ratio = 0.1, .ratio_sd = 0.4};
  FrictionLimit<double> limit;
  CHECK(limit(pull(2), seen).ratio_sd == 0.4);  // the dots alone say that it slides
  CHECK(limit(pull(2), seen).ratio_sd < 0.2);
  seen.stick_ratio = 0.6;
  CHECK(limit(pull(2.2), seen).limit == 0.5);  // dots that stick may bear more under more friction
  seen.stick_ratio = 0.4;
  CHECK(limit(pull(2.2), seen).limit == Approx(0.55 * 0.95));
  CHECK(limit(pull(2.0), seen).limit == Approx(0.55 * 0.95));
}

TEST_CASE("friction limit: on a soft object dots that fall behind need not slip") {
  FrictionLimit<double> limit({.soft_object = true});
  StickResult<double> seen{.status = StickStatus::updated, .stick_ratio = 1, .ratio_sd = 0.1};
  CHECK(limit(pull(1), seen).stick_ratio == 1);
  CHECK(limit(pull(1), seen).ratio_sd == 0.1);
  seen.stick_ratio = 0.6;
  const auto sheared = limit(pull(1), seen);
  CHECK(sheared.stick_ratio == Approx(0.8));
  CHECK(sheared.ratio_sd == Approx(std::sqrt(0.01 + 0.16 / 12)));
  CHECK_FALSE(sheared.in_doubt);
  CHECK(sheared.dots_ratio == 0.6);
  seen.stick_ratio = 0.3;
  CHECK(limit(pull(1.5), seen).stick_ratio == Approx(0.65));
  CHECK(limit(pull(1.5), seen).in_doubt);
  seen.stick_ratio = 0.1;  // a slide all the same
  CHECK(limit(pull(2), seen).stick_ratio == 0);
  CHECK(limit.limit() == 0.5);
}

TEST_CASE("friction limit: dots that fall back are asked where the load falls with them",
          "[friction_limit]") {
  FrictionLimit<double> limit;
  StickResult<double> seen{.status = StickStatus::updated, .stick_ratio = 0.1, .ratio_sd = 0};
  (void)limit(pull(2.2), seen);
  (void)limit(pull(2.2), seen);
  seen.status = StickStatus::falls_back;
  seen.ratio_sd = 0.3;
  seen.back_ratio = 0.8;
  seen.back_sd = 0.15;
  seen.back_age = 1;
  SECTION("an object that turns round carries them, and its load falls") {
    const auto r = limit(pull(1.8), seen);
    CHECK(r.stick_ratio == 0.8);
    CHECK(r.ratio_sd == Approx(std::hypot(0.15, 0.8 / std::sqrt(3.0))).margin(1e-5));
    CHECK(r.in_doubt);
    CHECK(r.evidence == SlipEvidence::both);
    CHECK(r.update == RatioUpdate::fresh);
    CHECK(r.reference_age == 1);
    CHECK(limit(pull(1.4), seen).stick_ratio == 0.8);
    seen = {.status = StickStatus::updated, .stick_ratio = 0.8, .ratio_sd = 0.15};
    CHECK(limit(pull(1.4), seen).in_doubt);  // the first answer of the dots themselves
    CHECK(limit(pull(1.4), seen).ratio_sd == Approx(0.15).margin(1e-5));
  }
  SECTION("one that slides lets them go, and its load stays") {
    const auto r = limit(pull(2.1), seen);
    CHECK(r.stick_ratio == 0);
    CHECK(r.ratio_sd > 0.2);  // the dots say that most are carried
  }
  SECTION("before a limit is known, that is the first slide of an object") {
    struct Case {
      double told, pull_n, stick_ratio;
    };
    for (const Case& c : {Case{0.4, 2.15, 0},      // less than half sticks, and the load is kept
                          Case{0.6, 2.15, 0.6},    // more sticks: the object may turn aside
                          Case{0.4, 2.06, 0.4},    // the load falls a little: unknown
                          Case{0.4, 2.0, 0.8}}) {  // it falls: carried
      CAPTURE(c.told, c.pull_n);
      limit.reset();
      seen.status = StickStatus::updated;
      seen.stick_ratio = c.told;
      seen.back_ratio = test::nan;
      (void)limit(pull(2.2), seen);
      seen.status = StickStatus::falls_back;
      seen.back_ratio = 0.8;
      seen.back_sd = 0.15;
      seen.back_age = 1;
      const auto r = limit(pull(c.pull_n), seen);
      CHECK(r.stick_ratio == c.stick_ratio);
      CHECK(r.falls_back);
      CHECK(is_finite(limit.limit()) == (c.stick_ratio == 0));
      CHECK((r.evidence == SlipEvidence::both) == (c.stick_ratio != c.told));
      CHECK((r.update == RatioUpdate::fresh) == (c.stick_ratio != c.told));
      const double kept_sd = std::hypot(0.3, c.told / std::sqrt(3));  // or the object slides
      CHECK((r.ratio_sd == Approx(c.stick_ratio == 0.8 ? 0.15 : kept_sd)) == (c.stick_ratio != 0));
    }
  }
  SECTION("a contact that hardly presses has no limit") {
    limit.reset();
    seen.stick_ratio = 0.4;
    const auto light = [](double n) {
      return ContactLoad<double>{.normal_n = n, .tangential_n = n};
    };
    (void)limit(light(4), 0.4, RatioUpdate::fresh);
    CHECK(limit(light(0.01), seen).stick_ratio == 0.4);
    CHECK(!is_finite(limit.limit()));
  }
  SECTION("the reference may be 64 frames back, and every load since then must be known") {
    limit.reset();
    seen.stick_ratio = 0.6;
    seen.back_age = 64;
    const auto after = [&](int frames, const ContactLoad<double>& between) {
      limit.reset();
      (void)limit(pull(2.2), 0.9, RatioUpdate::fresh);
      for (int k = 1; k < frames; ++k) {
        (void)limit(k == 30 ? between : pull(1.9), 0.9, RatioUpdate::fresh);
      }
      return limit(pull(1.9), seen).stick_ratio;
    };
    CHECK(after(64, pull(1.9)) == 0.8);  // the reference bore 2.2 N
    CHECK(after(65, pull(1.9)) == 0.6);
    CHECK(after(64, ContactLoad<double>{}) == 0.6);
  }
  SECTION("without a force nothing tells them apart") {
    CHECK(limit(ContactLoad<double>{}, seen).update == RatioUpdate::missing);
  }
}

TEST_CASE("friction limit: which dots hold", "[friction_limit]") {
  // of one dot of each state
  const auto held = [](const SlipResult<double>& slip) {
    std::string states;
    for (const DotState state :
         {DotState::none, DotState::unknown, DotState::slip, DotState::stick}) {
      states += slip.holds(state) ? '1' : '0';
    }
    return states;
  };
  const auto ratio = [](double share, Index dots) {
    return StickResult<double>{.status = StickStatus::updated, .stick = dots, .stick_ratio = share};
  };
  FrictionLimit<double> limit;
  const auto without_force = [&](const StickResult<double>& seen) {
    return held(limit(ContactLoad<double>{}, seen));
  };
  SECTION("those whose state says so") {
    CHECK(without_force(ratio(0.5, 100)) == "1101");
  }
  SECTION("none, unless the ratio is above a fifth by more than its dots leave open") {
    const double open = std::hypot(0.065, 0.9 / 10);
    CHECK(without_force(ratio(0.21 + open, 100)) == "1101");
    CHECK(without_force(ratio(0.19 + open, 100)) == "0000");
    CHECK(without_force(ratio(0.19 + open, 1000)) == "1101");
    CHECK(without_force(ratio(0.9, 0)) == "0000");
    auto kept = ratio(0.1, 100);  // tells nothing of this frame
    kept.status = StickStatus::unmoved;
    CHECK(without_force(kept) == "1101");
  }
  SECTION("none while friction shows a slide") {
    (void)limit(pull(2.2), ratio(0.1, 0));
    CHECK(held(limit(pull(1.9), ratio(0.9, 100))) == "1101");
    CHECK(held(limit(pull(2.2), ratio(0.9, 100))) == "0000");
  }
  SECTION("all that fall back with an object that carries most of them") {
    (void)limit(pull(2.2), ratio(0.3, 100));
    auto seen = ratio(0.3, 100);
    seen.status = StickStatus::falls_back;
    seen.back_ratio = 0.9;
    seen.back_age = 1;
    auto again = limit;
    CHECK(held(again(pull(1.8), seen)) == "1111");
    again = limit;
    CHECK(held(again(pull(2.06), seen)) == "1101");  // the load does not say who moves them
    CHECK(without_force(seen) == "1101");
    seen.back_ratio = 0.5;  // half of them slip: too many for a fit
    (void)limit(pull(2.2), ratio(0.3, 100));
    CHECK(held(limit(pull(1.8), seen)) == "1101");
  }
}

TEST_CASE("friction limit: a ratio in doubt", "[friction_limit]") {
  FrictionLimit<double> limit;
  const auto seen = [](double ratio, double sd, bool far_apart = false) {
    return StickResult<double>{.status = StickStatus::updated,
                               .stick = 100,
                               .far_apart = far_apart,
                               .stick_ratio = ratio,
                               .ratio_sd = sd};
  };
  CHECK_FALSE(limit(pull(1.0), seen(0.5, 0.2)).in_doubt);
  CHECK(limit(pull(1.0), seen(0.5, 0.2, true)).in_doubt);
  CHECK(limit(pull(1.0), seen(0.5, 0.41)).in_doubt);  // two random ratios differ by 0.408
  CHECK(limit({}, seen(0.5, 0.2)).in_doubt);          // no load tells a slide
  CHECK_FALSE(limit({}, seen(0.9, 0.2)).in_doubt);
  CHECK_FALSE(limit(pull(2.2), seen(0.1, 0.2)).in_doubt);  // the first slide
  CHECK_FALSE(limit(pull(2.3), seen(0.1, 0.2)).in_doubt);
  const auto against = limit(pull(2.3), seen(0.3, 0.2));
  CHECK(against.status == FrictionLimitStatus::sliding);
  CHECK(against.in_doubt);
  CHECK(limit({}, StickResult<double>{.status = StickStatus::too_few_dots}).in_doubt);
}

TEST_CASE("friction limit: names, and parameters that are refused", "[friction_limit]") {
  CHECK(std::string(name_of(FrictionLimitStatus::held)) == "held");
  CHECK(std::string(name_of(FrictionLimitStatus::sliding)) == "sliding");
  CHECK(std::string(name_of(FrictionLimitStatus::no_limit)) == "no limit");
  CHECK(std::string(name_of(FrictionLimitStatus::no_load)) == "no load");
  const auto with = [](const FrictionLimitOptions& o) {
    return test::refusal([&] { const FrictionLimit<double> limit(o); });
  };
  CHECK(with({}) == "accepted");
  CHECK(with({.slide_fraction = 1.1}) ==
        "FrictionLimitOptions: slide_fraction = 1.1, must be in (0, 1]");
  CHECK(with({.min_normal_n = 0}) ==
        "FrictionLimitOptions: min_normal_n = 0, must be finite and > 0");
}
