// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Discs drawn as a camera sees them: each pixel is the mean of 8 x 8 rays over two pixels each way,
// which is a lens a little out of focus. A ray is dark where it meets a disc of the print, and the
// print is seen through a map that no lattice repeats exactly.
#include "fingerpad/dots/dot_follower.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "support/allocations.hpp"
#include "support/catch.hpp"
#include "support/image.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;

namespace {

using Point = Point2<double>;
using Dots = test::Image<Point>;
using Bytes = test::Image<std::uint8_t>;

constexpr Index count = 11, side = 260;
constexpr double pitch_px = 17, radius = 0.22;  // of a disc, in pitches

/// A print of 11 x 11 discs under a load: stretched around the middle and sheared, through a lens.
struct Print {
  double load = 0;
  Point shift = {0, 0};  ///< of the whole print, px
  double light = 190, ink = 0.8, slope = 0.002;

  Point moved(const Point& u) const {
    const double r2 = dot(u, u), push = 0.25 * load * std::exp(-r2 / 8), lens = 0.004 * r2;
    return (1 + push + lens) * u + Point{0.3 * load * u.y * std::exp(-r2 / 12), 0};
  }
  Point seen(const Point& u) const {
    return Point{side / 2.0, side / 2.0} + shift + pitch_px * moved(u);
  }
  Point printed(const Point& px, Point u) const {
    const Point at = (px - shift - Point{side / 2.0, side / 2.0}) / pitch_px;
    Point off = at - moved(u);
    for (int k = 0; k < 30 && dot(off, off) > 1e-14; ++k) {
      u += 0.7 * off;
      off = at - moved(u);
    }
    return u;
  }
  /// Whether no ray of a pixel meets the edge of a disc.
  static bool far_from_edge(const Point& u) {
    return std::fabs(norm(u - Point{std::round(u.x), std::round(u.y)}) - radius) * pitch_px > 2;
  }
  double shade(const Point& px, const Point& u) const {
    const Point near = {std::round(u.x), std::round(u.y)};
    const bool on = std::max(std::fabs(near.x), std::fabs(near.y)) <= (count - 1) / 2;
    const double light_here = light * (1 + slope * (px.x - side / 2.0));
    return on && norm(u - near) < radius ? light_here * (1 - ink) : light_here;
  }
  Dots places() const {
    Dots dots(count, count);
    for (Index i = 0; i < count; ++i) {
      for (Index j = 0; j < count; ++j) {
        dots(i, j) = seen({double(j - count / 2), double(i - count / 2)});
      }
    }
    return dots;
  }
  test::Image<double> picture() const {
    constexpr int rays = 8;
    test::Image<double> picture(side, side);
    Dots u(side + 2, side + 2);  // of the pixels' centers; rays between them are interpolated
    for (Index i = 0; i < side + 2; ++i) {
      for (Index j = 0; j < side + 2; ++j) {
        const Point near = j > 0 ? u(i, j - 1) : i > 0 ? u(i - 1, j) : Point{0, 0};
        u(i, j) = printed({double(j - 1), double(i - 1)}, near);
      }
    }
    for (Index i = 0; i < side; ++i) {
      for (Index j = 0; j < side; ++j) {
        if (far_from_edge(u(i + 1, j + 1))) {
          picture(i, j) = shade({double(j), double(i)}, u(i + 1, j + 1));
          continue;
        }
        double sum = 0;
        for (int k = 0; k < rays * rays; ++k) {
          const double x = 2 * (k % rays + 0.5) / rays - 1, y = 2 * (k / rays + 0.5) / rays - 1;
          const Point across = 0.5 * (u(i + 1, j + 2) - u(i + 1, j));
          const Point down = 0.5 * (u(i + 2, j + 1) - u(i, j + 1));
          const Point bend = 0.5 * x * x * (u(i + 1, j + 2) + u(i + 1, j) - 2.0 * u(i + 1, j + 1)) +
                             0.5 * y * y * (u(i + 2, j + 1) + u(i, j + 1) - 2.0 * u(i + 1, j + 1));
          sum +=
              shade({double(j) + x, double(i) + y}, u(i + 1, j + 1) + x * across + y * down + bend);
        }
        picture(i, j) = sum / (rays * rays);
      }
    }
    return picture;
  }
};

Bytes bytes_of(const test::Image<double>& picture, double noise = 0, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noise > 0 ? noise : 1);
  Bytes bytes(side, side);
  for (std::size_t k = 0; k < bytes.cells.size(); ++k) {
    const double v = picture.cells[k] + (noise > 0 ? normal(random) : 0.0);
    bytes.cells[k] = static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0, 255.0)));
  }
  return bytes;
}

