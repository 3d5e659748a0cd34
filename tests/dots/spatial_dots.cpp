// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/dots/spatial_dots.hpp"

#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "fingerpad/adapt/opencv.hpp"
#include "support/catch.hpp"
#include "support/rolling.hpp"

using namespace fingerpad;
using test::Dots;
using test::Flags;

TEST_CASE("spatial dots: depth is read between pixels, at the dot's own pixel (E020)") {
  const Camera<double> camera;
  test::Image<double> depth(4, 5);
  for (Index i = 0; i < 4; ++i) {
    for (Index j = 0; j < 5; ++j) {
      depth(i, j) = 10 + 0.5 * static_cast<double>(i) - 0.25 * static_cast<double>(j);
    }
  }
  depth(3, 4) = std::nan("");
  test::Image<Point2<double>> dots(1, 9);
  dots(0, 0) = {1.25, 2.5};
  dots(0, 1) = {0, 0};
  dots(0, 2) = {3, 3};      // needs no missing pixel
  dots(0, 3) = {3.5, 2.5};  // needs one
  dots(0, 4) = {-0.01, 1};  // outside
  dots(0, 5) = {std::nan(""), 1};
  dots(0, 6) = {4, 2};    // the last column
  dots(0, 7) = {4.5, 2};  // beyond it
  dots(0, 8) = {2, 3.5};  // beyond the last row
  Dots out(1, 9);
  CHECK(spatial_dots(camera, dots, depth, out) == 4);
  const auto expected = point_at(camera, 2.5, 1.25, 10 + 1.25 - 0.3125);
  CHECK(out(0, 0).x == Approx(expected.x));
  CHECK(out(0, 0).y == Approx(expected.y));
  CHECK(out(0, 0).z == Approx(expected.z));
  CHECK(out(0, 2).z == Approx(10.75));
  CHECK(out(0, 6).z == Approx(10));
  for (const Index missing : {3, 4, 5, 7, 8}) {
    CHECK(std::isnan(out(0, missing).x));
    CHECK(std::isnan(out(0, missing).z));
  }
  Dots other_size(2, 9);
  CHECK(spatial_dots(camera, dots, depth, other_size) == -1);
  cv::Mat_<cv::Vec3f> image(1, 9);
  CHECK(spatial_dots(camera, dots, depth, image) == 4);
  CHECK(static_cast<double>(image(0, 0)[2]) == Approx(expected.z));

  test::Flags mask(4, 5, 0);
  mask(3, 1) = 255;
  mask(0, 0) = 1;
  test::Flags touching(1, 9, 9);
  CHECK(contact_at_dots(dots, mask, touching));
  CHECK(touching.cells == std::vector<unsigned char>{1, 1, 0, 0, 0, 0, 0, 0, 0});
  Flags turned_size(9, 1);
  CHECK(!contact_at_dots(dots, mask, turned_size));
}

TEST_CASE("contact at dots: with a radius, all of a dot must touch") {
  // a half plane from column 10 on, and a hole in it
  test::Flags mask(20, 40, 0);
  for (Index i = 0; i < 20; ++i) {
    for (Index j = 10; j < 40; ++j) {
      mask(i, j) = 255;
    }
  }
  mask(10, 30) = 0;
  test::Image<Point2<double>> dots(1, 7);
  dots(0, 0) = {13.0, 10.0};
  dots(0, 1) = {12.4, 10.0};  // its pixel is 12
  dots(0, 2) = {39.4, 0.0};   // pixels outside the mask do not count
  dots(0, 3) = {32.0, 12.0};  // sqrt(8) from the hole
  dots(0, 4) = {33.0, 10.0};
  dots(0, 5) = {32.0, 11.0};
  dots(0, 6) = {-2.0, 10.0};
  test::Flags touching(1, 7, 9);
  CHECK(contact_at_dots(dots, mask, touching, 2.5));
  CHECK(touching.cells == std::vector<unsigned char>{1, 1, 1, 1, 1, 0, 0});
  CHECK(contact_at_dots(dots, mask, touching, 3.0));
  CHECK(touching.cells == std::vector<unsigned char>{1, 0, 1, 0, 0, 0, 0});
  CHECK(contact_at_dots(dots, mask, touching, 4.0));
  CHECK(touching.cells == std::vector<unsigned char>{0, 0, 1, 0, 0, 0, 0});
  for (const double bad : {-1.0, 1e9, not_a_number<double>()}) {
    touching(0, 0) = 9;
    CHECK(!contact_at_dots(dots, mask, touching, bad));
    CHECK(touching(0, 0) == 9);
  }
}

TEST_CASE("contact at dots: a dot touches if its nearest pixel does") {
  test::Flags mask(6, 9, 0);
  mask(3, 5) = 1;
  test::Image<Point2<double>> dots(2, 4);
  const double inside[] = {-0.48, 0.48}, outside[] = {-0.52, 0.52};
  for (Index k = 0; k < 2; ++k) {
    dots(0, k) = {5 + inside[k], 3};
    dots(0, k + 2) = {5, 3 + inside[k]};
    dots(1, k) = {5 + outside[k], 3};
    dots(1, k + 2) = {5, 3 + outside[k]};
  }
  test::Flags touching(2, 4, 9);
  CHECK(contact_at_dots(dots, mask, touching));
  CHECK(touching.cells == std::vector<unsigned char>{1, 1, 1, 1, 0, 0, 0, 0});
}
