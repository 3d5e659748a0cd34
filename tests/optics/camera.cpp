// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/optics/camera.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fingerpad/optics/orthographic_camera.hpp"
#include "fingerpad/published/depth.hpp"
#include "support/cameras.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"

using namespace fingerpad;
using test::any_camera;
using test::any_offset;
using test::any_tangent;
using test::as;
using test::Digits50;
using test::near;
using test::Tangent;

namespace {

/// The camera in the symbols of the printed method; without a plate.
published::Pinhole<double> pinhole(const Camera<double>& camera) {
  return {camera.plate_distance_mm, camera.refractive_index, camera.center_y_px, camera.center_x_px,
          camera.pitch_mm};
}

double sine(double tangent) {
  return tangent / std::sqrt(1 + tangent * tangent);
}

/// Distance from the axis at depth z on the ray of tangent t.
template <class S>
S reach(const Camera<S>& camera, const S& t, const S& z) {
  const Ray<S> ray = ray_at_tangent(camera, t);
  return S(ray.plate_rho_mm + z * ray.tan_fluid);
}

}  // namespace

TEST_CASE("rays obey Snell's law", "[optics]") {
  rc::prop("sin(phi_air) = n sin(phi_fluid), to 4 epsilon", [] {
    const auto camera = any_camera();
    const auto ray = ray_at_tangent(camera, any_tangent());
    const double in_air = sine(ray.tan_air);
    RC_ASSERT(near(camera.refractive_index * sine(ray.tan_fluid), in_air, in_air, 4));
  });
  rc::prop("tan, cos and k belong to one angle", [] {
    const auto ray = ray_at_tangent(any_camera(), any_tangent());
    const double inv_cos = std::sqrt(1 + ray.tan_fluid * ray.tan_fluid);
    RC_ASSERT(near(ray.cos_fluid * inv_cos, 1.0, 1.0, 6));
    RC_ASSERT(near(ray.path_factor, 1 + inv_cos, inv_cos, 6));
    RC_ASSERT(ray.path_factor >= 2 - 4 * epsilon<double>());
  });
}

TEST_CASE("the plate", "[optics]") {
  rc::prop("of index 1 is air, of thickness 0 is not there", [] {
    auto with = any_camera();
    auto without = with;
    without.plate_thickness_mm = 0;
    if (test::whole(0, 1) == 1) {
      with.plate_index = 1;
    } else {
      with.plate_thickness_mm = 0;
    }
    const double t = any_tangent();
    const auto a = ray_at_tangent(with, t);
    const auto b = ray_at_tangent(without, t);
    RC_ASSERT(near(a.plate_rho_mm, b.plate_rho_mm, b.plate_rho_mm, 4));
    const auto& h = a;
    const auto& expected = b;
    RC_ASSERT(near(h.meridional_mm, expected.meridional_mm, expected.meridional_mm, 16));
    RC_ASSERT(near(h.sagittal_mm, expected.sagittal_mm, expected.sagittal_mm, 16));
    RC_ASSERT(near(tangent_per_px(with), tangent_per_px(without), tangent_per_px(without), 4));
  });
  rc::prop("of the fluid's index is fluid", [] {
    auto plate = any_camera();
    plate.plate_index = plate.refractive_index;
    auto fluid = plate;
    fluid.plate_distance_mm -= plate.plate_thickness_mm;
    fluid.plate_thickness_mm = 0;
    const double t = any_tangent();
    const double z = test::uniform(0, 15);
    const double expected = reach(fluid, t, z + plate.plate_thickness_mm);
    RC_ASSERT(near(reach(plate, t, z), expected, expected, 16));
    const auto h = ray_at_tangent(plate, t);
    const auto g = ray_at_tangent(fluid, t);
    const double thickness = plate.plate_thickness_mm;
    RC_ASSERT(near(h.meridional_mm, g.meridional_mm + thickness, h.meridional_mm, 16));
    RC_ASSERT(near(h.sagittal_mm, g.sagittal_mm + thickness, h.sagittal_mm, 16));
  });
  rc::prop("does not move the pixels' pitch near the axis", [] {
    const auto camera = any_camera();
    const auto ray = ray_at_pixel(camera, camera.center_y_px + 1e-4, camera.center_x_px);
    const double height_mm = camera.pitch_mm * camera.pixel_aspect;
    RC_ASSERT(std::abs(ray.plate_rho_mm / (1e-4 * height_mm) - 1) < 1e-7);
  });
}

