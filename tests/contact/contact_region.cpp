// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/contact/contact_region.hpp"

#include <algorithm>
#include <array>
#include <boost/math/constants/constants.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "fingerpad/optics/orthographic_camera.hpp"
#include "support/catch.hpp"
#include "support/contact_measures.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"
#include "support/rotated.hpp"
#include "support/soap_film.hpp"

using namespace fingerpad;
using test::begins_with;
using test::depths_of;
using test::height_map;
using test::Image;
using test::pad_camera;
using test::refusal;
using test::RoundFilm;

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

struct Found {
  ContactResult result;
  Image<Touch> mask;
};

template <class S, class CameraType>
Found find(const CameraType& camera, const Image<S>& depth, const ContactTest& test = {}) {
  ContactRegion<S> region(camera, depth.rows(), depth.cols(), test);
  Found found{{}, Image<Touch>(depth.rows(), depth.cols(), Touch::unknown)};
  found.result = region(depth, found.mask);
  REQUIRE(found.result.accepted());
  return found;
}

ContactTest with_ring(Index radius_px, Index min_region_px = 200) {
  ContactTest test;
  test.min_region_px = min_region_px;
  test.ring_px = static_cast<double>(radius_px);
  return test;
}
ContactTest at_threshold(ContactTest test) {
  test.places_edge = false;
  return test;
}
ContactTest with_gap(ContactTest test, double gap_mm) {
  test.touching_gap_mm = gap_mm;
  return test;
}

template <class T>
Index count(const Image<T>& mask, T what) {
  return static_cast<Index>(std::count(mask.cells.begin(), mask.cells.end(), what));
}

bool has_no_number(const ContactResult& r) {
  return std::isnan(r.area_mm2) && std::isnan(r.area_sd_mm2) && std::isnan(r.pressed_mm2) &&
         std::isnan(r.center_mm.x) && std::isnan(r.center_mm.z) && std::isnan(r.depth_mm);
}

/// Radius of a disc with the area of the contact.
double radius_of(const ContactResult& result) {
  return std::sqrt(result.area_mm2 / 3.14159265358979323846);
}

/// Pixels around a contact of that radius, enough to include some free membrane.
Index pixels_for(double radius_mm, Index ring_px, double pitch_mm = 0.08) {
  return 2 * static_cast<Index>(radius_mm / pitch_mm + 3.2 * static_cast<double>(ring_px)) + 1;
}

}  // namespace

TEST_CASE("a round contact is found where it is", "[contact_region]") {
  struct Case {
    double radius_mm;
    Index ring_px;
    double map_share;     ///< allowed relative error of the area, for a height map
    double camera_share;  ///< the same through a camera, where a large ring errs more
  };
  const Case cases[] = {{3, 12, 0.015, 0.02},  {3, 25, 0.015, 0.07}, {6, 25, 0.015, 0.045},
                        {9, 12, 0.015, 0.015}, {2, 25, 0.03, 0.11},  {1.5, 25, 0.05, 0.18}};
  const auto check = [](const auto& camera, const RoundFilm& film, Index ring_px, double share) {
    const Index size = static_cast<Index>(2 * camera.center_x_px) + 1;
    const auto depth = depths_of<float>(camera, film, size, size);
    const ContactResult r = find(camera, depth, with_gap(with_ring(ring_px), 0)).result;
    CHECK(r.regions == 1);
    CHECK(r.area_mm2 == Approx(film.area_mm2()).epsilon(share));
    CHECK(std::hypot(r.center_mm.x - film.x_mm, r.center_mm.y - film.y_mm) < 0.05);
    CHECK(r.center_mm.z == Approx(film.top_mm).margin(1e-3));
    CHECK(r.depth_mm == Approx(13 - film.top_mm).margin(1e-3));
    // without its edge, a contact may end anywhere within a ring of where it seems to
    auto test = with_gap(with_ring(ring_px), 0);
    test.places_edge = false;
    const ContactResult plain = find(camera, depth, test).result;
    if (plain.regions == 1) {
      const double ring_mm = static_cast<double>(ring_px) * camera.pitch_mm;
      const double perimeter_mm = 2 * std::sqrt(std::numbers::pi * plain.area_mm2);
      CHECK(plain.area_sd_mm2 == Approx(perimeter_mm * ring_mm / std::sqrt(3)).epsilon(0.35));
    }
  };
  for (const Case& c : cases) {
    test::RoundContact contact;
    contact.radius_mm = c.radius_mm;
    contact.x_mm = 0.3;
    contact.y_mm = -0.2;
    const RoundFilm film(contact);
    const Index size = pixels_for(c.radius_mm, c.ring_px);
    INFO("radius " << c.radius_mm << " mm, ring " << c.ring_px << " px");
    check(height_map(size, size), film, c.ring_px, c.map_share);
    check(pad_camera(size, size), film, c.ring_px, c.camera_share);
  }
}

