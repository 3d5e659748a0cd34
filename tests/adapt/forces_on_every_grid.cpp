// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Dots, flags, depths and readings in every kind of grid: every method that reads them gives the
// same result to the bit.
// Depth, neighbour light, contact region and stick ratio have tests of their own; the object's
// motion and the shift of a contact read dots as the stick ratio does.
#include <cmath>

#include "fingerpad/contact/equivalent_flat_area.hpp"
#include "fingerpad/contact/surface.hpp"
#include "fingerpad/depth/intensity_depth.hpp"
#include "fingerpad/foam/taxels.hpp"
#include "fingerpad/force/traction.hpp"
#include "fingerpad/gel/gel_slide.hpp"
#include "fingerpad/image/curvature.hpp"
#include "fingerpad/optics/orthographic_camera.hpp"
#include "support/catch.hpp"
#include "support/every_grid.hpp"
#include "support/pad.hpp"
#include "support/traction_scenes.hpp"

using namespace fingerpad;
using test::from_every_grid;
using test::same_bits;

namespace {

using Vector = Point3<double>;

bool same(const Vector& a, const Vector& b) {
  return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z);
}

}  // namespace

TEST_CASE("traction from every grid", "[adapt]") {
  const test::TractionScene& scene = test::traction_scenes()[3];
  const test::Dots stress_free = test::stress_free_dots();
  TractionField<> field(stress_free);
  const auto truth = field(scene.dots, scene.contact, scene.pressure_mpa);
  const auto check = [&](const auto& free, const auto& dots, const auto& contact) {
    TractionField<> other(free);
    const auto r = other(dots, contact, scene.pressure_mpa);
    CHECK(r.status == truth.status);
    CHECK(same(r.force_n, truth.force_n));
    CHECK(same(r.moment_n_mm, truth.moment_n_mm));
    CHECK(same_bits(other.pressure_mpa()(10, 10), field.pressure_mpa()(10, 10)));
  };
  CHECK(is_finite(truth.force_n.z));
  from_every_grid<Vector>(stress_free,
                          [&](const auto& free) { check(free, scene.dots, scene.contact); });
  from_every_grid<Vector>(scene.dots,
                          [&](const auto& dots) { check(stress_free, dots, scene.contact); });
  from_every_grid<unsigned char>(scene.contact,
                                 [&](const auto& flags) { check(stress_free, scene.dots, flags); });
}

TEST_CASE("taxel features from every grid", "[adapt]") {
  const auto readings = [](int k) {
    test::Image<double> taxels(16, 4, 500.0);
    taxels(3, 1) += 60 * std::sin(0.9 * k);
    taxels(9, 2) += 0.4 * k;
    return taxels;
  };
  TaxelFeatures<> begun(16, 4);
  for (int k = 0; k < 40; ++k) {
    (void)begun(readings(k), 0.01 * k);
  }
  auto state = begun;
  const auto truth = state(readings(40), 0.4);
  from_every_grid<double>(readings(40), [&](const auto& taxels) {
    auto copy = begun;
    const auto r = copy(taxels, 0.4);
    CHECK(r.status == truth.status);
    CHECK(same_bits(r.center_x_mm, truth.center_x_mm));
    CHECK(same_bits(r.center_y_mm, truth.center_y_mm));
    CHECK(r.location == truth.location);
    CHECK(r.waves == truth.waves);
  });
}

namespace {

/// A pad under a plate, 0.5 mm a pixel: a level contact of 5 mm in a dome.
struct Pressed {
  test::Image<double> depth{60, 64};
  test::Image<unsigned char> mask{60, 64};
  Pressed() {
    for (Index i = 0; i < 60; ++i) {
      for (Index j = 0; j < 64; ++j) {
        const double rho = 0.5 * std::hypot(double(i) - 29, double(j) - 31);
        mask(i, j) = rho < 5 ? 1 : 0;
        depth(i, j) = rho < 5 ? 10 : 10 - 0.03 * square(rho - 5) - 0.002 * double(i % 3);
      }
    }
  }
};
const OrthographicCamera<double> plan{31, 29, 0.5};

}  // namespace

