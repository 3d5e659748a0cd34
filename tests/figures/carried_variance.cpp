// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Dependence of results on their calibration: derivatives by dual numbers against differences.
#include <array>
#include <cmath>

#include "fingerpad/adapt/dual.hpp"
#include "fingerpad/depth/depth.hpp"
#include "fingerpad/depth/fit_reference.hpp"
#include "fingerpad/slip/stick_ratio.hpp"
#include "support/catch.hpp"
#include "support/pad.hpp"
#include "support/slipping_patch.hpp"

using namespace fingerpad;

namespace {

/// c_R, c_G, kappa, and the camera's distance, index, center (x, y) and pitch.
template <class S>
using Optics = std::array<S, 8>;

template <class S>
S depth_after_fit(const test::Pad& pad,
                  const test::Image<double>& shape,
                  const test::Frame<double>& frame,
                  const Colour<double>& seen,
                  Index row,
                  Index col,
                  const Optics<S>& p) {
  Absorption<S> fluid = cast<S>(pad.fluid);
  fluid.c_red_per_mm = p[0];
  fluid.c_green_per_mm = p[1];
  fluid.kappa = p[2];
  Camera<S> camera = cast<S>(pad.camera);
  camera.plate_distance_mm = p[3];
  camera.refractive_index = p[4];
  camera.center_x_px = p[5];
  camera.center_y_px = p[6];
  camera.pitch_mm = p[7];
  const auto reference = fit_reference<S>(camera, fluid, frame.red, frame.green, shape);
  const auto ray = ray_at_pixel(camera, S(static_cast<double>(row)), S(static_cast<double>(col)));
  return newton_depth(fluid, ray, reference.g(row, col), Colour<S>{S(seen.red), S(seen.green)})
      .depth_mm;
}

/// A camera's distance, index, center (x, y) and pitch.
template <class S>
using Places = std::array<S, 5>;

template <class S>
Camera<S> camera_of(const Places<S>& p) {
  Camera<S> camera = cast<S>(Camera<double>());
  camera.plate_distance_mm = p[0];
  camera.refractive_index = p[1];
  camera.center_x_px = p[2];
  camera.center_y_px = p[3];
  camera.pitch_mm = p[4];
  return camera;
}

/// Slips of four dots of a dragged patch whose edge begins to slip. Pixels and depths are those of
/// the default camera; `p` is the camera that the method assumes.
template <class S>
std::array<Point2<S>, 4> slips_of(const Places<S>& p) {
  constexpr Index n = 21;
  const Camera<double> seen_by;
  const Camera<S> camera = camera_of(p);
  StickRatio<S> ratio(n, n, {.noise = 0.005});
  test::SlippingPatch patch;
  const auto show = [&] {
    const LazyView dots(n, n, [&](Index i, Index j) {
      const auto& at = patch.dots(i, j);
      const auto px = pixel_of(seen_by, at);
      return point_at(camera, S(px.y), S(px.x), S(at.z));
    });
    return ratio(dots, patch.contact);
  };
  (void)show();
  patch.step(test::moved_by({0.002, 0.003, 0.01}, {0, 0, 28}, {0.5, 0.2, 0}), 0.7);
  REQUIRE(show().updated());
  std::array<Point2<S>, 4> slips;
  std::size_t k = 0;
  for (const Index col : {7, 10, 12, 13}) {
    slips[k++] = ratio.slips()(10, col);
  }
  return slips;
}

}  // namespace

TEST_CASE("depth follows fluid and camera, through the reference as well") {
  const test::Pad pad;
  const auto shape = pad.free_depths();
  const auto frame = pad.frame<double>(shape);
  const Optics<double> at = {
      pad.fluid.c_red_per_mm,       pad.fluid.c_green_per_mm,    pad.fluid.kappa,
      pad.camera.plate_distance_mm, pad.camera.refractive_index, pad.camera.center_x_px,
      pad.camera.center_y_px,       pad.camera.pitch_mm};
  for (const auto& pixel : {std::array<Index, 2>{24, 28}, {30, 20}, {12, 40}}) {
    const Index row = pixel[0];
    const Index col = pixel[1];
    CAPTURE(row, col);
    const auto seen = pad.colour(row, col, 0.8 * pad.free_depth(row, col), 50);
    const auto depth = depth_after_fit(pad, shape, frame, seen, row, col, seeded(at));
    CHECK(depth.value == Approx(0.8 * pad.free_depth(row, col)).epsilon(2e-3));
    for (std::size_t k = 0; k < at.size(); ++k) {
      CAPTURE(k);
      const double step = 1e-5 * at[k];
      const auto moved = [&](double by) {
        auto p = at;
        p[k] += by;
        return depth_after_fit(pad, shape, frame, seen, row, col, p);
      };
      const double slope = (moved(step) - moved(-step)) / (2 * step);
      CHECK(depth.slopes[k] == Approx(slope).epsilon(1e-5).margin(1e-6 / at[k]));
      CHECK(std::abs(slope) > 1e-6);
    }
  }
}

TEST_CASE("slips of dots follow the camera") {
  const Camera<double> camera;
  const Places<double> at = {camera.plate_distance_mm, camera.refractive_index, camera.center_x_px,
                             camera.center_y_px, camera.pitch_mm};
  const auto plain = slips_of(at);
  const auto dual = slips_of(seeded(at));
  for (std::size_t k = 0; k < at.size(); ++k) {
    const double step = 1e-6 * at[k];
    const auto moved = [&](double by) {
      auto p = at;
      p[k] += by;
      return slips_of(p);
    };
    const auto more = moved(step);
    const auto less = moved(-step);
    double largest = 0;
    for (std::size_t dot = 0; dot < plain.size(); ++dot) {
      CAPTURE(k, dot);
      CHECK(dual[dot].x.value == Approx(plain[dot].x).margin(1e-12));
      const Point2<double> slope = 1 / (2 * step) * (more[dot] - less[dot]);
      for (const auto& [found, wanted] :
           {std::pair{dual[dot].x.slopes[k], slope.x}, {dual[dot].y.slopes[k], slope.y}}) {
        CHECK(found == Approx(wanted).epsilon(1e-5).margin(1e-7 / at[k]));
        largest = std::fmax(largest, std::abs(wanted));
      }
    }
    CHECK(largest > 1e-6 / at[k]);
  }
}