TEST_CASE("virtual heights", "[optics]") {
  rc::prop("are the published closed form n h1 cos^3(phi1) / cos^3(phi2)", [] {
    auto camera = any_camera();
    camera.plate_thickness_mm = 0;
    camera.pixel_aspect = 1;
    const double air = std::atan(any_tangent());
    const double fluid = std::asin(std::sin(air) / camera.refractive_index);
    const auto ray = ray_at_tangent(camera, std::tan(air));
    const double ratio = std::cos(fluid) / std::cos(air);
    const double nh = camera.refractive_index * camera.plate_distance_mm;
    const auto printed =
        published::ray_of(pinhole(camera), camera.center_y_px,
                          camera.center_x_px + std::tan(air) / tangent_per_px(camera));
    const auto& two = ray;
    RC_ASSERT(std::abs(printed.h2_mm / (nh * std::pow(ratio, 3)) - 1) < 1e-12);
    RC_ASSERT(std::abs(printed.k / ray.path_factor - 1) < 1e-12);
    RC_ASSERT(std::abs(two.meridional_mm / (nh * std::pow(ratio, 3)) - 1) < 1e-13);
    RC_ASSERT(std::abs(two.sagittal_mm / (nh * ratio) - 1) < 1e-13);
  });

  SECTION("at 20.5 degrees, 50 mm, water") {
    const Camera<double> camera;
    const auto ray = ray_at_tangent(camera, std::tan(20.5 / 180 * std::numbers::pi));
    const auto& h = ray;
    CHECK(std::abs(h.meridional_mm - 72.7) < 0.1);
    CHECK(std::abs(h.sagittal_mm - 68.5) < 0.1);
  }
}

TEMPLATE_TEST_CASE(
    "a point is seen by the pixel that looks at it", "[optics]", float, double, long double) {
  rc::prop("pixel_of inverts point_at", test::pixel_of_inverts_point_at<TestType>);
}

TEST_CASE("symmetry of the picture", "[optics]") {
  rc::prop("a rotated pixel sees the rotated point", [] {
    const auto camera = any_camera();
    const auto p = any_offset(camera);
    const double angle = test::uniform(-4, 4);
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const double z = test::uniform(0, 15);
    const auto at = [&](double x, double y) {
      return point_at(camera, camera.center_y_px + y / camera.pixel_aspect, camera.center_x_px + x,
                      z);
    };
    const auto a = at(p.x, p.y);
    const auto b = at(c * p.x - s * p.y, s * p.x + c * p.y);
    const double scale = std::hypot(a.x, a.y) + 1000 * camera.pitch_mm;
    RC_ASSERT(near(b.x, c * a.x - s * a.y, scale, 32));
    RC_ASSERT(near(b.y, s * a.x + c * a.y, scale, 32));
  });
  rc::prop("a mirrored pixel sees the mirrored point, to the last bit", [] {
    Camera<double> camera = any_camera();
    camera.center_x_px = 319.5;
    camera.center_y_px = 239.5;
    const double x = static_cast<double>(test::whole(-2560, 2560)) / 8;
    const double y = static_cast<double>(test::whole(-1920, 1920)) / 8;
    const double z = test::uniform(0, 15);
    const auto a = point_at(camera, 239.5 + y, 319.5 + x, z);
    const auto left = point_at(camera, 239.5 + y, 319.5 - x, z);
    const auto up = point_at(camera, 239.5 - y, 319.5 + x, z);
    RC_ASSERT(left.x == -a.x);
    RC_ASSERT(left.y == a.y);
    RC_ASSERT(up.x == a.x);
    RC_ASSERT(up.y == -a.y);
    RC_ASSERT(a.z == z);
    const double scale = std::abs(x) + std::abs(y);
    const double tall = y * camera.pixel_aspect;
    RC_ASSERT(
        near(a.x * tall, a.y * x, scale * (std::abs(a.x) + std::abs(a.y)), 8));  // one azimuth
  });
}

TEMPLATE_TEST_CASE("the center pixel looks along the axis, exactly",
                   "[optics]",
                   float,
                   double,
                   Digits50,
                   Tangent<double>) {
  using S = TestType;
  const Camera<S> camera;
  const auto ray = ray_at_pixel(camera, camera.center_y_px, camera.center_x_px);
  CHECK(ray.tan_air == S(0));
  CHECK(ray.tan_fluid == S(0));
  CHECK(ray.plate_rho_mm == S(0));
  const auto point = point_at(camera, camera.center_y_px, camera.center_x_px, S(5));
  CHECK(point.x == S(0));
  CHECK(point.y == S(0));
  CHECK(point.z == S(5));
  const auto pixel = pixel_of(camera, point);
  CHECK(pixel.x == camera.center_x_px);
  CHECK(pixel.y == camera.center_y_px);
  const auto k = value(ray.path_factor) - 2;
  CHECK((k < 4 * epsilon<S>() && -k < 4 * epsilon<S>()));
}

