// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every sensor, every frame and every window.
#include "fingerpad/depth/depth.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numbers>
#include <numeric>
#include <opencv2/core.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#include "fingerpad/published/depth.hpp"
#include "support/allocations.hpp"
#include "support/catch.hpp"
#include "support/digest.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"
#include "support/refusal.hpp"
#include "support/rotated.hpp"

using namespace fingerpad;
using test::Digits50;
using test::Frame;
using test::Image;
using test::mirrored;
using test::Pad;
using test::refusal;
using test::Tangent;
using test::transposed;

namespace {

/// Largest relative error of g where the reference knows the pad.
template <class S>
double worst_g(const Pad& pad, const DepthReference<S>& reference) {
  double worst = 0;
  for (Index i = 0; i < pad.rows; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      if (reference.in_pad(i, j)) {
        worst =
            (std::max)(worst, std::abs(static_cast<double>(reference.g(i, j)) / pad.g(i, j) - 1));
      }
    }
  }
  return worst;
}

}  // namespace

TEMPLATE_TEST_CASE("the scattering of a frame without noise is found",
                   "[reference]",
                   float,
                   double) {
  using S = TestType;
  Pad pad;
  pad.scattering_loss = GENERATE(0.0, 0.05, 0.5);
  const auto reference = pad.reference<S>();
  // normal equations of a cubic lose four to five digits, which float still resolves
  CHECK(worst_g(pad, reference) <= (std::is_same_v<S, float> ? 1e-6 : 1e-11));
  // the residual comes from a difference of sums of squares, which loses half the digits
  CHECK(static_cast<double>(reference.residual_rms) <= 57 * 1e-7);

  const auto depth = pad.free_depths();
  Index known = 0;
  for (Index i = 0; i < pad.rows; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      const double l = depth(i, j);
      known += l > 0 ? 1 : 0;
      REQUIRE(reference.in_pad(i, j) == (l >= 0));
      REQUIRE(test::same_bits(reference.depth(i, j), S(l)));
    }
  }
  CHECK(reference.pixels_used == known);
  CHECK(known > 1000);
}

TEST_CASE("noise in the reference averages out", "[reference]") {
  // One level of noise is 0.7 mm of depth in a single pixel; over 1500 pixels and 31 coefficients
  // it leaves 0.7 sqrt(31 / 1500) = 0.1 mm. A press that the frame did not show errs like it.
  const Pad pad;
  const auto depth = pad.free_depths();
  double sum_sq = 0, count = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto frame = pad.frame<std::uint8_t>(depth, 1, seed);
    const auto reference = fit_reference(pad.camera, pad.fluid, frame.red, frame.green, depth);
    // 1 level of noise in red and green and the steps of 8 bit: 1.04 sqrt(kappa^2 + 1.07^2)
    CHECK(reference.residual_rms == Approx(1.5).epsilon(0.1));
    for (const double press_mm : {0.0, 2.0, 5.0}) {
      const auto pressed = pad.pressed_depths(press_mm);
      DepthEstimator<float> estimator(pad.camera, pad.fluid, reference, {.window_px = 1});
      const auto seen = test::estimate(estimator, pad.frame<double>(pressed));
      for (std::size_t k = 0; k < pressed.cells.size(); ++k) {
        if (static_cast<double>(seen.depth_mm.cells[k]) > 0) {
          sum_sq += square(static_cast<double>(seen.depth_mm.cells[k]) - pressed.cells[k]);
          count += 1;
        }
      }
    }
  }
  CHECK(std::sqrt(sum_sq / count) <= 0.15);
  CHECK(count > 15 * 1000);
}

namespace {

/// A frame of the pad under a lamp that falls by `ramp` along x, with `colour` of red across, and a
/// brighter spot.
Frame<double> under_a_lamp(const Pad& pad, const Image<double>& depth) {
  Frame<double> frame = pad.frame<double>(depth);
  for (Index i = 0; i < pad.rows; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      const auto at = point_at(pad.camera, double(i), double(j), 0.0);
      const double x = at.x / 20, y = at.y / 20;
      const double lamp = 1 + 0.1 * x - 0.05 * y + 0.06 * x * x * y - 0.1 * (x * x + y * y);
      frame.green(i, j) *= lamp;
      frame.red(i, j) *= lamp / (1 + 0.02 * x - 0.01 * y);
    }
  }
  return frame;
}

}  // namespace

TEST_CASE("a lamp that lights unevenly leaves the depth as it is", "[reference]") {
  Pad pad;
  pad.scattering_loss = 0;
  const auto free = pad.free_depths();
  const auto seen = under_a_lamp(pad, free);
  const auto reference = fit_reference<double>(pad.camera, pad.fluid, seen.red, seen.green, free);
  for (const double press_mm : {0.0, 1.0, 4.0}) {
    const auto pressed = pad.pressed_depths(press_mm);
    DepthEstimator<double> estimator(pad.camera, pad.fluid, reference, {.window_px = 1});
    const auto e = test::estimate(estimator, under_a_lamp(pad, pressed));
    CHECK(test::largest_error(e.depth_mm, pressed) <= 1e-9);
  }
  // a light that is known gives the same reference without a fit
  PadLight<double> light;
  light.scattering.coefficient[0] = pad.g(24, 32);
  light.kappa.coefficient[0] = pad.fluid.kappa;
  const auto plain = pad.frame<double>(free);
  const auto known =
      fit_reference<double>(pad.camera, pad.fluid, plain.red, plain.green, free, &light);
  CHECK(known.residual_rms < 1e-9);
  CHECK(known.gain(24, 32) == Approx(1));
}

TEST_CASE("what the light does not explain is masked for good", "[reference]") {
  const Pad pad;
  const auto free = pad.free_depths();
  auto seen = pad.frame<double>(free);
  for (Index i = 20; i < 24; ++i) {  // a reflection
    for (Index j = 26; j < 30; ++j) {
      seen.red(i, j) += 40;
      seen.green(i, j) += 20;
    }
  }
  const auto reference = fit_reference<double>(pad.camera, pad.fluid, seen.red, seen.green, free);
  for (Index i = 0; i < pad.rows; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      const bool reflects = i >= 20 && i < 24 && j >= 26 && j < 30;
      REQUIRE((!reference.in_pad(i, j) || is_finite(reference.g(i, j)) == !reflects));
    }
  }
  DepthEstimator<double> estimator(pad.camera, pad.fluid, reference, {.window_px = 1});
  const auto pressed = pad.pressed_depths(3);
  const auto e = test::estimate(estimator, pad.frame<double>(pressed));
  CHECK(test::largest_error(pressed, e.depth_mm) <= 1e-9);
  CHECK(std::isnan(e.depth_mm(22, 28)));
}

TEST_CASE("pixels without a colour or a depth take no part", "[reference]") {
  const Pad pad;
  auto depth = pad.free_depths();
  auto frame = pad.frame<float>(depth);
  const auto all = fit_reference(pad.camera, pad.fluid, frame.red, frame.green, depth);
  test::Random random(4);
  Index left = 0;
  for (std::size_t k = 0; k < depth.cells.size(); ++k) {
    if (!(depth.cells[k] > 0)) {
      continue;
    }
    switch (random.whole(0, 7)) {
      case 0:
        frame.red.cells[k] = 0;
        break;
      case 1:
        frame.green.cells[k] = 255;
        break;
      case 2:
        frame.red.cells[k] = static_cast<float>(test::nan);
        break;
      case 3:
        depth.cells[k] = test::nan;
        break;
      case 4:
        depth.cells[k] = -0.1;
        break;
      case 5:
        depth.cells[k] = pad.fluid.max_depth_mm * 1.01;
        break;
      default:
        ++left;
    }
  }
  const auto some = fit_reference(pad.camera, pad.fluid, frame.red, frame.green, depth);
  CHECK(some.pixels_used == left);
  CHECK(some.pixels_used < all.pixels_used);
  CHECK(worst_g(pad, some) <= 1e-5);  // float colours
  for (Index i = 0; i < pad.rows; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      const double l = depth(i, j);
      REQUIRE(some.in_pad(i, j) == (l >= 0 && l <= pad.fluid.max_depth_mm));
    }
  }
}

