// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/slip/contact_slide.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "fingerpad/slip/recoil.hpp"
#include "support/catch.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::begins_with;
using test::Image;
using test::refusal;

namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();
constexpr Index height = 60;
constexpr Index width = 80;
using Dots = Image<Point2<double>>;

/// A bumpy imprint in a disc, displaced and rotated; the dots stand still by default.
struct Pad {
  Point2<double> shift = {0, 0};
  double angle_rad = 0;
  double radius = 14;
  double gain = 1;
  Point2<double> dots_shift = {0, 0};

  Image<double> imprint() const {
    Image<double> image(height, width);
    for (Index i = 0; i < height; ++i) {
      for (Index j = 0; j < width; ++j) {
        const auto [x, y] = on_object(i, j);
        const double r = std::hypot(x, y);
        const double bumps = 1 + 0.3 * std::cos(x / 3) + 0.2 * std::sin(y / 2.5 + x / 7);
        image(i, j) = gain * 0.1 * bumps * std::exp(-std::pow(r / 14, 6));
      }
    }
    return image;
  }
  Image<std::uint8_t> contact() const {
    Image<std::uint8_t> mask(height, width);
    for (Index i = 0; i < height; ++i) {
      for (Index j = 0; j < width; ++j) {
        const auto [x, y] = on_object(i, j);
        mask(i, j) = std::hypot(x, y) < radius;
      }
    }
    return mask;
  }
  Dots dots() const {
    Dots dots(5, 7);
    for (Index i = 0; i < 5; ++i) {
      for (Index j = 0; j < 7; ++j) {
        dots(i, j) = {40.0 * double(j) + 40 + dots_shift.x, 40.0 * double(i) + 40 + dots_shift.y};
      }
    }
    return dots;
  }

 private:
  Point2<double> on_object(Index i, Index j) const {
    const double x = double(j) - 39.3 - shift.x;
    const double y = double(i) - 29.6 - shift.y;
    return {std::cos(angle_rad) * x + std::sin(angle_rad) * y,
            std::cos(angle_rad) * y - std::sin(angle_rad) * x};
  }
};

const ContactSlide<double> slide(height, width, 5, 7);

SlideResult<double> look(const Pad& pad, ContactSlide<double>::State& state) {
  return slide(pad.imprint(), pad.contact(), pad.dots(), state);
}

}  // namespace

TEST_CASE("contact slide: parts of a cell, past dots that move too", "[contact_slide]") {
  for (const double shift : {0.1, -0.37, 0.8, 2.6}) {
    auto state = slide.start();
    CHECK(look({}, state).status == SlideStatus::began);
    const Pad moved{.shift = {shift, 0.5 * shift}, .gain = 0.8, .dots_shift = {1.5, -1}};
    const auto result = look(moved, state);
    CHECK(result.status == SlideStatus::updated);
    CHECK(result.dots > 2);
    CHECK(std::abs(result.imprint_px.x - 4 * shift) < 0.02);
    CHECK(std::abs(result.imprint_px.y - 2 * shift) < 0.02);
    CHECK(std::abs(result.slide_px.x - (4 * shift - 1.5)) < 0.02);
    CHECK(std::abs(result.slide_px.y - (2 * shift + 1)) < 0.02);
    CHECK(result.slide == Approx(norm(result.slide_px) / 40));
    CHECK(result.correlation > 0.99);
  }
}

TEST_CASE("contact slide: rotation past the dots", "[contact_slide]") {
  auto state = slide.start();
  CHECK(look({}, state).ok());
  for (const double angle : {0.05, 0.1, 0.15}) {
    const auto result = look({.angle_rad = angle}, state);
    CHECK(result.status == SlideStatus::updated);
    CHECK(std::abs(result.rotation_rad - angle) < 0.003);
    CHECK(result.rotation_sd_rad < 0.02);
    CHECK(result.slide < 0.01);
  }
}