TEST_CASE("curvature, flat area and surface of a contact from every grid", "[adapt]") {
  const Pressed pressed;
  CurvatureMap<double> curvature(plan, 60, 64, 5);
  EquivalentFlatArea<> flat_area(plan, 60, 64);
  struct Answer {
    test::Image<double> curvature{60, 64};
    double flat_area_mm2, height_mm;
  };
  const auto answer = [&](const auto& depth, const auto& mask) {
    Answer a;
    REQUIRE(curvature(depth, a.curvature).has_value());
    a.flat_area_mm2 = flat_area(mask, depth).area_mm2;
    a.height_mm = fit_surface(plan, depth, mask).point_mm.z;
    return a;
  };
  const Answer truth = answer(pressed.depth, pressed.mask);
  REQUIRE(is_finite(truth.curvature(29, 31)));
  REQUIRE(is_finite(truth.flat_area_mm2));
  REQUIRE(is_finite(truth.height_mm));
  const auto check = [&](const auto& depth, const auto& mask) {
    const Answer a = answer(depth, mask);
    bool same_cells = true;
    for (std::size_t k = 0; k < a.curvature.cells.size(); ++k) {
      same_cells = same_cells && same_bits(a.curvature.cells[k], truth.curvature.cells[k]);
    }
    CHECK(same_cells);
    CHECK(same_bits(a.flat_area_mm2, truth.flat_area_mm2));
    CHECK(same_bits(a.height_mm, truth.height_mm));
  };
  from_every_grid<double>(pressed.depth, [&](const auto& depth) { check(depth, pressed.mask); });
  from_every_grid<unsigned char>(pressed.mask,
                                 [&](const auto& mask) { check(pressed.depth, mask); });
}

TEST_CASE("depth and slide of a gel from every grid", "[adapt]") {
  // a dark spot that moves toward the middle
  const auto image = [](double x, double dark) {
    test::Image<double> level(64, 80);
    for (Index i = 0; i < 64; ++i) {
      for (Index j = 0; j < 80; ++j) {
        const double off = std::hypot(double(i) - 30, double(j) - x) / 9;
        level(i, j) = 140 - dark * std::exp(-off * off) + double((7 * i + 3 * j) % 5);
      }
    }
    return level;
  };
  const auto free = image(30, 0), before = image(30, 60), after = image(34, 60);
  IntensityDepth<double> depth(free, {});
  test::Image<Point2<double>> dots(5, 7);
  for (Index i = 0; i < 5; ++i) {
    for (Index j = 0; j < 7; ++j) {
      dots(i, j) = {40.0 * double(j) + 40, 40.0 * double(i) + 40};
    }
  }
  test::Image<unsigned char> touches(64, 80);
  for (Index i = 0; i < 64; ++i) {
    for (Index j = 0; j < 80; ++j) {
      touches(i, j) = before(i, j) < 125 ? 1 : 0;
    }
  }
  GelSlide begun(64, 80, dots);
  (void)begun(before, touches, dots);
  struct Answer {
    test::Image<double> depth{64, 80};
    SlideResult slide;
  };
  const auto answer = [&](const auto& frame, const auto& flags, const auto& points) {
    Answer a;
    REQUIRE(depth(frame, a.depth) != FrameStatus::refused);
    GelSlide slide = begun;
    a.slide = slide(frame, flags, points);
    return a;
  };
  const Answer truth = answer(after, touches, dots);
  REQUIRE(truth.slide.status == SlideStatus::updated);
  const auto check = [&](const auto& frame, const auto& flags, const auto& points) {
    const Answer a = answer(frame, flags, points);
    bool same_cells = true;
    for (std::size_t k = 0; k < a.depth.cells.size(); ++k) {
      same_cells = same_cells && same_bits(a.depth.cells[k], truth.depth.cells[k]);
    }
    CHECK(same_cells);
    CHECK(a.slide.status == truth.slide.status);
    CHECK(same_bits(a.slide.slide_px.x, truth.slide.slide_px.x));
    CHECK(same_bits(a.slide.imprint_px.y, truth.slide.imprint_px.y));
  };
  from_every_grid<double>(after, [&](const auto& frame) { check(frame, touches, dots); });
  from_every_grid<unsigned char>(touches, [&](const auto& flags) { check(after, flags, dots); });
  from_every_grid<Point2<double>>(dots, [&](const auto& points) { check(after, touches, points); });
}
