// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// The depth model as printed: each equation by hand, and whole frames by plain loops over them.
#include "fingerpad/published/depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "support/catch.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"

using namespace fingerpad;
using test::Frame;
using test::Image;
using test::Pad;

namespace {

using Known = published::KnownPixel<double>;

Pad printed_pad() {
  Pad pad;
  pad.one_height = true;
  return pad;
}

/// Pixel of a pad at a depth, with errors of `red` and `green` in grey levels.
Known known(
    const Pad& pad, Index row, Index col, double depth_mm, double red = 0, double green = 0) {
  const auto colour = pad.colour(row, col, depth_mm, 57);
  const auto ray =
      published::ray_of(pad.published().camera, static_cast<double>(row), static_cast<double>(col));
  return {ray.k, ray.h2_mm, depth_mm, colour.red + red, colour.green + green};
}

double quotient_of(const Pad& pad, const Known& p, double depth_mm) {
  return published::quotient(pad.published().fluid, p.k, p.h2_mm, p.b_R, p.b_G, depth_mm);
}

}  // namespace

TEST_CASE("published quotient: it is g at every depth", "[published]") {
  const Pad pad = printed_pad();
  for (const double depth_mm : {0.5, 3.0, 8.0, 13.0}) {
    for (const Index col : {28, 40}) {
      const Known k = known(pad, 24, col, depth_mm);
      CHECK(quotient_of(pad, k, depth_mm) == Approx(pad.g(24, col)).epsilon(1e-9));
    }
  }
  // 0 / 0 at the plate: E006
  CHECK_FALSE(is_finite(quotient_of(pad, known(pad, 24, 28, 0), 0)));
}

TEST_CASE("published identification: three equations give back the fluid", "[published]") {
  Pad pad = printed_pad();
  for (const auto& [c_red, c_green, kappa] :
       {std::array{0.0290, 0.0336, 0.9924}, {0.022, 0.031, 0.9}, {0.04, 0.05, 1.1}}) {
    pad.fluid = {c_red, c_green, kappa};
    const auto at = [&](double depth_mm) { return known(pad, 24, 28, depth_mm); };
    const auto found = published::identify_fluid(at(12), std::array{at(1), at(4), at(8)},
                                                 published::Fluid<double>{0.03, 0.035, 1.0});
    CAPTURE(c_red);
    REQUIRE(found);
    CHECK(found->c_R == Approx(c_red).epsilon(1e-4));
    CHECK(found->c_G == Approx(c_green).epsilon(1e-4));
    CHECK(found->kappa == Approx(kappa).epsilon(1e-5));
    const double g = pad.g(24, 28);
    for (const double depth_mm : {1.0, 4.0, 8.0, 12.0}) {
      const Known k = at(depth_mm);
      CHECK(published::quotient(*found, k.k, k.h2_mm, k.b_R, k.b_G, depth_mm) ==
            Approx(g).epsilon(1e-3));
    }
  }
}

TEST_CASE("published identification: depths that are one, and noise", "[published]") {
  const Pad pad = printed_pad();
  const Known one = known(pad, 24, 28, 5);
  const auto same = published::identify_fluid(known(pad, 24, 28, 12), std::array{one, one, one});
  // the same equation three times: a solution or a refusal, but never these three numbers
  CHECK_FALSE((same && std::abs(same->c_R - 0.029) > 1e-6));
  // 0.03 grey levels at one depth change c_R by a tenth and more, but depths hardly
  const auto noisy = published::identify_fluid(
      known(pad, 24, 28, 12),
      std::array{known(pad, 24, 28, 1, 0.03), known(pad, 24, 28, 4), known(pad, 24, 28, 8)});
  REQUIRE(noisy);
  CHECK(std::abs(noisy->c_R / 0.029 - 1) > 0.1);
}

TEST_CASE("published identification: equations that contradict each other have no fluid",
          "[published]") {
  const Pad pad = printed_pad();
  // in float the iteration stops where no step gains anything
  const auto as_float = [](const Known& k) {
    return published::KnownPixel<float>{float(k.k), float(k.h2_mm), float(k.depth_mm), float(k.b_R),
                                        float(k.b_G)};
  };
  const Known at_12 = known(pad, 24, 28, 12), at_8 = known(pad, 24, 28, 8);
  const Known at_5 = known(pad, 24, 28, 5);
  for (const double error : {0.01, 0.1, 1.0}) {  // grey levels, at the same depth
    CAPTURE(error);
    const Known other = known(pad, 24, 28, 5, error);
    CHECK_FALSE(published::identify_fluid(at_12, std::array{at_5, other, at_8}));
    CHECK_FALSE(published::identify_fluid(
        as_float(at_12), std::array{as_float(at_5), as_float(other), as_float(at_8)}));
  }
}

