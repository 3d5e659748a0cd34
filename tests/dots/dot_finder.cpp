// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/dots/dot_finder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "fingerpad/adapt/opencv.hpp"
#include "support/catch.hpp"
#include "support/printed_dots.hpp"

using namespace fingerpad;
using test::DotPlaces;
using test::Print;

namespace {

constexpr double pi = 3.14159265358979323846;

DotPlaces lost_everywhere(const DotPlaces& like) {
  return DotPlaces(like.size(), cv::Vec2d::all(0));
}

/// The dots of the free pad as the finder has them.
DotPlaces free_of(const DotFinder& finder) {
  DotPlaces dots(static_cast<int>(finder.rows()), static_cast<int>(finder.cols()));
  const auto view = finder.free_px();
  for (int i = 0; i < dots.rows; ++i) {
    for (int j = 0; j < dots.cols; ++j) {
      dots(i, j) = {view(i, j).x, view(i, j).y};
    }
  }
  return dots;
}

/// Dots of `frame`, which follows the free pad.
DotPlaces dots_in(DotFinder finder, const cv::Mat& frame) {
  DotPlaces dots(static_cast<int>(finder.rows()), static_cast<int>(finder.cols()));
  CHECK(finder(frame, dots).ok());
  return dots;
}

bool same(const DotPlaces& a, const DotPlaces& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](auto p, auto q) {
           return (p == q) || (!is_present(p) && !is_present(q));
         });
}

}  // namespace

TEST_CASE("dots: a grid is found without a word about it, to a fraction of a pixel") {
  Print print;
  const bool bright = GENERATE(false, true);
  if (bright) {
    std::swap(print.ink, print.ground);
  }
  print.rows = 5;
  print.cols = 7;
  print.rotation_rad = GENERATE(-30, 0, 8, 40) * pi / 180;
  print.radius_px = GENERATE(2.5, 4.0, 6.0);
  print.pitch_px = 5 * print.radius_px;
  print.noise = 1;
  INFO("bright " << bright << ", rotated " << print.rotation_rad << ", radius " << print.radius_px);
  DotFinder finder(test::picture_of(print, test::places_of(print)));
  REQUIRE(finder.ok());
  REQUIRE(finder.rows() == print.rows);
  REQUIRE(finder.cols() == print.cols);
  CHECK(finder.pattern().bright == bright);
  CHECK(std::abs(finder.pattern().radius_px - print.radius_px) < 0.1 * print.radius_px + 0.3);
  CHECK(std::abs(finder.pattern().pitch_px - print.pitch_px) < 0.1);
  const auto errors = test::errors_of(free_of(finder), test::places_of(print));
  CHECK(errors.count == print.rows * print.cols);
  CHECK(errors.rms_px < 0.06);
  CHECK(errors.worst_px < 0.15);
}

TEST_CASE("dots: small, large and close dots are found without a word about them") {
  Print print;
  print.rows = print.cols = 3;
  print.radius_px = GENERATE(1.2, 1.5, 26.0);
  print.pitch_px = 2.7 * print.radius_px;
  print.noise = 1;
  const DotPlaces truth = test::places_of(print);
  const DotFinder finder(test::picture_of(print, truth));
  CAPTURE(print.radius_px, finder.refusal());
  REQUIRE(finder.ok());
  CHECK(test::errors_of(free_of(finder), truth).count == 9);
  CHECK(test::errors_of(free_of(finder), truth).worst_px < 0.15 + 0.01 * print.radius_px);
}

TEST_CASE("dots: a dot is fitted by the disc that the free pad shows at its place") {
  // ellipses, the more the farther to the right, as on the wall of a dome
  Print print;
  const DotPlaces truth = test::places_of(print);
  const auto picture = [&](const cv::Vec2d& by) {
    cv::Mat_<double> light(print.frame, print.ground);
    for (int i = 0; i < light.rows; ++i) {
      for (int j = 0; j < light.cols; ++j) {
        for (const cv::Vec2d& dot : truth) {
          const cv::Vec2d off = cv::Vec2d(j, i) - dot - by;
          const double across = print.radius_px * (1 - 0.5 * dot[0] / print.frame.width);
          const double r = std::hypot(off[0] / across, off[1] / print.radius_px);
          light(i, j) -= (print.ground - print.ink) *
                         (std::clamp)(0.5 + (1 - r) * across / 3, 0.0, 1.0) * (r < 2 ? 1 : 0);
        }
      }
    }
    cv::Mat bytes, frame;
    light.convertTo(bytes, CV_8U);
    cv::merge(std::vector<cv::Mat>(3, bytes), frame);
    return frame;
  };
  DotFinder finder(picture({0, 0}));
  REQUIRE(finder.ok());
  const DotPlaces found = dots_in(finder, picture({1.5, -0.7}));
  CHECK(test::errors_of(found, test::moved(truth, {1.5, -0.7})).count == 88);
  CHECK(test::errors_of(found, test::moved(truth, {1.5, -0.7})).rms_px < 0.006);
}