TEST_CASE("what is nearer than the gap counts as touched, but bears nothing", "[contact_region]") {
  const Index size = pixels_for(6, 12, 0.16);
  const auto camera = height_map(size, size, 0.16);
  const RoundFilm film({});
  const auto depth = depths_of<float>(camera, film, size, size);
  const auto seen_mm2 = [](const Found& found) {
    return 0.16 * 0.16 * static_cast<double>(count(found.mask, Touch::contact));
  };
  const Found edge = find(camera, depth, with_gap(with_ring(12), 0));
  CHECK(seen_mm2(edge) == Approx(edge.result.area_mm2));
  double before = seen_mm2(edge);
  for (const double gap : {0.003, 0.01, 0.03}) {
    const Found found = find(camera, depth, with_gap(with_ring(12), gap));
    const double seen = seen_mm2(found), beyond = seen - film.area_mm2();
    CHECK(seen > before);
    CHECK(found.result.area_mm2 == Approx(edge.result.area_mm2));
    CHECK(found.result.center_mm.x == Approx(edge.result.center_mm.x).margin(1e-9));
    // without noise all doubt is where within the gap the contact ends
    CHECK(beyond < 2 * found.result.area_sd_mm2);
    CHECK(found.result.area_sd_mm2 < beyond);
    const double one_minus_iou = beyond / seen;  // concentric
    CHECK(found.result.expected_one_minus_iou() < one_minus_iou);
    CHECK(one_minus_iou < 2.5 * found.result.expected_one_minus_iou());
    const double wider = std::sqrt(seen / std::numbers::pi) - radius_of(edge.result);
    const double law = std::sqrt(gap / film.free_per_mm);
    CHECK(wider > 0.9 * law);
    CHECK(wider < 1.1 * law);
    before = seen;
  }
}

TEST_CASE("a threshold near zero erodes by a ring's radius", "[contact_region]") {
  for (const double radius_mm : {4.0, 6.0, 8.0}) {
    for (const Index ring_px : {6, 9, 12}) {
      const Index size = pixels_for(radius_mm, ring_px, 0.16);
      const auto camera = height_map(size, size, 0.16);
      test::RoundContact contact;
      contact.radius_mm = radius_mm;
      const auto depth = depths_of<float>(camera, RoundFilm(contact), size, size);
      const double ring_mm = static_cast<double>(ring_px) * 0.16;
      CAPTURE(radius_mm, ring_px);
      ContactTest test = with_ring(ring_px);
      test.threshold_per_mm = 1e-4;
      const double eroded = radius_of(find(camera, depth, at_threshold(test)).result);
      CHECK(eroded == Approx(radius_mm - 0.9 * ring_mm).margin(0.12));
      test.threshold_per_mm = 0.025;  // half the level of the free pad: already near the edge
      CHECK(radius_of(find(camera, depth, at_threshold(test)).result) ==
            Approx(radius_mm).margin(0.15));
    }
  }
}

TEST_CASE("a hole stays a hole, and a slit parts the contact", "[contact_region]") {
  test::RoundContact ring;
  ring.radius_mm = 7;
  ring.hole_mm = 2.4;
  const Index size = 145;
  const auto camera = height_map(size, size, 0.16);
  const auto annulus = find(camera, depths_of<float>(camera, RoundFilm(ring), size, size),
                            with_gap(with_ring(6), 0));
  CHECK(annulus.result.regions == 1);
  CHECK(annulus.mask(size / 2, size / 2) == Touch::none);
  CHECK(annulus.mask(size / 2, size / 2 + 29) == Touch::contact);
  CHECK(annulus.result.area_mm2 == Approx(ring.area_mm2()).epsilon(0.08));

  test::StripFilm strip;
  strip.half_mm = 6;
  for (const double slit : {0.0, 2.0}) {
    strip.slit_mm = slit;
    const auto found = find(height_map(60, size, 0.16),
                            depths_of<float>(height_map(60, size, 0.16), strip, 60, size),
                            with_gap(with_ring(6), 0));
    CHECK(found.result.regions == (slit > 0 ? 2 : 1));
    CHECK(found.mask(30, size / 2) == (slit > 0 ? Touch::none : Touch::contact));
    // straight edges, through the middle row
    Index outermost = size / 2;
    while (found.mask(30, outermost + 1) != Touch::none || outermost < size / 2 + 25) {
      ++outermost;
    }
    CHECK(static_cast<double>(outermost - size / 2) * 0.16 == Approx(6).margin(0.25));
  }
}

TEST_CASE("curved and tilted objects", "[contact_region]") {
  const Index size = pixels_for(6, 12, 0.16);
  const auto check = [&](const test::RoundContact& contact) {
    INFO("curvature " << contact.object_per_mm << ", slope " << contact.slope);
    const RoundFilm film(contact);
    const auto by = [&](const auto& camera, double share) {
      const auto depth = depths_of<float>(camera, film, size, size);
      const ContactResult r = find(camera, depth, with_gap(with_ring(12), 0)).result;
      CHECK(r.regions == 1);
      // on the plate: the area of the touching disc, times the cosine of its tilt
      CHECK(r.area_mm2 == Approx(film.area_mm2()).epsilon(share));
      CHECK(r.center_mm.x == Approx(film.x_mm).margin(0.1));
      CHECK(r.center_mm.y == Approx(film.y_mm).margin(0.05));
      CHECK(r.center_mm.z == Approx(film.top_mm - contact.object_per_mm * 9).margin(0.08));
    };
    by(height_map(size, size, 0.16), 0.03);
    by(pad_camera(size, size, 0.16), 0.05);
  };
  for (const double h : {-0.1, -0.05, 0.005, 0.01, 0.02}) {
    test::RoundContact contact;
    contact.object_per_mm = h;
    contact.x_mm = 0.4;
    check(contact);
  }
  for (const double slope : {0.05, 0.14}) {
    test::RoundContact contact;
    contact.slope = slope;
    check(contact);
  }
}

TEST_CASE("a hollow object of which noise leaves specks is one contact", "[contact_region]") {
  test::RoundContact contact;
  contact.object_per_mm = 0.0248;  // the threshold is 0.025
  const RoundFilm film(contact);
  const Index size = pixels_for(6, 12, 0.16);
  const auto camera = height_map(size, size, 0.16);
  auto depth = depths_of<float>(camera, film, size, size);
  test::Random random(5);
  for (float& z : depth.cells) {
    z += static_cast<float>(0.003 * random.normal());
  }
  auto test = with_gap(with_ring(12), 0);
  test.min_region_px = 1;
  const ContactResult r = find(camera, depth, test).result;
  CHECK(r.regions == 1);
  CHECK(r.area_mm2 == Approx(film.area_mm2()).epsilon(0.05));
}