TEST_CASE("published place of a dot: eq. 13 with its angles", "[published]") {
  const published::Pinhole<double> camera{
      .h1_mm = 40, .n = 1.4, .center_row_px = 3, .center_col_px = 5, .pitch_mm = 0.1};
  for (const double row : {-97.0, 3.0, 60.0}) {
    for (const double col : {5.0, 55.0, 205.0}) {
      const double x = 0.1 * (col - 5), y = 0.1 * (row - 3), rho = std::hypot(x, y);
      const double in_air = std::atan2(rho, 40), in_fluid = std::asin(std::sin(in_air) / 1.4);
      for (const double depth_mm : {0.0, 2.0, 13.0}) {
        // 1 + l sin / (h tan); its limit on the axis
        const double stretch = rho > 0 ? 1 + depth_mm * std::sin(in_fluid) / (40 * std::tan(in_air))
                                       : 1 + depth_mm / (1.4 * 40);
        const auto p = published::point_at(camera, row, col, depth_mm);
        CHECK(p.x == Approx(stretch * x).margin(1e-12));
        CHECK(p.y == Approx(stretch * y).margin(1e-12));
        CHECK(p.z == depth_mm);
      }
    }
  }
}

TEST_CASE("published depth: sixteen halvings end at an odd multiple of 1 / 2^15 of the range",
          "[published]") {
  const auto is_odd = [](double multiple) { return std::abs(std::fmod(multiple, 2) - 1) < 1e-6; };
  const Pad pad = printed_pad();
  const auto o = pad.published();
  CHECK(o.halvings == published::DepthOptions<double>().halvings);
  const auto free = pad.free_depths();
  const auto frame = pad.frame<double>(free), pressed = pad.frame<double>(pad.pressed_depths(3));
  published::DepthEstimator<> estimate(o, frame.red, frame.green, free);
  Image<double> depth(pad.rows, pad.cols);
  REQUIRE(estimate(pressed.red, pressed.green, depth));
  CHECK(std::all_of(depth.cells.begin(), depth.cells.end(), [&](double l) {
    return std::isnan(l) || is_odd(std::ldexp(l / o.max_depth_mm, 15));
  }));
  for (const double depth_mm : {0.5, 3.0, 8.0, 13.0}) {
    const Known k = known(pad, 24, 28, depth_mm);
    const double l =
        published::bisect(pad.published().fluid, k.k, k.h2_mm, pad.g(24, 28), k.b_R, k.b_G, 14.0);
    CHECK(is_odd(std::ldexp(l / 14, 15)));
  }
}

namespace {

/// Mean red and green of the pixels of a window that lie in the pad and are neither 0 nor 255.
template <class Pixel>
Colour<double> plain_mean(const Frame<Pixel>& frame,
                          const Image<double>& free_mm,
                          const published::DepthOptions<double>& o,
                          Index row,
                          Index col) {
  double red = 0, green = 0, count = 0;
  for (Index i = row - o.window_px / 2; i <= row + o.window_px / 2; ++i) {
    for (Index j = col - o.window_px / 2; j <= col + o.window_px / 2; ++j) {
      if (i < 0 || j < 0 || i >= free_mm.rows() || j >= free_mm.cols() || !(free_mm(i, j) >= 0)) {
        continue;
      }
      const double r = static_cast<double>(frame.red(i, j)) / o.units_per_level;
      const double b = static_cast<double>(frame.green(i, j)) / o.units_per_level;
      if (r > 0 && r < 255 && b > 0 && b < 255) {
        red += r;
        green += b;
        count += 1;
      }
    }
  }
  return {red / count, green / count};
}

}  // namespace

