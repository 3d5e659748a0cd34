// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/contact/contact_measures.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "fingerpad/adapt/dual.hpp"
#include "fingerpad/contact/contact_region.hpp"
#include "support/catch.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Image;

namespace {

/// A pad of half-millimetre pixels under a plate, and its contact.
struct Pressed {
  test::Pad pad;
  Image<double> depth;
  Image<std::uint8_t> mask;
  ContactResult found;

  explicit Pressed(double press_mm) {
    pad.rows = 96;
    pad.cols = 112;
    pad.camera.pitch_mm = 0.4;
    pad.camera.center_x_px = 55.5;
    pad.camera.center_y_px = 47.5;
    depth = pad.pressed_depths(press_mm);
    mask = Image<std::uint8_t>(pad.rows, pad.cols);
    ContactTest test;
    test.ring = {3};
    test.free_apex_mm = pad.height_mm;
    const ContactRegion<HalfLevelEdge, Camera<double>, double> region(pad.camera, pad.rows,
                                                                      pad.cols, test);
    auto work = region.workspace();
    found = region(depth, mask, work);
  }
};

}  // namespace

TEST_CASE("measures of a contact are those of the region", "[contact]") {
  for (const double press_mm : {1.0, 2.5, 4.0}) {
    CAPTURE(press_mm);
    Pressed pressed(press_mm);
    REQUIRE(pressed.found.contact_px > 100);
    // in the middle; the area of a neighbour is then that of a flat pixel
    pressed.depth(47, 55) = test::nan;
    pressed.mask(47, 55) = 0;
    const auto measures = contact_measures(pressed.pad.camera, pressed.mask, pressed.depth);
    CHECK(measures.pixels == pressed.found.contact_px - 1);
    const double pixel = pressed.found.area_mm2 / static_cast<double>(pressed.found.contact_px);
    CHECK(measures.area_mm2 == Approx(pressed.found.area_mm2 - pixel).epsilon(2e-4));
    CHECK(measures.center_mm.x == Approx(pressed.found.center_mm.x).margin(1e-3));
    CHECK(measures.center_mm.y == Approx(pressed.found.center_mm.y).margin(1e-3));
    CHECK(measures.center_mm.z == Approx(pressed.found.center_mm.z).margin(1e-9));
  }
}

TEST_CASE("area of a disc at a depth, whatever the camera", "[contact]") {
  // a disc of 8 mm around an off-axis point, through a strongly refracting plate
  Camera<double> camera;
  camera.plate_thickness_mm = 5;
  camera.pitch_mm = 0.2;
  camera.center_x_px = 59.5;
  camera.center_y_px = 59.5;
  camera.pixel_aspect = GENERATE(1.0, 1.083, 0.9);
  CAPTURE(camera.pixel_aspect);
  const Image<double> depth(120, 120, 9.0);
  Image<std::uint8_t> mask(120, 120);
  for (Index i = 0; i < 120; ++i) {
    for (Index j = 0; j < 120; ++j) {
      const auto p = point_at(camera, static_cast<double>(i), static_cast<double>(j), 9.0);
      mask(i, j) = std::hypot(p.x - 2, p.y + 1) < 8 ? 1 : 0;
    }
  }
  const auto measures = contact_measures(camera, mask, depth);
  // pixels at the border are randomly in or out: some 250 of 0.06 mm^2
  CHECK(measures.area_mm2 == Approx(64 * std::numbers::pi).epsilon(5e-3));
  CHECK(measures.center_mm.x == Approx(2).margin(0.02));
  CHECK(measures.center_mm.y == Approx(-1).margin(0.02));
}

TEST_CASE("fifty digits of area; no contact, other sizes", "[contact]") {
  const Pressed pressed(2.5);
  const auto plain = contact_measures(pressed.pad.camera, pressed.mask, pressed.depth);
  const auto exact =
      contact_measures(cast<test::Digits50>(pressed.pad.camera), pressed.mask, pressed.depth);
  CHECK(test::relative_error(test::Digits50(plain.area_mm2), exact.area_mm2) < 1e-12);
  const auto none =
      contact_measures(pressed.pad.camera, Image<std::uint8_t>(96, 112), pressed.depth);
  CHECK(none.pixels == 0);
  CHECK(none.area_mm2 == 0);
  CHECK(std::isnan(none.center_mm.x));
  CHECK(
      contact_measures(pressed.pad.camera, Image<std::uint8_t>(96, 111, 1), pressed.depth).pixels ==
      0);
}

TEST_CASE("area and center follow the camera", "[contact]") {
  const Pressed pressed(2.5);
  const auto measured = [&](const auto& p) {
    auto camera = cast<std::remove_cvref_t<decltype(p[0])>>(pressed.pad.camera);
    camera.plate_distance_mm = p[0];
    camera.refractive_index = p[1];
    camera.center_x_px = p[2];
    camera.pitch_mm = p[3];
    const auto m = contact_measures(camera, pressed.mask, pressed.depth);
    return std::array{m.area_mm2, m.center_mm.x, m.center_mm.y};
  };
  const std::array<double, 4> at = {50, 1.33, 55.5, 0.4};
  const auto dual = measured(seeded(at));
  for (std::size_t k = 0; k < at.size(); ++k) {
    const double step = 1e-5 * at[k];
    const auto moved = [&](double by) {
      auto p = at;
      p[k] += by;
      return measured(p);
    };
    const auto more = moved(step), less = moved(-step);
    for (std::size_t part = 0; part < 3; ++part) {
      CAPTURE(k, part);
      CHECK(dual[part].slopes[k] ==
            Approx((more[part] - less[part]) / (2 * step)).epsilon(1e-7).margin(1e-7));
    }
  }
}

TEST_CASE("area and center of an image and of its reflections are the same", "[contact]") {
  // the membrane is rough and the contact reaches all four edges, so that every pixel counts
  constexpr Index rows = 7, cols = 9;
  test::Random random(3);
  Image<double> depth(rows, cols);
  for (double& l : depth.cells) {
    l = random.uniform(8, 10);
  }
  const Image<std::uint8_t> mask(rows, cols, 1);
  Camera<double> camera;
  camera.pitch_mm = 0.4;
  camera.center_x_px = 3.2;
  camera.center_y_px = 2.1;
  const auto measures = contact_measures(camera, mask, depth);
  Image<double> upside_down(rows, cols), left_to_right(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      upside_down(i, j) = depth(rows - 1 - i, j);
      left_to_right(i, j) = depth(i, cols - 1 - j);
    }
  }
  auto below = camera, beside = camera;
  below.center_y_px = static_cast<double>(rows - 1) - camera.center_y_px;
  beside.center_x_px = static_cast<double>(cols - 1) - camera.center_x_px;
  const auto turned = contact_measures(below, mask, upside_down);
  const auto mirrored = contact_measures(beside, mask, left_to_right);
  CHECK(turned.area_mm2 == Approx(measures.area_mm2).epsilon(1e-12));
  CHECK(turned.center_mm.y == Approx(-measures.center_mm.y).epsilon(1e-12));
  CHECK(mirrored.area_mm2 == Approx(measures.area_mm2).epsilon(1e-12));
  CHECK(mirrored.center_mm.x == Approx(-measures.center_mm.x).epsilon(1e-12));
}