TEST_CASE("contact slide: an imprint that has become deeper or shallower is found alike",
          "[contact_slide]") {
  const auto found = [](double gain) {
    auto state = slide.start();
    CHECK(look({}, state).ok());
    const auto result = look({.shift = {0.5, -0.3}, .angle_rad = 0.08, .gain = gain}, state);
    CHECK(result.status == SlideStatus::updated);
    return result;
  };
  const auto plain = found(1);
  CHECK(std::abs(plain.rotation_rad - 0.08) < 0.003);
  for (const double gain : {0.3, 3.0}) {
    CAPTURE(gain);
    CHECK(std::abs(found(gain).rotation_rad - plain.rotation_rad) < 1e-4);
    CHECK(norm(found(gain).imprint_px - plain.imprint_px) < 1e-3);
  }
}

TEST_CASE("contact slide: steps add up, and a way back takes back", "[contact_slide]") {
  auto state = slide.start();
  for (const double at : {0.0, 1.3, 2.6, 3.9, 5.2}) {
    CHECK(std::abs(look({.shift = {at, 0}}, state).slide_px.x - 4 * at) < 0.1);
  }
  CHECK(look({.shift = {5.2, 0}}, state).alarm);
  for (const double at : {3.9, 2.6, 1.3, 0.0}) {
    CHECK(std::abs(look({.shift = {at, 0}}, state).slide_px.x - 4 * at) < 0.1);
  }
  CHECK(!look({}, state).alarm);
}

TEST_CASE("contact slide: lost area counts once the imprint has travelled", "[contact_slide]") {
  auto state = slide.start();
  CHECK(look({}, state).lost == 0);
  const auto in_place = look({.radius = 10}, state);
  CHECK(in_place.lost == Approx(1 - 100.0 / 196).margin(0.03));
  CHECK(!in_place.alarm);
  const auto moved = look({.shift = {1.6, 0}, .radius = 10}, state);
  CHECK(moved.slide > 0.1);
  CHECK(moved.slide < 0.25);
  CHECK(moved.alarm);
  CHECK(moved.evidence > 1);
  CHECK(moved.held() == 0);
  CHECK(in_place.held() == Approx(1 - in_place.evidence));
}

TEST_CASE("contact slide: fifty digits say the same", "[contact_slide]") {
  const ContactSlide<test::Digits50> fine(height, width, 5, 7);
  auto state = slide.start();
  auto fine_state = fine.start();
  for (const double at : {0.0, 0.7, 1.9}) {
    const Pad pad{.shift = {at, 0.3 * at}};
    const auto plain = look(pad, state);
    const auto exact = fine(pad.imprint(), pad.contact(), pad.dots(), fine_state);
    CHECK(plain.slide_px.x == Approx(static_cast<double>(exact.slide_px.x)).margin(1e-9));
    CHECK(plain.evidence == Approx(static_cast<double>(exact.evidence)).margin(1e-9));
  }
}

TEST_CASE("contact slide: what it says when it cannot tell", "[contact_slide]") {
  auto state = slide.start();
  CHECK(look({.radius = 2}, state).status == SlideStatus::no_contact);
  CHECK(look({.radius = 2}, state).lost == 0);
  CHECK(look({}, state).status == SlideStatus::began);

  // an imprint that cannot be found again: the slide is kept and continues from there
  CHECK(look({.shift = {0.5, 0}}, state).slide_px.x == Approx(2).margin(0.05));
  Image<double> other(height, width);
  for (Index i = 0; i < height; ++i) {
    for (Index j = 0; j < width; ++j) {
      other(i, j) = 0.1 * std::sin(double(i) * 1.1) * std::sin(double(j) * 1.3);
    }
  }
  const Pad pad;
  const auto lost = slide(other, pad.contact(), pad.dots(), state);
  CHECK(lost.status == SlideStatus::not_found);
  CHECK(lost.slide_px.x == Approx(2).margin(0.05));

  state.reset();
  CHECK(look({}, state).status == SlideStatus::began);
  const Dots none(5, 7, Point2<double>{missing, missing});
  CHECK(slide(pad.imprint(), pad.contact(), none, state).status == SlideStatus::no_dots);

  const Image<std::uint8_t> all(height, width, 1);
  CHECK(slide(pad.imprint(), all, pad.dots(), state).status == SlideStatus::no_edge);
  CHECK(look({.radius = 2}, state).lost == 1);
  CHECK(look({}, state).status == SlideStatus::began);
  CHECK(look({}, state).lost == 0);

  CHECK(!slide(Image<double>(height, width + 1), pad.contact(), pad.dots(), state).accepted());
  CHECK(!slide(pad.imprint(), pad.contact(), Dots(5, 6), state).accepted());
  auto others = ContactSlide<double>(height, width, 5, 6).start();
  CHECK(!look({}, others).accepted());
}

