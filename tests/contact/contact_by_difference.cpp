// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/contact/contact_by_difference.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "fingerpad/adapt/opencv.hpp"
#include "support/catch.hpp"
#include "support/gel_frames.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::begins_with;
using test::ColourFrame;
using test::GelCamera;
using test::Image;
using test::Random;
using test::refusal;

namespace {

struct Scene {
  GelCamera camera;
  Random random{7};
  GelContact<> contact{GelPad{}};

  std::vector<ColourFrame> free(int count) {
    std::vector<ColourFrame> frames;
    for (int k = 0; k < count; ++k) {
      frames.push_back(camera.frame(GelContact<>(GelPad{}), random));
    }
    return frames;
  }
};

struct Found {
  ContactResult result;
  Image<Touch> mask;
};
template <class Contact, class Frame>
Found find(const Contact& contact, const Frame& frame) {
  auto workspace = contact.workspace();
  Found found{{}, Image<Touch>(contact.rows(), contact.cols(), Touch::unknown)};
  found.result = contact(frame, found.mask, workspace);
  REQUIRE(found.result.ok());
  return found;
}

Index count(const Image<Touch>& mask, Touch which) {
  return std::count(mask.cells.begin(), mask.cells.end(), which);
}

}  // namespace

TEST_CASE("contact by difference: a ball on a gel", "[contact_by_difference]") {
  Scene scene;
  DifferenceTest test;
  test.mm_per_px = scene.camera.mm_per_px;
  const ContactByDifference<> contact(scene.free(3), test);
  for (const double force_n : {0.1, 0.4, 1.5}) {
    const Point2<double> ball = {-1.7, 1.2};
    scene.contact.drag(force_n, ball);
    const Found found = find(contact, scene.camera.frame(scene.contact, scene.random));
    CHECK(found.result.regions == 1);
    CHECK(found.result.contact_px == count(found.mask, Touch::contact));
    CHECK(std::abs(found.result.center_mm.x - ball.x) < 0.3);
    CHECK(std::abs(found.result.center_mm.y - ball.y) < 0.3);
    CHECK(found.result.area_mm2 == Approx(double(found.result.contact_px) * 0.08 * 0.08));
    CHECK(std::isnan(found.result.center_mm.z));
    // all of the contact is found, and so is part of the dent around it
    const auto touched = scene.camera.touched(scene.contact);
    Index missed = 0;
    Index truth = 0;
    for (std::size_t k = 0; k < touched.cells.size(); ++k) {
      truth += touched.cells[k] != 0;
      missed += touched.cells[k] != 0 && found.mask.cells[k] != Touch::contact;
    }
    UNSCOPED_INFO(force_n << " N: " << found.result.contact_px << " px for " << truth << ", missed "
                          << missed);
    CHECK(missed <= truth / 50);
  }
}

TEST_CASE("contact by difference: as much of a ball's dent as the gel's slope says",
          "[contact_by_difference]") {
  // eq. 3.42 of Johnson: the slope at rho radii of the contact, relative to that at its edge
  const auto slope = [](double rho) {
    return 2 / 3.14159265358979 * (rho * std::asin(1 / rho) - std::sqrt(1 - 1 / (rho * rho)));
  };
  Scene scene;
  scene.camera.dot_mm = 0;
  scene.camera.noise = 0.3;
  DifferenceTest test;
  test.dot_px = 0;
  test.cell_px = 2;
  test.smoothing_px = 2;
  test.mm_per_px = scene.camera.mm_per_px;
  for (const double ball_mm : {6.0, 10.0}) {
    for (const double force_n : {0.3, 0.6, 1.0}) {
      for (const double threshold : {0.02, 0.04}) {
        test.min_difference = threshold;
        const ContactByDifference<> contact(scene.free(2), test);
        REQUIRE(contact.threshold() == threshold);
        GelContact<> ball(GelPad{.ball_mm = ball_mm});
        ball.drag(force_n, {0, 0});
        const double a = ball.radius_mm();
        const double at_edge =
            scene.camera.contrast * a / ball_mm / std::sqrt(2.0);  // rms of the lamps
        double rho = 1;
        while (slope(rho) > threshold / at_edge) {
          rho += 1e-3;
        }
        const auto found = find(contact, scene.camera.frame(ball, scene.random)).result;
        const double seen = std::sqrt(found.area_mm2 / 3.14159265358979) / a;
        CAPTURE(ball_mm, force_n, threshold, rho, seen);
        CHECK(std::abs(seen / rho - 1) < 0.05);
      }
    }
  }
}