TEST_CASE("a hollow object that never falls to half of the level is found by a fainter threshold",
          "[contact_region]") {
  const Index size = pixels_for(6, 12, 0.16);
  const auto camera = height_map(size, size, 0.16);
  ContactTest test = with_gap(with_ring(12), 0);
  ContactTest faint = test;
  faint.faint_per_mm = 0.04;
  for (const double hollow_per_mm : {0.0, 0.03, 0.033}) {
    test::RoundContact contact;
    contact.object_per_mm = hollow_per_mm;
    const RoundFilm film(contact);
    const auto depth = depths_of<float>(camera, film, size, size);
    const Found plain = find(camera, depth, test), found = find(camera, depth, faint);
    CAPTURE(hollow_per_mm);
    CHECK(found.result.regions == 1);
    if (hollow_per_mm > test.threshold_per_mm) {
      CHECK_FALSE(plain.result.in_contact());
      CHECK(found.result.area_mm2 == Approx(film.area_mm2()).epsilon(0.1));
    } else {  // what half of the level finds stays as it is
      CHECK(found.result.area_mm2 == plain.result.area_mm2);
      CHECK(found.mask.cells == plain.mask.cells);
    }
  }
  test::RoundContact none;
  none.radius_mm = 0;
  const auto free = depths_of<float>(camera, RoundFilm(none), size, size);
  CHECK_FALSE(find(camera, free, faint).result.in_contact());
}

TEST_CASE("a hollow object takes the pressure that the membrane on it does not carry",
          "[contact_region]") {
  for (const double object_per_mm : {-0.02, 0.0, 0.01, 0.02}) {
    test::RoundContact contact;
    contact.object_per_mm = object_per_mm;
    contact.radius_mm = 8;
    const RoundFilm film(contact);
    const Index size = pixels_for(8, 12, 0.16);
    const auto camera = height_map(size, size, 0.16);
    const auto depth = depths_of<float>(camera, film, size, size);
    for (const bool places_edge : {true, false}) {
      auto test = with_gap(with_ring(12), 0);
      test.places_edge = places_edge;
      const ContactResult r = find(camera, depth, test).result;
      const double share =
          places_edge ? (std::min)(1 - object_per_mm / contact.free_per_mm, 1.0) : 1;
      CAPTURE(object_per_mm, places_edge);
      CHECK(r.pressed_mm2 == Approx(share * r.area_mm2).epsilon(0.05));
    }
  }
}

TEST_CASE("a free pad has no contact", "[contact_region]") {
  for (const double curvature : {0.03, 0.05, 0.1}) {
    test::RoundContact none;
    none.radius_mm = 0;
    none.free_per_mm = curvature;
    const auto camera = pad_camera(80, 100, 0.16);
    const auto found =
        find(camera, depths_of<double>(camera, RoundFilm(none), 80, 100), with_ring(12));
    CHECK_FALSE(found.result.in_contact());
    CHECK(count(found.mask, Touch::contact) == 0);
    CHECK(found.result.regions == 0);
    CHECK(found.result.area_mm2 == 0);
    CHECK(std::isnan(found.result.depth_mm));
    CHECK(std::isnan(found.result.center_mm.x));
    CHECK(std::isnan(found.result.center_mm.y));
    CHECK(std::isnan(found.result.center_mm.z));
  }
}

namespace {

using Plan = OrthographicCamera<double>;

}  // namespace

TEST_CASE("pixels need not be square", "[contact_region]") {
  const auto check = [](auto camera) {
    const auto found = [&](double aspect) {
      const Index rows = static_cast<Index>(std::lround(160 / aspect));
      camera.pixel_aspect = aspect;
      camera.center_y_px = static_cast<double>(rows - 1) / 2;
      const auto depth = depths_of<float>(camera, RoundFilm({}), rows, 160);
      return find(camera, depth, with_gap(with_ring(12), 0)).result;
    };
    const double square_mm = radius_of(found(1));
    CHECK(square_mm == Approx(6).epsilon(0.025));
    for (const double aspect : {0.8, 1.083, 1.25}) {
      CAPTURE(aspect);
      const ContactResult r = found(aspect);
      CHECK(radius_of(r) == Approx(square_mm).epsilon(0.006));
      CHECK(r.center_mm.x == Approx(0).margin(0.05));
      CHECK(r.center_mm.y == Approx(0).margin(0.05));
    }
  };
  check(height_map(160, 160, 0.16));
  check(pad_camera(160, 160, 0.16));
}

TEST_CASE("specks are dropped", "[contact_region]") {
  // three flats in a bowl whose sections all bulge
  const auto camera = height_map(80, 160, 0.16);
  Image<float> depth(80, 160);
  for (Index i = 0; i < 80; ++i) {
    for (Index j = 0; j < 160; ++j) {
      const double x = static_cast<double>(j % 80 - 40) * 0.16;
      const double y = static_cast<double>(i - 40) * 0.16;
      const double rho = std::hypot(x, y);
      const double flat = j < 80 ? 3.2 : 1.2;
      depth(i, j) = static_cast<float>(rho < flat ? 10 : 10 - 0.1 * (rho - flat) * (rho - flat));
    }
  }
  const auto with_least = [&](Index pixels) {
    return find(camera, depth, at_threshold(with_ring(5, pixels)));
  };
  const auto all = with_least(1);
  const auto large = with_least(all.result.contact_px / 2);
  REQUIRE(all.result.regions >= 2);
  CHECK(large.result.regions == 1);
  CHECK(large.mask(40, 40) == Touch::contact);
  CHECK(large.mask(40, 120) == Touch::none);
  CHECK(all.mask(40, 120) == Touch::contact);
  const Index least = large.result.contact_px;
  CHECK(with_least(least).mask.cells == large.mask.cells);
  CHECK_FALSE(with_least(least + 1).result.in_contact());
}