TEST_CASE("a reference that determines nothing is refused", "[reference]") {
  const Pad pad;
  const auto depth = pad.free_depths();
  const auto frame = pad.frame<double>(depth);
  const auto fit = [&](const Image<double>& l) {
    return refusal([&] { fit_reference(pad.camera, pad.fluid, frame.red, frame.green, l); });
  };
  using Catch::Matchers::Contains;
  using Catch::Matchers::StartsWith;
  const std::string refused = "fit_reference: blocks of pixels with a known depth = ";
  CHECK(fit(depth) == "accepted");
  CHECK_THAT(fit(Image<double>(pad.rows, pad.cols, test::nan)), StartsWith(refused + "0"));
  CHECK_THAT(fit(Image<double>(pad.rows, pad.cols, 0)), StartsWith("fit_reference: deepest"));
  Pad folded;
  folded.camera.distortion_k1 = -4;
  CHECK_THAT(
      refusal([&] { (void)folded.reference<float>(); }),
      StartsWith("fit_reference: camera.distortion_k1 = -4, must be a distortion that does"));
  CHECK_THAT(fit(Image<double>(pad.rows, pad.cols, 100)), StartsWith("fit_reference: share"));

  // Four pixels at one radius do not determine g as a function of the radius.
  Image<double> ring(pad.rows, pad.cols, test::nan);
  for (const auto& [i, j] : {std::pair<Index, Index>{13, 27}, {34, 27}, {23, 17}, {24, 38}}) {
    ring(i, j) = pad.free_depth(i, j);
  }
  CHECK_THAT(fit(ring), StartsWith(refused + "4"));
  ring = Image<double>(pad.rows, pad.cols, test::nan);
  for (Index j = 27; j < 30; ++j) {
    ring(23, j) = pad.free_depth(23, j);
  }
  CHECK_THAT(fit(ring), StartsWith(refused + "3"));

  const Image<double> narrow(pad.rows, pad.cols - 1, 50);
  CHECK_THAT(refusal([&] { fit_reference(pad.camera, pad.fluid, narrow, frame.green, depth); }),
             Contains("same size"));
  CHECK_THAT(refusal([&] { fit_reference(pad.camera, pad.fluid, frame.red, narrow, depth); }),
             Contains("same size"));
  CHECK_THAT(refusal([&] { fit_reference(pad.camera, pad.fluid, frame.red, frame.green, narrow); }),
             Contains("same size"));
  Absorption<double> fluid = pad.fluid;
  fluid.kappa = 0;
  CHECK_THAT(refusal([&] { fit_reference(pad.camera, fluid, frame.red, frame.green, depth); }),
             StartsWith("Absorption: kappa = 0"));
}

TEST_CASE("a refusal of depths of 0 outside of the pad tells their share", "[reference]") {
  Pad pad;
  const auto frame = pad.frame<double>(pad.free_depths());
  Image<double> depth = pad.free_depths();
  double pixels = 0, at_zero = 0;
  for (double& l : depth.cells) {
    at_zero += l == l ? 0 : 1;
    pixels += 1;
    l = l == l ? l : 0;
  }
  char share[40];
  std::snprintf(share, sizeof share, "%.9g", at_zero / pixels);
  CHECK_THAT(refusal([&] { fit_reference(pad.camera, pad.fluid, frame.red, frame.green, depth); }),
             Catch::Matchers::StartsWith(
                 "fit_reference: share of pixels at depth 0 = " + std::string(share) + ","));
}

TEST_CASE("a pad is judged off the axis only if its whole outline is in the image", "[reference]") {
  // A square pad of 20 x 20 pixels; only inside the image is its center known.
  const auto off_axis = [](Index top, Index left) {
    test::Image<double> depth(60, 80, not_a_number<double>());
    for (Index i = top; i < top + 20; ++i) {
      for (Index j = left; j < left + 20; ++j) {
        depth(i, j) = 5;
      }
    }
    Camera<double> camera;
    camera.center_x_px = 39.5;
    camera.center_y_px = 29.5;
    const std::string said = refusal([&] { (void)detail::expects_free_pad(camera, 14, depth); });
    const std::string begin = "fit_reference: distance of the pad's center from the axis, in radii";
    CHECK((said == "accepted" || test::begins_with(said, begin)));
    return said == "accepted" ? 0 : std::stod(said.substr(begin.size() + 3));
  };
  CHECK(off_axis(20, 30) == 0);
  const double radius_px = 20 / std::sqrt(std::numbers::pi);
  CHECK(off_axis(1, 30) == Approx(19 / radius_px));
  CHECK(off_axis(39, 30) == Approx(19 / radius_px));
  CHECK(off_axis(20, 1) == Approx(29 / radius_px));
  CHECK(off_axis(20, 59) == Approx(29 / radius_px));
  for (const auto& [top, left] : {std::pair(0, 30), {40, 30}, {20, 0}, {20, 60}}) {
    CHECK(off_axis(top, left) == 0);
  }
}

TEST_CASE("the rim is the part of the pad up to a fifth of its depth", "[reference]") {
  DepthReference<double> reference;
  reference.rows = 32;
  reference.cols = 5;
  for (Index i = 0; i < reference.rows; ++i) {
    reference.depth_mm.insert(reference.depth_mm.end(), {10, 2, 2.01, 0, test::nan});
  }
  reference.green.assign(reference.depth_mm.size(), 100);
  const auto changes = [&](std::array<int, 5> light, double expected = 1) {
    Image<double> frame(reference.rows, reference.cols);
    for (Index i = 0; i < reference.rows; ++i) {
      std::copy(light.begin(), light.end(), &frame(i, 0));
    }
    return detail::Rim(reference).has_changed(as_view(frame), as_view(frame), expected);
  };
  CHECK_FALSE(changes({50, 100, 50, 100, 50}));  // only beside it
  CHECK_FALSE(changes({50, 104, 50, 105, 50}));
  CHECK(changes({100, 50, 100, 100, 100}));
  CHECK(changes({100, 100, 100, 50, 100}));
  CHECK_FALSE(changes({100, 100, 100, 255, 100}));  // half of it is lit
  CHECK(changes({50, 90, 50, 90, 50}));
  CHECK_FALSE(changes({50, 90, 50, 90, 50}, 0.9));
  reference.rows = 31;  // 62 pixels tell nothing
  CHECK_FALSE(changes({100, 50, 100, 50, 100}));
}

// Averaged colours, against means that sum every window anew.

namespace {

namespace bound {
// Roundoff in grey levels of up to 255, with weights of two windows that sum to less than 2.5.
constexpr double single = 2.5 * 255 * 4 * 1.2e-7;
constexpr double twice = 2.5 * 255 * 1e3 * 2.3e-16;  // running sums of up to 1e3 pixels
constexpr double residual_step = 2.5 / 256;          // residuals are stored in steps of 1/128
}  // namespace bound

/// A random frame of a random pad, wide enough for whole SIMD vectors and a remainder. Valid levels
/// are at most 230, whose residuals are below the 256 levels that 16 bits hold.
template <class Pixel, class S>
struct Scene {
  Camera<double> camera = Pad().camera;
  Absorption<double> fluid;
  static constexpr GreyScale scale = grey_scale_of<Pixel>();
  detail::PadArea area;
  DepthReference<S> reference;
  Frame<Pixel> frame{0, 0};  ///< of the area

  Scene(Index rows, Index cols) : area{2, 3, rows, cols}, frame(rows, cols) {
    reference.rows = rows + area.row + 1;
    reference.cols = cols + area.col + 2;
    const auto size = static_cast<std::size_t>(reference.rows * reference.cols);
    reference.depth_mm.assign(size, S(0));
    reference.scattering.assign(size, S(0.0163));
  }

