// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Single printed forms: each by its equation computed by hand, and by its known errors.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "fingerpad/depth/neighbour_light.hpp"
#include "fingerpad/published/contact_region.hpp"
#include "fingerpad/published/neighbour_light.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Image;

namespace {

/// A pad and a press of it, small enough for fifty radii.
struct SmallPress {
  static constexpr Index size = 36, radius = 6;
  static constexpr double pitch_mm = 0.25;
  Image<double> free{size, size}, pressed{size, size}, actual{size, size};
  std::vector<double> change;

  SmallPress() {
    for (Index i = 0; i < size; ++i) {
      for (Index j = 0; j < size; ++j) {
        const double x = pitch_mm * static_cast<double>(j - 16);
        const double y = pitch_mm * static_cast<double>(i - 19);
        free(i, j) = 8 - 0.05 * (x * x + y * y);
        pressed(i, j) = free(i, j) - 2 * std::exp(-(x * x + 0.7 * y * y) / 4);
      }
    }
    change = published::inclination_change(pressed, free, pitch_mm);
    for (Index i = 0; i < size; ++i) {
      for (Index j = 0; j < size; ++j) {
        actual(i, j) = published::without_neighbour_light(pressed(i, j), free(i, j),
                                                          psi_sum(radius, i, j), 2e-3, 0.3);
      }
    }
  }
  double psi_sum(Index r, Index i, Index j) const {
    return published::disc_sum(change, size, r, i, j);
  }
};

}  // namespace

TEST_CASE("published fit of the neighbouring light: a line of logarithms", "[published]") {
  // least squares of logarithms: the weight of a factor on one error depends on its position, not
  // on its size; an error that is not positive has no logarithm
  SmallPress press;
  for (Index i = 0; i < press.size; ++i) {
    for (Index j = 0; j < press.size; ++j) {
      const double factor = (i + j) % 7 == 0 ? -1 : std::exp(0.1 * static_cast<double>(j % 5));
      const double error = press.pressed(i, j) - press.actual(i, j);
      press.actual(i, j) = press.pressed(i, j) - factor * error;
    }
  }
  const auto found =
      published::identify_neighbour_light(press.pressed, press.actual, press.free, press.pitch_mm);
  REQUIRE(found.ok());
  const auto sum_sq = [&](double ln_m0, double n) {
    double sum = 0;
    for (Index i = 0; i < press.size; ++i) {
      for (Index j = 0; j < press.size; ++j) {
        const double psi_sum = press.psi_sum(found.radius_px, i, j);
        const double error = press.pressed(i, j) - press.actual(i, j);
        if (error > 0 && psi_sum > 0) {
          const double risen = press.pressed(i, j) - press.free(i, j);
          sum += square(std::log(error) - std::log(psi_sum) - ln_m0 - n * risen);
        }
      }
    }
    return sum;
  };
  const double ln_m0 = std::log(found.m0_mm_per_rad), n = found.n_per_mm;
  CHECK(found.sum_sq == Approx(sum_sq(ln_m0, n)).epsilon(1e-9));
  CHECK(found.sum_sq > 1);
  // the least: a parabola in each parameter, alike on both sides
  for (const double step : {0.01, 0.1}) {
    CHECK(sum_sq(ln_m0 + step, n) > found.sum_sq);
    CHECK(sum_sq(ln_m0 + step, n) == Approx(sum_sq(ln_m0 - step, n)).epsilon(1e-9));
    CHECK(sum_sq(ln_m0, n + step) == Approx(sum_sq(ln_m0, n - step)).epsilon(1e-9));
  }
}

TEST_CASE("published neighbouring light: r, m_0 and n of presses are found again", "[published]") {
  const SmallPress press;
  const auto found =
      published::identify_neighbour_light(press.pressed, press.actual, press.free, press.pitch_mm);
  REQUIRE(found.ok());
  CHECK(found.radius_px == press.radius);
  CHECK(found.m0_mm_per_rad == Approx(2e-3));
  CHECK(found.n_per_mm == Approx(0.3));
  CHECK(found.sum_sq < 1e-9);
  for (Index r = 1; r <= 50; ++r) {  // the residuals tell the radius from those beside it
    const double sum_sq = found.sum_sq_by_radius[static_cast<std::size_t>(r - 1)];
    CHECK((r == press.radius ? sum_sq == found.sum_sq : sum_sq > 1e-3));
  }
  // the default compensation is the same in the middle of the image
  NeighbourLightCompensation<double> light({press.radius, 2e-3, 0.3}, press.pitch_mm, press.free);
  test::Image<double> out(press.size, press.size);
  REQUIRE(light(press.pressed, out) == FrameStatus::ok);
  CHECK(out(18, 17) == Approx(press.actual(18, 17)).epsilon(1e-9));
  const test::Image<double> narrow(press.size, press.size - 1);
  CHECK_FALSE(
      published::identify_neighbour_light(press.pressed, narrow, press.free, press.pitch_mm).ok());
  // no error has a logarithm
  CHECK_FALSE(
      published::identify_neighbour_light(press.pressed, press.pressed, press.free, press.pitch_mm)
          .ok());
}