TEST_CASE("a pixel that is not square sees what a square one sees at its place", "[optics]") {
  rc::prop("along x and y, through a plate and from above", [] {
    const auto camera = any_camera();
    auto square = camera;
    square.pixel_aspect = 1;
    const auto p = any_offset(camera);
    const double z = test::uniform(0, 15), col = camera.center_x_px + p.x;
    const double row = camera.center_y_px + p.y;
    const double low = camera.center_y_px + p.y * camera.pixel_aspect;
    const auto a = point_at(camera, row, col, z), b = point_at(square, low, col, z);
    const double scale = std::hypot(a.x, a.y) + 1000 * camera.pitch_mm;
    RC_ASSERT(near(a.x, b.x, scale, 32));
    RC_ASSERT(near(a.y, b.y, scale, 32));
    RC_ASSERT(near(ray_at_pixel(camera, row, col).path_factor,
                   ray_at_pixel(square, low, col).path_factor, 2.0, 64));
    const OrthographicCamera<double> above{camera.center_x_px, camera.center_y_px, camera.pitch_mm,
                                           camera.pixel_aspect};
    const auto plan = point_at(above, row, col, z);
    RC_ASSERT(near(plan.y, p.y * camera.pitch_mm * camera.pixel_aspect, scale, 32));
    RC_ASSERT(near(pixel_of(above, plan).y, row, 1000 + std::abs(row), 32));
  });
}

TEST_CASE("grazing pixels stay finite and NaN stays NaN", "[optics]") {
  const Camera<double> camera;
  for (const double t : {10.0, 1e3, 1e6, 1e9}) {  // 84 degrees and beyond
    const auto ray = ray_at_tangent(camera, t);
    CHECK(is_finite(ray.path_factor));
    CHECK(is_finite(ray.plate_rho_mm));
    CHECK(ray.cos_fluid > 0.65);  // never beyond the critical angle, 48.75 degrees
    CHECK(ray.tan_fluid < 1.1405);
    const auto& h = ray;
    CHECK(is_finite(h.meridional_mm));
    CHECK(h.meridional_mm > h.sagittal_mm);
  }
  const double missing = not_a_number<double>();
  const auto point = point_at(camera, 100.0, 100.0, missing);
  CHECK_FALSE(is_finite(point.x));
  CHECK_FALSE(is_finite(point.y));
  CHECK_FALSE(is_finite(point.z));
  CHECK_FALSE(is_finite(ray_at_pixel(camera, missing, 0.0).path_factor));
  CHECK_FALSE(is_finite(ray_at_pixel(camera, 0.0, missing).plate_rho_mm));
  CHECK_FALSE(is_finite(pixel_of(camera, Point3<double>{missing, 1, 5}).x));
  CHECK_FALSE(is_finite(pixel_of(camera, Point3<double>{missing, 1, 5}).y));
}

TEST_CASE("the published sine shift is short by the audit's numbers", "[optics]") {
  const Camera<double> camera;
  const auto missing_mm = [&](double t, double depth) {
    const double col = camera.center_x_px + t / tangent_per_px(camera);
    const double right = point_at(camera, camera.center_y_px, col, depth).x;
    return right - published::point_at(pinhole(camera), camera.center_y_px, col, depth).x;
  };
  CHECK(std::abs(missing_mm(std::tan(std::numbers::pi / 6), 13) - 0.387) < 0.001);

  // On a pad of radius 20 mm and height 13 mm it is at most 0.026 mm everywhere.
  double worst = 0;
  for (double t = 0; t < 0.37; t += 1e-3) {
    double low = 0;
    double high = 13;
    while (high - low > 1e-9) {
      const double depth = (low + high) / 2;
      const bool inside = std::hypot(reach(camera, t, depth), depth + 7) < 20;
      (inside ? low : high) = depth;
    }
    worst = std::max(worst, missing_mm(t, low));
  }
  CHECK(std::abs(worst - 0.0258) < 1e-4);

  // It lies along the pixel's direction, and is 0 on the plate.
  const double row = 100, col = 400;
  for (const double depth : {0.0, 5.0}) {
    const auto right = point_at(camera, row, col, depth);
    const auto sine = published::point_at(pinhole(camera), row, col, depth);
    const double shorter =
        depth > 0 ? std::hypot(sine.x, sine.y) / std::hypot(right.x, right.y) : 1;
    CHECK((shorter > 0.99 && shorter <= 1));
    CHECK(sine.x == Approx(shorter * right.x).epsilon(1e-12));
    CHECK(sine.y == Approx(shorter * right.y).epsilon(1e-12));
    CHECK(sine.z == depth);
  }
}