TEST_CASE("dots: a frame that is moved has its dots moved alike") {
  Print print;
  print.fall = 0;
  const DotPlaces truth = test::places_of(print);
  DotFinder finder(test::picture_of(print, truth));
  REQUIRE(finder.ok());
  const cv::Vec2d by(GENERATE(-3, 0, 5), GENERATE(-4, 1));
  const DotPlaces found = dots_in(finder, test::picture_of(print, test::moved(truth, by)));
  CHECK(test::errors_of(found, test::moved(free_of(finder), by)).count == print.rows * print.cols);
  CHECK(test::errors_of(found, test::moved(free_of(finder), by)).worst_px < 0.03);
}

TEST_CASE("dots: a picture that is rotated by 90 degrees has its dots rotated") {
  Print print;
  print.rotation_rad = 0.1;
  const cv::Mat picture = test::picture_of(print, test::places_of(print));
  cv::Mat rotated;
  cv::rotate(picture, rotated, cv::ROTATE_90_CLOCKWISE);
  const DotFinder upright(picture);
  const DotFinder turned(rotated);
  REQUIRE(upright.ok());
  REQUIRE(turned.rows() == upright.cols());
  REQUIRE(turned.cols() == upright.rows());
  const DotPlaces dots = free_of(upright);
  DotPlaces expected(dots.cols, dots.rows);
  for (int i = 0; i < dots.rows; ++i) {
    for (int j = 0; j < dots.cols; ++j) {
      expected(j, dots.rows - 1 - i) = {picture.rows - 1 - dots(i, j)[1], dots(i, j)[0]};
    }
  }
  CHECK(test::errors_of(free_of(turned), expected).count == print.rows * print.cols);
  CHECK(test::errors_of(free_of(turned), expected).worst_px < 0.03);
}

TEST_CASE("dots: a picture upside down has its dots upside down, also at the border") {
  // The light falls toward one border, within half a cell of the background's light.
  Print print;
  print.rotation_rad = pi / 2;
  print.frame = {240, 320};
  print.rows = 5;
  print.cols = 7;
  print.radius_px = 2.5;
  print.pitch_px = 32;
  print.fall = 0.6;
  const cv::Vec2d down = {52, 20};
  cv::Mat upright, turned;
  cv::rotate(test::picture_of(print, test::moved(test::places_of(print), down)), upright,
             cv::ROTATE_90_CLOCKWISE);
  cv::flip(upright, turned, 0);
  const DotFinder a(upright), b(turned);
  REQUIRE(a.ok());
  REQUIRE(b.ok());
  const DotPlaces dots = free_of(a);
  DotPlaces expected = dots.clone();
  for (int i = 0; i < dots.rows; ++i) {
    for (int j = 0; j < dots.cols; ++j) {
      const cv::Vec2d dot = dots(dots.rows - 1 - i, j);
      expected(i, j) = {dot[0], upright.rows - 1 - dot[1]};
    }
  }
  const auto errors = test::errors_of(free_of(b), expected);
  CHECK(errors.count == dots.rows * dots.cols);
  CAPTURE(errors.worst_px, errors.rms_px);
  CHECK(errors.worst_px < 0.003);
}

TEST_CASE("dots: what is lost is NaN, the others stay, and it comes back under its own name") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  DotFinder finder(test::picture_of(print, truth));
  REQUIRE(finder.ok());
  DotPlaces dots(print.rows, print.cols);
  for (int frame = 0; frame < 6; ++frame) {
    const DotPlaces now = test::moved(truth, {2.0 * frame, 0.5 * frame});
    DotPlaces shown = now.clone();
    const bool hides = frame == 2 || frame == 3;
    if (hides) {
      shown(2, 3) = shown(2, 4) = shown(7, 10) = cv::Vec2d::all(std::nan(""));
    }
    const DotResult result = finder(test::picture_of(print, shown), dots);
    INFO("frame " << frame);
    CHECK(result.ok());
    CHECK(result.found == truth.rows * truth.cols - (hides ? 3 : 0));
    CHECK(result.expected == truth.rows * truth.cols);
    for (const cv::Point at : {cv::Point(3, 2), cv::Point(4, 2), cv::Point(10, 7)}) {
      CHECK(is_present(dots(at)) == !hides);
    }
    CHECK(test::errors_of(dots, now).worst_px < 0.1);
  }
}