TEST_CASE("published neighbouring light: inclination and sums up to the border", "[published]") {
  const Image<double> level(7, 9, 5.0);
  Image<double> plane(7, 9);
  std::vector<double> change;
  for (Index i = 0; i < 7; ++i) {
    for (Index j = 0; j < 9; ++j) {
      plane(i, j) = 5 + 0.3 * static_cast<double>(j) - 0.2 * static_cast<double>(i);
      change.push_back(std::ldexp(1.0, static_cast<int>(i + 2 * j)));
    }
  }
  const auto by_pixel = published::inclination_change(plane, level, 0.5);
  for (Index i = 0; i < 7; ++i) {
    for (Index j = 0; j < 9; ++j) {
      const bool inner = i > 0 && j > 0 && i < 6 && j < 8;
      const double here = published::inclination(plane, 0.5, i, j);
      CAPTURE(i, j);
      CHECK((inner ? here == Approx(std::atan(std::hypot(0.3, 0.2) / 0.5)) : std::isnan(here)));
      CHECK(by_pixel[static_cast<std::size_t>(9 * i + j)] == (inner ? here : 0));
      double sum = 0;
      for (Index k = 0; k < 7; ++k) {
        for (Index l = 0; l < 9; ++l) {
          const bool near = (k - i) * (k - i) + (l - j) * (l - j) <= 9;
          sum += near ? change[static_cast<std::size_t>(9 * k + l)] : 0;
        }
      }
      CHECK(published::disc_sum(change, 9, 3, i, j) == sum);
    }
  }
}

TEST_CASE("published circle through three points", "[published]") {
  // a sphere of 20 mm in any direction: nearest pixels use their own distance
  Image<double> sphere(41, 41), level(41, 41, 9.0);
  for (Index i = 0; i < 41; ++i) {
    for (Index j = 0; j < 41; ++j) {
      const double x = 0.1 * static_cast<double>(j - 20), y = 0.1 * static_cast<double>(i - 20);
      sphere(i, j) = std::sqrt(400 - x * x - y * y);
    }
  }
  for (int k = 0; k < 18; ++k) {
    CHECK(published::section_curvature<double>(sphere, 20, 20, k * std::numbers::pi / 18, 10,
                                               0.1) == Approx(0.05).epsilon(1e-9));
  }
  for (const double center_mm : {0.0, 1.0, -4.0}) {  // of the circle, beside the middle
    const auto on_circle = [&](double u) { return std::sqrt(400 - square(u - center_mm)); };
    CHECK(published::circle_center_curvature(2.0, on_circle(-2), on_circle(0), on_circle(2)) ==
          Approx(0.05).epsilon(1e-9));
    CHECK(published::circle_center_curvature(2.0, -on_circle(-2), -on_circle(0), -on_circle(2)) ==
          Approx(-0.05).epsilon(1e-9));
  }
  CHECK(std::isnan(published::section_curvature<double>(level, 20, 20, 0.3, 10, 0.1)));
  CHECK(std::isnan(published::section_curvature<double>(sphere, 2, 20, 1.5, 10, 0.1)));
}