  /// Some pixels are outside the pad, without g or gain, bad, or exactly on a limit.
  Scene() : Scene(test::whole(1, 14), test::whole(1, 36)) {
    test::Random random(static_cast<std::uint64_t>(test::whole(0, 1 << 30)));
    fluid.kappa = random.uniform(0.95, 1.05);
    const double bad = test::uniform(0, 1);
    const double inside = test::uniform(0.3, 1);
    const bool has_gain = test::whole(0, 1) == 1;
    const double bad_gain[] = {0, -1, test::nan};
    for (std::size_t k = 0; k < reference.depth_mm.size(); ++k) {
      const bool is_inside = random.uniform() < inside;
      reference.depth_mm[k] = is_inside ? S(random.uniform(0, 3)) : not_a_number<S>();
      const double g[] = {0, -0.01, test::nan, 0.0163};
      reference.scattering[k] = S(random.uniform() < 0.1 ? g[random.whole(0, 3)] : 0.015);
      if (has_gain) {
        reference.red_gain.push_back(
            S(random.uniform() < 0.05 ? bad_gain[random.whole(0, 2)] : random.uniform(0.9, 1.05)));
      }
    }
    for (std::size_t k = 0; k < frame.red.cells.size(); ++k) {
      const auto level = [&] {
        const double x = random.uniform() < bad ? random.uniform(0, 230) : random.uniform(60, 190);
        return random.uniform() < 0.02 ? 255.0 * static_cast<double>(random.whole(0, 1)) : x;
      };
      frame.red.cells[k] = test::stored<Pixel>(level());
      frame.green.cells[k] = test::stored<Pixel>(level());
      if (!std::is_integral_v<Pixel> && random.uniform() < bad / 3) {
        frame.red.cells[k] = static_cast<Pixel>(test::nan);
      }
    }
  }

  /// The averaged colours of every row.
  Frame<S> averaged(int window_px) const {
    Frame<S> out(area.rows, area.cols);
    detail::ColourRows<S> rows(camera, fluid, reference, area, window_px, 1);
    const auto red = as_view(frame.red);
    const auto green = as_view(frame.green);
    rows.start(red, green);
    std::vector<S> of_red(static_cast<std::size_t>(area.cols + 64)), of_green = of_red;
    for (Index i = 0; i < area.rows; ++i) {
      rows.next(red, green, of_red.data(), of_green.data());
      std::copy_n(of_red.data(), area.cols, &out.red(i, 0));
      std::copy_n(of_green.data(), area.cols, &out.green(i, 0));
    }
    return out;
  }

  double red(Index i, Index j) const {
    const auto gain = static_cast<double>(reference.gain(area.row + i, area.col + j));
    return static_cast<double>(frame.red(i, j)) / scale.units_per_level * gain;
  }
  double green(Index i, Index j) const {
    return static_cast<double>(frame.green(i, j)) / scale.units_per_level;
  }
  bool is_used(Index i, Index j) const {
    const Index row = area.row + i, col = area.col + j;
    return reference.in_pad(row, col) && reference.g(row, col) > S(0) &&
           reference.gain(row, col) > S(0);
  }
  bool counts(Index i, Index j) const {
    const auto lies_between = [&](Pixel x) {
      return static_cast<double>(x) > scale.dark && static_cast<double>(x) < scale.saturated;
    };
    return is_used(i, j) && lies_between(frame.red(i, j)) && lies_between(frame.green(i, j));
  }
  /// exp(delta k l0) and g W(l0) of a pixel.
  std::pair<double, double> anchor(Index i, Index j) const {
    const Index row = area.row + i, col = area.col + j;
    const auto pencil = ray_at_pixel(camera, static_cast<double>(row), static_cast<double>(col));
    const auto l = static_cast<double>(reference.depth(row, col));
    const double delta = fluid.c_green_per_mm - fluid.c_red_per_mm;
    return {std::exp(delta * pencil.path_factor * l),
            static_cast<double>(reference.g(row, col)) *
                scattered_light(l, fluid.c_red_per_mm, pencil)};
  }
  double residual(Index i, Index j) const {
    const auto [rise, scattered] = anchor(i, j);
    return rise * green(i, j) - fluid.kappa * red(i, j) + scattered;
  }

  /// Mean of f over the pixels of a window that count; NaN where there are none.
  template <class F>
  double window_mean(Index row, Index col, int window, const F& f) const {
    double sum = 0;
    double count = 0;
    const Index r = window / 2;
    for (Index i = (std::max)(row - r, Index(0)); i <= (std::min)(row + r, area.rows - 1); ++i) {
      for (Index j = (std::max)(col - r, Index(0)); j <= (std::min)(col + r, area.cols - 1); ++j) {
        if (counts(i, j)) {
          sum += f(i, j);
          count += 1;
        }
      }
    }
    return sum / count;
  }

  /// What averaged() must give, with windows and weights as documented.
  Colour<double> expected(Index i, Index j, int window_px) const {
    const double nan = test::nan;
    if (window_px == 1) {
      return counts(i, j) ? Colour<double>{red(i, j), green(i, j)} : Colour<double>{nan, nan};
    }
    const auto odd_near = [](double x) { return 2 * static_cast<int>(std::floor(x / 2)) + 1; };
    const int in = odd_near(1.4 * window_px), out = odd_near(2.3 * window_px);
    const double b = static_cast<double>(in * in - 1) / (out * out - in * in);
    const auto of_green = [&](Index p, Index q) { return green(p, q); };
    const auto of_residual = [&](Index p, Index q) { return residual(p, q); };
    const double mean_green = window_mean(i, j, in, of_green);
    const double mean_residual =
        (1 + b) * window_mean(i, j, in, of_residual) - b * window_mean(i, j, out, of_residual);
    const auto [rise, scattered] = anchor(i, j);
    return {(rise * mean_green + scattered - mean_residual) / fluid.kappa, mean_green};
  }
};

bool near(double a, double b, double bound) {
  return a != a ? b != b : std::abs(a - b) <= bound;
}

template <class Pixel, class S>
void compare_with_windows() {
  const Scene<Pixel, S> scene;
  const int window_px = test::whole(0, 3) == 0 ? 1 : 3 + 2 * static_cast<int>(test::whole(0, 6));
  const auto out = scene.averaged(window_px);
  const bool single = std::is_same_v<S, float>;
  const bool whole = window_px > 1 && single && std::is_integral_v<Pixel>;
  const double rounding = single ? bound::single : bound::twice;
  for (Index i = 0; i < scene.area.rows; ++i) {
    for (Index j = 0; j < scene.area.cols; ++j) {
      const auto red = static_cast<double>(out.red(i, j));
      const auto green = static_cast<double>(out.green(i, j));
      // beside the pad a window may hold pixels that count, but there is no depth
      if (scene.is_used(i, j)) {
        const auto expected = scene.expected(i, j, window_px);
        RC_ASSERT(near(green, expected.green, rounding));
        RC_ASSERT(near(red, expected.red,
                       (window_px > 1 ? 3 : 1) * rounding + (whole ? bound::residual_step : 0)));
      } else {
        RC_ASSERT(window_px > 1 || (red != red && green != green));
      }
    }
  }
}

}  // namespace

TEST_CASE("a smoothed colour is the mean over the valid pixels of the window", "[smoothing]") {
  rc::prop("8 bit", compare_with_windows<std::uint8_t, float>);
  rc::prop("16 bit", compare_with_windows<std::uint16_t, float>);
  rc::prop("float", compare_with_windows<float, float>);
  rc::prop("double", compare_with_windows<double, double>);
  rc::prop("8 bit in double", compare_with_windows<std::uint8_t, double>);
}

TEST_CASE("the bias-free mean leaves a quadratic deviation as it is", "[smoothing]") {
  rc::prop("wherever both windows are whole", [] {
    // on the plate F is green - kappa red
    Scene<double, double> scene(40, 40);
    scene.fluid.kappa = 1;
    double c[7];
    for (double& x : c) {
      x = test::uniform(-1, 1);
    }
    for (Index i = 0; i < 40; ++i) {
      for (Index j = 0; j < 40; ++j) {
        const double y = static_cast<double>(i - 20) / 20;
        const double x = static_cast<double>(j - 20) / 20;
        scene.frame.red(i, j) = 100 + c[0] * x + c[1] * y + 9 * (c[2] * x * x + c[3] * y * y);
        scene.frame.green(i, j) = 100 + 9 * (c[4] * x * y + c[5] * x * x + c[6] * y * y);
      }
    }
    const auto out = scene.averaged(7);
    for (Index i = 8; i < 32; ++i) {
      for (Index j = 8; j < 32; ++j) {
        const double deviation = scene.frame.green(i, j) - scene.frame.red(i, j);
        RC_ASSERT(near(out.green(i, j) - out.red(i, j), deviation, bound::twice));
        // the bias of one window is curvature times (w^2 - 1) / 12, w = 9
        const double bias = 9 * (c[5] + c[6]) / 400 * (81 - 1) / 12;
        RC_ASSERT(near(out.green(i, j), scene.frame.green(i, j) + bias, bound::twice));
      }
    }
  });
}