TEST_CASE("the edge needs no free membrane in sight", "[contact_region]") {
  // an image with little but the contact: the threshold then represents the free pad
  const auto camera = height_map(40, 40, 0.16);
  test::RoundContact contact;
  contact.radius_mm = 2.3;
  const auto depth = depths_of<float>(camera, RoundFilm(contact), 40, 40);
  const auto found = find(camera, depth, with_gap(with_ring(6), 0));
  CHECK(found.result.regions == 1);
  CHECK(found.result.area_mm2 == Approx(contact.area_mm2()).epsilon(0.13));
  // an image entirely in contact
  const auto flat = find(camera, Image<float>(40, 40, 9.0F), with_ring(6));
  CHECK(flat.result.contact_px + flat.result.unknown_px == 1600);
  CHECK(flat.result.contact_px > 900);
}

TEST_CASE("a region may take what another has lost", "[contact_region]") {
  // seed, free, seed: the first is dropped and the second grows over all three, so more pixels
  // enter the queue than the image has
  detail::Regions regions({1, 3});
  const auto marks = regions.marks();
  marks(0, 0) = detail::Mark::seed;
  marks(0, 1) = detail::Mark::free;
  marks(0, 2) = detail::Mark::seed;
  int found = 0;
  const auto second = [&](const detail::Regions::Region&) { return ++found == 2; };
  const Index kept = regions.for_each(second, [&](detail::Regions::Region& region) {
    regions.grow(region, 2, [](Index) { return true; });
    CHECK(region.begin == 0);
    CHECK(region.pixels() == 3);
    regions.trim(region, [&](Index at) { return at != regions.image().at(0, 1); });
    CHECK(region.pixels() == 2);
  });
  CHECK(kept == 1);
  CHECK(marks(0, 0) == detail::Mark::contact);
  CHECK(marks(0, 1) == detail::Mark::free);
  CHECK(marks(0, 2) == detail::Mark::contact);
}

TEST_CASE("masks of bytes, of bool and of Touch say the same", "[contact_region]") {
  const auto camera = height_map(60, 64, 0.32);
  auto depth = depths_of<float>(camera, RoundFilm({}), 60, 64);
  depth(30, 30) = std::numeric_limits<float>::quiet_NaN();
  ContactRegion<> region(camera, 60, 64, with_ring(5));
  Image<Touch> touch(60, 64);
  Image<std::uint8_t> bytes(60, 64, 3);
  Image<float> numbers(60, 64, 3.0F);
  std::array<bool, 60 * 64> flags{};
  const auto result = region(depth, touch);
  (void)region(depth, bytes);
  (void)region(depth, numbers);
  (void)region(depth, StridedView<bool>(flags.data(), 60, 64, 64));
  for (std::size_t k = 0; k < flags.size(); ++k) {
    const bool in = touch.cells[k] == Touch::contact;
    REQUIRE(bytes.cells[k] == (in ? 255 : 0));
    REQUIRE(numbers.cells[k] == (in ? 255.0F : 0.0F));
    REQUIRE(flags[k] == in);
  }
  CHECK(count(touch, Touch::contact) == result.contact_px);
  CHECK(count(touch, Touch::unknown) == result.unknown_px);
  CHECK(touch(30, 30) == Touch::unknown);
  // pixels without a statistic are unknown
  const auto statistic = region.statistic();
  for (Index i = 0; i < 60; ++i) {
    for (Index j = 0; j < 64; ++j) {
      REQUIRE((touch(i, j) == Touch::unknown) == std::isnan(statistic(i, j)));
    }
  }
}

TEST_CASE("missing depth is never contact and reaches no farther than its ring",
          "[contact_region]") {
  const auto camera = height_map(60, 64, 0.32);
  const auto depth = depths_of<double>(camera, RoundFilm({}), 60, 64);
  const Index ring = 5;
  const auto far = [](Index i, Index j, double px) {
    return std::hypot(static_cast<double>(i - 30), static_cast<double>(j - 38)) > px;
  };
  for (const double bad : {test::nan, infinite, -infinite, 1e30, -1e30}) {
    auto spoilt = depth;
    spoilt(30, 38) = bad;
    spoilt(31, 38) = bad;
    const auto plain = find(camera, depth, at_threshold(with_ring(ring, 1)));
    const auto found = find(camera, spoilt, at_threshold(with_ring(ring, 1)));
    const auto edge = find(camera, spoilt, with_ring(ring));
    const auto edge_before = find(camera, depth, with_ring(ring));
    CHECK(found.mask(30, 38) == Touch::unknown);
    CHECK(edge.mask(30, 38) == Touch::unknown);
    CHECK(edge.result.unknown_px == edge_before.result.unknown_px + 2);
    Index moved = 0;
    for (Index i = 0; i < 60; ++i) {
      for (Index j = 0; j < 64; ++j) {
        if (far(i, j, static_cast<double>(ring) + 1.5)) {
          REQUIRE(found.mask(i, j) == plain.mask(i, j));
          moved += edge.mask(i, j) == edge_before.mask(i, j) ? 0 : 1;
        }
      }
    }
    CHECK(moved <= 2);  // the level of the edge is a mean over known pixels
    CHECK(edge.result.area_mm2 == Approx(edge_before.result.area_mm2).epsilon(0.03));
    CHECK(edge.result.depth_mm == Approx(edge_before.result.depth_mm).margin(1e-3));
  }
}