TEST_CASE("dots: specks that are no dots take no name and move no dot") {
  // A speck whose edge is within a radius of a dot's edge belongs to its spot and shifts it a
  // little.
  struct Case {
    double nearest_radii;  // from a dot's center; dots have 1, specks 1/3
    double worst_px;
  };
  const Case far = GENERATE(Case{7.0 / 3, 0.1}, Case{1.9, 1});
  Print print;
  const DotPlaces truth = test::places_of(print);
  DotFinder finder(test::picture_of(print, truth));
  REQUIRE(finder.ok());
  std::mt19937 random(20110801);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int picture = 0; picture < 5; ++picture) {
    std::vector<cv::Vec2d> specks;
    while (specks.size() < 30) {
      const double x = 320 * unit(random), y = 240 * unit(random);
      const cv::Vec2d speck(x, y);
      const bool beside = std::all_of(truth.begin(), truth.end(), [&](const cv::Vec2d& dot) {
        return cv::norm(dot - speck) > far.nearest_radii * print.radius_px;
      });
      if (beside) {
        specks.push_back(speck);
      }
    }
    const DotPlaces found = dots_in(finder, test::picture_of(print, truth, specks));
    CHECK(test::errors_of(found, truth).count == truth.rows * truth.cols);
    CHECK(test::errors_of(found, truth).worst_px < far.worst_px);
  }
}

TEST_CASE("dots: what hides a part of the frame hides only dots there") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  DotFinder finder(test::picture_of(print, truth));
  REQUIRE(finder.ok());
  cv::Mat frame = test::picture_of(print, truth);
  const cv::Rect hidden(90, 80, 40, 30);
  frame(hidden) = cv::Scalar::all(GENERATE(0, 40, 255));
  const DotPlaces found = dots_in(finder, frame);
  const cv::Rect near(hidden.tl() - cv::Point(11, 11), hidden.br() + cv::Point(11, 11));
  for (int i = 0; i < truth.rows; ++i) {
    for (int j = 0; j < truth.cols; ++j) {
      const cv::Point at(cv::Point2d(truth(i, j)[0], truth(i, j)[1]));
      INFO("row " << i << ", col " << j);
      CHECK((near.contains(at) || is_present(found(i, j))));
      CHECK_FALSE((hidden.contains(at) && is_present(found(i, j))));
    }
  }
  CHECK(test::errors_of(found, truth).worst_px < 0.1);  // half-hidden dots
}

TEST_CASE("dots: damaged dots tell rows and columns, but have no center") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  DotFinder finder(test::picture_of(print, truth));
  REQUIRE(finder.ok());
  const DotPlaces now = test::moved(truth, {GENERATE(0.0, 0.8) * print.pitch_px, 0});
  cv::Mat frame = test::picture_of(print, now);
  struct Damage {
    cv::Rect where;  // from the middle of a dot
    int grey;
  };
  const Damage scratch = {{-1, -8, 3, 16}, 120}, dirt = {{0, -8, 8, 16}, 60};
  const Damage damage = GENERATE_COPY(scratch, dirt);
  const int last = print.cols - 1;
  for (int i = 0; i < print.rows; ++i) {
    const cv::Point at(cvRound(now(i, last)[0]), cvRound(now(i, last)[1]));
    frame(damage.where + at) = cv::Scalar::all(damage.grey);
  }
  DotPlaces found(print.rows, print.cols);
  const DotResult result = finder(frame, found);
  REQUIRE(result.ok());
  CHECK(result.found == print.rows * last);
  for (int i = 0; i < print.rows; ++i) {
    CHECK_FALSE(is_present(found(i, last)));
  }
  CHECK(test::errors_of(found, now).worst_px < 0.1);
}

TEST_CASE("dots: the order of the spots does not matter") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  DotFinder finder(test::picture_of(print, truth));
  DotFinder again = finder;
  std::vector<Point2<double>> spots;
  for (const cv::Vec2d& dot : truth) {
    spots.push_back({dot[0] + 3, dot[1] - 2});
  }
  spots.push_back({100.5, 100.5});
  DotPlaces first(truth.size()), second(truth.size());
  REQUIRE(finder.label(spots, first).ok());
  std::shuffle(spots.begin(), spots.end(), std::mt19937(7));
  REQUIRE(again.label(spots, second).ok());
  CHECK(same(first, second));
  CHECK(test::errors_of(first, test::moved(truth, {3, -2})).worst_px < 1e-12);
}

