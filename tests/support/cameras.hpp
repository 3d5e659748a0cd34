// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#pragma once
// Random cameras and pixels, the same in every number type.
#include <cmath>
#include <limits>
#include <numbers>

#include "fingerpad/optics/camera.hpp"
#include "fingerpad/optics/orthographic_camera.hpp"
#include "support/generators.hpp"

namespace test {

using fingerpad::Camera;
using fingerpad::OrthographicCamera;
using fingerpad::Point2;

/// Camera of a height map.
inline OrthographicCamera<double> plan(double pitch_mm) {
  OrthographicCamera<double> camera;
  camera.pitch_mm = pitch_mm;
  return camera;
}
/// A camera whose pitch grows with depth by `growth_per_mm`, relative per mm.
inline Camera<double> through(double pitch_mm, double growth_per_mm) {
  Camera<double> camera;
  camera.pitch_mm = pitch_mm;
  camera.plate_distance_mm = 1 / (growth_per_mm * camera.refractive_index);
  return camera;
}

/// A random camera, with a plate or without; its numbers are exact in every type.
inline Camera<double> any_camera() {
  Camera<double> camera;
  camera.plate_distance_mm = test::uniform(5, 100);
  camera.refractive_index = test::uniform(1, 2);
  camera.center_x_px = test::uniform(0, 640);
  camera.center_y_px = test::uniform(0, 480);
  camera.pitch_mm = test::uniform(0.01, 0.2);
  camera.plate_index = test::uniform(1, 2);
  camera.pixel_aspect = test::whole(0, 1) == 1 ? 1 : test::uniform(0.8, 1.25);
  if (test::whole(0, 1) == 1) {
    camera.plate_thickness_mm = test::uniform(0, 0.9) * camera.plate_distance_mm;
  }
  return camera;
}

template <class S>
Camera<S> as(const Camera<double>& c) {
  return fingerpad::cast<S>(c);
}

/// tan(phi_air), up to 75 degrees.
inline double any_tangent() {
  return test::uniform(0, 3.7);
}

/// A pixel, relative to the center pixel, that looks at most 60 degrees off the axis.
inline Point2<double> any_offset(const Camera<double>& camera) {
  const double r = test::uniform(0, 1.7) / tangent_per_px(camera);
  const double angle = test::uniform(-std::numbers::pi, std::numbers::pi);
  return {r * std::cos(angle), r * std::sin(angle)};
}

/// Whether |a - b| is at most `epsilons` epsilons of `scale`.
template <class S>
bool near(const S& a, const S& b, const S& scale, double epsilons) {
  using std::abs;
  return S(abs(S(a - b))) <= S(epsilons) * (std::numeric_limits<S>::epsilon)() * scale;
}

/// The pixel that sees a point is the one that the point was found from.
template <class S>
void pixel_of_inverts_point_at() {
  const auto camera = as<S>(any_camera());
  const auto offset = any_offset(as<double>(Camera<double>{}));
  const S row = S(camera.center_y_px + S(offset.y));
  const S col = S(camera.center_x_px + S(offset.x));
  const fingerpad::Point3<S> point = point_at(camera, row, col, S(test::uniform(0, 20)));
  const Point2<S> pixel = pixel_of(camera, point);
  const S scale = S(1000 + std::hypot(offset.x, offset.y));
  RC_ASSERT(near<S>(pixel.x, col, scale, 32));
  RC_ASSERT(near<S>(pixel.y, row, scale, 32));
}

}  // namespace test
