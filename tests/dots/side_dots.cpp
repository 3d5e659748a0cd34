// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Three rows around a rim beside a printed grid, drawn as a camera sees them: each pixel is the
// mean of 6 x 6 rays over two pixels each way. A ray is dark where it meets a disc of the free pad,
// which is seen through a smooth map that grows with the load and is still at the rim.
#include "fingerpad/dots/side_dots.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "support/allocations.hpp"
#include "support/catch.hpp"
#include "support/digest.hpp"
#include "support/image.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;

namespace {

using Point = Point2<double>;
using Bytes = test::Image<std::uint8_t>;

constexpr Index side = 250, count = 42;
constexpr double rim_px = 115;
const Camera<double> camera{50, 1.33, 124.5, 125.2, 0.1};
const Point middle = {124.5, 125.2};

/// Discs of the free pad, and how the load moves them.
struct Print {
  double load = 0, turn = 0;
  Index skipped = -1;  ///< a dot of the first row that a dot of the grid replaces
  struct Disc {
    Point at;
    double radial, around;  ///< half axes, px
  };
  std::vector<SideRow> rows() const {
    std::vector<SideRow> all;
    for (const double arc : {2.0, 4.0, 6.0}) {
      const double half = all.size() % 2 == 1 ? std::numbers::pi / count : 0.0;
      all.push_back({count, arc, 0.6, turn + half});
    }
    return all;
  }
  /// Side dots, row by row, then those of the grid, some of which lie between the rows.
  std::vector<Disc> discs() const {
    std::vector<Disc> all;
    const double rho[] = {104, 90.5, 75};
    for (int r = 0; r < 3; ++r) {
      for (Index k = 0; k < count; ++k) {
        const double angle = rows()[std::size_t(r)].first_angle_rad +
                             2 * std::numbers::pi * double(k) / double(count);
        const double at = rho[r] + 1.5 * std::sin(angle);  // the pad leans a little
        all.push_back({middle + at * Point{std::cos(angle), std::sin(angle)}, 1.7 + 0.3 * r, 2.8});
      }
    }
    const auto sides = all;
    for (int i = -6; i <= 6; ++i) {
      for (int j = -6; j <= 6; ++j) {
        const Point at = middle + Point{15.0 * j, 15.0 * i};
        const bool crowded = std::any_of(sides.begin(), sides.end(),
                                         [&](const Disc& d) { return norm(d.at - at) < 11; });
        if (!crowded && norm(at - middle) < 100) {
          all.push_back({at, 3.6, 3.6});
        }
      }
    }
    if (skipped >= 0) {
      Disc& d = all[std::size_t(skipped)];
      d.radial = d.around = 3.6;
    }
    return all;
  }
  Point moved(const Point& free) const {
    const Point off = (free - middle) / rim_px;
    const double in = 1 - dot(off, off);  // 0 at the rim
    return free + load * in *
                      (Point{6, 2} + 11 * off + Point{-8 * off.y, 8 * off.x} +
                       9 * dot(off, off) * Point{-off.x, off.y});
  }
  Point free_of(const Point& seen, Point guess) const {
    for (int k = 0; k < 20; ++k) {
      const Point miss = seen - moved(guess);
      guess += 0.8 * miss;
      if (dot(miss, miss) < 1e-12) {
        break;
      }
    }
    return guess;
  }
  test::Image<double> picture() const {
    const auto all = discs();
    test::Image<double> picture(side, side, 8);
    test::Image<Point> free(side, side);
    test::Image<int> near(side, side, -1);  // the disc whose edge a pixel's rays may meet
    for (std::size_t d = 0; d < all.size(); ++d) {
      const Point at = moved(all[d].at);
      for (int y = -14; y <= 14; ++y) {
        for (int x = -14; x <= 14; ++x) {
          const auto i = Index(std::lround(at.y)) + y, j = Index(std::lround(at.x)) + x;
          const Point p = {double(j), double(i)};
          if (i >= 0 && j >= 0 && i < side && j < side) {
            int& now = near(i, j);
            now =
                now < 0 || norm(p - moved(all[std::size_t(now)].at)) > norm(p - at) ? int(d) : now;
          }
        }
      }
    }
    for (Index i = 0; i < side; ++i) {
      for (Index j = 0; j < side; ++j) {
        const Point p = {double(j), double(i)};
        free(i, j) = norm(p - middle) < rim_px
                         ? free_of(p, j > 0 && norm(free(i, j - 1)) > 0 ? free(i, j - 1) : p)
                         : Point{0, 0};
      }
    }
    for (Index i = 1; i + 1 < side; ++i) {
      for (Index j = 1; j + 1 < side; ++j) {
        const Point p = {double(j), double(i)};
        if (norm(p - middle) > rim_px - 2) {
          continue;
        }
        const double light = 120 + 60 * dot(p - middle, p - middle) / (rim_px * rim_px) + 0.1 * p.x;
        const Point across = 0.5 * (free(i, j + 1) - free(i, j - 1));
        const Point down = 0.5 * (free(i + 1, j) - free(i - 1, j));
        double sum = 0;
        for (int k = 0; k < 36 && near(i, j) >= 0; ++k) {
          const double x = 2 * (k % 6 + 0.5) / 6 - 1, y = 2 * (k / 6 + 0.5) / 6 - 1;
          const Disc& d = all[std::size_t(near(i, j))];
          const Point off = free(i, j) + x * across + y * down - d.at;
          const Point out = (d.at - middle) / (std::max)(norm(d.at - middle), 1.0);
          const double u = dot(off, out) / d.radial;
          const double v = (off.y * out.x - off.x * out.y) / d.around;
          const double r = std::sqrt(u * u + v * v);
          const double beyond_px = (r - 1) * r / std::hypot(u / d.radial, v / d.around);
          sum += std::clamp(0.5 - 3 * beyond_px, 0.0, 1.0) / 36;
        }
        picture(i, j) = light * (1 - 0.8 * sum);
      }
    }
    return picture;
  }
};

Bytes bytes_of(const test::Image<double>& picture, double noise = 0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 1);
  Bytes bytes(side, side);
  for (std::size_t k = 0; k < bytes.cells.size(); ++k) {
    const double v = picture.cells[k] + (noise > 0 ? noise * normal(random) : 0.0);
    bytes.cells[k] = static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0, 255.0)));
  }
  return bytes;
}