TEST_CASE("pixels at the image's end count as much as others", "[contact_region]") {
  const OrthographicCamera<double> camera;
  ContactTest test = with_ring(3);
  test.directions = 2;  // one along rows, one along columns
  const Image<double> plate(30, 41, 5.0);
  const auto found = find(camera, plate, at_threshold(test));
  CHECK(found.mask(0, 20) == Touch::contact);
  CHECK(found.mask(29, 20) == Touch::contact);
  CHECK(found.mask(15, 0) == Touch::contact);
  CHECK(found.mask(15, 40) == Touch::contact);
  const double pixel_mm2 = camera.pitch_mm * camera.pitch_mm;
  const auto count = static_cast<double>(found.result.contact_px);
  CHECK(found.result.area_mm2 == Approx(count * pixel_mm2).epsilon(1e-12));
}

TEST_CASE("area and center are those of the plainest loop", "[contact_region]") {
  test::Pad pad;
  pad.rows = 96;
  pad.cols = 112;
  pad.camera.plate_thickness_mm = 5;
  pad.camera.pitch_mm = 0.4;
  pad.camera.center_x_px = 52.5;
  pad.camera.center_y_px = 45.5;
  for (const double press_mm : {1.0, 2.5, 4.0}) {
    CAPTURE(press_mm);
    const auto found = find(pad.camera, pad.pressed_depths(press_mm), with_gap(with_ring(3), 0));
    REQUIRE(found.result.contact_px > 100);
    Image<int> mask(pad.rows, pad.cols);
    std::transform(found.mask.cells.begin(), found.mask.cells.end(), mask.cells.begin(),
                   [](Touch t) { return t == Touch::contact ? 1 : 0; });
    const auto plain = test::contact_measures(pad.camera, mask, pad.pressed_depths(press_mm));
    CHECK(plain.pixels == found.result.contact_px);
    // the rays of the estimator are a table
    CHECK(found.result.area_mm2 == Approx(plain.area_mm2).epsilon(1e-6));
    CHECK(norm(found.result.center_mm - plain.center_mm) < 1e-6);
  }
}

TEST_CASE("an image smaller than the ring is unknown", "[contact_region]") {
  for (const Index size : {2, 9}) {
    const Image<float> depth(size, size + 1, 9.0F);
    const auto found = find(height_map(size, size + 1), depth);
    CHECK(found.result.unknown_px == size * (size + 1));
    CHECK(count(found.mask, Touch::unknown) == size * (size + 1));
    CHECK_FALSE(found.result.in_contact());
    CHECK(found.result.status == FrameStatus::not_of_this_pad);
    CHECK(has_no_number(found.result));
  }
  const Image<float> missing(30, 40, static_cast<float>(test::nan));
  CHECK(find(height_map(30, 40), missing, with_ring(4)).result.unknown_px == 30 * 40);
}

TEST_CASE("a grid of another size is not accepted", "[contact_region]") {
  const auto camera = height_map(60, 64, 0.32);
  ContactRegion<> region(camera, 60, 64, with_ring(5));
  const auto depth = depths_of<float>(camera, RoundFilm({}), 60, 64);
  const auto refused = [&](const Image<float>& from, Image<std::uint8_t> to) {
    std::fill(to.cells.begin(), to.cells.end(), std::uint8_t(7));
    const ContactResult r = region(from, to);
    return !r.ok() && r.contact_px == 0 && r.unknown_px == 0 && has_no_number(r) &&
           count(to, std::uint8_t(7)) == to.rows() * to.cols();
  };
  const Image<std::uint8_t> mask(60, 64);
  CHECK(refused(Image<float>(60, 63), mask));
  CHECK(refused(Image<float>(61, 64), mask));
  CHECK(refused(depth, Image<std::uint8_t>(64, 60)));
  CHECK_FALSE(refused(depth, mask));
}

TEST_CASE("bad parameters are refused by name", "[contact_region]") {
  const auto with = [](const ContactTest& test) {
    return refusal([&] { ContactRegion<> region({}, 60, 60, test); });
  };
  ContactTest test;
  CHECK(with(test) == "accepted");
  for (const double bad : {0.0, -0.1, test::nan, infinite}) {
    test = {};
    test.threshold_per_mm = bad;
    CHECK(begins_with(with(test), "ContactTest: threshold_per_mm = "));
  }
  test = {};
  test.faint_per_mm = -0.01;
  CHECK(with(test) == "ContactTest: faint_per_mm = -0.01, must be finite and >= 0");
  test = {};
  test.free_apex_mm = test::nan;
  CHECK(begins_with(with(test), "ContactTest: free_apex_mm = nan"));
  CHECK(with(with_ring(9, 0)) == "ContactTest: min_region_px = 0, must be >= 1");
  CHECK(with(with_ring(0)) == "ContactTest: ring_px = 0, must be in [1, 1000]");

  for (const double bad : {-0.01, 1.1, test::nan}) {
    CHECK(begins_with(with(with_gap({}, bad)), "ContactTest: touching_gap_mm = "));
  }
  Camera<double> camera;
  camera.refractive_index = 0.5;
  CHECK(begins_with(refusal([&] { ContactRegion<> region(camera, 60, 60); }),
                    "Camera: refractive_index = 0.5"));
  camera = {};
  camera.center_y_px = -1e300;
  CHECK(begins_with(refusal([&] { ContactRegion<> region(camera, 60, 60); }),
                    "ContactRegion: camera: corner of the image, mm = "));
  camera = {};
  camera.center_y_px = 0;  // one of the other corners alone
  camera.center_x_px = 59;
  camera.plate_distance_mm = 10;
  camera.distortion_k1 = -0.6;
  CHECK(begins_with(refusal([&] { ContactRegion<> region(camera, 60, 60); }),
                    "ContactRegion: camera: corner of the image, mm = nan"));
  // a pixel without neighbours on both sides has no area
  for (const Index one : {0, 1}) {
    CHECK(begins_with(refusal([&] { ContactRegion<> region({}, one, 60); }),
                      "ContactRegion: rows = "));
    CHECK(begins_with(refusal([&] { ContactRegion<> region({}, 60, one); }),
                      "ContactRegion: cols = "));
  }
}