TEST_CASE("the bias-free mean has the noise of a box of its name", "[smoothing]") {
  // 1.4 and 2.3 times the window: a^2/1.96 - 2ab/5.29 + b^2/5.29 = 1.01 for large windows.
  CHECK(detail::two_windows(29, 1) == std::array<int, 2>{41, 67});
  Scene<double, double> scene(135, 135);
  scene.frame.red.cells.assign(scene.frame.red.cells.size(), 100);
  scene.frame.green.cells.assign(scene.frame.green.cells.size(), 100);
  const auto before = scene.averaged(29);
  scene.frame.red(67, 67) += 1;
  const auto after = scene.averaged(29);
  double sum = 0, second = 0, variance = 0;
  for (Index i = 0; i < 135; ++i) {
    for (Index j = 0; j < 135; ++j) {
      const double weight = after.red(i, j) - before.red(i, j);
      sum += weight;
      second += weight * square(static_cast<double>(i - 67));
      variance += square(weight);
    }
  }
  CHECK(sum == Approx(1));
  CHECK(second == Approx(0).margin(1e-6));  // of 70 for a box
  CHECK(variance * 29 * 29 == Approx(1).epsilon(0.05));
}

TEST_CASE("windows in samples are as wide on the pad, and never below three samples",
          "[smoothing]") {
  for (const int window_px : {7, 29, 61}) {
    for (const int step : {2, 3, 4}) {
      CAPTURE(window_px, step);
      const auto whole = detail::two_windows(window_px, 1);
      const auto sampled = detail::two_windows(window_px, step);
      for (std::size_t k = 0; k < 2; ++k) {
        const int least = 3 + 2 * static_cast<int>(k);
        CHECK(sampled[k] % 2 == 1);
        CHECK(sampled[k] >= least);
        CHECK((sampled[k] == least || std::abs(sampled[k] * step - whole[k]) <= step + 1));
      }
    }
  }
}

namespace {

/// Error of an estimator on the free pad, rim included, in mm.
template <class Pixel, class S>
double free_pad_error(const Pad& pad, int window_px) {
  const auto depth = pad.free_depths();
  auto estimator = pad.estimator<S>({.window_px = window_px});
  return test::largest_error(test::estimate(estimator, pad.frame<Pixel>(depth)).depth_mm, depth);
}

}  // namespace

TEST_CASE("smoothing leaves the free pad as it is, rim and printed dots included", "[smoothing]") {
  Pad pad;
  int window_px = 0;  // 19 mm are steep at the rim
  std::tie(pad.sphere_radius_mm, window_px) =
      GENERATE(std::pair(19.0, 3), std::pair(19.0, 21), std::pair(20.0, 9), std::pair(40.0, 21));
  // Double: roundoff. Float: roundoff of 57 grey levels, where F rises by 1.3 per mm; the first
  // pixels of the rim are the least accurate. 16 bit: residuals of half of 1/128 grey level, if all
  // have the same sign.
  CHECK(free_pad_error<double, double>(pad, window_px) <= 1e-10);
  CHECK(free_pad_error<float, float>(pad, window_px) <= 3e-5);
  CHECK(free_pad_error<std::uint16_t, float>(pad, window_px) <= 2.2 * 3e-3);
}

// The estimator.

TEMPLATE_TEST_CASE("a pixel without a valid one in its window says why it has no depth",
                   "[depth]",
                   std::uint8_t,
                   std::uint16_t,
                   float) {
  using Pixel = TestType;
  const Pad pad;
  const auto truth = pad.free_depths();
  auto frame = pad.frame<Pixel>(truth);
  frame.red(20, 20) = Pixel(0);
  frame.green(20, 30) = test::stored<Pixel>(255);
  const bool has_nan = !std::is_integral_v<Pixel>;
  if (has_nan) {
    frame.red(20, 40) = static_cast<Pixel>(test::nan);
  }
  const auto e = test::estimate(pad.estimator<float>({.window_px = 1}), frame);
  CHECK(e.status(20, 20) == PixelStatus::dark);
  CHECK(e.status(20, 30) == PixelStatus::saturated);
  CHECK((e.status(20, 40) == PixelStatus::not_a_number) == has_nan);
  CHECK(e.status(0, 0) == PixelStatus::outside_pad);
  const auto windows = test::estimate(pad.estimator<float>({.window_px = 5}), frame);
  CHECK(windows.status(20, 20) == PixelStatus::ok);
}

TEST_CASE("a frame of another size is refused and nothing written", "[depth]") {
  const Pad pad;
  auto estimator = pad.estimator<float>();
  const auto good = pad.frame<std::uint8_t>(pad.free_depths());
  const Index r = pad.rows;
  const Index c = pad.cols;
  const auto refused = [&](Index red_rows, Index green_cols, Index depth_rows, Index status_cols) {
    const Image<std::uint8_t> red(red_rows, c, 50);
    const Image<std::uint8_t> green(r, green_cols, 50);
    Image<float> depth(depth_rows, c, -7);
    Image<PixelStatus> status(r, status_cols, PixelStatus::dark);
    const auto result = estimator(red, green, depth, status);
    CHECK_FALSE(result.ok());
    CHECK(result.valid_pixels() == 0);
    CHECK(depth.cells == Image<float>(depth_rows, c, -7).cells);
    CHECK(status.cells == Image<PixelStatus>(r, status_cols, PixelStatus::dark).cells);
  };
  refused(r - 1, c, r, c);
  refused(r, c + 1, r, c);
  refused(r, c, r + 1, c);
  refused(r, c, r, c - 1);
  // and the estimator remains usable
  test::Estimate<float> e(r, c);
  CHECK(estimator(good.red, good.green, e.depth_mm).ok());
}

namespace {

using D = Tangent<double>;

/// Depth as a function of (red, green, c_red, kappa, g), with the one of index `which` shifted by
/// x.
template <class S>
S shifted_depth(const Pad& pad, double l, int which, const S& x) {
  const auto shift = [&](int k, double v) { return which == k ? S(S(v) + x) : S(v); };
  const auto light = pad.pencil(10, 20);
  const auto c = pad.colour(10, 20, l, pad.brightness);
  const Absorption<S> fluid{shift(2, pad.fluid.c_red_per_mm), S(pad.fluid.c_green_per_mm),
                            shift(3, pad.fluid.kappa), S(pad.fluid.max_depth_mm)};
  const Ray<S> ray{.path_factor = S(light.path_factor),
                   .meridional_mm = S(light.meridional_mm),
                   .sagittal_mm = S(light.sagittal_mm)};
  return newton_depth(fluid, ray, shift(4, pad.g(10, 20)),
                      Colour<S>{shift(0, c.red), shift(1, c.green)})
      .depth_mm;
}

}  // namespace

TEST_CASE("a dual number carries the derivative of depth", "[depth]") {
  rc::prop("with respect to red, green, c_red, kappa and g", [] {
    const Pad pad;
    const double l = test::uniform(1, 13);
    // steps that change the depth by some micrometres: differences are then accurate to 1e-7
    const double steps[] = {1e-4, 1e-4, 1e-7, 1e-6, 1e-6};
    for (int which = 0; which < 5; ++which) {
      const double by_dual = shifted_depth(pad, l, which, D(0, 1)).d;
      const double h = steps[which];
      const double by_difference =
          (shifted_depth(pad, l, which, h) - shifted_depth(pad, l, which, -h)) / (2 * h);
      RC_ASSERT(test::relative_error(by_dual, by_difference) <= 1e-6);
    }
  });
}

