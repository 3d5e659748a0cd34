// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/gel/gel_slide.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

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

GelSlide slide_from(const Pad& free = {}) {
  return GelSlide(height, width, free.dots());
}

SlideResult look(const Pad& pad, GelSlide& slide) {
  return slide(pad.imprint(), pad.contact(), pad.dots());
}

}  // namespace

TEST_CASE("gel slide: parts of a cell, past dots that move too", "[gel_slide]") {
  for (const double shift : {0.1, -0.37, 0.8, 2.6}) {
    GelSlide slide = slide_from();
    CHECK(look({}, slide).status == SlideStatus::began);
    const Pad moved{.shift = {shift, 0.5 * shift}, .gain = 0.8, .dots_shift = {1.5, -1}};
    const auto result = look(moved, slide);
    CHECK(result.status == SlideStatus::updated);
    CHECK(result.dots > 2);
    CHECK(std::abs(result.imprint_px.x - 4 * shift) < 0.025);
    CHECK(std::abs(result.imprint_px.y - 2 * shift) < 0.025);
    CHECK(std::abs(result.slide_px.x - (4 * shift - 1.5)) < 0.025);
    CHECK(std::abs(result.slide_px.y - (2 * shift + 1)) < 0.025);
    CHECK(result.slide == Approx(norm(result.slide_px) / 40));
  }
}

TEST_CASE("gel slide: an imprint that has become deeper or shallower is found alike",
          "[gel_slide]") {
  const auto found = [](double gain) {
    GelSlide slide = slide_from();
    CHECK(look({}, slide).ok());
    const auto result = look({.shift = {0.5, -0.3}, .angle_rad = 0.08, .gain = gain}, slide);
    CHECK(result.status == SlideStatus::updated);
    return result;
  };
  const auto plain = found(1);
  for (const double gain : {0.3, 3.0}) {
    CAPTURE(gain);
    CHECK(norm(found(gain).imprint_px - plain.imprint_px) < 1e-3);
  }
}

TEST_CASE("gel slide: steps add up, and a way back takes back", "[gel_slide]") {
  GelSlide slide = slide_from();
  for (const double at : {0.0, 1.3, 2.6, 3.9, 5.2}) {
    CHECK(std::abs(look({.shift = {at, 0}}, slide).slide_px.x - 4 * at) < 0.1);
  }
  CHECK(look({.shift = {5.2, 0}}, slide).alarm);
  for (const double at : {3.9, 2.6, 1.3, 0.0}) {
    CHECK(std::abs(look({.shift = {at, 0}}, slide).slide_px.x - 4 * at) < 0.1);
  }
  CHECK(!look({}, slide).alarm);
}

TEST_CASE("gel slide: lost area counts once the imprint has travelled", "[gel_slide]") {
  GelSlide slide = slide_from();
  CHECK(look({}, slide).lost == 0);
  const auto in_place = look({.radius = 10}, slide);
  CHECK(in_place.lost == Approx(1 - 100.0 / 196).margin(0.03));
  CHECK(!in_place.alarm);
  const auto moved = look({.shift = {1.6, 0}, .radius = 10}, slide);
  CHECK(moved.slide > 0.1);
  CHECK(moved.slide < 0.25);
  CHECK(moved.alarm);
  CHECK(moved.evidence > 1);
  CHECK(moved.held() == 0);
  CHECK(in_place.held() == Approx(1 - in_place.evidence));
}