using test::mirrored;
using test::transposed;

namespace {

constexpr double pitch_mm = 0.32;

struct Bytes {
  ContactResult result;
  Image<std::uint8_t> mask;
};

template <class S, class D>
Bytes bytes_of(ContactRegion<S>& region, const Image<D>& depth) {
  Bytes found{{}, Image<std::uint8_t>(depth.rows(), depth.cols(), 3)};
  found.result = region(depth, found.mask);
  RC_ASSERT(found.result.accepted());
  return found;
}

ContactTest any_test() {
  ContactTest test;
  test.min_region_px = 1;
  test.ring_px = test::uniform(4, 6);
  test.threshold_per_mm = test::uniform(0.01, 0.04);
  test.places_edge = false;
  return test;
}

/// A pad with a contact anywhere, waves on it, and sometimes missing pixels.
Image<double> any_membrane(Index rows, Index cols) {
  test::RoundContact contact;
  contact.radius_mm = test::uniform(1, 4);
  contact.free_per_mm = test::uniform(0.03, 0.08);
  contact.x_mm = test::uniform(-2, 2);
  contact.y_mm = test::uniform(-2, 2);
  const RoundFilm film(contact);
  const auto camera = test::height_map(rows, cols, pitch_mm);
  Image<double> depth = test::depths_of<double>(camera, film, rows, cols);
  const double wave = test::whole(0, 1) == 0 ? 0 : test::log_uniform(1e-4, 0.05);
  const double a = test::uniform(0.2, 1.5), b = test::uniform(0.2, 1.5), c = test::uniform(0, 6);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      depth(i, j) += wave * std::sin(a * static_cast<double>(i) + c) *
                     std::cos(b * static_cast<double>(j) - c);
    }
  }
  for (Index k = test::whole(0, 4); k > 1; --k) {
    depth(test::whole(0, rows - 1), test::whole(0, cols - 1)) = test::nan;
  }
  return depth;
}

Image<double> any_membrane() {
  return any_membrane(test::whole(24, 44), test::whole(24, 44));
}

Index differing(const Image<std::uint8_t>& a, const Image<std::uint8_t>& b) {
  RC_ASSERT(a.cells.size() == b.cells.size());
  Index count = 0;
  for (std::size_t k = 0; k < a.cells.size(); ++k) {
    count += a.cells[k] == b.cells[k] ? 0 : 1;
  }
  return count;
}

bool within(const Image<std::uint8_t>& part, const Image<std::uint8_t>& whole) {
  for (std::size_t k = 0; k < part.cells.size(); ++k) {
    if (part.cells[k] > whole.cells[k]) {
      return false;
    }
  }
  return true;
}

/// Sizes of the components of a mask by OpenCV, largest first.
std::vector<Index> parts(Image<std::uint8_t> mask) {
  const cv::Mat image(static_cast<int>(mask.rows()), static_cast<int>(mask.cols()), CV_8U,
                      mask.cells.data());
  cv::Mat labels, stats, centers;
  const int count = cv::connectedComponentsWithStats(image, labels, stats, centers, 4);
  std::vector<Index> sizes;
  for (int k = 1; k < count; ++k) {
    sizes.push_back(stats.at<int>(k, cv::CC_STAT_AREA));
  }
  std::sort(sizes.rbegin(), sizes.rend());
  return sizes;
}

Plan camera_of(const Image<double>& depth) {
  return test::height_map(depth.rows(), depth.cols(), pitch_mm);
}

Bytes find_in(const Image<double>& depth, const ContactTest& test) {
  ContactRegion<double> region(camera_of(depth), depth.rows(), depth.cols(), test);
  return bytes_of(region, depth);
}

}  // namespace

TEST_CASE("the contact turns with the membrane", "[contact_region]") {
  rc::prop("transposed and mirrored", [] {
    const auto depth = any_membrane();
    const ContactTest test = any_test();
    const Bytes found = find_in(depth, test);
    // in double no curvature is so near the threshold that the order of summation matters
    const Bytes rotated = find_in(transposed(depth), test);
    const Bytes flipped = find_in(mirrored(depth), test);
    const Bytes upset = find_in(transposed(mirrored(transposed(depth))), test);
    RC_ASSERT(rotated.mask.cells == transposed(found.mask).cells);
    RC_ASSERT(flipped.mask.cells == mirrored(found.mask).cells);
    RC_ASSERT(upset.mask.cells == transposed(mirrored(transposed(found.mask))).cells);
    RC_ASSERT(rotated.result.unknown_px == found.result.unknown_px);
    RC_ASSERT(rotated.result.regions == found.result.regions);
    if (found.result.in_contact()) {
      RC_ASSERT(std::abs(rotated.result.area_mm2 - found.result.area_mm2) < 1e-3);
      RC_ASSERT(std::abs(rotated.result.center_mm.x - found.result.center_mm.y) < 1e-3);
      RC_ASSERT(std::abs(flipped.result.center_mm.x + found.result.center_mm.x) < 1e-3);
      RC_ASSERT(std::abs(flipped.result.depth_mm - found.result.depth_mm) < 1e-4);
    }
  });
}

