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
DotPlaces dots_in(const DotFinder& finder, const cv::Mat& frame) {
  DotPlaces dots(static_cast<int>(finder.rows()), static_cast<int>(finder.cols()));
  auto state = finder.start();
  CHECK(finder(frame, dots, state).ok());
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
  const DotFinder finder(test::picture_of(print, test::places_of(print)));
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

TEST_CASE("dots: a frame that is moved has its dots moved alike") {
  Print print;
  print.fall = 0;
  const DotPlaces truth = test::places_of(print);
  const DotFinder finder(test::picture_of(print, truth));
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
  const DotFinder finder(test::picture_of(print, truth));
  REQUIRE(finder.ok());
  auto state = finder.start();
  DotPlaces dots(print.rows, print.cols);
  for (int frame = 0; frame < 6; ++frame) {
    const DotPlaces now = test::moved(truth, {2.0 * frame, 0.5 * frame});
    DotPlaces shown = now.clone();
    const bool hides = frame == 2 || frame == 3;
    if (hides) {
      shown(2, 3) = shown(2, 4) = shown(7, 10) = cv::Vec2d::all(std::nan(""));
    }
    const DotResult result = finder(test::picture_of(print, shown), dots, state);
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
  const DotFinder finder(test::picture_of(print, truth));
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
  const DotFinder finder(test::picture_of(print, truth));
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
  CHECK(test::errors_of(found, truth).worst_px < 0.1 * print.pitch_px);  // half-hidden dots
}

TEST_CASE("dots: the order of the spots does not matter") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  const DotTracker tracker(truth);
  std::vector<Point2<double>> spots;
  for (const cv::Vec2d& dot : truth) {
    spots.push_back({dot[0] + 3, dot[1] - 2});
  }
  spots.push_back({100.5, 100.5});
  DotPlaces first(truth.size()), second(truth.size());
  auto state = tracker.start();
  REQUIRE(tracker(spots, first, state).ok());
  std::shuffle(spots.begin(), spots.end(), std::mt19937(7));
  state = tracker.start();
  REQUIRE(tracker(spots, second, state).ok());
  CHECK(same(first, second));
  CHECK(test::errors_of(first, test::moved(truth, {3, -2})).worst_px < 1e-12);
}

TEST_CASE("dots: smooth moves of several pitches at once keep the labels") {
  // A square print that is held at the rim; the middle moves and rotates as one.
  constexpr int count = 19;
  constexpr double pitch_px = 17;
  std::mt19937 random(20110801);
  std::uniform_real_distribution<double> unit(-1, 1);
  DotPlaces free_pad(count, count);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      free_pad(i, j) = pitch_px * cv::Vec2d(j, i) + cv::Vec2d(50, 50);
    }
  }
  const DotTracker tracker(free_pad);
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
    auto state = tracker.start();
    const DotResult result = tracker(spots, found, state);
    INFO("trial " << trial << ", shift " << shift << " px, rotation " << rotation);
    CHECK(result.found > 85 * count * count / 100);
    CHECK(test::errors_of(found, truth).worst_px < pitch_px / 2);
  }
}

TEST_CASE("dots: a frame without them loses them, and the next one has them again") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  const DotFinder finder(test::picture_of(print, truth));
  REQUIRE(finder.ok());
  auto state = finder.start();
  DotPlaces dots(print.rows, print.cols);
  const DotResult black = finder(cv::Mat(print.frame, CV_8UC3, cv::Scalar::all(0)), dots, state);
  CHECK(black.status == DotStatus::lost);
  CHECK_FALSE(black.ok());
  CHECK(count_present(dots) == 0);
  const DotPlaces next = test::moved(truth, {4, 3});
  CHECK(finder(test::picture_of(print, next), dots, state).ok());
  CHECK(test::errors_of(dots, next).count == print.rows * print.cols);
}

TEST_CASE("dots: what is no frame of the pad is refused and writes nothing") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  const DotFinder finder(test::picture_of(print, truth));
  REQUIRE(finder.ok());
  auto state = finder.start();
  DotPlaces dots = lost_everywhere(truth);
  DotPlaces smaller(print.rows, print.cols - 1, cv::Vec2d::all(0));
  const cv::Mat good = test::picture_of(print, truth);
  const auto refuses = [&](const cv::Mat& frame, DotPlaces& out) {
    const DotResult result = finder(frame, out, state);
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
    const DotFinder finder(frame);
    CHECK_FALSE(finder.ok());
    CHECK(finder.rows() == 0);
    auto state = finder.start();
    DotPlaces dots(0, 0);
    CHECK_FALSE(finder(frame, dots, state).ok());
  }
}