TEST_CASE("contact slide: unknown cells and wild dots do not count", "[contact_slide]") {
  auto state = slide.start();
  Pad pad;
  const auto spoil = [](Image<double> image) {
    for (Index i = 20; i < 25; ++i) {
      for (Index j = 35; j < 42; ++j) {
        image(i, j) = missing;
      }
    }
    return image;
  };
  CHECK(slide(spoil(pad.imprint()), pad.contact(), pad.dots(), state).ok());
  pad.shift = {0.6, -0.3};
  auto dots = pad.dots();
  dots(2, 3) = {missing, 3};
  dots(2, 2).x += 20;
  const auto result = slide(spoil(pad.imprint()), pad.contact(), dots, state);
  CHECK(result.status == SlideStatus::updated);
  CHECK(std::abs(result.slide_px.x - 2.4) < 0.05);
  CHECK(std::abs(result.slide_px.y + 1.2) < 0.05);
}

TEST_CASE("contact slide: the first and the last dot of the pattern count", "[contact_slide]") {
  // 10 cells apart; within 14 cells of the middle lie the first dot and those beside and below it
  const auto dots_counted = [](const Point2<double>& dots_shift) {
    auto state = slide.start();
    (void)look({.dots_shift = dots_shift}, state);
    return look({.dots_shift = dots_shift}, state).dots;
  };
  CHECK(dots_counted({120, 80}) == 3);
  CHECK(dots_counted({-120, -80}) == 4);  // the last dot and the three before it
}

TEST_CASE("contact slide: all cells of a small imprint count", "[contact_slide]") {
  // 36 cells; 30 are needed
  detail::PaddedCells<double> imprint(20, 20, 0), region(20, 20, 0);
  for (Index i = 0; i < 20; ++i) {
    for (Index j = 0; j < 20; ++j) {
      const double x = double(j) - 9.7, y = double(i) - 9.4;
      imprint(i, j) = std::exp(-(x * x + 0.8 * y * y + 0.3 * x * y) / 8);
      region(i, j) = i >= 7 && i < 13 && j >= 7 && j < 13 ? 1 : 0;
    }
  }
  detail::ImprintShift<double> shift(20, 20);
  shift.take(imprint, region);
  const auto motion = shift.find(imprint, {0.3, -0.2}, 2.0);
  CHECK(motion.correlation > 0.99);
  CHECK(norm(motion.shift) < 0.05);
}

TEST_CASE("contact slide: the standard deviation is the mean of both axes", "[contact_slide]") {
  // steep along x, flat along y; with x and y exchanged, the mean is the same
  const auto waves = [](bool exchanged) {
    Image<double> image(60, 60);
    for (Index i = 0; i < 60; ++i) {
      for (Index j = 0; j < 60; ++j) {
        const double x = double(exchanged ? i : j) - 30, y = double(exchanged ? j : i) - 27;
        image(i, j) = std::cos(x / 1.5) + 0.3 * std::cos(y / 6);
      }
    }
    return image;
  };
  const auto sd_px = [&](bool exchanged) {
    Image<std::uint8_t> contact(60, 60, 0);
    for (Index i = 20; i < 40; ++i) {
      std::fill_n(&contact(i, 20), 20, std::uint8_t{1});
    }
    const ContactSlide<double> square(60, 60, 5, 7);
    auto state = square.start();
    (void)square(waves(exchanged), contact, Pad().dots(), state);
    return square(waves(exchanged), contact, Pad().dots(), state).imprint_sd_px;
  };
  CHECK(sd_px(false) > 0);
  CHECK(sd_px(true) == Approx(sd_px(false)).epsilon(1e-9));
}

