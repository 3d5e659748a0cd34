// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/gel/gel_contact.hpp"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "support/catch.hpp"
#include "support/gel_frames.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::BallOnGel;
using test::begins_with;
using test::GelCamera;
using test::GelPad;
using test::Random;
using test::refusal;

namespace {

constexpr double pi = 3.14159265358979;

struct Scene {
  GelCamera camera;
  Random random{7};
  BallOnGel<> contact{GelPad{}};

  cv::Mat frame() { return test::mat_of(camera.frame(contact, random)); }
  std::vector<cv::Mat> free(int count) {
    std::vector<cv::Mat> frames;
    for (int k = 0; k < count; ++k) {
      frames.push_back(test::mat_of(camera.frame(BallOnGel<>(GelPad{}), random)));
    }
    return frames;
  }
  Point2<double> center_mm(const GelResult& found) const {
    return camera.mm_of(found.center_px.y, found.center_px.x);
  }
  double area_mm2(const GelResult& found) const {
    return found.contact_px * camera.mm_per_px * camera.mm_per_px;
  }
};

GelResult find(GelContact& contact, const cv::Mat& frame) {
  const GelResult found = contact(frame);
  REQUIRE(found.ok());
  return found;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

}  // namespace

TEST_CASE("gel contact: a ball on a gel", "[gel_contact]") {
  Scene scene;
  GelContact contact(scene.free(3));
  for (const double force_n : {0.1, 0.4, 1.5}) {
    const Point2<double> ball = {-1.7, 1.2};
    scene.contact.drag(force_n, ball);
    const GelResult found = find(contact, scene.frame());
    CHECK(found.in_contact());
    CHECK(norm(scene.center_mm(found) - ball) < 0.3);
    // all of the contact is found, and so is part of the dent around it
    const auto touched = scene.camera.touched(scene.contact);
    Index missed = 0;
    Index truth = 0;
    for (int i = 0; i < 240; ++i) {
      for (int j = 0; j < 320; ++j) {
        truth += touched(i, j) != 0;
        missed += touched(i, j) != 0 && contact.mask()(i / 4, j / 4) == 0;
      }
    }
    UNSCOPED_INFO(force_n << " N: " << found.contact_px << " px for " << truth << ", missed "
                          << missed);
    CHECK(missed <= truth / 50);
  }
}

TEST_CASE("gel contact: as much of a ball's dent as the gel's slope says", "[gel_contact]") {
  // eq. 3.42 of Johnson: the slope at rho radii of the contact, relative to that at its edge
  const auto slope = [](double rho) {
    return 2 / pi * (rho * std::asin(1 / rho) - std::sqrt(1 - 1 / (rho * rho)));
  };
  Scene scene;
  scene.camera.dot_mm = 0;
  scene.camera.noise = 0.3;
  GelOptions options;
  options.dot_px = 0;
  options.cell_px = 2;
  options.smoothing_px = 2;
  for (const double ball_mm : {6.0, 10.0}) {
    for (const double force_n : {0.3, 0.6, 1.0}) {
      for (const double threshold : {0.02, 0.04}) {
        options.min_difference = threshold;
        GelContact contact(scene.free(2), options);
        REQUIRE(contact.threshold() == threshold);
        scene.contact = BallOnGel<>(GelPad{.ball_mm = ball_mm});
        scene.contact.drag(force_n, {0, 0});
        const double a = scene.contact.radius_mm();
        const double at_edge =
            scene.camera.contrast * a / ball_mm / std::sqrt(2.0);  // rms of the lamps
        double rho = 1;
        while (slope(rho) > threshold / at_edge) {
          rho += 1e-3;
        }
        const GelResult found = find(contact, scene.frame());
        const double seen = std::sqrt(scene.area_mm2(found) / pi) / a;
        CAPTURE(ball_mm, force_n, threshold, rho, seen);
        CHECK(std::abs(seen / rho - 1) < 0.05);
      }
    }
  }
}

TEST_CASE("gel contact: a contact near the frame's edge is as large as one in the middle",
          "[gel_contact]") {
  Scene scene;
  scene.camera.dot_mm = 0;  // dots on the outline would also change the area
  GelContact contact(scene.free(3), {.dot_px = 0, .max_gap_px = 56});
  const auto area_mm2 = [&](const Point2<double>& ball) {
    scene.contact.drag(0.3, ball);
    return scene.area_mm2(find(contact, scene.frame()));
  };
  const double middle = area_mm2({0, 0});
  // from the edge of the dent to that of the frame
  const double radius = std::sqrt(middle / pi);
  const double half_mm = 160 * scene.camera.mm_per_px;
  for (const double left_px : {4, 8, 12, 16}) {
    const double x = half_mm - radius - left_px * scene.camera.mm_per_px;
    // the mean over 7 px is one-sided at the edge
    const double allowed = left_px < 7 ? 0.05 : 0.02;
    CHECK(area_mm2({x, 0}) == Approx(middle).epsilon(allowed));
    CHECK(area_mm2({-x, 0}) == Approx(middle).epsilon(allowed));
  }
}

TEST_CASE("gel contact: a free pad is free in any exposure", "[gel_contact]") {
  Scene scene;
  GelContact contact(scene.free(3));
  for (const double exposure : {0.6, 1.0, 1.3}) {
    scene.camera.exposure = exposure;
    const GelResult found = find(contact, scene.frame());
    CHECK(found.contact_px == 0);
    CHECK(std::isnan(found.center_px.x));
    CHECK(cv::countNonZero(contact.mask()) == 0);
  }
}

TEST_CASE("gel contact: free frames that differ raise the threshold", "[gel_contact]") {
  Scene scene;
  CHECK(GelContact(scene.free(1)).threshold() == 0.02);
  CHECK(GelContact(scene.free(2)).threshold() == 0.02);
  scene.camera.noise = 40;
  const auto noisy = scene.free(4);
  const double threshold = GelContact(noisy).threshold();
  CHECK(threshold > 0.02);
  // about a hundredth of a frame exceeds it
  GelContact others(std::vector{noisy[0], noisy[1], noisy[2]});
  (void)others(noisy[3]);
  const cv::Mat exceeds = others.difference() > threshold;
  const double share = cv::mean(exceeds)[0] / 255;
  CHECK(share > 0.0025);
  CHECK(share < 0.04);
  // one that is not free does not change it much
  scene.contact.drag(1, {0, 0});
  GelContact one_pressed(std::vector{noisy[0], noisy[1], noisy[2], noisy[3], scene.frame()});
  CHECK(one_pressed.threshold() < 2 * threshold);
}

TEST_CASE("gel contact: every kind of image, one answer", "[gel_contact]") {
  Scene scene;
  const auto free = scene.free(1);
  scene.contact.drag(0.6, {0.4, 0.3});
  const cv::Mat frame = scene.frame();
  GelContact contact(free);
  const GelResult right = find(contact, frame);

  SECTION("16 bit") {
    const auto deep = [](const cv::Mat& image) {
      cv::Mat levels;
      image.convertTo(levels, CV_16U, 256);
      return levels;
    };
    GelContact of_deep(std::vector{deep(free[0])});
    CHECK(std::abs(find(of_deep, deep(frame)).contact_px - right.contact_px) <= 64);
  }
  SECTION("a part of a larger image") {
    cv::Mat larger(300, 400, CV_8UC3, cv::Scalar(9, 8, 7));
    frame.copyTo(larger({40, 30, 320, 240}));
    GelContact again(free);
    CHECK(find(again, larger({40, 30, 320, 240})).contact_px == right.contact_px);
    CHECK(same(again.mask(), contact.mask()));
  }
  SECTION("one channel, or three that are equal") {
    const auto red = [](const cv::Mat& image) {
      cv::Mat channel;
      cv::extractChannel(image, channel, 0);
      return channel;
    };
    GelContact of_one(std::vector{red(free[0])});
    const GelResult one = find(of_one, red(frame));
    CHECK(one.contact_px > right.contact_px / 2);
    const auto thrice = [&](const cv::Mat& image) {
      cv::Mat colours;
      cv::cvtColor(red(image), colours, cv::COLOR_GRAY2BGR);
      return colours;
    };
    GelContact of_equal(std::vector{thrice(free[0])});
    CHECK(find(of_equal, thrice(frame)).contact_px == one.contact_px);
    CHECK(same(of_equal.mask(), of_one.mask()));
  }
}

TEST_CASE("gel contact: bad pixels say nothing, nor do they spread", "[gel_contact]") {
  Scene scene;
  GelContact contact(scene.free(1));
  scene.contact.drag(0.6, {-4, 0});
  const cv::Mat frame = scene.frame();
  const GelResult whole = find(contact, frame);
  for (const int bad : {255, 0}) {
    cv::Mat spoilt = frame.clone();
    spoilt({220, 80, 80, 80}).setTo(cv::Scalar::all(bad));
    const GelResult found = find(contact, spoilt);
    CHECK(std::isnan(contact.difference()(30, 65)));
    CHECK(std::isfinite(contact.difference()(30, 51)));
    // only the exposure is measured on fewer pixels
    CHECK(std::abs(found.contact_px - whole.contact_px) < 0.02 * whole.contact_px);
  }
  cv::Mat one_channel = frame.clone();
  for (int i = 80; i < 160; ++i) {
    for (int j = 220; j < 300; ++j) {
      one_channel.at<cv::Vec3b>(i, j)[1] = 255;
    }
  }
  (void)find(contact, one_channel);
  CHECK(std::isnan(contact.difference()(30, 65)));
  CHECK(contact(cv::Mat(240, 320, CV_8UC3, cv::Scalar::all(0))).status ==
        FrameStatus::not_of_this_pad);
}

TEST_CASE("gel contact: bands of light are those of the pixels that can be read", "[gel_contact]") {
  Scene scene;
  GelContact contact(scene.free(2));
  cv::Mat frame = scene.frame();
  for (int i = 0; i < frame.rows; ++i) {
    frame.row(i) *= 1 + 0.08 * std::sin(2 * pi * i / 60);
  }
  frame({0, 80, 200, 80}).setTo(cv::Scalar::all(0));  // more than half of these rows
  const GelResult found = find(contact, frame);
  CHECK(found.contact_px == 0);
  for (int row = 22; row < 38; ++row) {
    CHECK(contact.difference()(row, 65) < 0.02F);
  }
}

TEST_CASE("gel contact: what is known reaches all four edges of the frame", "[gel_contact]") {
  Scene scene;
  GelContact contact(scene.free(1));
  cv::Mat framed(240, 320, CV_8UC3, cv::Scalar::all(0));
  scene.frame()({30, 30, 260, 180}).copyTo(framed({30, 30, 260, 180}));
  (void)find(contact, framed);
  for (int i = 0; i < 60; ++i) {
    CHECK((std::isnan(contact.difference()(i, 0)) && std::isnan(contact.difference()(i, 79))));
  }
  for (int j = 0; j < 80; ++j) {
    CHECK((std::isnan(contact.difference()(0, j)) && std::isnan(contact.difference()(59, j))));
  }
  CHECK(contact.difference()(30, 40) < 0.02F);
  CHECK(find(contact, scene.frame()).ok());
  CHECK(cv::countNonZero(contact.difference() == contact.difference()) == 60 * 80);
}

TEST_CASE("gel contact: numbers are those of the mask, whatever the cells", "[gel_contact]") {
  // pixels beyond the last whole cell are left out
  for (const int cell_px : {1, 2, 3, 4, 5, 16}) {
    const cv::Mat free(83, 101, CV_8UC1, 100);
    GelContact contact(std::vector{free}, {.cell_px = cell_px,
                                           .smoothing_px = double(cell_px) / 2,
                                           .dot_px = 0,
                                           .max_gap_px = 0,
                                           .min_region_px = 0});
    cv::Mat frame = free.clone();
    frame({50, 35, 51, 25}).setTo(130);
    const GelResult found = find(contact, frame);
    double x = 0;
    double y = 0;
    int pixels = 0;
    for (int i = 0; i < 83 / cell_px * cell_px; ++i) {
      for (int j = 0; j < 101 / cell_px * cell_px; ++j) {
        const int touches = contact.mask()(i / cell_px, j / cell_px) == 255 ? 1 : 0;
        pixels += touches;
        x += touches * j;
        y += touches * i;
      }
    }
    REQUIRE(pixels > 900);
    CHECK(found.contact_px == pixels);
    CHECK(found.center_px.x == Approx(x / pixels));
    CHECK(found.center_px.y == Approx(y / pixels));
  }
}

TEST_CASE("gel contact: what an old gel keeps of a press is no contact", "[gel_contact]") {
  Scene scene;
  scene.camera.contrast = 4;  // a steep gel, of which some cells are saturated in a press
  const double ball_mm = GENERATE(2.0, 4.0);
  scene.contact = BallOnGel<>(GelPad{.ball_mm = ball_mm});
  GelContact contact(scene.free(4)), never_pressed(scene.free(4));
  scene.contact.drag(0.5, {-1.7, 1.2});
  const cv::Mat pressed = scene.frame();
  cv::Mat kept;
  cv::addWeighted(scene.free(1)[0], 0.96, pressed, 0.04, 0, kept);
  CHECK(find(never_pressed, kept).in_contact());
  CHECK(find(contact, pressed).in_contact());
  CHECK_FALSE(find(contact, kept).in_contact());
  scene.contact = BallOnGel<>(GelPad{});  // a light touch at the same place is found
  scene.contact.drag(0.05, {-1.7, 1.2});
  CHECK(contact(scene.frame()).contact_px > 4000);
}

TEST_CASE("gel contact: holes are filled, specks dropped", "[gel_contact]") {
  const cv::Mat free(80, 90, CV_8UC1, 100);
  GelOptions options{
      .cell_px = 1, .smoothing_px = 0.5, .dot_px = 0, .max_gap_px = 0, .min_region_px = 60};
  cv::Mat frame = free.clone();
  frame({20, 20, 40, 40}).setTo(120);
  frame({30, 30, 20, 20}).setTo(100);
  frame({70, 5, 5, 5}).setTo(80);
  GelContact contact(std::vector{free}, options);
  const GelResult found = find(contact, frame);
  CHECK(contact.mask()(40, 40) == 255);
  CHECK(contact.mask()(7, 72) == 0);
  CHECK(std::abs(found.contact_px - 1600) < 180);
  // a region is as large as its cells
  options.min_region_px = found.contact_px;
  GelContact just(std::vector{free}, options);
  CHECK(find(just, frame).in_contact());
  options.min_region_px = found.contact_px + 1;
  GelContact too_small(std::vector{free}, options);
  CHECK(!find(too_small, frame).in_contact());
}

TEST_CASE("gel contact: the imprint is that of the gel without dots", "[gel_contact]") {
  Scene dotted;
  Scene plain;
  plain.camera.dot_mm = 0;
  dotted.camera.noise = plain.camera.noise = 0;
  GelContact with_dots(dotted.free(1));
  GelContact without(plain.free(1), {.dot_px = 0});
  dotted.contact.drag(0.8, {0.5, 0.2});
  plain.contact.drag(0.8, {0.5, 0.2});
  (void)find(with_dots, dotted.frame());
  (void)find(without, plain.frame());
  const auto off = [&](const cv::Mat& image) {
    return cv::norm(image, without.difference()) / cv::norm(without.difference());
  };
  CHECK(off(with_dots.imprint()) < 0.08);
  CHECK(same(without.imprint(), without.difference()));
}

TEST_CASE("gel contact: what does not fit is refused", "[gel_contact]") {
  Scene scene;
  auto free = scene.free(2);
  GelContact contact(free);
  scene.contact.drag(0.6, {0, 0});
  CHECK(find(contact, scene.frame()).in_contact());
  const cv::Mat before = contact.mask().clone();
  CHECK(contact(cv::Mat(240, 319, CV_8UC3)).status == FrameStatus::refused);
  CHECK(contact(cv::Mat(239, 320, CV_8UC3)).status == FrameStatus::refused);
  CHECK(contact(cv::Mat(240, 320, CV_8UC1)).status == FrameStatus::refused);
  CHECK(contact(cv::Mat(240, 320, CV_16UC3)).status == FrameStatus::refused);
  CHECK(contact(cv::Mat()).status == FrameStatus::refused);
  CHECK(same(contact.mask(), before));

  const auto refused = [](const std::vector<cv::Mat>& frames, const GelOptions& options = {}) {
    return refusal([&] { GelContact(frames, options); });
  };
  CHECK(begins_with(refused({}), "GelContact: free_frames = 0"));
  CHECK(begins_with(refused({cv::Mat()}), "GelContact: free_frames: side = 0"));
  CHECK(begins_with(refused({cv::Mat(3, 9, CV_8UC3)}), "GelContact: free_frames: side = 3"));
  CHECK(begins_with(refused({cv::Mat(9, 9, CV_32FC3)}), "GelContact: free_frames: type = 21"));
  CHECK(begins_with(refused({cv::Mat(9, 9, CV_8UC4)}), "GelContact: free_frames: type = 24"));
  free.emplace_back(240, 321, CV_8UC3);
  CHECK(begins_with(refused(free), "GelContact: free_frames: number = 2"));
}

TEST_CASE("gel contact: bad parameters are refused by name", "[gel_contact]") {
  const auto refused = [](auto GelOptions::*field, auto bad) {
    GelOptions options;
    options.*field = bad;
    const std::string said = check(options);
    const std::vector free = {cv::Mat(99, 99, CV_8UC1, 90)};
    CHECK(refusal([&] { GelContact(free, options); }) == (said.empty() ? "accepted" : said));
    return said;
  };
  CHECK(begins_with(refused(&GelOptions::cell_px, 0), "GelOptions: cell_px = 0"));
  CHECK(begins_with(refused(&GelOptions::cell_px, 17), "GelOptions: cell_px = 17"));
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    CHECK(begins_with(refused(&GelOptions::smoothing_px, bad), "GelOptions: smoothing_px"));
    CHECK(begins_with(refused(&GelOptions::dot_px, bad), "GelOptions: dot_px"));
    CHECK(begins_with(refused(&GelOptions::dot_contrast, bad), "GelOptions: dot_contrast"));
    CHECK(begins_with(refused(&GelOptions::min_difference, bad), "GelOptions: min_difference"));
    CHECK(begins_with(refused(&GelOptions::max_gap_px, bad), "GelOptions: max_gap_px"));
  }
  CHECK(begins_with(refused(&GelOptions::dot_contrast, 1.0), "GelOptions: dot_contrast = 1"));
  CHECK(begins_with(refused(&GelOptions::min_difference, 0.0), "GelOptions: min_difference = 0"));
  CHECK(begins_with(refused(&GelOptions::min_region_px, -1), "GelOptions: min_region_px = -1"));
  CHECK(refused(&GelOptions::cell_px, 16) != "");      // the smoothing is too narrow
  CHECK(refused(&GelOptions::max_gap_px, 0.0) == "");  // no gap is closed
}