TEST_CASE("the estimator takes g of each pixel", "[depth]") {
  const Pad pad;
  const auto depth = pad.pressed_depths(3);
  auto reference = pad.reference<double>();
  auto frame = pad.frame<double>(depth);
  test::Random random(7);
  for (Index i = 0; i < pad.rows; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      if (reference.in_pad(i, j)) {
        double& g = reference.scattering[static_cast<std::size_t>(i * pad.cols + j)];
        g = pad.scattering * random.uniform(0.7, 1.3);
        const auto c = colour_at_depth(pad.fluid, pad.pencil(i, j), 57.0, g, depth(i, j));
        frame.red(i, j) = c.red;
        frame.green(i, j) = c.green;
      }
    }
  }
  DepthEstimator<double> estimator(pad.camera, pad.fluid, reference, {.window_px = 1});
  CHECK(test::largest_error(test::estimate(estimator, frame).depth_mm, depth) <= 1e-10);
  // a pixel without g has no depth
  reference.scattering[static_cast<std::size_t>(24 * pad.cols + 28)] = 0;
  DepthEstimator<double> without(pad.camera, pad.fluid, reference, {.window_px = 1});
  const auto e = test::estimate(without, frame);
  CHECK(e.status(24, 28) == PixelStatus::outside_pad);
  CHECK(e.result.pad_pixels == test::estimate(estimator, frame).result.pad_pixels - 1);
  CHECK(e.result.valid_pixels() == e.result.pad_pixels);
}

TEST_CASE("a pixel without a gain of red is not used", "[depth]") {
  const Pad pad;
  auto reference = pad.reference<float>();
  reference.red_gain.assign(reference.depth_mm.size(), 1.0F);
  const auto frame = pad.frame<std::uint8_t>(pad.pressed_depths(3), 1, 5);
  for (const double bad : {test::nan, 0.0, -1.0, HUGE_VAL}) {
    reference.red_gain[static_cast<std::size_t>(24 * pad.cols + 28)] = static_cast<float>(bad);
    for (const int window_px : {1, 29}) {
      DepthEstimator<> estimator(pad.camera, pad.fluid, reference, {.window_px = window_px});
      const auto e = test::estimate(estimator, frame);
      CHECK(e.status(24, 28) == PixelStatus::outside_pad);
      CHECK(is_finite(e.depth_mm(24, 29)));
    }
  }
}

TEMPLATE_TEST_CASE("pixels that are higher or lower than wide, and a lens",
                   "[depth]",
                   float,
                   double) {
  using S = TestType;
  Pad pad;
  const auto [aspect, cols] = GENERATE(std::pair(0.5, 56), std::pair(1.3, 56), std::pair(2.0, 16));
  pad.camera.pixel_aspect = aspect;
  pad.camera.distortion_k1 = GENERATE(0.0, -0.06);
  pad.rows = static_cast<Index>(48 / aspect);
  pad.cols = cols;  // of the last, only a strip of the pad is in the image
  pad.camera.center_x_px = static_cast<double>(pad.cols - 1) / 2;
  pad.camera.center_y_px = static_cast<double>(pad.rows - 1) / 2;
  const auto free = pad.free_depths();
  const auto pressed = pad.pressed_depths(3);
  const double bound = std::is_same_v<S, float> ? 5e-5 : 1e-10;
  const auto reference = pad.reference<S>();
  for (const auto& [depth, window_px] :
       {std::pair(&pressed, 1), std::pair(&free, 1), std::pair(&free, 9)}) {
    CAPTURE(aspect, window_px);
    DepthEstimator<S> estimator(pad.camera, pad.fluid, reference, {.window_px = window_px});
    const auto e = test::estimate(estimator, pad.frame<S>(*depth));
    CHECK(test::largest_error(e.depth_mm, *depth) <= bound);
    CHECK(e.result.ok());
    CHECK(e.result.valid_pixels() == e.result.pad_pixels);
  }
  // as square pixels, the rays are others
  Camera<double> square_pixels = pad.camera;
  square_pixels.pixel_aspect = 1;
  DepthEstimator<S> wrong(square_pixels, pad.fluid, reference, {.window_px = 1});
  CHECK_FALSE(test::largest_error(test::estimate(wrong, pad.frame<S>(pressed)).depth_mm, pressed) <
              0.02);
}

TEST_CASE("an estimator refuses what cannot be, and says why", "[depth]") {
  const Pad pad;
  const auto reference = pad.reference<float>();
  using Catch::Matchers::StartsWith;
  const auto with_camera = [&](auto change) {
    Camera<double> camera = pad.camera;
    change(camera);
    return refusal([&] { DepthEstimator<>(camera, pad.fluid, reference); });
  };
  CHECK_THAT(with_camera([](auto& c) { c.refractive_index = 0.9; }),
             StartsWith("Camera: refractive_index = 0.9, must be"));
  CHECK_THAT(with_camera([](auto& c) { c.pitch_mm = 0; }), StartsWith("Camera: pitch_mm = 0"));
  CHECK_THAT(with_camera([](auto& c) { c.center_x_px = test::nan; }),
             StartsWith("Camera: center_x_px = nan"));
  const auto with_fluid = [&](auto change) {
    Absorption<double> fluid = pad.fluid;
    change(fluid);
    return refusal([&] { DepthEstimator<>(pad.camera, fluid, reference); });
  };
  CHECK_THAT(with_fluid([](auto& f) { f.c_red_per_mm = 0; }),
             StartsWith("Absorption: c_red_per_mm = 0, must be finite and > 0"));
  CHECK_THAT(with_fluid([](auto& f) { f.c_green_per_mm = 0.01; }),
             StartsWith("Absorption: c_green_per_mm = 0.01, must be finite and >= 0.029"));
  CHECK_THAT(with_fluid([](auto& f) { f.kappa = -1; }), StartsWith("Absorption: kappa = -1"));
  CHECK_THAT(with_fluid([](auto& f) { f.max_depth_mm = test::nan; }),
             StartsWith("Absorption: max_depth_mm = nan"));
  CHECK_THAT(refusal([&] { DepthEstimator<>(pad.camera, pad.fluid, DepthReference<float>()); }),
             StartsWith("DepthEstimator: rows = 0, must be in [1, 1000000]"));
  const auto with_options = [&](const DepthOptions& options) {
    return refusal([&] { DepthEstimator<>(pad.camera, pad.fluid, reference, options); });
  };
  for (const int window_px : {-3, 0, 2, 4, 28, 110, 111}) {
    CHECK(with_options({.window_px = window_px}) ==
          "DepthOptions: window_px = " + std::to_string(window_px) + ", must be odd, in [1, 109]");
  }
  for (const int window_px : {1, 3, 109}) {  // the last is larger than the image
    CHECK(with_options({.window_px = window_px}) == "accepted");
  }
  // the limit is on window_px / step
  CHECK(with_options({.window_px = 327, .step = 3}) == "accepted");
  CHECK(with_options({.window_px = 329, .step = 3}) ==
        "DepthOptions: window_px = 329, must be odd, in [1, 327]");
  for (const int step : {-1, 0, 17}) {
    CHECK(with_options({.step = step}) ==
          "DepthOptions: step = " + std::to_string(step) + ", must be in [1, 16]");
  }
  const auto with_reference = [&](auto change) {
    DepthReference<float> other = reference;
    change(other);
    return refusal([&] { DepthEstimator<>(pad.camera, pad.fluid, other); });
  };
  const char* planes = "DepthEstimator: reference.pixels_used = ";
  CHECK_THAT(with_reference([](auto& r) { r.depth_mm.pop_back(); }), StartsWith(planes));
  CHECK_THAT(with_reference([](auto& r) { r.scattering.clear(); }), StartsWith(planes));
  CHECK_THAT(with_reference([](auto& r) { r.red_gain.push_back(1); }), StartsWith(planes));
  CHECK_THAT(with_reference([](auto& r) { r.pixels_used = 0; }), StartsWith(planes));
  CHECK(refusal([&] { DepthEstimator<>(pad.camera, pad.fluid, reference); }) == "accepted");
}