SideDots dots_of(const Print& free, double noise = 0) {
  return {bytes_of(free.picture(), noise), camera, rim_px * camera.pitch_mm, free.rows()};
}

const SideDots& free_dots() {
  static const SideDots dots = dots_of({});
  return dots;
}
/// Distance from where a dot's center is seen; NaN if it is absent. The center is that of the
/// ellipse that the free picture shows.
Point error(const SideDots& dots, const Print& print, std::size_t k) {
  static const auto discs = Print{}.discs();
  const Point offset = free_dots().free_px()[k] - discs[k].at;
  return dots.px()[k] - print.moved(discs[k].at) - offset;
}
double worst(const SideDots& dots, const Print& print) {
  double most = 0;
  for (std::size_t k = 0; k < dots.px().size(); ++k) {
    const double off = norm(error(dots, print, k));
    most = off > most ? off : most;
  }
  return most;
}
Index seen(const SideDots& dots) {
  return std::count_if(dots.px().begin(), dots.px().end(),
                       [](const Point& p) { return is_finite(p); });
}

const test::Image<double>& loaded_picture() {
  static const auto picture = Print{.load = 0.5}.picture();
  return picture;
}

}  // namespace

TEST_CASE("side dots: light between four pixels") {
  test::Image<double> image(5, 7);
  const auto light = [](double x, double y) { return 3 + 2 * x - y + 0.5 * x * y; };
  for (Index i = 0; i < 5; ++i) {
    for (Index j = 0; j < 7; ++j) {
      image(i, j) = light(double(j), double(i));
    }
  }
  const auto view = as_view(image);
  for (const Point2<double>& p : {Point2<double>{0, 0}, {1.25, 2.5}, {5.9, 3.1}, {3, 3.75}}) {
    CHECK(detail::light_at(view, p) == Approx(light(p.x, p.y)).epsilon(1e-12));
  }
  for (const Point2<double>& p :
       {Point2<double>{-0.1, 2}, {6, 2}, {2, 4.1}, {not_a_number<double>(), 2}}) {
    CHECK(detail::light_at(view, p) == 0);
  }
}