TEST_CASE("published contact conditions: what each lets pass", "[published]") {
  enum Condition { twice, clamped, every };
  const auto surface = [](double along_x, double along_y) {
    Image<double> z(61, 61);
    for (Index i = 0; i < 61; ++i) {
      for (Index j = 0; j < 61; ++j) {
        const double x = 0.08 * static_cast<double>(j - 30), y = 0.08 * static_cast<double>(i - 30);
        // bulging is positive: the membrane is seen from inside
        z(i, j) = 9 - (along_x * x * x + along_y * y * y) / 2;
      }
    }
    return z;
  };
  const auto touches = [&](Condition condition, double along_x, double along_y,
                           double threshold = 0.01) {
    published::SlidesContactOptions o;
    o.clamps = condition == clamped;
    o.every_direction = condition == every;
    o.threshold_per_mm = threshold;
    return published::touches(surface(along_x, along_y), 30, 30, o);
  };
  // pressed by a ball: all touch
  CHECK(touches(twice, -0.05, -0.05));
  CHECK(touches(clamped, -0.05, -0.05));
  CHECK(touches(every, -0.05, -0.05));
  // free: none touch
  CHECK_FALSE(touches(twice, 0.05, 0.05));
  CHECK_FALSE(touches(clamped, 0.05, 0.05));
  CHECK_FALSE(touches(every, 0.05, 0.05));
  // a free saddle: only the plain mean is wrong (E017)
  CHECK(touches(twice, 0.05, -0.06));
  CHECK_FALSE(touches(clamped, 0.05, -0.06));
  CHECK_FALSE(touches(every, 0.05, -0.06));
  // a cylinder that bulges slightly in one direction: the mean of 18 directions is half of its
  // curvature, and both twice the mean and one direction give all of it
  CHECK(touches(clamped, 0.015, -1e-6));
  CHECK_FALSE(touches(every, 0.015, -1e-6));
  CHECK_FALSE(touches(every, -1e-6, 0.015));
  CHECK_FALSE(touches(twice, 0.015, -1e-6));
  // twice the mean of a sphere is 2 / R (E015)
  CHECK_FALSE(touches(twice, 0.05, 0.05, 0.0999));
  CHECK(touches(twice, 0.05, 0.05, 0.1001));
  CHECK_FALSE(touches(clamped, 0.05, 0.05, 0.0499));
  CHECK(touches(clamped, 0.05, 0.05, 0.0501));
}

TEST_CASE("published contact conditions: which sections there are, in a turned press",
          "[published]") {
  // one section in 18 bulges, wherever the press is turned: only the test of every direction sees
  // it
  const auto pressed_but_at = [](double turn_rad) {
    Image<double> z(61, 61);
    for (Index i = 0; i < 61; ++i) {
      for (Index j = 0; j < 61; ++j) {
        const double x = 0.08 * static_cast<double>(j - 30), y = 0.08 * static_cast<double>(i - 30);
        const double off = std::remainder(std::atan2(y, x) - turn_rad, std::numbers::pi);
        z(i, j) = 9 - (std::abs(off) < 0.05 ? 0.05 : -0.02) * (x * x + y * y) / 2;
      }
    }
    return z;
  };
  for (int k = 1; k <= 18; ++k) {
    CAPTURE(k);
    const auto z = pressed_but_at(std::numbers::pi * k / 18);
    published::SlidesContactOptions o{.every_direction = true, .threshold_per_mm = 0.01};
    o.radius_px = 25;
    CHECK_FALSE(published::touches(z, 30, 30, o));
    o.threshold_per_mm = 0.06;
    CHECK(published::touches(z, 30, 30, o));
    o = {.clamps = true, .threshold_per_mm = 0.99 * 0.05 / 18, .radius_px = 25};
    CHECK_FALSE(published::touches(z, 30, 30, o));
    o.threshold_per_mm = 1.01 * 0.05 / 18;
    CHECK(published::touches(z, 30, 30, o));
  }
}