namespace {

namespace bound_mm {
constexpr double bisection = 14.0 / 32768 + 1e-9;  // its half-width, 16 halvings of 14 mm
constexpr double newton = 1e-10;                   // roundoff of g, of the rays and of the colours
constexpr double polynomial = 1e-9;                // wider cameras need more powers of u
// Single floats of up to 60 grey levels (spacing 3.8e-6) where F rises by more than 1 level per mm.
constexpr double single = 2e-4;
constexpr double anchored_8_bit = 1e-3;  // 1/128 of a grey level, the step of the stored residuals
}  // namespace bound_mm

/// Any camera, fluid and pad; small, so that hundreds of them are fast.
Pad any_pad() {
  Pad pad;
  pad.rows = test::whole(14, 26);
  pad.cols = test::whole(14, 26);
  pad.camera.plate_distance_mm = test::uniform(40, 100);
  pad.camera.refractive_index = test::uniform(1.2, 1.6);
  pad.camera.pitch_mm = test::uniform(1.2, 2);
  pad.camera.center_x_px = static_cast<double>(pad.cols) / 2 + test::uniform(-2, 1);
  pad.camera.center_y_px = static_cast<double>(pad.rows) / 2 + test::uniform(-2, 1);
  pad.camera.plate_thickness_mm = test::whole(0, 1) == 0 ? 0 : test::uniform(0, 10);
  pad.fluid.c_red_per_mm = test::uniform(0.02, 0.04);
  pad.fluid.c_green_per_mm =
      pad.fluid.c_red_per_mm + (test::whole(0, 3) == 0 ? 0 : test::uniform(0, 0.01));
  pad.fluid.kappa = test::uniform(0.8, 1.2);
  // Only g h^2 matters: the light scattered back stays between a few and some 50 grey levels.
  const double h = pad.camera.refractive_index * pad.camera.plate_distance_mm;
  pad.scattering = test::uniform(0.008, 0.02) * square(66.5 / h);
  pad.scattering_loss = test::uniform(0, 0.1);
  pad.brightness = test::uniform(30, 60);
  pad.height_mm = test::uniform(6, 13.5);
  return pad;
}

/// Depth of each pixel by itself, by polynomials.
template <class S>
struct Rows {
  using Scalar = S;
  static constexpr bool one_height = false;
  static constexpr double bound =
      std::is_same_v<S, float> ? bound_mm::single : bound_mm::polynomial;

  static Image<S> depth_of(const Pad& pad, const Frame<S>& frame) {
    auto e = test::estimate(pad.estimator<S>({.window_px = 1}), frame);
    RC_ASSERT(e.result.status != FrameStatus::refused);
    return e.depth_mm;
  }
};

/// The same by Newton's method.
template <class S>
struct Newton {
  using Scalar = S;
  static constexpr bool one_height = false;
  static constexpr double bound = std::is_same_v<S, float> ? bound_mm::single : bound_mm::newton;

  static Image<S> depth_of(const Pad& pad, const Frame<S>& frame) {
    Image<S> depth(pad.rows, pad.cols, not_a_number<S>());
    const auto reference = pad.reference<S>();
    for (Index i = 0; i < pad.rows; ++i) {
      for (Index j = 0; j < pad.cols; ++j) {
        if (reference.in_pad(i, j)) {
          const auto light = pad.pencil(i, j);
          depth(i, j) =
              newton_depth(cast<S>(pad.fluid),
                           Ray<S>{.path_factor = S(light.path_factor),
                                  .meridional_mm = S(light.meridional_mm),
                                  .sagittal_mm = S(light.sagittal_mm)},
                           reference.g(i, j), Colour<S>{frame.red(i, j), frame.green(i, j)})
                  .depth_mm;
        }
      }
    }
    return depth;
  }
};

/// As printed. It has no plate, and takes one height for both directions of a pencil.
struct Printed {
  using Scalar = double;
  static constexpr bool one_height = true;
  static constexpr double bound = bound_mm::bisection;

  static Image<double> depth_of(const Pad& pad, const Frame<double>& frame) {
    const auto free = pad.free_depths();
    const auto free_frame = pad.frame<double>(free);
    published::DepthEstimator<> estimator(pad.published(1), free_frame.red, free_frame.green, free);
    Image<double> depth(pad.rows, pad.cols);
    RC_ASSERT(estimator(frame.red, frame.green, depth));
    return depth;
  }
};

/// A pad that the way can see.
template <class Way>
Pad any_pad_of() {
  Pad pad = any_pad();
  pad.one_height = Way::one_height;
  pad.camera.plate_thickness_mm = Way::one_height ? 0 : pad.camera.plate_thickness_mm;
  return pad;
}

/// Makes some pixels dark, saturated or, if the type allows it, NaN.
template <class Pixel>
void spoil(Frame<Pixel>& frame, int share) {
  for (Index i = 0; i < frame.red.rows(); ++i) {
    for (Index j = 0; j < frame.red.cols(); ++j) {
      if (test::whole(0, 99) >= share) {
        continue;
      }
      Pixel bad = Pixel(0);
      const auto kind = test::whole(0, 2);
      if (kind == 1) {
        bad = test::stored<Pixel>(255);
      } else if (kind == 2 && !std::is_integral_v<Pixel>) {
        bad = static_cast<Pixel>(test::nan);
      }
      (test::whole(0, 1) == 0 ? frame.red : frame.green)(i, j) = bad;
    }
  }
}

template <class Pixel, class Turn>
Frame<Pixel> rotated(const Frame<Pixel>& frame, const Turn& turn) {
  Frame<Pixel> out(0, 0);
  out.red = turn(frame.red);
  out.green = turn(frame.green);
  return out;
}

/// Largest difference; infinite where only one is NaN.
template <class S>
double difference(const Image<S>& a, const Image<S>& b) {
  return (std::max)(test::largest_error(a, b), test::largest_error(b, a));
}

}  // namespace

TEMPLATE_TEST_CASE("what the forward model shows, the inverse finds",
                   "[depth][law]",
                   Rows<float>,
                   Rows<double>,
                   Newton<float>,
                   Newton<double>,
                   Printed) {
  rc::prop("on random sensors, with printed dots", [] {
    using S = typename TestType::Scalar;
    const Pad pad = any_pad_of<TestType>();
    const auto depth = pad.pressed_depths(test::uniform(0, 5));
    const auto found = TestType::depth_of(pad, pad.frame<S>(depth));
    RC_ASSERT(test::largest_error(found, depth) <= TestType::bound);
  });
}

TEMPLATE_TEST_CASE("the membrane's brightness does not matter",
                   "[depth][law]",
                   Rows<double>,
                   Newton<double>,
                   Printed) {
  rc::prop("pixel by pixel", [] {
    const Pad pad = any_pad_of<TestType>();
    const auto depth = pad.pressed_depths(test::uniform(0, 5));
    Frame<double> frame(pad.rows, pad.cols);
    const double low = test::uniform(1, 40);  // at most tripled, so nothing saturates
    for (Index i = 0; i < pad.rows; ++i) {
      for (Index j = 0; j < pad.cols; ++j) {
        const double bright = low * (1 + static_cast<double>((7 * i + 3 * j) % 5) / 2);
        const auto c = pad.colour(i, j, depth(i, j) == depth(i, j) ? depth(i, j) : 1.0, bright);
        frame.red(i, j) = c.red;
        frame.green(i, j) = c.green;
      }
    }
    const auto found = TestType::depth_of(pad, frame);
    RC_ASSERT(test::largest_error(found, depth) <= 3 * TestType::bound);
  });
}

TEST_CASE("units do not matter", "[depth][law]") {
  const auto depth_of = [](const Pad& pad, const Frame<double>& frame) {
    const auto free = pad.free_depths();
    const auto free_frame = pad.frame<double>(free);
    const auto reference =
        fit_reference<double>(pad.camera, pad.fluid, free_frame.red, free_frame.green, free);
    DepthEstimator<double> estimator(pad.camera, pad.fluid, reference, {.window_px = 3});
    return test::estimate(estimator, frame).depth_mm;
  };
  rc::prop("lengths times a, absorption and scattering divided: depth times a", [&] {
    const Pad pad = any_pad();
    const double a = test::log_uniform(0.1, 10);
    Pad large = pad;
    large.camera.plate_distance_mm *= a;
    large.camera.pitch_mm *= a;
    large.camera.plate_thickness_mm *= a;
    large.sphere_radius_mm *= a;
    large.height_mm *= a;
    large.fluid.c_red_per_mm /= a;
    large.fluid.c_green_per_mm /= a;
    large.fluid.max_depth_mm *= a;
    large.scattering /= a * a;
    const double press = test::uniform(0, 5);
    auto expected = depth_of(pad, pad.frame<double>(pad.pressed_depths(press)));
    for (double& l : expected.cells) {
      l *= a;
    }
    const auto frame = large.frame<double>(large.pressed_depths(a * press));
    RC_ASSERT(difference(depth_of(large, frame), expected) <= a * bound_mm::newton);
  });
}