TEST_CASE("recoil: by how much dots have fallen back", "[recoil]") {
  const Pad free;
  const Recoil<double> recoil(free.dots(), {.pitch_px = 40, .min_dots = 5});
  auto state = recoil.start();
  double largest = 0;
  for (const double at : {0.0, 8.0, 16.0, 6.0, 10.0}) {
    const auto result = recoil(Pad{.dots_shift = {0, at}}.dots(), state);
    largest = std::max(largest, at / 40);
    CHECK(result.ok());
    CHECK(result.dots == 35);
    CHECK(result.displaced == Approx(at / 40));
    CHECK(result.recoil == Approx(largest - at / 40).margin(1e-12));
    CHECK(result.alarm == (result.recoil > 0.1));
    CHECK(result.evidence == Approx(result.recoil / 0.1).margin(1e-12));
    CHECK(result.held() == Approx((std::max)(0.0, 1 - result.recoil / 0.1)).margin(1e-12));
  }
  const auto few = recoil(Dots(5, 7, Point2<double>{missing, 1}), state);
  CHECK(!few.ok());
  CHECK(few.displaced == Approx(0.25));
  state.reset();
  CHECK(recoil(free.dots(), state).recoil == 0);
  const auto refused = recoil(Dots(4, 7), state);
  CHECK(refused.status == FrameStatus::refused);
  CHECK(refused.evidence == 0);
}

TEST_CASE("recoil: dots whose distance is no number do not count", "[recoil]") {
  test::Image<Point2<float>> dots(4, 5, {1, 2});
  const Recoil<> recoil(dots, {.min_dots = 10});
  auto state = recoil.start();
  dots.cells.assign(20, {1e30F, 2});
  CHECK_FALSE(recoil(dots, state).ok());
  dots.cells.assign(20, {41, 2});
  const auto r = recoil(dots, state);
  CHECK(r.ok());
  CHECK(r.displaced == Approx(1));
  CHECK(r.recoil == 0);
}

TEST_CASE("contact slide, recoil: names and bad parameters", "[contact_slide][recoil]") {
  CHECK(name_of(SlideStatus::not_found) == std::string("not found"));
  CHECK(name_of(SlideStatus::no_edge) == std::string("no edge"));
  const auto refused = [](auto SlideTest::*field, auto bad) {
    SlideTest test;
    test.*field = bad;
    return refusal([&] { ContactSlide<>{9, 9, 1, 1, test}; });
  };
  for (const double bad : {-1.0, missing}) {
    CHECK(begins_with(refused(&SlideTest::pitch_px, bad), "SlideTest: pitch_px"));
    CHECK(begins_with(refused(&SlideTest::cell_px, bad), "SlideTest: cell_px"));
    CHECK(begins_with(refused(&SlideTest::max_slide, bad), "SlideTest: max_slide"));
    CHECK(begins_with(refused(&SlideTest::min_slide, bad), "SlideTest: min_slide"));
    CHECK(begins_with(refused(&SlideTest::max_lost, bad), "SlideTest: max_lost"));
    CHECK(begins_with(refused(&SlideTest::min_correlation, bad), "SlideTest: min_correlation"));
  }
  CHECK(begins_with(refused(&SlideTest::min_cells, Index(29)), "SlideTest: min_cells = 29"));
  CHECK(begins_with(refusal([] {
                      ContactSlide<>{2, 9, 1, 1};
                    }),
                    "ContactSlide: imprint: rows = 2"));
  CHECK(begins_with(refusal([] { ContactSlide<>{9, 9, 1, 0}; }), "ContactSlide: dots: cols = 0"));
  const Dots dots(2, 2);
  CHECK(begins_with(refusal([&] { Recoil<>{dots, {.pitch_px = 0}}; }), "RecoilTest: pitch_px = 0"));
  CHECK(begins_with(refusal([&] { Recoil<>{dots, {.quantile = 1}}; }), "RecoilTest: quantile = 1"));
  CHECK(begins_with(refusal([&] { Recoil<>{dots, {.min_dots = 0}}; }), "RecoilTest: min_dots = 0"));
  // dots 40 px apart
  const auto pitch = [](double pitch_px) {
    return refusal([&] { Recoil<double>{Pad().dots(), {.pitch_px = pitch_px}}; });
  };
  for (const double factor : {2.95, 1 / 2.95}) {
    CHECK(pitch(40 * factor) == "accepted");
  }
  for (const double factor : {3.05, 1 / 3.05}) {
    CHECK(begins_with(pitch(40 * factor), "RecoilTest: pitch_px = "));
  }
}