TEST_CASE("dots: smooth moves of several pitches at once keep the labels") {
  // A square print that is held at the rim; the middle moves and rotates as one.
  constexpr int count = 19;
  constexpr double pitch_px = 17;
  std::mt19937 random(20110801);
  std::uniform_real_distribution<double> unit(-1, 1);
  Print print;
  print.frame = {420, 420};
  print.rows = print.cols = count;
  print.pitch_px = pitch_px;
  print.radius_px = 4;
  const DotPlaces free_pad = test::places_of(print);
  const DotFinder free_finder(test::picture_of(print, free_pad));
  REQUIRE(free_finder.ok());
  const cv::Vec2d center = free_pad(count / 2, count / 2);
  for (int trial = 0; trial < 4; ++trial) {
    const cv::Vec2d shift = pitch_px * cv::Vec2d(1.5 * unit(random), 1.5 * unit(random));
    const double rotation = 0.4 * unit(random);
    DotPlaces truth(count, count);
    std::vector<Point2<double>> spots;
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < count; ++j) {
        const cv::Vec2d from = free_pad(i, j) - center;
        const double rest = (std::max)(0.0, 1 - from.dot(from) / std::pow(11 * pitch_px, 2));
        const double angle = rotation * rest * rest;
        const cv::Matx22d rotated(std::cos(angle), -std::sin(angle), std::sin(angle),
                                  std::cos(angle));
        truth(i, j) = center + rotated * from + rest * rest * shift;
        if (unit(random) < 0.9) {  // one in twenty is not visible
          spots.push_back(
              {truth(i, j)[0] + 0.1 * unit(random), truth(i, j)[1] + 0.1 * unit(random)});
        }
      }
    }
    for (int k = 0; k < 10; ++k) {  // and some spots are not dots
      spots.push_back(
          {center[0] + 9 * pitch_px * unit(random), center[1] + 9 * pitch_px * unit(random)});
    }
    DotPlaces found(count, count);
    DotFinder finder = free_finder;
    const DotResult result = finder.label(spots, found);
    INFO("trial " << trial << ", shift " << shift << " px, rotation " << rotation);
    CHECK(result.found > 85 * count * count / 100);
    CHECK(test::errors_of(found, truth).worst_px < pitch_px / 2);
  }
}

TEST_CASE("dots: a frame without them loses them, and the next one has them again") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  DotFinder finder(test::picture_of(print, truth));
  REQUIRE(finder.ok());
  DotPlaces dots(print.rows, print.cols);
  const DotResult black = finder(cv::Mat(print.frame, CV_8UC3, cv::Scalar::all(0)), dots);
  CHECK(black.status == DotStatus::lost);
  CHECK_FALSE(black.ok());
  CHECK(count_present(dots) == 0);
  const DotPlaces next = test::moved(truth, {4, 3});
  CHECK(finder(test::picture_of(print, next), dots).ok());
  CHECK(test::errors_of(dots, next).count == print.rows * print.cols);
}

TEST_CASE("dots: what is no frame of the pad is refused and writes nothing") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  DotFinder finder(test::picture_of(print, truth));
  REQUIRE(finder.ok());
  DotPlaces dots = lost_everywhere(truth);
  DotPlaces smaller(print.rows, print.cols - 1, cv::Vec2d::all(0));
  const cv::Mat good = test::picture_of(print, truth);
  const auto refuses = [&](const cv::Mat& frame, DotPlaces& out) {
    const DotResult result = finder(frame, out);
    CHECK(result.status == DotStatus::refused);
    CHECK_FALSE(result.ok());
    CHECK(cv::countNonZero(out.reshape(1)) == 0);
  };
  refuses(cv::Mat(), dots);
  refuses(good(cv::Rect(0, 0, 319, 240)), dots);
  refuses(cv::Mat(print.frame, CV_32FC3, cv::Scalar::all(0.5)), dots);
  refuses(cv::Mat(print.frame, CV_8UC2, cv::Scalar::all(9)), dots);
  refuses(good, smaller);
}

TEST_CASE("dots: a free frame without a grid says so") {
  cv::Mat noise(240, 320, CV_8UC3);
  cv::theRNG().state = 20110801;
  cv::randn(noise, cv::Scalar::all(60), cv::Scalar::all(1));
  Print few;
  few.rows = few.cols = 2;
  for (const cv::Mat& frame :
       {noise, cv::Mat(240, 320, CV_8UC3, cv::Scalar(90, 120, 100)), cv::Mat(),
        cv::Mat(3, 3, CV_8UC3, cv::Scalar::all(0)), test::picture_of(few, test::places_of(few))}) {
    DotFinder finder(frame);
    CHECK_FALSE(finder.ok());
    CHECK(finder.rows() == 0);
    DotPlaces dots(0, 0);
    CHECK_FALSE(finder(frame, dots).ok());
  }
}