TEMPLATE_TEST_CASE("a mirrored or transposed frame gives the mirrored or transposed depth",
                   "[depth][law]",
                   std::uint8_t,
                   std::uint16_t,
                   float) {
  rc::prop("when the camera's center goes with it", [] {
    using Pixel = TestType;
    const Pad pad = any_pad();
    auto frame = pad.frame<Pixel>(pad.pressed_depths(test::uniform(0, 5)), 1, 7);
    spoil(frame, 10);
    const auto depth_of = [&](const Pad& p, const Frame<Pixel>& f) {
      return test::estimate(p.estimator<float>({.window_px = 5}), f).depth_mm;
    };
    const auto depth = depth_of(pad, frame);
    Pad mirror = pad;
    mirror.camera.center_x_px = static_cast<double>(pad.cols - 1) - pad.camera.center_x_px;
    // the reference's depths differ by roundoff and, in 8 bit, so does the step of storage
    const auto flip = [](const auto& image) { return mirrored(image); };
    RC_ASSERT(difference(depth_of(mirror, rotated(frame, flip)), mirrored(depth)) <=
              bound_mm::anchored_8_bit);
    Pad turn = pad;
    std::swap(turn.rows, turn.cols);
    std::swap(turn.camera.center_x_px, turn.camera.center_y_px);
    const auto swap = [](const auto& image) { return transposed(image); };
    RC_ASSERT(difference(depth_of(turn, rotated(frame, swap)), transposed(depth)) <=
              bound_mm::anchored_8_bit);
  });
}

namespace {

template <class P, class S>
struct Kind {
  using Pixel = P;
  using Scalar = S;
};

}  // namespace

TEMPLATE_TEST_CASE("the counts are those of the statuses, and only ok comes with a number",
                   "[depth][law]",
                   (Kind<std::uint8_t, float>),
                   (Kind<std::uint16_t, float>),
                   (Kind<float, float>),
                   (Kind<std::uint8_t, double>),
                   (Kind<double, double>)) {
  rc::prop("for any frame", [] {
    using S = typename TestType::Scalar;
    using Pixel = typename TestType::Pixel;
    Pad pad = any_pad();
    pad.rows += test::whole(0, 50);
    auto frame = pad.frame<Pixel>(pad.pressed_depths(test::uniform(0, 5)), 1, 3);
    spoil(frame, static_cast<int>(test::whole(0, 40)));
    const int window_px = 1 + 2 * static_cast<int>(test::whole(0, 10));
    auto estimator = pad.estimator<S>({.window_px = window_px});
    const auto whole = test::estimate(estimator, frame);

    std::array<Index, pixel_status_count> seen = {};
    Index numbers = 0;
    for (std::size_t k = 0; k < whole.status.cells.size(); ++k) {
      ++seen[static_cast<std::size_t>(whole.status.cells[k])];
      numbers += is_finite(whole.depth_mm.cells[k]) ? 1 : 0;
    }
    RC_ASSERT(seen == whole.result.count);
    RC_ASSERT(numbers == whole.result.valid_pixels());
  });
}

namespace {

namespace bound_mm {
constexpr double newton_double = 1e-12;  // documented for newton_depth()
// A float colour of 57 grey levels has a resolution of 3.8e-6; F rises by at least 1.3 grey levels
// per mm and is itself rounded to a few such units.
constexpr double newton_float = 2e-5;
constexpr double polynomial_double = 1e-12;  // documented for detail::DepthPolynomial
constexpr double polynomial_float = 1e-5;
constexpr double smallest = 1e-6;
constexpr double deepest = 14;
}  // namespace bound_mm

/// The published numbers; delta from 0 to the published 0.0046 per mm.
Absorption<double> fluid_with(double delta_per_mm, double max_depth_mm = 18) {
  Absorption<double> fluid;
  fluid.c_green_per_mm = fluid.c_red_per_mm + delta_per_mm;
  fluid.max_depth_mm = max_depth_mm;
  return fluid;
}
const double published_delta =
    Absorption<double>().c_green_per_mm - Absorption<double>().c_red_per_mm;
const std::vector<double> deltas = {0, 1e-4, published_delta};
constexpr double brightness = 57;
constexpr double scattering = 0.0163;

/// One row of pixels from the axis to the rim of a pad with a base radius of 18.735 mm.
constexpr Index pixels_to_rim = 235;
Camera<double> camera_at_corner() {
  Camera<double> camera;
  camera.center_x_px = 0;
  camera.center_y_px = 0;
  return camera;
}

template <class S>
Ray<S> as(const Ray<double>& p) {
  return {.path_factor = S(p.path_factor),
          .meridional_mm = S(p.meridional_mm),
          .sagittal_mm = S(p.sagittal_mm)};
}

/// F in the slides' closed form, independent of the library's series.
struct ExactEquation {
  Digits50 c, delta, k, product, sum, kappa_red, green, g;

  template <class S>
  ExactEquation(const Absorption<S>& fluid,
                const Ray<Digits50>& p,
                const Digits50& scatter,
                const Colour<S>& colour)
      : c(fluid.c_red_per_mm),
        delta(Digits50(fluid.c_green_per_mm) - Digits50(fluid.c_red_per_mm)),
        k(p.path_factor),
        product(p.meridional_mm * p.sagittal_mm),
        sum(p.meridional_mm + p.sagittal_mm),
        kappa_red(Digits50(fluid.kappa) * Digits50(colour.red)),
        green(colour.green),
        g(scatter) {}

  /// From a depth with an error of about 1e-3 mm, five Newton steps give fifty digits.
  Digits50 root(double near) const {
    const Digits50 ck = c * k;
    const Digits50 q1 = (product + (sum + 2 / ck) / ck) / k;
    Digits50 l(near);
    for (int step = 0; step < 5; ++step) {
      const Digits50 decay = exp(Digits50(-ck * l));
      const Digits50 membrane = green * exp(Digits50(delta * k * l));
      const Digits50 q2 = (l * l + sum * l + 2 * l / ck) / k;
      const Digits50 scatter_slope = c * (l * l + sum * l + product) * decay;
      const Digits50 value = membrane - kappa_red + g * (q1 * (1 - decay) - q2 * decay);
      l = l - value / (membrane * delta * k + g * scatter_slope);
    }
    return l;
  }
};

template <class S>
double error_mm(const S& depth, const Digits50& exact) {
  return static_cast<double>(abs(Digits50(Digits50(depth) - exact)));
}

/// Colours in S of a pixel at depth l, and the exact root for these colours.
template <class S>
struct Pixel {
  Absorption<S> fluid;
  Ray<double> light;
  S g;
  Colour<S> colour;
  Digits50 exact;