TEST_CASE("side dots: rows are found by their first angle, beside a grid", "[figures]") {
  for (const double turn : {0.0, 0.031, -1.2, 3.0}) {
    Print print{.turn = turn};
    const SideDots dots = dots_of(print);
    INFO("turned by " << turn << ": " << dots.refusal());
    REQUIRE(dots.ok());
    CHECK(seen(dots) == 3 * count);
    const auto discs = print.discs();
    for (std::size_t k = 0; k < dots.px().size(); ++k) {
      CHECK(norm(dots.px()[k] - discs[k].at) < 0.08);
    }
    // told another angle, the same dots have other numbers
    print.turn += 2 * std::numbers::pi / count;
    const SideDots moved(bytes_of(Print{.turn = turn}.picture()), camera, rim_px * camera.pitch_mm,
                         print.rows());
    CHECK(norm(moved.px()[0] - dots.px()[1]) < 0.01);
  }
}

TEST_CASE("side dots: no dot of the grid is taken for a row's dot") {
  const Print print{.skipped = 7};
  SideDots dots = dots_of(print);
  REQUIRE(dots.ok());
  CHECK(!is_finite(dots.px()[7]));
  CHECK(!is_finite(dots.free_px()[7]));
  CHECK(seen(dots) == 3 * count - 1);
  const auto frame = dots(bytes_of(Print{.load = 0.2, .skipped = 7}.picture()));
  CHECK(frame.ok());
  CHECK(frame.expected == 3 * count - 1);
  CHECK(!is_finite(dots.px()[7]));
}

TEST_CASE("side dots: centers are right to some hundredths of a pixel whatever the load",
          "[figures]") {
  SideDots dots = free_dots();
  double square = 0, all = 0;
  for (const double load : {0.0, 0.15, 0.35, 0.6, 0.8, 1.0, 0.5, 0.1}) {
    const Print print{.load = load};
    const auto result = dots(bytes_of(print.picture()));
    INFO("load " << load << ", found " << result.found << ", worst " << worst(dots, print));
    CHECK(result.ok());
    CHECK(result.found == 3 * count);
    CHECK(worst(dots, print) < 0.1);
    for (std::size_t k = 0; k < dots.px().size(); ++k) {
      square += squared_norm(error(dots, print, k));
      all += 2;
    }
  }
  CHECK(std::sqrt(square / all) < 0.02);
}

TEST_CASE("side dots: noise scatters the centers as their sd says") {
  const double noise = GENERATE(1.0, 4.0);
  SideDots dots = dots_of({}, noise / 4);  // as the mean of 16 frames
  REQUIRE(dots.ok());
  Index within = 0, all = 0;
  for (unsigned seed = 2; seed < 7; ++seed) {
    REQUIRE(dots(bytes_of(loaded_picture(), noise, seed)).ok());
    for (std::size_t k = 0; k < dots.px().size(); ++k) {
      if (is_finite(dots.px()[k])) {
        const Point off = error(dots, {.load = 0.5}, k);
        const double two = 2 * dots.sd_px()[k];
        within += (std::fabs(off.x) < two ? 1 : 0) + (std::fabs(off.y) < two ? 1 : 0);
        all += 2;
      }
    }
  }
  INFO(within << " of " << all << " within 2 sd");
  CHECK(all > 9 * 3 * count);
  CHECK(double(within) > 0.85 * double(all));
}

TEST_CASE("side dots: a hidden, dirty or reflecting dot is absent, and comes back") {
  const Print print{.load = 0.5};
  const std::size_t k = GENERATE(std::size_t(3), std::size_t(60), std::size_t(110));
  const double stain = GENERATE(15.0, 170.0, 250.0);
  const double beside = GENERATE(0.0, 2.5);
  auto stained = loaded_picture();
  const Point at = print.moved(print.discs()[k].at) + Point{beside, beside};
  for (Index i = 0; i < side; ++i) {
    for (Index j = 0; j < side; ++j) {
      stained(i, j) = norm(Point{double(j), double(i)} - at) < 5.5 ? stain : stained(i, j);
    }
  }
  SideDots dots = free_dots();
  REQUIRE(dots(bytes_of(Print{.load = 0.3}.picture())).ok());
  const auto hidden = dots(bytes_of(stained));
  INFO("stain " << stain << " beside dot " << k << " by " << beside);
  CHECK(hidden.ok());
  CHECK(!is_finite(dots.px()[k]));
  CHECK(!is_finite(dots.sd_px()[k]));
  CHECK(hidden.found >= 3 * count - 3);
  CHECK(worst(dots, print) < 0.3);
  CHECK(dots(bytes_of(loaded_picture())).found == 3 * count);
}

