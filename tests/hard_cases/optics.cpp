// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/optics/camera.hpp"
#include "support/cameras.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;
using test::any_camera;
using test::any_tangent;
using test::as;
using test::Digits50;

TEST_CASE("rays follow 50 digits", "[optics]") {
  rc::prop("to 6 epsilon in double", [] {
    const auto camera = any_camera();
    const double t = any_tangent();
    const auto reference = ray_at_tangent(as<Digits50>(camera), Digits50(t));
    const auto ray = ray_at_tangent(camera, t);
    const auto close = [](double a, const Digits50& b) {
      return test::relative_error(Digits50(a), b) <= 6 * epsilon<double>();
    };
    RC_ASSERT(close(ray.tan_fluid, reference.tan_fluid));
    RC_ASSERT(close(ray.cos_fluid, reference.cos_fluid));
    RC_ASSERT(close(ray.path_factor, reference.path_factor));
    RC_ASSERT(close(ray.plate_rho_mm, reference.plate_rho_mm));
  });
}

TEST_CASE("virtual heights in 50 digits", "[optics]") {
  rc::prop("are where neighbouring rays meet: d rho / d tan and rho / tan", [] {
    const auto camera = as<Digits50>(any_camera());
    const Digits50 t(test::uniform(1e-3, 3.7));
    const Digits50 step("1e-15");
    const auto heights = pencil_heights(camera, ray_at_tangent(camera, t));
    const auto rho = [&](const Digits50& s) { return ray_at_tangent(camera, s).plate_rho_mm; };
    const auto tangent = [&](const Digits50& s) { return ray_at_tangent(camera, s).tan_fluid; };
    const Digits50 along =
        test::slope_by_difference(rho, t, step) / test::slope_by_difference(tangent, t, step);
    const Digits50 across = rho(t) / tangent(t);
    RC_ASSERT(test::relative_error(heights.meridional_mm, along) < Digits50("1e-22"));
    RC_ASSERT(test::relative_error(heights.sagittal_mm, across) < Digits50("1e-46"));
  });
  rc::prop("let the area of a pixel grow as (z + meridional)(z + sagittal)", [] {
    const auto camera = as<Digits50>(any_camera());
    const Digits50 row(test::uniform(0, 480));
    const Digits50 col(test::uniform(0, 640));
    const Digits50 z(test::uniform(0, 15));
    const Digits50 step("1e-12");
    const auto area = [&](const Digits50& depth) {
      const auto right = point_at(camera, row, Digits50(col + step), depth);
      const auto left = point_at(camera, row, Digits50(col - step), depth);
      const auto down = point_at(camera, Digits50(row + step), col, depth);
      const auto up = point_at(camera, Digits50(row - step), col, depth);
      return Digits50((right.x - left.x) * (down.y - up.y) - (right.y - left.y) * (down.x - up.x));
    };
    const auto h = pencil_heights(camera, ray_at_pixel(camera, row, col));
    const Digits50 expected =
        (z + h.meridional_mm) * (z + h.sagittal_mm) / (h.meridional_mm * h.sagittal_mm);
    const Digits50 ratio = area(z) / area(Digits50(0));
    RC_ASSERT(test::relative_error(ratio, expected) < Digits50("1e-20"));
  });
}

TEST_CASE("a point is seen by the pixel that looks at it, to 50 digits", "[optics]") {
  rc::prop("pixel_of inverts point_at", test::pixel_of_inverts_point_at<Digits50>);
}