TEST_CASE("gel slide: what it says when it cannot tell", "[gel_slide]") {
  GelSlide slide = slide_from();
  CHECK(look({.radius = 2}, slide).status == SlideStatus::no_contact);
  CHECK(look({.radius = 2}, slide).lost == 0);
  CHECK(look({}, slide).status == SlideStatus::began);

  // an imprint that cannot be found again: the slide is kept and continues from there
  CHECK(look({.shift = {0.5, 0}}, slide).slide_px.x == Approx(2).margin(0.05));
  Image<double> other(height, width);
  for (Index i = 0; i < height; ++i) {
    for (Index j = 0; j < width; ++j) {
      other(i, j) = 0.1 * std::sin(double(i) * 1.1) * std::sin(double(j) * 1.3);
    }
  }
  const Pad pad;
  const auto lost = slide(other, pad.contact(), pad.dots());
  CHECK(lost.status == SlideStatus::not_found);
  CHECK(lost.slide_px.x == Approx(2).margin(0.05));

  slide = slide_from();
  CHECK(look({}, slide).status == SlideStatus::began);
  const Dots none(5, 7, Point2<double>{missing, missing});
  CHECK(slide(pad.imprint(), pad.contact(), none).status == SlideStatus::no_dots);
  for (const Index left : {2, 3}) {  // of two, one could be wrong
    slide = slide_from();
    CHECK(look({}, slide).status == SlideStatus::began);
    Dots few = none;
    const auto all_dots = pad.dots();
    for (Index k = 0; k < left; ++k) {
      few(2, 2 + k) = all_dots(2, 2 + k);
    }
    CHECK(slide(pad.imprint(), pad.contact(), few).dots == left);
    CHECK(slide(pad.imprint(), pad.contact(), few).ok() == (left == 3));
  }

  const Image<std::uint8_t> all(height, width, 1);
  CHECK(slide(pad.imprint(), all, pad.dots()).status == SlideStatus::no_edge);
  CHECK(look({.radius = 2}, slide).lost == 1);
  CHECK(look({}, slide).status == SlideStatus::began);
  CHECK(look({}, slide).lost == 0);

  const Image<double> wider(height, width + 1);
  const SlideResult refused = slide(wider, pad.contact(), pad.dots());
  CHECK(refused.status == SlideStatus::refused);
  CHECK(std::isnan(refused.held()));
  CHECK(std::isnan(refused.slide_px.x));
  CHECK(std::isnan(refused.imprint_px.x));
  CHECK(slide(pad.imprint(), pad.contact(), Dots(5, 6)).status == SlideStatus::refused);
}

TEST_CASE("gel slide: unknown cells and wild dots do not count", "[gel_slide]") {
  GelSlide slide = slide_from();
  Pad pad;
  const auto spoil = [](Image<double> image) {
    for (Index i = 20; i < 25; ++i) {
      for (Index j = 35; j < 42; ++j) {
        image(i, j) = missing;
      }
    }
    return image;
  };
  CHECK(slide(spoil(pad.imprint()), pad.contact(), pad.dots()).ok());
  pad.shift = {0.6, -0.3};
  auto dots = pad.dots();
  dots(2, 3) = {missing, 3};
  dots(2, 2).x += 20;
  const auto result = slide(spoil(pad.imprint()), pad.contact(), dots);
  CHECK(result.status == SlideStatus::updated);
  CHECK(std::abs(result.slide_px.x - 2.4) < 0.05);
  CHECK(std::abs(result.slide_px.y + 1.2) < 0.05);
}

TEST_CASE("gel slide: the first and the last dot of the pattern count", "[gel_slide]") {
  // 10 cells apart; within 14 cells of the middle lie the first dot and those beside and below it
  const auto dots_counted = [](const Point2<double>& dots_shift) {
    GelSlide slide = slide_from({.dots_shift = dots_shift});
    (void)look({.dots_shift = dots_shift}, slide);
    return look({.dots_shift = dots_shift}, slide).dots;
  };
  CHECK(dots_counted({120, 80}) == 3);
  CHECK(dots_counted({-120, -80}) == 4);  // the last dot and the three before it
}