TEST_CASE("side dots: what is blurred into the dark beyond the rim is absent") {
  const double near_px = 108;  // the first row leans and comes as near as 2.5 px
  const auto picture = bytes_of(Print{}.picture());
  SideDots dots(picture, camera, near_px * camera.pitch_mm, Print{}.rows());
  REQUIRE(dots.ok());
  const auto result = dots(picture);
  CHECK(result.ok());
  CHECK(result.found == seen(dots));
  for (std::size_t k = 0; k < 3 * std::size_t(count); ++k) {
    const double gap_px = near_px - norm(dots.free_px()[k] - middle);
    INFO("dot " << k << ", " << gap_px << " px from the rim");
    CHECK((!(gap_px < 3) || !is_finite(dots.px()[k])));
    CHECK((!(gap_px > 5) || is_finite(dots.px()[k])));
  }
}

TEST_CASE("side dots: without half of the dots none is told, and the next frame begins anew") {
  SideDots dots = free_dots();
  REQUIRE(dots(bytes_of(loaded_picture())).ok());
  const auto dark = dots(Bytes(side, side, 40));
  CHECK(dark.status == DotFollowerStatus::lost);
  CHECK(seen(dots) == 0);
  CHECK(dots(bytes_of(Print{.load = 0.1}.picture())).ok());
  CHECK(worst(dots, {.load = 0.1}) < 0.1);
  test::Image<float> broken(side, side, std::nanf(""));
  CHECK(dots(broken).status == DotFollowerStatus::lost);
}

TEST_CASE("side dots: mistakes are refused, and a frame allocates nothing") {
  const Print print;
  const Bytes free = bytes_of(print.picture());
  auto rows = print.rows();
  const auto construct = [&] { return SideDots(free, camera, 11.5, rows); };
  rows[1].arc_mm = 2;
  CHECK(test::begins_with(test::refusal(construct), "SideDots: arc_mm = 2, must be more than"));
  rows[1].count = 3;
  CHECK(test::begins_with(test::refusal(construct), "SideRow: count = 3"));
  rows = print.rows();
  rows[2].count = 53;  // another print
  const SideDots other = construct();
  CHECK(test::begins_with(other.refusal(), "the row of side dots at 6 mm from the rim shows"));
  CHECK(SideDots(other)(free).status == DotFollowerStatus::refused);
  CHECK(!SideDots(Bytes(side, side, 90), camera, 11.5, print.rows()).ok());

  SideDots dots = free_dots();
  CHECK(dots(Bytes(side, side - 1, 90)).status == DotFollowerStatus::refused);
  const Bytes frame = bytes_of(loaded_picture());
  const long before = test::allocations();
  const auto first = dots(frame), second = dots(free);
  CHECK(test::allocations() == before);
  CHECK((first.ok() && second.ok()));
  // a copy goes on as the object does, here through a jump to and fro
  SideDots copy = dots;
  CHECK((copy(frame).found == 3 * count && dots(frame).found == 3 * count));
  CHECK(std::equal(copy.px().begin(), copy.px().end(), dots.px().begin(),
                   [](const Point& a, const Point& b) { return a.x == b.x && a.y == b.y; }));
}

TEST_CASE("unchanged: side dots of a noisy picture", "[unchanged]") {
  SideDots dots = dots_of({});
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, 1.5);
  test::Digest d;
  for (const double load : {0.1, 0.3, 0.5}) {
    auto picture = Print{.load = load}.picture();
    for (double& light : picture.cells) {
      light += noise(random);
    }
    const auto r = dots(bytes_of(picture));
    d.all(r.status, r.found, r.expected);
    for (std::size_t k = 0; k < dots.px().size(); ++k) {
      d.all(dots.px()[k], dots.sd_px()[k]);
    }
  }
  CHECK(d.sum() == test::same(50428.229));
}
