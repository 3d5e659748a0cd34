// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every membrane, every ring and every policy.
#include "fingerpad/contact/contact_region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/rotated.hpp"
#include "support/soap_film.hpp"

using namespace fingerpad;
using test::Image;
using test::mirrored;
using test::RoundFilm;
using test::transposed;

namespace {

using Plan = OrthographicCamera<double>;
constexpr double pitch_mm = 0.32;

struct Found {
  ContactResult result;
  Image<std::uint8_t> mask;
};

template <class S, class D>
Found find(ContactRegion<S>& region, const Image<D>& depth) {
  Found found{{}, Image<std::uint8_t>(depth.rows(), depth.cols(), 3)};
  found.result = region(depth, found.mask);
  RC_ASSERT(found.result.accepted());
  return found;
}

ContactTest any_test() {
  ContactTest test;
  test.min_region_px = 1;
  test.ring.radius_px = test::uniform(4, 6);
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

Found find_in(const Image<double>& depth, const ContactTest& test) {
  ContactRegion<double> region(camera_of(depth), depth.rows(), depth.cols(), test);
  return find(region, depth);
}

}  // namespace

TEST_CASE("the contact turns with the membrane", "[contact_region]") {
  rc::prop("transposed and mirrored", [] {
    const auto depth = any_membrane();
    const ContactTest test = any_test();
    const Found found = find_in(depth, test);
    // in double no curvature is so near the threshold that the order of summation matters
    const Found rotated = find_in(transposed(depth), test);
    const Found flipped = find_in(mirrored(depth), test);
    const Found upset = find_in(transposed(mirrored(transposed(depth))), test);
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
    test.ring.radius_px = test::uniform(4, 6);
    test.min_region_px = 20;
    const Found found = find_in(depth, test);
    RC_ASSERT(found.result.regions == 1);
    const Found rotated = find_in(transposed(depth), test);
    RC_ASSERT(rotated.mask.cells == transposed(found.mask).cells);
    const Found flipped = find_in(mirrored(depth), test);
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
    const Found a = find_in(depth, test), b = find_in(deeper, test);
    RC_ASSERT(a.mask.cells == b.mask.cells);
    if (a.result.in_contact()) {
      RC_ASSERT(std::abs(a.result.depth_mm - by - b.result.depth_mm) < 1e-4);
      RC_ASSERT(std::abs(a.result.area_mm2 - b.result.area_mm2) < 1e-3);
    }
  });
}

TEST_CASE("the larger the contact, the larger the area", "[contact_region]") {
  rc::prop("of every edge", [] {
    test::RoundContact contact;
    contact.radius_mm = test::uniform(2, 4);
    contact.free_per_mm = test::uniform(0.04, 0.08);
    const auto camera = test::height_map(44, 44, pitch_mm);
    const auto area = [&](bool places_edge) {
      const auto depth = test::depths_of<double>(camera, RoundFilm(contact), 44, 44);
      ContactTest test;
      test.ring.radius_px = 4;
      test.min_region_px = 1;
      test.places_edge = places_edge;
      return find_in(depth, test).result.area_mm2;
    };
    const double before[] = {area(false), area(true)};
    contact.radius_mm += test::uniform(0.1, 1);
    RC_ASSERT(area(false) >= before[0]);
    RC_ASSERT(area(true) >= before[1]);
  });
}

TEST_CASE("cleaning keeps the regions that it says", "[contact_region]") {
  rc::prop("against OpenCV's components", [] {
    const auto depth = any_membrane();
    const ContactTest test = any_test();
    const Found all = find_in(depth, test);
    const auto sizes = parts(all.mask);
    RC_ASSERT(all.result.regions == static_cast<Index>(sizes.size()));

    const Index least = test::whole(1, 200);
    ContactTest cleaned = test;
    cleaned.min_region_px = least;
    const Found large = find_in(depth, cleaned);
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
  const Found found = find(region, depth);
  const ContactResult& r = found.result;
  const Index pixels = depth.rows() * depth.cols();
  const Index in = std::count(found.mask.cells.begin(), found.mask.cells.end(), 255);
  RC_ASSERT(in == r.contact_px);
  RC_ASSERT(r.contact_px + r.unknown_px <= pixels);
  RC_ASSERT(r.regions <= r.contact_px);
  RC_ASSERT((r.regions > 0) == r.in_contact());
  RC_ASSERT(is_finite(r.area_mm2));
  for (const double field : {r.center_mm.x, r.center_mm.y, r.center_mm.z, r.depth_mm}) {
    RC_ASSERT(is_finite(field) == r.in_contact());
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
  const Found again = find(fresh, depth);
  RC_ASSERT(again.mask.cells == found.mask.cells);
  RC_ASSERT(again.result.area_mm2 == r.area_mm2);
  RC_ASSERT(again.result.regions == r.regions);
}

template <class S, class CameraType>
void fuzz(
    const CameraType& camera, bool places_edge, Index rows, Index cols, Index min_region_px = 1) {
  ContactTest test;
  test.ring.radius_px = test::uniform(1, 7);
  test.ring.min_direction_share = test::uniform(0.01, 1);
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