TEST_CASE("published contact conditions: thresholds from the free pad, by definition",
          "[published]") {
  // delta_R is the least of all sections, delta_f that of the means, on a free pad that bends more
  // one way than the other, however it is turned
  const bool every_direction = GENERATE(false, true), clamps = GENERATE(false, true);
  const double turn_rad = GENERATE(0.0, 0.4, 1.1);
  const published::SlidesContactOptions o{.clamps = clamps,
                                          .every_direction = every_direction,
                                          .directions = 6,
                                          .radius_px = 4,
                                          .pitch_mm = 0.2,
                                          .step_px = 3};
  std::vector<Image<double>> frames;
  test::Random random(8);
  for (int k = 0; k < 5; ++k) {
    Image<double> z(24, 25);
    for (Index i = 0; i < 24; ++i) {
      for (Index j = 0; j < 25; ++j) {
        const double x = 0.2 * static_cast<double>(j - 12), y = 0.2 * static_cast<double>(i - 11);
        const double u = std::cos(turn_rad) * x + std::sin(turn_rad) * y;
        const double v = std::cos(turn_rad) * y - std::sin(turn_rad) * x;
        z(i, j) = 9 - 0.05 * u * u - 0.01 * v * v + 1e-3 * random.normal();
      }
    }
    frames.push_back(z);
  }
  frames[2](7, 16) = test::nan;
  const int count = clamps || every_direction ? o.directions : 2 * o.directions;
  double least = 1e9;
  int lows = 0;
  for (Index i = 1; i < 24; i += 3) {
    for (Index j = 1; j < 25; j += 3) {
      for (int section = 1; section <= (every_direction ? count : 1); ++section) {
        std::vector<double> seen;
        for (const auto& z : frames) {
          const auto at = [&](int n) {
            const double k = published::section_curvature<double>(
                z, i, j, std::numbers::pi * n / count, o.radius_px, o.pitch_mm);
            return clamps && k < 0 ? 0 : k;
          };
          double mean = 0;
          for (int n = 1; n <= count; ++n) {
            mean += at(n) / o.directions;
          }
          seen.push_back(every_direction ? at(section) : mean);
        }
        double mean = 0, squares = 0;
        for (const double x : seen) {
          mean += x / 5;
        }
        for (const double x : seen) {
          squares += (x - mean) * (x - mean) / 4;
        }
        const double low = mean - 2 * std::sqrt(squares);
        least = low < least ? low : least;
        lows += low == low ? 1 : 0;
      }
    }
  }
  CHECK(lows > 25);
  CHECK(published::threshold_by_slides(frames, o) == Approx(least).epsilon(1e-12));
  auto bad = o;
  bad.directions = 0;
  CHECK_THROWS_AS(published::threshold_by_slides(frames, bad), parameter_error);
  const std::vector<Image<double>> unknown(2, Image<double>(24, 25, test::nan));
  CHECK(std::isinf(published::threshold_by_slides(unknown, o)));
}

TEST_CASE("published contact region: centers every 5 pixels", "[published]") {
  // bulging on the left of column 52, pressed in on the right
  Image<double> z(60, 103);
  for (Index i = 0; i < 60; ++i) {
    for (Index j = 0; j < 103; ++j) {
      const double x = 0.08 * static_cast<double>(j - 52), y = 0.08 * static_cast<double>(i - 30);
      z(i, j) = 9 - (j < 52 ? 0.05 : -0.05) * (x * x + y * y) / 2;
    }
  }
  Image<unsigned char> mask(60, 103, 9);
  published::SlidesContactOptions o;
  o.threshold_per_mm = 0.001;
  const double area = published::contact_by_slides(z, mask, o);
  double set = 0;
  for (Index i = 0; i < 60; ++i) {
    for (Index j = 0; j < 103; ++j) {
      CHECK(mask(i, j) == mask(i / 5 * 5, j / 5 * 5));  // one answer per block
      set += mask(i, j) != 0 ? 1 : 0;
    }
  }
  CHECK(area == Approx(set * 0.08 * 0.08));
  CHECK(set > 0);
  CHECK(mask(31, 71) != 0);
  CHECK(mask(31, 31) == 0);
  CHECK(mask(31, 101) == 0);  // no ring beyond the edge
  Index off_center = 0;
  for (Index i = 0; i < 60; i += 5) {
    for (Index j = 0; j < 100; j += 5) {
      CHECK((mask(i, j) != 0) == published::touches(z, i + 2, j + 2, o));
      off_center += (mask(i, j) != 0) != published::touches(z, i, j, o) ? 1 : 0;
    }
  }
  CHECK(off_center > 0);  // some corner would differ
  Image<unsigned char> other(60, 100, 9);
  CHECK(std::isnan(published::contact_by_slides(z, other, o)));
  CHECK(other(0, 0) == 9);
  o.step_px = 0;
  CHECK_THROWS_AS(published::contact_by_slides(z, mask, o), parameter_error);
}

TEST_CASE("published contact region: radius and pitch at the ends of their ranges", "[published]") {
  const Image<double> z(5, 5, 1.0);
  Image<unsigned char> mask(5, 5);
  const auto accepts = [&](double radius_px, double pitch_mm) {
    published::SlidesContactOptions o;
    o.radius_px = radius_px;
    o.pitch_mm = pitch_mm;
    try {
      (void)published::contact_by_slides(z, mask, o);
    } catch (const parameter_error&) {
      return false;
    }
    return true;
  };
  CHECK(accepts(1, 0.1));
  CHECK(accepts(1000, 0.1));
  CHECK(accepts(2, 10));
  CHECK_FALSE(accepts(0.99, 0.1));
  CHECK_FALSE(accepts(1001, 0.1));
  CHECK_FALSE(accepts(2, 0));
  CHECK_FALSE(accepts(2, 10.1));
}