DotFollower follower_of(const Print& print, double noise = 0) {
  return {bytes_of(print.picture(), noise), print.places(), {.radius_px = 4}};
}

/// Follows a print without a load or noise.
DotFollower free_follower() {
  static const DotFollower follower = follower_of({});
  return follower;
}

/// Where the dots' centers are seen. What the center of a disc is that no ellipse resembles is a
/// convention: the center of the ellipse that the free picture shows.
Dots centers_of(const Print& print) {
  static const Dots offsets = [] {
    const Print free;
    DotFollower follower = free_follower();
    Dots dots(count, count);
    REQUIRE(follower(bytes_of(free.picture()), dots).ok());
    for (std::size_t k = 0; k < dots.cells.size(); ++k) {
      dots.cells[k] = dots.cells[k] - free.places().cells[k];
    }
    return dots;
  }();
  Dots centers = print.places();
  for (std::size_t k = 0; k < centers.cells.size(); ++k) {
    centers.cells[k] += offsets.cells[k];
  }
  return centers;
}

struct Errors {
  Index count = 0, wrong = 0;
  double rms = 0, worst = 0, radial = 0;  ///< radial: mean, away from the middle
};
Errors errors_of(const Dots& found, const Dots& truth) {
  Errors e;
  double square = 0, outward = 0;
  for (std::size_t k = 0; k < found.cells.size(); ++k) {
    if (is_finite(found.cells[k])) {
      const Point off = found.cells[k] - truth.cells[k];
      const Point arm = truth.cells[k] - truth.cells[truth.cells.size() / 2];
      ++e.count;
      e.wrong += norm(off) > pitch_px / 3 ? 1 : 0;
      e.worst = std::max(e.worst, norm(off));
      square += dot(off, off) / 2;
      outward += norm(arm) > 0 ? dot(off, arm) / norm(arm) : 0;
    }
  }
  e.rms = std::sqrt(square / double(std::max<Index>(e.count, 1)));
  e.radial = outward / double(std::max<Index>(e.count, 1));
  return e;
}

}  // namespace

TEST_CASE("dot follower: centers are right to a hundredth of a pixel whatever the load",
          "[figures]") {
  DotFollower follower = free_follower();
  Dots dots(count, count);
  for (const double load : {0.0, 0.1, 0.25, 0.4, 0.55, 0.7, 0.85, 1.0, 0.8, 0.5, 0.2, 0.0}) {
    const Print print{.load = load};
    const auto seen = follower(bytes_of(print.picture()), dots);
    const Errors e = errors_of(dots, centers_of(print));
    INFO("load " << load << ", found " << seen.found << ", rms " << e.rms << ", worst " << e.worst);
    REQUIRE(seen.ok());
    CHECK(seen.expected == count * count);
    CHECK(e.count == count * count);
    CHECK(e.rms < 0.015);
    CHECK(e.worst < 0.06);
    CHECK(std::fabs(e.radial) < 0.01);
  }
}