TEST_CASE("contact by difference: a contact near the frame's edge is as large as one in the middle",
          "[contact_by_difference]") {
  Scene scene;
  scene.camera.dot_mm = 0;  // dots on the outline would also change the area
  DifferenceTest test;
  test.dot_px = 0;
  test.max_gap_px = 56;
  test.mm_per_px = scene.camera.mm_per_px;
  const ContactByDifference<> contact(scene.free(3), test);
  const auto area_mm2 = [&](const Point2<double>& ball) {
    scene.contact.drag(0.3, ball);
    return find(contact, scene.camera.frame(scene.contact, scene.random)).result.area_mm2;
  };
  const double middle = area_mm2({0, 0});
  // from the edge of the dent to that of the frame
  const double radius = std::sqrt(middle / 3.14159265358979);
  const double half_mm = 160 * scene.camera.mm_per_px;
  for (const double left_px : {4, 8, 12, 16}) {
    const double x = half_mm - radius - left_px * scene.camera.mm_per_px;
    // the mean over 7 px is one-sided at the edge
    const double allowed = left_px < 7 ? 0.05 : 0.02;
    CHECK(area_mm2({x, 0}) == Approx(middle).epsilon(allowed));
    CHECK(area_mm2({-x, 0}) == Approx(middle).epsilon(allowed));
  }
}

TEST_CASE("contact by difference: a free pad is free in any exposure", "[contact_by_difference]") {
  Scene scene;
  const ContactByDifference<> contact(scene.free(3));
  for (const double exposure : {0.6, 1.0, 1.3}) {
    scene.camera.exposure = exposure;
    const Found found = find(contact, scene.camera.frame(scene.contact, scene.random));
    CHECK(found.result.contact_px == 0);
    CHECK(found.result.regions == 0);
    CHECK(std::isnan(found.result.center_mm.x));
  }
}

TEST_CASE("contact by difference: free frames that differ raise the threshold",
          "[contact_by_difference]") {
  Scene scene;
  CHECK(ContactByDifference<>(scene.free(1)).threshold() == 0.02);
  CHECK(ContactByDifference<>(scene.free(2)).threshold() == 0.02);
  scene.camera.noise = 40;
  const double noisy = ContactByDifference<>(scene.free(4)).threshold();
  CHECK(noisy > 0.02);
  DifferenceTest test;
  test.noise_factor = 2;
  scene = Scene{};
  scene.camera.noise = 40;
  CHECK(ContactByDifference<>(scene.free(4), test).threshold() > 1.5 * noisy);
}

TEST_CASE("contact by difference: every kind of image, one answer", "[contact_by_difference]") {
  Scene scene;
  const auto free = scene.free(1);
  scene.contact.drag(0.6, {0.4, 0.3});
  const ColourFrame frame = scene.camera.frame(scene.contact, scene.random);
  const ContactByDifference<> contact(free);
  const Found packed = find(contact, frame);

  cv::Mat_<cv::Vec3b> mat(240, 320);
  for (int i = 0; i < 240; ++i) {
    for (int j = 0; j < 320; ++j) {
      const auto& p = frame(i, j);
      mat(i, j) = {p[0], p[1], p[2]};
    }
  }
  const Found from_mat = find(contact, mat);
  CHECK(from_mat.mask.cells == packed.mask.cells);
  const LazyView lazy(240, 320, [&](Index i, Index j) {
    const auto& p = frame(i, j);
    return std::array<double, 3>{double(p[0]), double(p[1]), double(p[2])};
  });
  CHECK(find(contact, lazy).mask.cells == packed.mask.cells);

  // one channel, in another scalar
  const auto red = [](const ColourFrame& of) {
    return LazyView(240, 320, [&of](Index i, Index j) { return of(i, j)[0]; });
  };
  const std::vector red_free = {red(free[0])};
  const Found one = find(ContactByDifference<1, double>(red_free), red(frame));
  CHECK(one.result.contact_px > packed.result.contact_px / 2);
}

