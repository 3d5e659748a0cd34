// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdio>
#include <string>

#include "fingerpad/depth/depth_reference.hpp"
#include "fingerpad/published/depth.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Frame;
using test::Image;
using test::Pad;

namespace {

/// Largest relative error of g where the reference knows the pad.
template <class Reference>
double worst_g(const Pad& pad, const Reference& reference) {
  double worst = 0;
  for (Index i = 0; i < pad.rows; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      if (reference.in_pad(i, j)) {
        const double rho = pad.ray(i, j).plate_rho_mm;
        using S = std::remove_cvref_t<decltype(reference.residual_rms)>;
        const auto g = static_cast<double>(reference.scattering(i, j, S(rho * rho)));
        worst = (std::max)(worst, std::abs(g / pad.g(i, j) - 1));
      }
    }
  }
  return worst;
}

std::string refusal(const auto& make) {
  try {
    make();
  } catch (const parameter_error& e) {
    return e.what();
  }
  return "accepted";
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
  // The error of g of one pixel is about 2.3 % at 1 mm and 0.24 % at 12 mm per 0.034 grey levels.
  // One level over 1500 pixels and four coefficients leaves 0.3 % on average, and a few times that
  // at the rim, where g matters least.
  const Pad pad;
  const auto depth = pad.free_depths();
  double inner = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto frame = pad.frame<std::uint8_t>(depth, 1, seed);
    const auto reference = fit_reference(pad.camera, pad.fluid, frame.red, frame.green, depth);
    // 1 level of noise in red and green and the steps of 8 bit: 1.04 sqrt(kappa^2 + 1.07^2)
    CHECK(reference.residual_rms == Approx(1.5).epsilon(0.1));
    CHECK(worst_g(pad, reference) <= 0.2);
    for (Index j = 20; j < 36; ++j) {
      const double rho = pad.ray(24, j).plate_rho_mm;
      const auto g = static_cast<double>(reference.scattering(24, j, float(rho * rho)));
      inner = (std::max)(inner, std::abs(g / pad.g(24, j) - 1));
    }
  }
  CHECK(inner <= 0.02);
}

TEST_CASE("the pixel quotient is the published formula", "[reference]") {
  const Pad pad;
  const auto depth = pad.free_depths();
  const auto frame = pad.frame<double>(depth, 0.5, 3);
  const auto reference = published::depth_reference<double>(pad.camera, pad.fluid, frame.red,
                                                            frame.green, depth, NoSmoothing{});
  double worst = 0;
  for (Index i = 0; i < pad.rows; ++i) {
    for (Index j = 0; j < pad.cols; ++j) {
      const double g = reference.scattering(i, j, 0.0);
      REQUIRE((g == g) == (depth(i, j) > 0));
      if (g == g) {
        const double expected =
            published::quotient(pad.fluid, pad.pencil<published::SingleHeight>(i, j),
                                Colour<double>{frame.red(i, j), frame.green(i, j)}, depth(i, j));
        // (near the rim the published form itself cancels)
        if (depth(i, j) > 0.5) {
          worst = (std::max)(worst, std::abs(g / expected - 1));
        }
      }
    }
  }
  CHECK(worst <= 1e-9);
}

TEST_CASE("an estimator with the pixel quotient finds the depth it was made from", "[reference]") {
  const Pad pad;
  const auto depth = pad.free_depths();
  const auto frame = pad.frame<double>(depth);
  const auto check = [&](auto s, auto inverse, double bound_mm) {
    using S = decltype(s);
    const auto reference = published::depth_reference<S, AstigmaticHeights>(
        pad.camera, pad.fluid, frame.red, frame.green, depth, NoSmoothing{});
    const DepthEstimator estimator(pad.camera, pad.fluid, reference, NoSmoothing{}, inverse);
    const auto pressed = pad.pressed_depths(3);
    const auto e = test::estimate<S>(estimator, pad.frame<double>(pressed));
    CHECK(test::largest_error(e.depth_mm, pressed) <= bound_mm);
  };
  check(double(), Newton(), 1e-10);
  check(double(), ExponentialFree<9, 12, 8>(), 1e-10);
  check(float(), ExponentialFree<>(), 5e-5);
}

TEST_CASE("averaged alike, the reference frame itself has the free pad's depth", "[reference]") {
  const Pad pad;
  const auto depth = pad.free_depths();
  const auto frame = pad.frame<std::uint8_t>(depth, 1, 3);
  const auto error_with = [&](const auto& smoothing) {
    const auto reference = published::depth_reference<double>(pad.camera, pad.fluid, frame.red,
                                                              frame.green, depth, smoothing);
    const DepthEstimator estimator(pad.camera, pad.fluid, reference, published::BoxMean{9},
                                   Newton());
    const auto e = test::estimate<double>(estimator, frame);
    double worst = 0;
    for (std::size_t k = 0; k < depth.cells.size(); ++k) {
      if (depth.cells[k] > 2) {
        worst = (std::max)(worst, std::abs(e.depth_mm.cells[k] - depth.cells[k]));
      }
    }
    return worst;
  };
  CHECK(error_with(published::BoxMean{9}) < 1e-10);
  CHECK_FALSE(error_with(NoSmoothing{}) < 0.5);
}

TEST_CASE("the units of the grey scale do not matter", "[reference]") {
  const Pad pad;
  const auto depth = pad.free_depths();
  auto frame = pad.frame<double>(depth, 1, 2);
  const auto once = fit_reference(pad.camera, pad.fluid, frame.red, frame.green, depth);
  for (auto* channel : {&frame.red, &frame.green}) {
    for (double& x : channel->cells) {
      x *= 64;
    }
  }
  const auto other = fit_reference(pad.camera, pad.fluid, frame.red, frame.green, depth,
                                   GreyScale{64, 0, 255 * 64});
  CHECK(once.scattering.coefficient == other.scattering.coefficient);
  CHECK(once.residual_rms == other.residual_rms);
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
  const std::string refused = "fit_reference: pixels with a known depth = ";
  CHECK(fit(depth) == "accepted");
  CHECK_THAT(fit(Image<double>(pad.rows, pad.cols, test::nan)), StartsWith(refused + "0"));
  CHECK_THAT(fit(Image<double>(pad.rows, pad.cols, 0)), StartsWith("fit_reference: deepest"));
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
  const Image<double> nothing(pad.rows, pad.cols, test::nan);
  CHECK_THAT(refusal([&] {
               published::depth_reference(pad.camera, pad.fluid, frame.red, frame.green, nothing);
             }),
             StartsWith("depth_reference: pixels with a known depth = 0"));
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
    return detail::shape_of_free_pad(camera, 14, depth).off_axis;
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