TEST_CASE("dot follower: noise scatters the centers as their sd says") {
  const double noise = GENERATE(1.0, 4.0);
  const Print print{.load = 0.3};
  DotFollower follower = follower_of(print, noise);
  const auto clean = print.picture();
  const Dots centers = centers_of(print);
  Dots dots(count, count);
  Index within = 0, all = 0;
  double worst_sd = 0;
  for (unsigned seed = 2; seed < 12; ++seed) {
    REQUIRE(follower(bytes_of(clean, noise, seed), dots).ok());
    for (Index i = 0; i < count; ++i) {
      for (Index j = 0; j < count; ++j) {
        const double sd = follower.sd_px()(i, j);
        const Point off = dots(i, j) - centers(i, j);
        worst_sd = std::max(worst_sd, sd);
        within += (std::fabs(off.x) < 2 * sd ? 1 : 0) + (std::fabs(off.y) < 2 * sd ? 1 : 0);
        all += 2;
      }
    }
  }
  INFO(within << " of " << all << " within 2 sd, largest sd " << worst_sd);
  CHECK(double(within) > 0.85 * double(all));
  CHECK(worst_sd < 0.01 + 0.01 * noise);
}

TEST_CASE("dot follower: a covered, dirty or reflecting dot is lost and comes back") {
  DotFollower follower = free_follower();
  const Print print{.load = 0.1};
  const auto clean = print.picture();
  const Point dirty = centers_of(print)(4, 5);
  const double stain = GENERATE(20.0, 250.0);
  const double right = GENERATE(0.0, 3.0, -4.0, 6.0, -7.0);  // over it, over half of it, beside it
  const Point beside = {right, right / 2};
  auto stained = clean;
  for (Index i = 0; i < side; ++i) {
    for (Index j = 0; j < side; ++j) {
      const Point off = Point{double(j), double(i)} - dirty - beside;
      stained(i, j) = norm(off) < 5 ? stain : clean(i, j);
    }
  }
  Dots dots(count, count);
  const auto seen = follower(bytes_of(stained), dots);
  INFO("stain " << stain << " beside by " << beside.x);
  CHECK(seen.ok());
  CHECK(seen.found == count * count - 1);
  CHECK(!is_finite(dots(4, 5)));
  CHECK(!is_finite(follower.sd_px()(4, 5)));
  CHECK(errors_of(dots, centers_of(print)).rms < 0.02);
  CHECK(follower(bytes_of(clean), dots).found == count * count);
  CHECK(norm(dots(4, 5) - dirty) < 0.05);
}

TEST_CASE(
    "dot follower: a part of the print that moves while it is covered is found when it is bare") {
  DotFollower follower(bytes_of(Print{}.picture()), Print{}.places(),
                       {.radius_px = 4, .max_lost = 0.5});
  Dots dots(count, count);
  for (const double load : {0.25, 0.5, 0.75, 1.0}) {
    const Print print{.load = load};
    auto picture = print.picture();
    const bool bare = load == 1;
    for (Index i = side / 2 - 40; i < side / 2 + 40 && !bare; ++i) {
      std::fill_n(&picture(i, side / 2 - 40), 80, 40.0);
    }
    const auto seen = follower(bytes_of(picture), dots);
    INFO("load " << load << ", found " << seen.found);
    CHECK(seen.ok());
    CHECK((bare ? seen.found == count * count : seen.found < count * count - 12));
    CHECK(errors_of(dots, centers_of(print)).worst < 0.07);
  }
}