TEST_CASE("dots: 16 bit, one channel and four show what 8 bit and three show") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  const cv::Mat free_frame = test::picture_of(print, truth);
  const cv::Mat frame = test::picture_of(print, test::moved(truth, {3, 2}));
  DotFinder finder(free_frame);
  REQUIRE(finder.ok());
  const DotPlaces found = dots_in(finder, frame);
  cv::Mat wide, grey, four;
  frame.convertTo(wide, CV_16U, 256);
  cv::extractChannel(frame, grey, 1);
  four = cv::Mat(frame.size(), CV_8UC4, cv::Scalar::all(77));
  cv::mixChannels(std::vector<cv::Mat>{frame}, std::vector<cv::Mat>{four}, {0, 0, 1, 1, 2, 2});
  for (const cv::Mat& other : {wide, grey, four}) {
    const auto errors = test::errors_of(dots_in(finder, other), found);
    CHECK(errors.count == print.rows * print.cols);
    CHECK(errors.worst_px < 1e-3);
  }
}

TEST_CASE("dots: channels that are left out do no harm") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  cv::Mat frame = test::picture_of(print, truth);
  for (int i = 0; i < frame.rows; ++i) {
    for (int j = 0; j < frame.cols; ++j) {
      frame.at<cv::Vec3b>(i, j)[0] = static_cast<unsigned char>((37 * i + 101 * j) % 256);
    }
  }
  DotFinderOptions options;
  options.color_weights = {0, 1, 1};
  DotFinder finder(frame, options);
  REQUIRE(finder.ok());
  CHECK(test::errors_of(free_of(finder), truth).worst_px < 0.1);
}

TEST_CASE("dots: a regular grid flattened is the same grid, also with dots missing") {
  detail::Places dots(3, 5, detail::no_place());
  for (Index i = 0; i < 3; ++i) {
    for (Index j = 0; j < 5; ++j) {
      dots(i, j) = {100 + 8.0 * static_cast<double>(j) - 2.0 * static_cast<double>(i),
                    50 + 1.0 * static_cast<double>(j) + 10.0 * static_cast<double>(i)};
    }
  }
  detail::Places some = dots;
  some(0, 0) = some(1, 3) = some(2, 4) = detail::no_place();
  const detail::Places flat = detail::flattened(some);
  for (Index i = 0; i < 3; ++i) {
    for (Index j = 0; j < 5; ++j) {
      CHECK(norm(flat(i, j) - dots(i, j)) < 1e-12);
    }
  }
}

TEST_CASE("dots: a dot is expected on the plane through the moves of its neighbours") {
  const detail::Place far = {70, -40};
  const auto expected_from = [&](int known) {  // the first of them, row by row
    return detail::by_neighbours(5, 6, 2, 3, [&](Index i, Index j) {
      const double down = static_cast<double>(i - 2), right = static_cast<double>(j - 3);
      return known-- > 0 ? far + detail::Place{0.1 * down, 0.05 * right} : detail::no_place();
    });
  };
  CHECK(norm(expected_from(24) - far) < 1e-9);  // symmetrical: nothing holds the slopes
  CHECK(norm(expected_from(7) - far) < 0.1);
  CHECK_FALSE(is_finite(expected_from(2)));
}

TEST_CASE("dots: a grid is named from the spot with the most neighbours") {
  // a cross, and nearer to the middle of all spots two groups
  const detail::LatticeSteps steps = {{10, 0}, {0, 10}};
  for (const double turn : {1.0, -1.0}) {
    std::vector<detail::Place> spots = {{0, 0}, {10, 0}, {0, 10}, {-10, 0}, {0, -10}};
    for (int k = 0; k < 4; ++k) {  // two rows and two columns of four: three neighbours at most
      for (const double beside : {0.0, 10.0}) {
        spots.push_back({60 + 10.0 * k, beside});
        spots.push_back({60 + beside, 40 + 10.0 * k});
      }
    }
    for (detail::Place& spot : spots) {
      spot = turn * spot;
    }
    CHECK(detail::lattice_seed(detail::SpotMap(spots), steps) == 0);
  }
}