TEST_CASE("gel slide: a small contact is followed", "[gel_slide]") {
  // 37 cells; 30 are needed
  const auto bump = [](double x0) {
    Image<double> image(20, 20);
    for (Index i = 0; i < 20; ++i) {
      for (Index j = 0; j < 20; ++j) {
        const double x = double(j) - x0, y = double(i) - 9.4;
        image(i, j) = std::exp(-(x * x + 0.8 * y * y + 0.3 * x * y) / 8);
      }
    }
    return image;
  };
  Image<std::uint8_t> contact(20, 20, 0);
  for (Index i = 7; i < 13; ++i) {
    std::fill_n(&contact(i, 7), 6, std::uint8_t{1});
  }
  Dots dots(2, 2);
  for (Index k = 0; k < 4; ++k) {
    dots(k / 2, k % 2) = {32.0 + 16 * double(k % 2), 32.0 + 16 * double(k / 2)};
  }
  GelSlide slide(20, 20, dots, {.min_cells = 30});
  CHECK(slide(bump(9.7), contact, dots).status == SlideStatus::began);
  const auto moved = slide(bump(10.0), contact, dots);
  CHECK(moved.status == SlideStatus::updated);
  CHECK(norm(moved.imprint_px - Point2<double>{1.2, 0}) < 0.2);
  CHECK(moved.dots == 4);
}

TEST_CASE("gel slide: the standard deviation is the mean of both axes", "[gel_slide]") {
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
    GelSlide square(60, 60, Pad().dots());
    (void)square(waves(exchanged), contact, Pad().dots());
    return square(waves(exchanged), contact, Pad().dots()).imprint_sd_px;
  };
  CHECK(sd_px(false) > 0);
  CHECK(sd_px(true) == Approx(sd_px(false)).epsilon(1e-9));
}

TEST_CASE("gel slide: dots with other labels than in the free pad do not count", "[gel_slide]") {
  GelSlide slide = slide_from();
  CHECK(look({}, slide).status == SlideStatus::began);
  CHECK(look({}, slide).status == SlideStatus::updated);
  const auto shifted = look({.dots_shift = {40, 0}}, slide);  // the names of the next column
  CHECK(shifted.status == SlideStatus::no_dots);
  CHECK(shifted.slide < 1e-9);
  CHECK(look({.dots_shift = {29, 0}}, slide).dots == 0);  // the key frame had no dots
  CHECK(look({.dots_shift = {29, 0}}, slide).status == SlideStatus::updated);
}

TEST_CASE("gel slide: names and bad parameters", "[gel_slide]") {
  CHECK(name_of(SlideStatus::updated) == std::string("updated"));
  CHECK(name_of(SlideStatus::not_found) == std::string("not found"));
  CHECK(name_of(SlideStatus::refused) == std::string("refused"));
  const auto refused = [](auto SlideOptions::*field, auto bad) {
    SlideOptions options;
    options.*field = bad;
    return refusal([&] { GelSlide(height, width, Pad().dots(), options); });
  };
  for (const double bad : {-1.0, missing}) {
    CHECK(begins_with(refused(&SlideOptions::cell_px, bad), "SlideOptions: cell_px"));
    CHECK(begins_with(refused(&SlideOptions::max_slide, bad), "SlideOptions: max_slide"));
    CHECK(begins_with(refused(&SlideOptions::min_slide, bad), "SlideOptions: min_slide"));
    CHECK(begins_with(refused(&SlideOptions::max_lost, bad), "SlideOptions: max_lost"));
  }
  CHECK(begins_with(refused(&SlideOptions::min_slide, 0.26), "SlideOptions: min_slide"));
  CHECK(begins_with(refused(&SlideOptions::min_cells, Index(29)), "SlideOptions: min_cells = 29"));
  const auto sized = [](Index rows, const Dots& dots) {
    return refusal([&] { GelSlide(rows, width, dots); });
  };
  CHECK(begins_with(sized(2, Pad().dots()), "GelSlide: imprint: rows = 2"));
  CHECK(begins_with(sized(height, Dots(1, 0)), "GelSlide: dots: cols = 0"));
  // the pitch: at least a cell, at most the imprint's 320 px
  const auto spaced = [&](double factor) {
    Dots dots = Pad().dots();
    for (auto& dot : dots.cells) {
      dot = factor * dot;
    }
    return sized(height, dots);
  };
  for (const double factor : {0.11, 7.9}) {
    CHECK(spaced(factor) == "accepted");
  }
  for (const double factor : {0.09, 8.1, missing}) {
    CHECK(begins_with(spaced(factor), "GelSlide: free_px: pitch"));
  }
}