TEST_CASE("dot follower: after a jump of the whole print no label is wrong, and it can restart",
          "[figures]") {
  const double pitches = GENERATE(0.2, 0.4, 0.5, 0.6, 0.8, 1.0, 1.4);
  const double angle = GENERATE(0.0, 0.7, 1.5707963);
  const Print print{
      .shift = {pitches * pitch_px * std::cos(angle), pitches * pitch_px * std::sin(angle)}};
  const Bytes picture = bytes_of(print.picture());
  DotFollower follower = free_follower();
  Dots dots(count, count);
  const auto seen = follower(picture, dots);
  INFO("jump of " << pitches << " pitches, found " << seen.found);
  CHECK(errors_of(dots, centers_of(print)).wrong == 0);
  CHECK(seen.ok() == (errors_of(dots, centers_of(print)).count > 0));
  CHECK((pitches > 0.3 || seen.ok()));
  dots = print.places();
  dots(2, 2) = {std::nan(""), 0};
  dots(8, 0).x += 1.5;
  CHECK(follower.restart(picture, dots).found >= count * count - 6);  // some may leave the picture
  CHECK(errors_of(dots, centers_of(print)).worst < 0.07);
  CHECK(follower(picture, dots).ok());
}

TEST_CASE(
    "dot follower: dark spots beside the print are dirt, unless there is half a side of them") {
  const Print print{.slope = 0};
  const auto clean = print.picture();
  struct Spots {
    int count;     ///< of the 44 places a pitch beyond the border
    double share;  ///< of a dot's darkness
    bool ok;
  };
  for (const Spots& spots :
       {Spots{5, 1, true}, Spots{6, 1, false}, Spots{11, 0.53, false}, Spots{11, 0.47, true}}) {
    auto picture = clean;
    for (int k = 0; k < spots.count; ++k) {
      const Point at = print.seen({double(k - count / 2), double(count / 2 + 1)});
      for (Index i = 0; i < side; ++i) {
        for (Index j = 0; j < side; ++j) {
          const bool in_spot = norm(Point{double(j), double(i)} - at) < 4;
          picture(i, j) = in_spot ? print.light * (1 - spots.share * print.ink) : picture(i, j);
        }
      }
    }
    CAPTURE(spots.count, spots.share);
    DotFollower follower = follower_of(print);
    Dots dots(count, count);
    CHECK(follower(bytes_of(picture), dots).ok() == spots.ok);
  }
}

TEST_CASE("dot follower: discs that stay round on a print that bends are followed", "[figures]") {
  // beads in a gel, or the heads of pins: 9 x 9 discs
  constexpr Index n = 9;
  constexpr double apart_px = 25, radius_px = 7;
  const auto places_of = [&](const Print& print) {
    Dots dots(n, n);
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) {
        const Point u = {double(j - n / 2), double(i - n / 2)};
        dots(i, j) = Point{side / 2.0, side / 2.0} + apart_px * print.moved(u);
      }
    }
    return dots;
  };
  const auto picture_of = [&](const Print& print) {
    constexpr int rays = 8;
    constexpr Index reach = 9;
    test::Image<double> picture(side, side, print.light);
    for (const Point& center : places_of(print).cells) {
      const auto x = Index(center.x), y = Index(center.y);
      for (Index i = y - reach; i <= std::min(y + reach, side - 1); ++i) {
        for (Index j = x - reach; j <= std::min(x + reach, side - 1); ++j) {
          int dark = 0;
          for (int k = 0; k < rays * rays; ++k) {
            const Point ray = {double(j) + 2 * (k % rays + 0.5) / rays - 1,
                               double(i) + 2 * (k / rays + 0.5) / rays - 1};
            dark += norm(ray - center) < radius_px ? 1 : 0;
          }
          picture(i, j) -= print.ink * print.light * dark / (rays * rays);
        }
      }
    }
    return picture;
  };
  const double noise = GENERATE(0.0, 1.0);
  DotFollower follower(bytes_of(picture_of({}), noise), places_of({}), {.radius_px = radius_px});
  Dots dots(n, n);
  for (const double load : {0.3, 0.6, 1.0, 0.7, 0.2}) {
    const Print print{.load = load};
    const auto seen = follower(bytes_of(picture_of(print), noise, 2), dots);
    const Errors e = errors_of(dots, places_of(print));
    INFO("noise " << noise << ", load " << load << ", found " << seen.found << ", rms " << e.rms
                  << ", worst " << e.worst);
    CHECK(e.count == n * n);
    CHECK(e.rms < 0.02);
    CHECK(e.worst < 0.1);
  }
}