TEST_CASE("dots: spots that fit badly are dropped whichever of them comes first") {
  // two neighbours are off, the second one less than the first
  detail::Places base(6, 7, detail::no_place());
  std::vector<detail::Place> spots;
  for (Index i = 0; i < 6; ++i) {
    for (Index j = 0; j < 7; ++j) {
      base(i, j) = {10.0 * static_cast<double>(j), 10.0 * static_cast<double>(i)};
      const bool first = i == 2 && j == 3, second = i == 2 && j == 4;
      spots.push_back(base(i, j) + detail::Place{0, first ? 3.45 : second ? -3.3 : 0.0});
    }
  }
  for (std::size_t first = 0; first < spots.size(); ++first) {
    CAPTURE(first);
    std::vector<detail::Place> order = spots;
    std::swap(order[0], order[first]);
    const detail::SpotMap map(order);
    const auto labels = detail::DotGrowth(base, map).from({4, 1}, {0, 0});
    CHECK(detail::number_of(labels) == 40);
    CHECK(labels(2, 3) == -1);
    CHECK(labels(2, 4) == -1);
  }
}

TEST_CASE("dots: a line of strange spots beside the print takes no label") {
  // three dots of the first row are hidden, and as many strange spots lie off it in a line
  detail::Places base(6, 7, detail::no_place());
  std::vector<detail::Place> spots;
  for (Index i = 0; i < 6; ++i) {
    for (Index j = 0; j < 7; ++j) {
      base(i, j) = {10.0 * static_cast<double>(j), 10.0 * static_cast<double>(i)};
      const bool strange = i == 0 && j >= 2 && j <= 4;
      spots.push_back(base(i, j) + detail::Place{0, strange ? -3.2 : 0.0});
    }
  }
  for (const bool turned : {false, true}) {
    for (auto& places : {&base.cells(), &spots}) {
      for (detail::Place& place : *places) {
        place = turned ? detail::Place{} - place : place;
      }
    }
    const detail::SpotMap map(spots);
    const auto labels = detail::DotGrowth(base, map).from({3, 3}, {0, 0});
    CHECK(detail::number_of(labels) == 39);
    CHECK(labels(0, 3) == -1);
  }
}

TEST_CASE("dots: what lies in a grid but is faint is not taken for the dots") {
  // The blocks of a compressed image; there are more of them than dots.
  Print print;
  print.rows = 4;
  print.cols = 6;
  print.pitch_px = 44;
  print.radius_px = 7;
  print.ground = 117;
  print.ink = 28;
  print.fall = 0;
  const DotPlaces truth = test::places_of(print);
  cv::Mat frame = test::picture_of(print, truth);
  for (int y = 8; y < frame.rows; y += 16) {
    for (int x = 8; x < frame.cols; x += 16) {
      cv::Mat block(frame, cv::Rect(x - 3, y - 3, 6, 6));
      block *= 1.16;
    }
  }
  DotFinder finder(frame);
  REQUIRE(finder.ok());
  CHECK(finder.pattern().bright == false);
  REQUIRE(finder.cols() == 6);
  CHECK(test::errors_of(free_of(finder), truth).worst_px < 1);
}

TEST_CASE("dots: where they cannot be, none is found") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  DotFinderOptions options;
  options.where = cv::Mat_<unsigned char>(print.frame, 0);
  options.where(cv::Rect(0, 0, 170, 240)) = 1;
  DotFinder finder(test::picture_of(print, truth), options);
  REQUIRE(finder.ok());
  for (const cv::Vec2d& dot : free_of(finder)) {
    CHECK((!is_present(dot) || dot[0] < 170));
  }
  CHECK(finder.cols() == 6);
}

TEST_CASE("dots: options that cannot be are refused with their name") {
  const Print print;
  const cv::Mat frame = test::picture_of(print, test::places_of(print));
  const auto refused = [&](const char* name, auto change) {
    DotFinderOptions options;
    change(options);
    INFO(name);
    CHECK_THROWS_WITH(DotFinder(frame, options), Catch::Matchers::Contains(name));
  };
  refused("pattern.rows", [](auto& o) { o.pattern.rows = o.pattern.cols = 2000; });
  refused("pattern.rows", [](auto& o) { o.pattern.rows = 5; });
  refused("pattern.radius_px", [](auto& o) { o.pattern.radius_px = 0.5; });
  refused("pattern.radius_px", [](auto& o) { o.pattern.radius_px = std::nan(""); });
  refused("pattern.pitch_px", [](auto& o) { o.pattern.pitch_px = -1; });
  refused("pattern.pitch_px", [](auto& o) {
    o.pattern.radius_px = 5;
    o.pattern.pitch_px = 1e30;
  });
  refused("min_contrast", [](auto& o) { o.min_contrast = 0; });
  refused("color_weights", [](auto& o) { o.color_weights = {0, -1, 1}; });
  refused("color_weights", [](auto& o) { o.color_weights = {0, 0, 0}; });
  refused("where", [](auto& o) { o.where = cv::Mat_<unsigned char>(5, 5, 1); });
  refused("max_off", [](auto& o) { o.max_off = 0; });
}