TEST_CASE("published depth: mean, quotient and bisection of each pixel", "[published]") {
  const int window_px = GENERATE(1, 3, 29, 101);
  const int halvings = GENERATE(2, 16);
  const auto check = [&](auto cell) {
    using Pixel = decltype(cell);
    const Pad pad;
    auto o = pad.published(window_px);
    o.units_per_level = grey_scale_of<Pixel>().units_per_level;
    o.halvings = halvings;
    const auto free = pad.free_depths();
    auto free_frame = pad.frame<Pixel>(free, 1, 3);
    auto frame = pad.frame<Pixel>(pad.pressed_depths(3), 1, 4);
    for (std::size_t k = 0; k < frame.red.cells.size(); ++k) {
      if (!(free.cells[k] >= 0)) {  // light beside the pad
        free_frame.red.cells[k] = frame.red.cells[k] = test::stored<Pixel>(99);
        free_frame.green.cells[k] = frame.green.cells[k] = test::stored<Pixel>(20);
      }
    }
    for (std::size_t k = 0; k < frame.red.cells.size(); k += 7) {
      free_frame.red.cells[k] = test::stored<Pixel>(k % 2 == 0 ? 0 : 255);
      frame.green.cells[k] = test::stored<Pixel>(k % 3 == 0 ? 0 : 255);
      frame.red.cells[(k + 3) % frame.red.cells.size()] = test::stored<Pixel>(1);
    }
    published::DepthEstimator<> estimate(o, free_frame.red, free_frame.green, free);
    Image<double> depth(pad.rows, pad.cols);
    REQUIRE(estimate(frame.red, frame.green, depth));
    Index numbers = 0;
    for (Index i = 0; i < pad.rows; ++i) {
      for (Index j = 0; j < pad.cols; ++j) {
        double expected = test::nan;
        if (free(i, j) > 0) {
          const auto ray =
              published::ray_of(o.camera, static_cast<double>(i), static_cast<double>(j));
          const auto at_rest = plain_mean(free_frame, free, o, i, j);
          const auto now = plain_mean(frame, free, o, i, j);
          const double g = published::quotient(o.fluid, ray.k, ray.h2_mm, at_rest.red,
                                               at_rest.green, free(i, j));
          if (is_finite(g) && is_finite(now.red)) {
            expected = published::bisect(o.fluid, ray.k, ray.h2_mm, g, now.red, now.green,
                                         o.max_depth_mm, o.halvings);
            ++numbers;
          }
        }
        CAPTURE(i, j, depth(i, j), expected);
        REQUIRE(test::same_bits(depth(i, j), expected));
      }
    }
    CHECK(numbers > 1000);
  };
  check(std::uint8_t());
  check(std::uint16_t());
}

TEST_CASE("published depth: what is refused", "[published]") {
  const Pad pad;
  const auto free = pad.free_depths();
  const auto frame = pad.frame<std::uint8_t>(free);
  const auto with = [&](auto change) {
    auto o = pad.published();
    change(o);
    return test::refusal([&] { published::DepthEstimator<> e(o, frame.red, frame.green, free); });
  };
  using Catch::Matchers::StartsWith;
  const std::string owner = "published::DepthOptions: ";
  CHECK(with([](auto&) {}) == "accepted");
  CHECK(with([](auto& o) { o.window_px = 1; }) == "accepted");
  CHECK(with([](auto& o) { o.window_px = 255; }) == "accepted");
  CHECK(with([](auto& o) { o.window_px = 28; }) ==
        owner + "window_px = 28, must be odd, in [1, 255]");
  for (const int halvings : {-1, 1, 101}) {
    CHECK_THAT(with([&](auto& o) { o.halvings = halvings; }),
               StartsWith(owner + "halvings = " + std::to_string(halvings)));
  }
  CHECK_THAT(with([](auto& o) { o.camera.h1_mm = 0; }), StartsWith(owner + "camera.h1_mm = 0"));
  CHECK_THAT(with([](auto& o) { o.camera.n = 0.9; }), StartsWith(owner + "camera.n = 0.9"));
  CHECK_THAT(with([](auto& o) { o.camera.pitch_mm = test::nan; }),
             StartsWith(owner + "camera.pitch_mm = nan"));
  CHECK_THAT(with([](auto& o) { o.fluid.c_R = 0; }), StartsWith(owner + "fluid.c_R = 0"));
  CHECK_THAT(with([](auto& o) { o.fluid.kappa = -1; }), StartsWith(owner + "fluid.kappa = -1"));
  CHECK_THAT(with([](auto& o) { o.max_depth_mm = 0; }), StartsWith(owner + "max_depth_mm = 0"));
  CHECK_THAT(with([](auto& o) { o.units_per_level = 0; }),
             StartsWith(owner + "units_per_level = 0"));
  const Image<double> narrow(pad.rows, pad.cols - 1, 5);
  CHECK_THAT(test::refusal([&] {
               published::DepthEstimator<> e(pad.published(), frame.red, frame.green, narrow);
             }),
             StartsWith("published::DepthEstimator: rows of free_depth_mm"));

  published::DepthEstimator<> estimate(pad.published(), frame.red, frame.green, free);
  Image<double> depth(pad.rows, pad.cols, -7), small(pad.rows - 1, pad.cols, -7);
  CHECK_FALSE(estimate(frame.red, narrow, depth));
  CHECK_FALSE(estimate(frame.red, frame.green, small));
  CHECK(depth.cells == Image<double>(pad.rows, pad.cols, -7).cells);
  CHECK(small.cells == Image<double>(pad.rows - 1, pad.cols, -7).cells);
}