  Pixel(const Absorption<double>& f, double rho_px, double l, double bright = brightness)
      : fluid(cast<S>(f)) {
    const auto camera = camera_at_corner();
    light = ray_at_pixel(camera, 0.0, rho_px);
    // rounding of the pencil is no error of the solver
    light = as<double>(Ray<double>{.path_factor = static_cast<double>(S(light.path_factor)),
                                   .meridional_mm = static_cast<double>(S(light.meridional_mm)),
                                   .sagittal_mm = static_cast<double>(S(light.sagittal_mm))});
    g = S(scattering);
    const auto c = colour_at_depth(f, light, bright, scattering, l);
    colour = {S(c.red), S(c.green)};
    exact = ExactEquation(fluid, as<Digits50>(light), Digits50(g), colour).root(l);
  }
};

/// Depths from 1e-6 to 14 mm, dense at both ends of the scale.
std::vector<double> depths() {
  std::vector<double> l;
  for (double x = bound_mm::smallest; x < 1; x *= 30) {
    l.push_back(x);
  }
  for (double x = 1; x < bound_mm::deepest; x += 3.25) {
    l.push_back(x);
  }
  l.push_back(bound_mm::deepest);
  return l;
}

/// Worst error of a solver over all deltas, radii and depths.
template <class S, class Solve>
double worst_error(const Solve& solve, double bright = brightness) {
  double worst = 0;
  for (const double delta : deltas) {
    for (double rho = 0; rho <= static_cast<double>(pixels_to_rim); rho += 78) {
      for (const double l : depths()) {
        const Pixel<S> p(fluid_with(delta), rho, l, bright);
        const DepthRoot<S> root = solve(p.fluid, as<S>(p.light), p.g, p.colour);
        if (root.status == PixelStatus::below_range && p.exact < 2 * bound_mm::newton_float) {
          continue;  // a float colour cannot resolve such a depth
        }
        const double error =
            root.status == PixelStatus::ok ? error_mm(root.depth_mm, p.exact) : HUGE_VAL;
        worst = (std::max)(worst, error);
      }
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("Newton's depth is the root to roundoff", "[depth]") {
  const auto solve = [](const auto& fluid, const auto& light, const auto& g, const auto& colour) {
    return newton_depth(fluid, light, g, colour);
  };
  CHECK(worst_error<double>(solve) <= bound_mm::newton_double);
  CHECK(worst_error<double>(solve, 0.4 * brightness) <= bound_mm::newton_double);
  CHECK(worst_error<float>(solve) <= bound_mm::newton_float);
  rc::prop("at random depth, radius and difference of absorption", [] {
    const double delta = test::whole(0, 4) == 0 ? 0 : test::log_uniform(1e-12, published_delta);
    const double l = test::log_uniform(bound_mm::smallest, bound_mm::deepest);
    const Pixel<double> p(fluid_with(delta), test::uniform(0, 235), l);
    const auto root = newton_depth(p.fluid, p.light, p.g, p.colour);
    RC_ASSERT(root.status == PixelStatus::ok);
    RC_ASSERT(error_mm(root.depth_mm, p.exact) <= bound_mm::newton_double);
  });
}

TEST_CASE("Newton's depth also has no bound of its own in 50 digits", "[depth]") {
  const Pixel<Digits50> p(fluid_with(published_delta), 100, 6);
  const auto root = newton_depth(p.fluid, as<Digits50>(p.light), p.g, p.colour);
  CHECK(error_mm(root.depth_mm, p.exact) <= 1e-44);
}

namespace {

/// One pixel in one row, in a block of others.
template <class S>
DepthRoot<S> in_a_block(
    const detail::DepthPolynomial<S>& rows, int col, S red, S green, const S& per_g) {
  constexpr auto n = static_cast<std::size_t>(detail::DepthPolynomial<S>::block);
  const std::vector<S> reds(n, red), greens(n, green), all_per_g(n, per_g);
  std::vector<S> depth(n, S(-1));
  std::vector<PixelStatus> status(n);
  rows.invert(0, col, reds.data(), greens.data(), all_per_g.data(), depth.data(), status.data());
  return {depth[0], status[0]};
}

}  // namespace

TEST_CASE("a depth beyond either end of the range is refused, never clamped", "[depth]") {
  const auto fluid = fluid_with(published_delta, 10);
  const detail::DepthPolynomial<double> rows(camera_at_corner(), fluid, 235, scattering);
  const auto expect = [&](const Pixel<double>& p, PixelStatus status, bool by_rows = true) {
    std::vector<DepthRoot<double>> roots{newton_depth(p.fluid, p.light, p.g, p.colour)};
    if (by_rows) {
      roots.push_back(in_a_block(rows, 100, p.colour.red, p.colour.green, 1 / p.g));
    }
    for (const auto& root : roots) {
      CHECK(root.status == status);
      CHECK(is_finite(root.depth_mm) == (status == PixelStatus::ok));
    }
  };
  expect(Pixel<double>(fluid, 100, 10 - 1e-9), PixelStatus::ok);
  expect(Pixel<double>(fluid, 100, 10 + 1e-9), PixelStatus::above_range);
  expect(Pixel<double>(fluid, 100, 17), PixelStatus::above_range);
  expect(Pixel<double>(fluid, 100, 1e-9), PixelStatus::ok);

  Pixel<double> p(fluid, 100, 5);
  const Colour<double> good = p.colour;
  const double infinity = std::numeric_limits<double>::infinity();
  p.colour.green = p.fluid.kappa * good.red;  // exactly at depth 0
  expect(p, PixelStatus::ok);
  p.colour.green *= 1 + 1e-12;
  expect(p, PixelStatus::below_range);
  for (const double bad : {not_a_number<double>(), infinity, -infinity}) {
    // the rows are given no infinite colour: a window leaves such pixels out
    p.colour = {bad, good.green};
    expect(p, PixelStatus::not_a_number, bad != bad);
    p.colour = {good.red, bad};
    expect(p, PixelStatus::not_a_number, bad != bad);
    p.colour = good;
    p.g = bad;
    expect(p, PixelStatus::not_a_number, false);
    p.g = scattering;
  }
  expect(p, PixelStatus::ok);
}

namespace {

/// One row of pixels from the axis to the rim, all at one depth.
template <class S>
class RowSolver {
 public:
  explicit RowSolver(const Absorption<double>& fluid)
      : fluid_(fluid), rows_(camera_at_corner(), fluid, pixels_to_rim, scattering) {}

  /// Worst error with all pixels at depth l.
  double error(double l, double bright) const {
    const auto camera = camera_at_corner();
    const S per_g = S(1) / S(scattering);
    const auto g = static_cast<double>(S(scattering));
    double worst = 0;
    for (int j = 0; j < static_cast<int>(pixels_to_rim); j += 39) {
      const auto light = ray_at_pixel(camera, 0.0, static_cast<double>(j));
      const auto c = colour_at_depth(fluid_, light, bright, g, l);
      const Colour<S> rounded{S(c.red), S(c.green)};
      const auto root = in_a_block(rows_, j, rounded.red, rounded.green, per_g);
      const ExactEquation f(
          fluid_, as<Digits50>(light), Digits50(g),
          Colour<double>{static_cast<double>(rounded.red), static_cast<double>(rounded.green)});
      const Digits50 exact = f.root(l);
      if (root.status == PixelStatus::below_range && exact < 2 * bound_mm::newton_float) {
        continue;
      }
      worst = (std::max)(
          worst, root.status == PixelStatus::ok ? error_mm(root.depth_mm, exact) : HUGE_VAL);
    }
    return worst;
  }

  double worst(double bright) const {
    double worst = 0;
    for (const double l : depths()) {
      worst = (std::max)(worst, error(l, bright));
    }
    return worst;
  }

 private:
  Absorption<double> fluid_;
  detail::DepthPolynomial<S> rows_;
};

/// Worst error over all differences of absorption, for membranes of the published brightness and
/// darker.
template <class S>
double worst_of_rows(double max_depth_mm) {
  double worst = 0;
  for (const double delta : deltas) {
    const RowSolver<S> solver(fluid_with(delta, max_depth_mm));
    for (const double bright : {brightness, 0.4 * brightness}) {
      worst = (std::max)(worst, solver.worst(bright));
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("depth by polynomials, for ranges of 14.5 and 18 mm", "[depth]") {
  const double max_depth_mm = GENERATE(14.5, 18.0);
  const double single = worst_of_rows<float>(max_depth_mm);
  const double twice = worst_of_rows<double>(max_depth_mm);
  CAPTURE(max_depth_mm, single, twice);
  CHECK(single <= bound_mm::polynomial_float);
  CHECK(twice <= bound_mm::polynomial_double);
}

TEST_CASE("unchanged: reference and depth of noisy frames", "[unchanged]") {
  const test::Pad pad = test::pad_of(120, 140, 0.32);
  auto free = pad.frame<std::uint8_t>(pad.free_depths(), 1, 3);
  for (Index j = 50; j < 60; ++j) {
    free.red(40, j) = 255;  // glare
  }
  const auto reference =
      fit_reference(pad.camera, pad.fluid, free.red, free.green, pad.free_depths());
  auto depths = pad.free_depths();
  for (double& l : depths.cells) {
    l = std::fmin(l, 9.0);
  }
  auto frame = pad.frame<std::uint8_t>(depths, 1, 4);
  frame.green(60, 70) = 0;
  frame.red(61, 20) = 255;
  test::Digest d;
  for (const int window_px : {1, 9, 21}) {
    DepthEstimator<float> estimate(pad.camera, pad.fluid, reference, {.window_px = window_px});
    Image<float> depth_mm(120, 140);
    Image<PixelStatus> status(120, 140);
    d.add(estimate(frame.red, frame.green, depth_mm, status).status);
    d.all(depth_mm, status);
  }
  for (std::size_t k = 0; k < reference.scattering.size(); k += 7) {
    d.all(reference.scattering[k], reference.green[k]);
  }
  CHECK(d.sum() == test::same(2284424.805));
}