TEST_CASE("dots: garbage among the spots is none") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  DotFinder finder(test::picture_of(print, truth));
  std::vector<Point2<double>> spots;
  for (const cv::Vec2d& dot : truth) {
    spots.push_back({dot[0], dot[1]});
  }
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), inf, -inf, 1e300}) {
    spots.insert(spots.begin() + 3, {bad, 5});
    spots.push_back({5, bad});
  }
  DotPlaces found(truth.size());
  const DotResult result = finder.label(spots, found);
  CHECK(result.ok());
  CHECK(result.spots == truth.rows * truth.cols);
  CHECK(test::errors_of(found, truth).worst_px == 0);
}

TEST_CASE("dots: a print that jumps as a whole keeps its labels") {
  // a round print, as on a pad; along rows and columns it moves by up to two pitches to both sides
  Print print;
  print.frame = {360, 360};
  print.rows = print.cols = 11;
  DotPlaces truth = test::places_of(print);
  for (cv::Vec2d& dot : truth) {
    if (cv::norm(dot - truth(5, 5)) > 5.2 * print.pitch_px) {
      dot = cv::Vec2d::all(std::nan(""));
    }
  }
  DotFinder finder(test::picture_of(print, truth));
  REQUIRE(finder.ok());
  std::mt19937 random(20110801);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int frame = 0; frame < 100; ++frame) {
    const DotPlaces now =
        test::moved(truth, 2 * print.pitch_px * cv::Vec2d(unit(random), unit(random)));
    std::vector<Point2<double>> spots;
    for (const cv::Vec2d& dot : now) {
      if (is_present(dot) && unit(random) < 0.9) {
        spots.push_back({dot[0] + 0.2 * unit(random), dot[1] + 0.2 * unit(random)});
      }
    }
    DotPlaces found(truth.size());
    CAPTURE(frame);
    REQUIRE(finder.label(spots, found).ok());
    CHECK(test::errors_of(found, now).count >= 70);
    CHECK(test::errors_of(found, now).worst_px < 1);
  }
}

TEST_CASE("dots: where nothing tells by which rows and columns, none are given") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  const DotFinder free_finder(test::picture_of(print, truth));
  const double jump = GENERATE(0.0, 0.4, 0.6, 1.0);  // pitches
  std::vector<Point2<double>> spots;
  for (int i = 0; i < truth.rows; ++i) {
    for (int j = 0; j + 1 < truth.cols; ++j) {  // the last column is hidden
      spots.push_back({truth(i, j)[0] + jump * print.pitch_px, truth(i, j)[1]});
    }
  }
  DotFinder finder = free_finder;
  DotPlaces found(truth.size());
  CHECK(finder.label(spots, found).status == DotStatus::ambiguous);
  CHECK(count_present(found) == 0);
  for (int i = 0; i < 3; ++i) {  // three of its dots tell
    spots.push_back({truth(i, 10)[0] + jump * print.pitch_px, truth(i, 10)[1]});
  }
  CHECK(finder.label(spots, found).ok());
  CHECK(test::errors_of(found, test::moved(truth, {jump * print.pitch_px, 0})).worst_px < 1e-9);
}

TEST_CASE("dots: strange dots beside a print do not refute its rows and columns") {
  // The print jumps until its first column has left the picture. Some strange dots beside its last
  // column would be dots of that column if the print had jumped by one column less.
  Print print;
  const DotPlaces truth = test::places_of(print);
  DotFinder finder(test::picture_of(print, truth));
  const int strange = GENERATE(0, 3, 4, 5);
  const int first = GENERATE(0, 2);  // row of the first of them
  const double jump = GENERATE(1.35, 1.4, 1.6);
  const DotPlaces now = test::moved(truth, {-jump * print.pitch_px, 0});
  std::vector<Point2<double>> spots;
  for (int i = 0; i < now.rows; ++i) {
    for (int j = 1; j < now.cols; ++j) {
      spots.push_back({now(i, j)[0], now(i, j)[1]});
    }
    if (i >= first && i < first + strange) {
      spots.push_back({now(i, now.cols - 1)[0] + print.pitch_px, now(i, 0)[1]});
    }
  }
  DotPlaces found(truth.size());
  CAPTURE(strange, first, jump);
  CHECK(finder.label(spots, found).status == DotStatus::ambiguous);
  CHECK(count_present(found) == 0);
}