TEST_CASE("dot follower: a picture without dots loses them all, and the next is followed again") {
  DotFollower follower = free_follower();
  Dots dots(count, count);
  const Bytes good = bytes_of(Print{.load = 0.1}.picture());
  for (const int level : {0, 90, 255}) {
    const auto seen = follower(Bytes(side, side, static_cast<std::uint8_t>(level)), dots);
    CHECK(seen.status == DotFollowerStatus::lost);
    CHECK(errors_of(dots, dots).count == 0);
    CHECK(follower(good, dots).ok());
  }
  test::Image<float> broken(side, side, std::nanf(""));
  CHECK(follower(broken, dots).status == DotFollowerStatus::lost);
  CHECK(follower(good, dots).ok());
}

TEST_CASE("dot follower: any image and grid of points gives the same, bright dots too") {
  const bool bright = GENERATE(false, true);
  const double ink = bright ? -1.5 : 0.8, light = bright ? 90 : 190;
  const Print free{.light = light, .ink = ink}, print{.load = 0.15, .light = light, .ink = ink};
  const Bytes first = bytes_of(free.picture()), next = bytes_of(print.picture());
  DotFollower follower(first, free.places(), {.radius_px = 4});
  DotFollower other = follower, third = follower;
  Dots dots(count, count);
  REQUIRE(follower(next, dots).ok());
  CHECK(errors_of(dots, centers_of(print)).rms < 0.02);
  std::vector<float> three(std::size_t(3 * side * side));
  for (std::size_t k = 0; k < next.cells.size(); ++k) {
    three[3 * k + 1] = float(next.cells[k]);
  }
  test::Image<Point2<float>> floats(count, count);
  REQUIRE(other(interleaved_channel(three.data(), side, side, 3, 1, 3 * side), floats).ok());
  const auto lazy = LazyView(side, side, [&](Index i, Index j) { return int(next(i, j)); });
  Dots lazily(count, count);
  REQUIRE(third(lazy, lazily).ok());
  for (std::size_t k = 0; k < dots.cells.size(); ++k) {
    CHECK(lazily.cells[k].x == dots.cells[k].x);
    CHECK(floats.cells[k].y == float(dots.cells[k].y));
  }
}

TEST_CASE("dot follower: mistakes are refused, and a frame allocates nothing") {
  const Print print;
  const Bytes picture = bytes_of(print.picture());
  const auto refusal = [&](const Dots& dots, const DotFollowerOptions& options) {
    return test::refusal([&] { return DotFollower(picture, dots, options); });
  };
  CHECK(test::begins_with(refusal(print.places(), {.radius_px = 0.5}), "DotFollower: radius_px"));
  CHECK(test::begins_with(refusal(print.places(), {.max_lost = 1}), "DotFollower: max_lost"));
  CHECK(test::begins_with(refusal(Dots(count, count, {5, 5}), {}), "DotFollower: dots found"));
  DotFollower follower(picture, print.places(), {.radius_px = 4});
  Dots dots(count, count, {1, 2}), small(count, 3, {1, 2});
  CHECK(follower(Bytes(3, 3), dots).status == DotFollowerStatus::refused);
  CHECK(follower(picture, small).status == DotFollowerStatus::refused);
  CHECK(follower.restart(picture, small).status == DotFollowerStatus::refused);
  CHECK(small(0, 0).x == 1);
  CHECK(dots(0, 0).x == 1);
  const Bytes next = bytes_of(Print{.load = 0.2, .shift = {4, 3}}.picture());
  const long before = test::allocations();
  const bool good = follower(next, dots).ok() && follower.restart(picture, dots).ok();
  const long after = test::allocations();
  CHECK(good);
  CHECK(before > 0);
  CHECK(after == before);
}