TEST_CASE("derivatives by the dual number are those of central differences", "[optics]") {
  rc::prop("to 1e-6, by index, distance, pixel and depth", [] {
    const auto camera = any_camera();
    const auto offset = any_offset(camera);
    const double row = camera.center_y_px + offset.y;
    const double col = camera.center_x_px + offset.x;
    const double z = test::uniform(0, 15);
    const auto sum = [](const auto& p) { return p.x - p.y; };
    const auto agree = [](const auto& f, double x) {
      const double by_tangent = test::slope_by_tangent(f, x);
      const double by_difference = test::slope_by_difference(f, x, 1e-5 * (1 + std::abs(x)));
      RC_ASSERT(std::abs(by_tangent - by_difference) <= 1e-6 * (1 + std::abs(by_difference)));
    };
    agree(
        [&]<class S>(const S& n) {
          auto c = as<S>(camera);
          c.refractive_index = n;
          return sum(point_at(c, S(row), S(col), S(z)));
        },
        camera.refractive_index);
    agree(
        [&]<class S>(const S& h) {
          auto c = as<S>(camera);
          c.plate_distance_mm = h;
          const auto ray = ray_at_pixel(c, S(row), S(col));
          return S(ray.meridional_mm * ray.path_factor);
        },
        camera.plate_distance_mm);
    agree([&]<class S>(const S& x) { return sum(point_at(as<S>(camera), S(row), x, S(z))); }, col);
    agree([&]<class S>(const S& d) { return sum(point_at(as<S>(camera), S(row), S(col), d)); }, z);
    agree(
        [&]<class S>(const S& x) {
          return sum(pixel_of(as<S>(camera), Point3<S>{x, S(offset.y / 100), S(z)}));
        },
        1 + offset.x / 100);
  });
  rc::prop("and are those of the camera on the axis itself, where the radius has none", [] {
    const auto camera = any_camera();
    const auto k = [&](const auto& n) {
      using S = std::remove_cvref_t<decltype(n)>;
      auto c = as<S>(camera);
      c.refractive_index = n;
      return ray_at_pixel(c, c.center_y_px, c.center_x_px).path_factor;
    };
    RC_ASSERT(std::abs(test::slope_by_tangent(k, camera.refractive_index)) < 1e-14);
  });
}

namespace {

/// A lens that distorts, but folds nothing back within 35 degrees.
Camera<double> any_lens() {
  auto camera = any_camera();
  camera.distortion_k1 = test::uniform(-0.2, 0.3);
  camera.distortion_k2 = test::uniform(-0.08, 0.1);
  return camera;
}
Point2<double> any_direction(double most = 0.7) {
  const double t = test::uniform(0, most), angle = test::uniform(-4, 4);
  return {t * std::cos(angle), t * std::sin(angle)};
}

}  // namespace

TEST_CASE("a lens distorts as in OpenCV", "[optics]") {
  rc::prop("each direction by 1 + k1 t^2 + k2 t^4", [] {
    const auto camera = any_lens();
    const auto d = any_direction();
    const double s = d.x * d.x + d.y * d.y;
    const double factor = 1 + camera.distortion_k1 * s + camera.distortion_k2 * s * s;
    const auto pixel = pixel_at_tangents(camera, d);
    const double px = factor / tangent_per_px(camera);
    RC_ASSERT(near(pixel.x, camera.center_x_px + d.x * px, 1000 + std::abs(d.x * px), 8));
    RC_ASSERT(near(pixel.y, camera.center_y_px + d.y * px / camera.pixel_aspect,
                   1000 + std::abs(d.y * px), 8));
  });
  rc::prop("and its derivatives by k1, k2 and the pixel are those of differences", [] {
    auto camera = any_lens();
    camera.distortion_k1 = test::whole(0, 3) == 0 ? 0 : camera.distortion_k1;
    camera.distortion_k2 = test::whole(0, 3) == 0 ? 0 : camera.distortion_k2;
    const auto pixel = pixel_at_tangents(camera, any_direction(0.6));
    const auto agree = [&](int which, double x) {
      const auto f = [&]<class S>(const S& at) {
        auto c = as<S>(camera);
        (which == 0 ? c.distortion_k1 : which == 1 ? c.distortion_k2 : c.center_x_px) = at;
        const auto there = point_at(c, S(pixel.y), S(pixel.x), S(3));
        const auto back = pixel_of(c, Point3<S>{S(4), S(-3), S(2)});
        return S(there.x - there.y + S(camera.pitch_mm) * (back.x + back.y));
      };
      const double by_tangent = test::slope_by_tangent(f, x);
      const double by_difference = test::slope_by_difference(f, x, 1e-6 * (1 + std::abs(x)));
      RC_ASSERT(std::abs(by_tangent - by_difference) <= 1e-5 * (1 + std::abs(by_difference)));
    };
    if (std::hypot(5, 4) / camera.plate_distance_mm < 0.6) {
      agree(0, camera.distortion_k1);
      agree(1, camera.distortion_k2);
      agree(2, camera.center_x_px);
    }
  });
}