TEST_CASE("dots: a print that reaches beyond the picture is followed by small steps") {
  Print print;
  print.rows = 14;
  print.cols = 20;
  const DotPlaces truth = test::places_of(print);
  DotFinder finder(test::picture_of(print, truth));
  REQUIRE(finder.ok());
  const cv::Point2d first(truth(0, 0)[0], truth(0, 0)[1]);
  const int row = cvRound((finder.free_px()(0, 0).y - first.y) / print.pitch_px);
  const int col = cvRound((finder.free_px()(0, 0).x - first.x) / print.pitch_px);
  DotPlaces found(static_cast<int>(finder.rows()), static_cast<int>(finder.cols()));
  for (int frame = 1; frame < 6; ++frame) {  // a pitch and a quarter
    const DotPlaces now = test::moved(truth, {6.0 * frame, -2.0 * frame});
    CHECK(finder(test::picture_of(print, now), found).ok());
    const DotPlaces seen = now(cv::Rect(col, row, found.cols, found.rows));
    CHECK(test::errors_of(found, seen).count > 90);
    CHECK(test::errors_of(found, seen).worst_px < 0.3);
  }
}

TEST_CASE("dots: another print than the one told is refused by what it shows") {
  Print print;
  print.rows = 7;
  print.cols = 9;
  DotPlaces truth = test::places_of(print);
  DotFinderOptions options;
  const auto told = [&](Index rows, Index cols) {
    options.pattern.rows = rows;
    options.pattern.cols = cols;
    const DotFinder finder(test::picture_of(print, truth), options);
    CHECK(finder.ok() == finder.refusal().empty());
    return finder.refusal();
  };
  SECTION("without a middle") {
    CHECK(told(0, 0) == "");
    CHECK(told(7, 9) == "");
    CHECK(told(8, 10) == "7 rows and 9 columns of dots, not 8 and 10");
    CHECK(told(9, 7) == "7 rows and 9 columns of dots, not 9 and 7");
    CHECK(told(9, 11) == "7 rows and 9 columns of dots, not 9 and 11");
    CHECK(told(5, 9) == "7 rows and 9 columns of dots, not 5 and 9");
  }
  SECTION("with the middle, rows and columns on both sides may be hidden") {
    options.pattern.middle_px = {truth(3, 4)[0] + 5, truth(3, 4)[1] - 5};
    CHECK(told(7, 9) == "");
    CHECK(told(9, 11) == "");
    CHECK(told(8, 10) == "7 rows and 9 columns of dots, not 8 and 10");
    CHECK(told(9, 7) == "7 rows and 9 columns of dots, not 9 and 7");
    options.pattern.middle_px = {truth(3, 4)[0] + print.pitch_px / 2, truth(3, 4)[1]};
    CHECK(told(7, 10) == "");
  }
  SECTION("with the middle at a corner of a print that is turned") {
    for (cv::Vec2d& dot : truth) {
      const cv::Vec2d off = dot - cv::Vec2d(160, 120);
      dot = cv::Vec2d(160, 120) + std::cos(0.3) * off + std::sin(0.3) * cv::Vec2d(-off[1], off[0]);
    }
    options.pattern.middle_px = {truth(6, 8)[0], truth(6, 8)[1]};
    CHECK(told(13, 17) == "");
    CHECK(told(14, 17) == "7 rows and 9 columns of dots, not 14 and 17");
    CHECK(told(11, 15) == "7 rows and 9 columns of dots, not 11 and 15");
  }
  SECTION("an inner row is missing") {
    truth.row(GENERATE(2, 3)) = cv::Vec2d::all(std::nan(""));
    CHECK(told(0, 0).find("and 9 columns, and") != std::string::npos);
    CHECK(told(7, 9) != "");
  }
}

TEST_CASE("dots: random dots are no print") {
  Print print;
  print.radius_px = 4;
  std::mt19937 random(20110801);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int picture = 0; picture < 8; ++picture) {
    DotPlaces dots(1, 100);
    for (cv::Vec2d& dot : dots) {
      dot = {10 + 300 * unit(random), 10 + 220 * unit(random)};
    }
    DotFinderOptions options;
    options.pattern.radius_px = picture % 2 == 0 ? 0 : 4;
    const DotFinder finder(test::picture_of(print, dots), options);
    CAPTURE(picture, finder.rows(), finder.cols());
    CHECK_FALSE(finder.ok());
    CHECK(finder.refusal() != "");
  }
}