TEST_CASE("dots: 16 bit, one channel and four show what 8 bit and three show") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  const cv::Mat free_frame = test::picture_of(print, truth);
  const cv::Mat frame = test::picture_of(print, test::moved(truth, {3, 2}));
  const DotFinder finder(free_frame);
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
  const DotFinder finder(frame, options);
  REQUIRE(finder.ok());
  CHECK(test::errors_of(free_of(finder), truth).worst_px < 0.1);
}

TEST_CASE("dots: rows and columns that are given are kept") {
  Print print;
  print.rows = 5;
  print.cols = 7;
  const DotPlaces truth = test::places_of(print);
  const cv::Mat frame = test::picture_of(print, truth);
  DotFinderOptions options;
  SECTION("fewer than the frame shows: the first") {
    options.pattern.rows = 5;
    options.pattern.cols = 6;
    const DotFinder finder(frame, options);
    REQUIRE(finder.ok());
    CHECK(test::errors_of(free_of(finder), truth(cv::Rect(0, 0, 6, 5))).worst_px < 0.1);
  }
  SECTION("fewer, and where their middle is") {
    options.pattern.rows = 5;
    options.pattern.cols = 6;
    options.pattern.middle_px = {truth(2, 4)[0] - 8, truth(2, 4)[1]};
    const DotFinder finder(frame, options);
    REQUIRE(finder.ok());
    CHECK(test::errors_of(free_of(finder), truth(cv::Rect(1, 0, 6, 5))).worst_px < 0.1);
  }
  SECTION("more: a row that comes into sight later has its place") {
    options.pattern.rows = 6;
    options.pattern.cols = 7;
    const DotFinder finder(frame, options);
    REQUIRE(finder.ok());
    CHECK(count_present(free_of(finder)) == 35);
    print.rows = 6;
    DotPlaces all(6, 7);
    for (int j = 0; j < 7; ++j) {
      for (int i = 0; i < 6; ++i) {
        all(i, j) = truth(0, j) + i * (truth(1, j) - truth(0, j));
      }
    }
    const DotPlaces found = dots_in(finder, test::picture_of(print, all));
    CHECK(test::errors_of(found, all).count == 42);
    CHECK(test::errors_of(found, all).worst_px < 0.1);
  }
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

TEST_CASE("dots: of the windows with as many dots, the one around the given middle is taken") {
  detail::Places dots(7, 9, detail::no_place());
  for (Index i = 0; i < 7; ++i) {
    for (Index j = 0; j < 9; ++j) {
      dots(i, j) = {10.0 * static_cast<double>(j), 12.0 * static_cast<double>(i)};
    }
  }
  // every window, by a middle off its own by less than half a step
  for (const auto& [rows, cols] : {std::pair<Index, Index>{2, 5}, {5, 2}, {4, 3}}) {
    for (Index top = 0; top <= 7 - rows; ++top) {
      for (Index left = 0; left <= 9 - cols; ++left) {
        const detail::Place first = dots(top, left), last = dots(top + rows - 1, left + cols - 1);
        for (const double off : {-4.0, 4.0}) {
          const detail::Place middle = 0.5 * (first + last) + detail::Place{off, -off};
          const detail::Places window = detail::best_window(dots, rows, cols, middle);
          CAPTURE(rows, cols, top, left, off);
          CHECK(window.rows() == rows);
          CHECK(window.cols() == cols);
          CHECK(norm(window(0, 0) - first) == 0);
        }
      }
    }
  }
}

TEST_CASE("dots: an outlier among the neighbours weighs as little wherever the dots are") {
  // moves of 24 neighbours on a plane, but for one
  const auto expected_at = [](const detail::Place& everywhere) {
    return detail::by_neighbours(5, 6, 2, 3, 2.0, [&](Index i, Index j) {
      const double down = static_cast<double>(i - 2), right = static_cast<double>(j - 3);
      const detail::Place off = i == 1 && j == 3 ? detail::Place{30, -20} : detail::Place{0, 0};
      return everywhere + off + detail::Place{0.1 * down, 0.05 * right};
    });
  };
  CHECK(norm(expected_at({0, 0})) < 0.01);
  const detail::Place far = {70, -40};
  CHECK(norm(expected_at(far) - far - expected_at({0, 0})) < 1e-12);
}

TEST_CASE("dots: the order of the neighbours does not matter") {
  // a plane of moves with an outlier, the neighbours in both orders
  const auto expected = [](bool backward) {
    detail::Neighbours around;
    for (int k = 0; k < 25; ++k) {
      const int at = backward ? 24 - k : k;
      const Index down = at / 5 - 2, right = at % 5 - 2;
      const double x = static_cast<double>(right), y = static_cast<double>(down);
      if (at != 12) {
        around.add(down, right, {at == 6 ? 30.0 : 0.7 * x + 0.1 * y * y, 0.4 * y - 0.2 * x});
      }
    }
    return around.at_middle(2.0);
  };
  CHECK(norm(expected(true) - expected(false)) < 1e-12);
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
  const auto spacing_px = detail::spacings_px(base);
  for (std::size_t first = 0; first < spots.size(); ++first) {
    CAPTURE(first);
    std::vector<detail::Place> order = spots;
    std::swap(order[0], order[first]);
    const detail::SpotMap map(order);
    const detail::DotMatcher matcher(base, spacing_px, map, 1.0);
    const auto labels = matcher.match([](Index, Index) { return true; },
                                      [](Index, Index) {
                                        return detail::Place{0, 0};
                                      });
    CHECK(detail::count_labels(labels) == 40);
    CHECK(labels(2, 3) == -1);
    CHECK(labels(2, 4) == -1);
  }
}

TEST_CASE("dots: every labelled dot counts, also that of the first spot") {
  std::vector<detail::Place> spots;
  detail::Places base(2, 4, detail::no_place());
  for (Index i = 0; i < 2; ++i) {
    for (Index j = 0; j < 4; ++j) {
      base(i, j) = {10.0 * static_cast<double>(j), 10.0 * static_cast<double>(i)};
      spots.push_back(base(i, j));
    }
  }
  const detail::SpotMap map(spots);
  const auto spacing_px = detail::spacings_px(base);
  const detail::DotMatcher matcher(base, spacing_px, map, 1.0);
  const auto labels = matcher.match([](Index, Index) { return true; },
                                    [](Index, Index) {
                                      return detail::Place{0, 0};
                                    });
  CHECK(detail::count_labels(labels) == 8);
  // nothing has moved: no penalty
  CHECK(matcher.score(labels) == Approx(8).epsilon(1e-12));
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
  const DotFinder finder(frame);
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
  const DotFinder finder(test::picture_of(print, truth), options);
  REQUIRE(finder.ok());
  for (const cv::Vec2d& dot : free_of(finder)) {
    CHECK((!is_present(dot) || dot[0] < 170));
  }
  CHECK(finder.cols() == 6);
}

TEST_CASE("dots: a state is a value") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  const DotFinder finder(test::picture_of(print, truth));
  REQUIRE(finder.ok());
  const cv::Mat one = test::picture_of(print, test::moved(truth, {4, 0}));
  const cv::Mat two = test::picture_of(print, test::moved(truth, {8, 1}));
  DotPlaces dots(truth.size()), again(truth.size());
  auto state = finder.start();
  CHECK(finder(one, dots, state).ok());
  auto copy = state;
  CHECK(finder(two, dots, state).ok());
  CHECK(finder(two, again, copy).ok());
  CHECK(same(dots, again));
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
  refused("pattern.cols", [](auto& o) { o.pattern.rows = 5; });
  refused("pattern.radius_px", [](auto& o) { o.pattern.radius_px = 0.5; });
  refused("pattern.radius_px", [](auto& o) { o.pattern.radius_px = std::nan(""); });
  refused("pattern.pitch_px", [](auto& o) { o.pattern.pitch_px = 20; });
  refused("pattern.pitch_px", [](auto& o) {
    o.pattern.radius_px = 5;
    o.pattern.pitch_px = 1e30;
  });
  refused("min_contrast", [](auto& o) { o.min_contrast = 0; });
  refused("color_weights", [](auto& o) { o.color_weights = {0, -1, 1}; });
  refused("color_weights", [](auto& o) { o.color_weights = {0, 0, 0}; });
  refused("where", [](auto& o) { o.where = cv::Mat_<unsigned char>(5, 5, 1); });
  refused("max_off", [](auto& o) { o.tracker.max_off = 0; });
  CHECK_THROWS_WITH(DotTracker(DotPlaces(3, 2, cv::Vec2d(1, 1))),
                    Catch::Matchers::Contains("free_px"));
}

TEST_CASE("dots: garbage among the spots is none") {
  Print print;
  const DotPlaces truth = test::places_of(print);
  const DotTracker tracker(truth);
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
  auto state = tracker.start();
  const DotResult result = tracker(spots, found, state);
  CHECK(result.ok());
  CHECK(result.spots == truth.rows * truth.cols);
  CHECK(test::errors_of(found, truth).worst_px == 0);
}

TEST_CASE("dots: a free dot at an impossible position counts as not seen") {
  Print print;
  DotPlaces free = test::places_of(print);
  free(2, 3) = {1e300, 5};
  const DotTracker tracker(free);
  DotPlaces found(free.size());
  auto state = tracker.start();
  const DotResult result = tracker(std::vector<Point2<double>>{}, found, state);
  CHECK(result.expected == free.rows * free.cols - 1);
  CHECK(std::abs(tracker.places_px()(2, 3).x - test::places_of(print)(2, 3)[0]) < 1);

  const DotPlaces far(free.rows, free.cols, cv::Vec2d(1e300, 1e300));
  CHECK_THROWS_WITH(DotTracker(far), Catch::Matchers::Contains("free_px = 0"));
}