TEMPLATE_TEST_CASE("a distorted pixel is found again, to roundoff",
                   "[optics]",
                   float,
                   double,
                   long double,
                   Digits50) {
  using S = TestType;
  rc::prop("by its direction and by its point", [] {
    const auto lens = any_lens();
    const auto camera = as<S>(lens);
    const auto d = any_direction();
    const Point2<S> direction = {S(d.x), S(d.y)};
    const auto pixel = pixel_at_tangents(camera, direction);
    const auto back = tangents_of_pixel(camera, pixel.y, pixel.x);
    // a pixel is known to epsilon of its number, not of its distance from the center
    const S scale = S(1 + 1000 * tangent_per_px(lens));
    RC_ASSERT(near<S>(back.x, direction.x, scale, 64));
    RC_ASSERT(near<S>(back.y, direction.y, scale, 64));
    const auto again = pixel_of(camera, point_at(camera, pixel.y, pixel.x, S(7)));
    const S far = S(1000 + 1 / tangent_per_px(lens));
    RC_ASSERT(near<S>(again.x, pixel.x, far, 64));
    RC_ASSERT(near<S>(again.y, pixel.y, far, 64));
  });
}

TEST_CASE("where a distortion folds back, nothing is seen", "[optics]") {
  Camera<double> camera;
  const auto k = GENERATE(std::pair(-0.5, 0.0), std::pair(-0.5, 0.1), std::pair(0.5, -0.3));
  const double k1 = camera.distortion_k1 = k.first, k2 = camera.distortion_k2 = k.second;
  double fold = 0;  // the first tangent at which the distorted one falls
  const auto distorted = [&](double t) { return t + k1 * t * t * t + k2 * std::pow(t, 5); };
  while (distorted(fold + 1e-4) > distorted(fold)) {
    fold += 1e-4;
  }
  const double per_px = tangent_per_px(camera), row = camera.center_y_px;
  const auto seen = [&](double d) {
    return tangents_of_pixel(camera, row, camera.center_x_px + d / per_px).x;
  };
  CHECK(seen(distorted(0.9 * fold)) == Approx(0.9 * fold));
  for (const double more : {1.001, 1.1, 2.0, 10.0, 1e3, 1e9}) {
    CAPTURE(k1, k2, more);
    CHECK_FALSE(is_finite(seen(more * distorted(fold))));
    CHECK_FALSE(is_finite(pixel_at_tangents(camera, {more * (fold + 1e-3), 0.0}).x));
  }
}

TEST_CASE("cameras are set for 640 x 480 pixels until they are told otherwise", "[optics]") {
  CHECK(Camera<>().center_x_px == 319.5);
  CHECK(Camera<>().center_y_px == 239.5);
  CHECK(OrthographicCamera<>().center_x_px == 319.5);
  CHECK(OrthographicCamera<>().center_y_px == 239.5);
  CHECK(OrthographicCamera<>().pitch_mm == 0.08);
}

TEST_CASE("the default camera looks through water and a thin plate of acrylic", "[optics]") {
  const Camera<double> camera;
  CHECK(camera.refractive_index == 1.33);
  CHECK(camera.plate_thickness_mm == 0);
  CHECK(camera.plate_index == 1.49);
  CHECK(camera.pixel_aspect == 1);
  CHECK(camera.distortion_k1 == 0);
  CHECK(camera.distortion_k2 == 0);
}

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
    const auto heights = ray_at_tangent(camera, t);
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
    const auto h = ray_at_pixel(camera, row, col);
    const Digits50 expected =
        (z + h.meridional_mm) * (z + h.sagittal_mm) / (h.meridional_mm * h.sagittal_mm);
    const Digits50 ratio = area(z) / area(Digits50(0));
    RC_ASSERT(test::relative_error(ratio, expected) < Digits50("1e-20"));
  });
}

TEST_CASE("a point is seen by the pixel that looks at it, to 50 digits", "[optics]") {
  rc::prop("pixel_of inverts point_at", test::pixel_of_inverts_point_at<Digits50>);
}