TEST_CASE("so does its edge, but for the lattice that its level is taken on", "[contact_region]") {
  rc::prop("transposed exactly, mirrored nearly", [] {
    test::RoundContact contact;
    contact.radius_mm = test::uniform(2.5, 3.5);
    contact.x_mm = test::uniform(-0.3, 0.3);
    const auto depth =
        test::depths_of<double>(test::height_map(45, 41, pitch_mm), RoundFilm(contact), 45, 41);
    ContactTest test;
    test.ring_px = test::uniform(4, 6);
    test.min_region_px = 20;
    const Bytes found = find_in(depth, test);
    RC_ASSERT(found.result.regions == 1);
    const Bytes rotated = find_in(transposed(depth), test);
    RC_ASSERT(rotated.mask.cells == transposed(found.mask).cells);
    const Bytes flipped = find_in(mirrored(depth), test);
    RC_ASSERT(differing(flipped.mask, mirrored(found.mask)) <= found.result.contact_px / 50);
  });
}

TEST_CASE("only shape counts, not depth, seen from infinitely far", "[contact_region]") {
  rc::prop("all pixels as much deeper", [] {
    const auto depth = any_membrane();
    ContactTest test = any_test();
    test.places_edge = true;
    auto deeper = depth;
    const double by = test::uniform(-8, 8);
    for (double& l : deeper.cells) {
      l += by;
    }
    const Bytes a = find_in(depth, test), b = find_in(deeper, test);
    RC_ASSERT(a.mask.cells == b.mask.cells);
    if (a.result.in_contact()) {
      RC_ASSERT(std::abs(a.result.depth_mm - by - b.result.depth_mm) < 1e-4);
      RC_ASSERT(std::abs(a.result.area_mm2 - b.result.area_mm2) < 1e-3);
    }
  });
}

TEST_CASE("cleaning keeps the regions that it says", "[contact_region]") {
  rc::prop("against OpenCV's components", [] {
    const auto depth = any_membrane();
    const ContactTest test = any_test();
    const Bytes all = find_in(depth, test);
    const auto sizes = parts(all.mask);
    RC_ASSERT(all.result.regions == static_cast<Index>(sizes.size()));

    const Index least = test::whole(1, 200);
    ContactTest cleaned = test;
    cleaned.min_region_px = least;
    const Bytes large = find_in(depth, cleaned);
    const auto kept =
        std::count_if(sizes.begin(), sizes.end(), [&](Index size) { return size >= least; });
    RC_ASSERT(within(large.mask, all.mask));
    RC_ASSERT(large.result.regions == kept);
    RC_ASSERT(static_cast<Index>(parts(large.mask).size()) == kept);
  });
}

namespace {

/// Any input: membranes, noise, flats with creases, with missing, infinite and huge depths.
Image<double> anything(Index rows, Index cols) {
  Image<double> depth(rows, cols, 9.0);
  const auto kind = test::whole(0, 2);
  if (kind == 0) {
    depth = any_membrane(rows, cols);
  }
  test::Random random(static_cast<std::uint64_t>(test::whole(0, 1000000)));
  const double noise = kind == 1 ? test::log_uniform(1e-6, 10) : 0;
  const double crease = kind == 2 ? test::uniform(0, 0.3) : 0;
  const double bad = test::whole(0, 1) == 0 ? 0 : test::uniform(0, 0.2);
  const double values[] = {test::nan,
                           std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity(),
                           1e38,
                           -1e38,
                           1e300,
                           1e5,
                           -1e5,
                           0};
  for (double& l : depth.cells) {
    l += noise * random.normal();
    l += random.uniform() < crease ? random.uniform(0, 0.05) : 0;
    if (random.uniform() < bad) {
      l = values[random.whole(0, 8)];
    }
  }
  return depth;
}

template <class R>
void check_anything(R& region, R fresh, const Image<double>& depth, const ContactTest& test) {
  const Bytes found = bytes_of(region, depth);
  const ContactResult& r = found.result;
  const Index pixels = depth.rows() * depth.cols();
  const Index in = std::count(found.mask.cells.begin(), found.mask.cells.end(), 255);
  RC_ASSERT(in == r.contact_px);
  RC_ASSERT(r.contact_px + r.unknown_px <= pixels);
  RC_ASSERT(r.regions <= r.contact_px);
  RC_ASSERT((r.regions > 0) == r.in_contact());
  for (const double field : {r.area_mm2, r.area_sd_mm2, r.pressed_mm2}) {
    RC_ASSERT(is_finite(field) == r.ok());
  }
  for (const double field : {r.center_mm.x, r.center_mm.y, r.center_mm.z, r.depth_mm}) {
    RC_ASSERT(is_finite(field) == (r.ok() && r.in_contact()));
  }
  for (std::size_t k = 0; k < depth.cells.size(); ++k) {
    RC_ASSERT(found.mask.cells[k] == 0 || is_finite(depth.cells[k]));
  }
  // each pixel is classified by its own statistic
  const auto statistic = region.statistic();
  Index unknown = 0;
  for (Index i = 0; i < depth.rows(); ++i) {
    for (Index j = 0; j < depth.cols(); ++j) {
      const auto k = statistic(i, j);
      unknown += is_finite(k) ? 0 : 1;
      if (!test.places_edge && is_finite(k)) {
        const bool below = static_cast<double>(k) < test.threshold_per_mm;
        RC_ASSERT(found.mask(i, j) == 0 || below);  // contact is below the threshold
        RC_ASSERT(!below || found.mask(i, j) != 0 ||
                  test.min_region_px > 1);  // and below it is contact
      }
    }
  }
  RC_ASSERT(unknown == r.unknown_px);
  // nothing of earlier frames is kept
  const Bytes again = bytes_of(fresh, depth);
  RC_ASSERT(again.mask.cells == found.mask.cells);
  RC_ASSERT(test::same_bits(again.result.area_mm2, r.area_mm2));
  RC_ASSERT(again.result.regions == r.regions);
}

template <class S, class CameraType>
void fuzz(
    const CameraType& camera, bool places_edge, Index rows, Index cols, Index min_region_px = 1) {
  ContactTest test;
  test.ring_px = test::uniform(1, 7);
  test.directions = static_cast<int>(test::whole(1, 18));
  test.threshold_per_mm = test::log_uniform(1e-3, 0.03);
  test.min_region_px = min_region_px;
  test.places_edge = places_edge;
  const ContactRegion<S> fresh(camera, rows, cols, test);
  ContactRegion<S> region = fresh;
  for (int frame = 0; frame < 3; ++frame) {
    check_anything(region, fresh, anything(rows, cols), test);
  }
}

}  // namespace