TEST_CASE("contact by difference: bad pixels say nothing, nor do they spread",
          "[contact_by_difference]") {
  Scene scene;
  const auto free = scene.free(1);
  scene.contact.drag(0.6, {-4, 0});
  const ColourFrame frame = scene.camera.frame(scene.contact, scene.random);
  const ContactByDifference<> contact(free);
  const Found whole = find(contact, frame);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), 255.0, 0.0,
                           std::numeric_limits<double>::infinity()}) {
    const LazyView spoilt(240, 320, [&](Index i, Index j) {
      const auto& p = frame(i, j);
      const bool is_bad = i >= 80 && i < 160 && j >= 220 && j < 300;
      return is_bad ? std::array{bad, bad, bad}
                    : std::array{double(p[0]), double(p[1]), double(p[2])};
    });
    const Found found = find(contact, spoilt);
    CHECK(found.mask(120, 260) == Touch::unknown);
    CHECK(found.result.unknown_px > 50 * 50);
    CHECK(found.result.unknown_px == count(found.mask, Touch::unknown));
    // only the exposure is measured on fewer pixels
    CHECK(std::abs(double(found.result.contact_px - whole.result.contact_px)) <
          0.02 * double(whole.result.contact_px));
  }
}

TEST_CASE("contact by difference: the mask reaches all four edges of the frame",
          "[contact_by_difference]") {
  Scene scene;
  const auto free = scene.free(1);
  const ColourFrame frame = scene.camera.frame(scene.contact, scene.random);
  const ContactByDifference<> contact(free);
  const LazyView framed(240, 320, [&](Index i, Index j) {
    const bool is_bad = i < 30 || i >= 210 || j < 30 || j >= 290;
    const auto& p = frame(i, j);
    return is_bad ? std::array{0.0, 0.0, 0.0}
                  : std::array{double(p[0]), double(p[1]), double(p[2])};
  });
  const Found found = find(contact, framed);
  for (Index i = 0; i < 240; ++i) {
    CHECK((found.mask(i, 0) == Touch::unknown && found.mask(i, 319) == Touch::unknown));
  }
  for (Index j = 0; j < 320; ++j) {
    CHECK((found.mask(0, j) == Touch::unknown && found.mask(239, j) == Touch::unknown));
  }
  CHECK(found.mask(120, 160) == Touch::none);
}

TEST_CASE("contact by difference: numbers are those of the mask, whatever the cells",
          "[contact_by_difference]") {
  // narrower cells at the right and lower edge, with unknown pixels and contact on both
  for (const Index cell_px : {1, 3, 4, 5, 16}) {
    const Index rows = 83;
    const Index cols = 101;
    DifferenceTest test;
    test.cell_px = cell_px;
    test.dot_px = 0;
    test.max_gap_px = 0;
    test.smoothing_px = double(cell_px) / 2;
    test.min_region_px = 0;
    test.mm_per_px = 0.5;
    const std::vector free = {Image<double>(rows, cols, 100.0)};
    const ContactByDifference<1, double> contact(free, test);
    Image<double> frame(rows, cols, 100.0);
    for (Index i = 35; i < rows; ++i) {
      for (Index j = 50; j < cols; ++j) {
        frame(i, j) = i < 60 ? 130 : j < 80 ? 100 : 0;  // black pixels are unknown
      }
    }
    const Found found = find(contact, frame);
    double x = 0;
    double y = 0;
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const double touches = found.mask(i, j) == Touch::contact ? 1 : 0;
        x += touches * double(j);
        y += touches * double(i);
      }
    }
    const Index pixels = count(found.mask, Touch::contact);
    REQUIRE(pixels > 900);
    CHECK(found.result.contact_px == pixels);
    CHECK(found.result.unknown_px == count(found.mask, Touch::unknown));
    CHECK(found.result.unknown_px > 0);
    CHECK(found.result.area_mm2 == Approx(0.25 * double(pixels)));
    CHECK(found.result.center_mm.x == Approx(0.5 * (x / double(pixels) - 50)));
    CHECK(found.result.center_mm.y == Approx(0.5 * (y / double(pixels) - 41)));
  }
}