TEST_CASE("whatever the frame, the result can be read", "[contact_region]") {
  rc::prop("no crash, no NaN, no memory of other frames", [] {
    const Index rows = test::whole(2, 30), cols = test::whole(2, 30);
    const auto plan = test::height_map(rows, cols, pitch_mm);
    const auto through = test::pad_camera(rows, cols, pitch_mm);
    const Index specks = test::whole(1, 30);
    fuzz<double>(plan, true, rows, cols, specks);
    fuzz<float>(through, true, rows, cols);
    fuzz<float>(through, false, rows, cols);
    fuzz<double>(plan, false, rows, cols, specks);
  });
}

// Level of the edge against the mean over the ring, integrated in 50 digits.

using detail::edge_share;
using detail::share_at_end;
using test::Digits50;

namespace test {

template <class Real>
Tangent<Real> acos(const Tangent<Real>& a) {
  using std::acos;
  using std::sqrt;
  const Real sine_sq = Real(1) - a.v * a.v;
  const Real sine = sqrt(sine_sq);
  return {acos(a.v), -a.d / sine};
}

}  // namespace test

namespace {

const Digits50 pi = boost::math::constants::pi<Digits50>();

template <class S, class F>
S integral(const F& f, const S& from, const S& to) {
  return boost::math::quadrature::gauss<S, 60>::integrate(f, from, to);
}

/// Mean curvature on a ring of radius 1 whose center is `offset` outside a straight edge with the
/// gap s^2. By definition it is the mean of gap(ring) - gap(center), doubled because the section of
/// a parabola s^2 has curvature 2.
Digits50 share_by_integration(const Digits50& offset) {
  using std::acos;
  const Digits50 last = offset < 1 ? Digits50(acos(Digits50(-offset))) : pi;  // beyond: in contact
  const auto gap = [&](const Digits50& angle) {
    using std::cos;
    const Digits50 s = offset + cos(angle);
    return Digits50(s * s);
  };
  return Digits50((integral(gap, Digits50(0), last) / pi - offset * offset) * 2);
}

/// The same for a ring centered on the edge of a round contact, in double.
double share_on_round_edge(double ring, double patch) {
  // the gap to first order in slope, per jump; the ring is outside the edge on one side
  const auto gap = [&](double angle) {
    const double rho_sq = patch * patch + ring * ring + 2 * patch * ring * std::cos(angle);
    const double excess = (rho_sq - patch * patch) / (patch * patch);
    return excess > 0 ? patch * patch / 2 * (excess - std::log1p(excess)) : 0.0;
  };
  const double last = std::acos(-ring / (2 * patch));
  return 2 * integral(gap, 0.0, last) / (pi.convert_to<double>() * ring * ring);
}

}  // namespace

TEMPLATE_TEST_CASE(
    "share of the jump against 50 digits", "[contact_region]", float, double, Digits50) {
  using S = TestType;
  // the constant 2 / pi has 20 digits
  const double bound = std::is_same_v<S, float> ? 3e-7 : std::is_same_v<S, double> ? 5e-16 : 1e-16;
  rc::prop("at any offset", [&] {
    // near 1 the sine is a small difference
    const bool near_end = test::whole(0, 1) == 1;
    const S offset =
        static_cast<S>(near_end ? 1 - test::log_uniform(1e-14, 1) : test::uniform(0, 1.5));
    const Digits50 exact = share_by_integration(Digits50(offset));
    const Digits50 error = Digits50(edge_share(offset)) - exact;
    RC_ASSERT(std::abs(static_cast<double>(error)) <= bound);
  });
  CHECK(std::abs(static_cast<double>(edge_share(S(0))) - 0.5) <= bound);
  CHECK(edge_share(S(1)) == S(1));
  CHECK(edge_share(S(40)) == S(1));
  CHECK(edge_share(not_a_number<S>()) == S(1));
}

TEST_CASE("a round edge curves away from the ring", "[contact_region]") {
  for (const double ratio : {0.001, 0.01, 0.1, 0.3}) {
    const double exact = share_on_round_edge(ratio, 1);
    const double share = share_at_end(1.0, 0.0, ratio, 1.0);
    CHECK(share == Approx(exact).margin(0.03 * ratio * ratio + 1e-9));  // to first order
  }
}

TEMPLATE_TEST_CASE(
    "a contact ends beyond half of the jump", "[contact_region]", float, double, test::Digits50) {
  using S = TestType;
  rc::prop("for every contact", [] {
    const S jump = static_cast<S>(test::log_uniform(1e-6, 0.4));
    const S gap = static_cast<S>(test::whole(0, 3) == 0 ? 0.0 : test::log_uniform(1e-9, 1));
    const S ring = static_cast<S>(test::log_uniform(0.05, 5));
    const S patch = static_cast<S>(test::log_uniform(0.05, 20));
    const S share = share_at_end(jump, gap, ring, patch);
    RC_ASSERT(!(share < S(0.5) - S(1e-6)));
    RC_ASSERT(!(S(1) < share));
    RC_ASSERT(!(share_at_end(jump, static_cast<S>(S(2) * gap), ring, patch) + S(1e-6) < share));
  });
}