TEST_CASE("contact by difference: holes are filled, specks dropped", "[contact_by_difference]") {
  const auto flat = [](Index rows, Index cols) { return Image<double>(rows, cols, 100.0); };
  DifferenceTest test;
  test.dot_px = 0;
  test.cell_px = 1;
  test.smoothing_px = 0.5;
  test.max_gap_px = 0;
  test.min_region_px = 60;
  const std::vector free = {flat(80, 90)};
  const ContactByDifference<1, double> contact(free, test);
  Image<double> frame = flat(80, 90);
  for (Index i = 20; i < 60; ++i) {
    for (Index j = 20; j < 60; ++j) {
      const bool inside = i >= 30 && i < 50 && j >= 30 && j < 50;
      frame(i, j) = inside ? 100 : 120;
    }
  }
  for (Index i = 5; i < 10; ++i) {
    for (Index j = 70; j < 75; ++j) {
      frame(i, j) = 80;
    }
  }
  const Found found = find(contact, frame);
  CHECK(found.result.regions == 1);
  CHECK(found.mask(40, 40) == Touch::contact);
  CHECK(found.mask(7, 72) == Touch::none);
  CHECK(std::abs(double(found.result.contact_px) - 1600) < 180);
}

TEST_CASE("contact by difference: what does not fit is refused", "[contact_by_difference]") {
  Scene scene;
  auto free = scene.free(2);
  const ContactByDifference<> contact(free);
  auto workspace = contact.workspace();
  Image<std::uint8_t> mask(240, 320, 9);
  CHECK(!contact(ColourFrame(240, 319), mask, workspace).ok());
  Image<std::uint8_t> small(239, 320, 9);
  CHECK(!contact(free[0], small, workspace).ok());
  CHECK(small(0, 0) == 9);
  DifferenceTest other;
  other.smoothing_px = 5;
  auto others = ContactByDifference<>(free, other).workspace();
  CHECK(!contact(free[0], mask, others).ok());
  CHECK(mask(0, 0) == 9);

  CHECK(begins_with(refusal([] { ContactByDifference<>(std::vector<ColourFrame>{}); }),
                    "ContactByDifference: free_frames = 0"));
  free.emplace_back(240, 321);
  CHECK(begins_with(refusal([&] { ContactByDifference<>{free}; }),
                    "ContactByDifference: free_frames of another size, number = 2"));
}

TEST_CASE("contact by difference: bad parameters are refused by name", "[contact_by_difference]") {
  const auto refused = [](auto DifferenceTest::*field, auto bad) {
    DifferenceTest test;
    test.*field = bad;
    return refusal([&] { expects_valid(test); });
  };
  CHECK(begins_with(refused(&DifferenceTest::cell_px, Index(0)), "DifferenceTest: cell_px = 0"));
  CHECK(begins_with(refused(&DifferenceTest::cell_px, Index(17)), "DifferenceTest: cell_px = 17"));
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    CHECK(begins_with(refused(&DifferenceTest::smoothing_px, bad), "DifferenceTest: smoothing_px"));
    CHECK(begins_with(refused(&DifferenceTest::dot_px, bad), "DifferenceTest: dot_px"));
    CHECK(begins_with(refused(&DifferenceTest::dot_contrast, bad), "DifferenceTest: dot_contrast"));
    CHECK(begins_with(refused(&DifferenceTest::min_difference, bad),
                      "DifferenceTest: min_difference"));
    CHECK(begins_with(refused(&DifferenceTest::noise_factor, bad), "DifferenceTest: noise_factor"));
    CHECK(begins_with(refused(&DifferenceTest::max_gap_px, bad), "DifferenceTest: max_gap_px"));
    CHECK(begins_with(refused(&DifferenceTest::saturated, bad), "DifferenceTest: saturated"));
    CHECK(begins_with(refused(&DifferenceTest::mm_per_px, bad), "DifferenceTest: mm_per_px"));
  }
  CHECK(begins_with(refused(&DifferenceTest::min_region_px, Index(-1)),
                    "DifferenceTest: min_region_px = -1"));
  CHECK(refused(&DifferenceTest::cell_px, Index(16)) != "accepted");  // the smoothing is too narrow
  CHECK(refused(&DifferenceTest::max_gap_px, 0.0) == "accepted");     // no gap is closed
}

TEST_CASE("contact by difference: the border is each cell of the four sides, once",
          "[contact_by_difference]") {
  for (const Index rows : {1, 2, 5}) {
    for (const Index cols : {1, 2, 7}) {
      Image<int> visits(rows, cols, 0);
      detail::for_border(rows, cols, [&](Index i, Index j) { ++visits(i, j); });
      for (Index i = 0; i < rows; ++i) {
        for (Index j = 0; j < cols; ++j) {
          const bool at_side = i == 0 || j == 0 || i + 1 == rows || j + 1 == cols;
          CAPTURE(rows, cols, i, j);
          CHECK(visits(i, j) == (at_side ? 1 : 0));
        }
      }
    }
  }
}
