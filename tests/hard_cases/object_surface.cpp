// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/contact/object_surface.hpp"

#include <array>
#include <cmath>
#include <vector>

#include "support/cameras.hpp"
#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Digits50;
using test::Image;

namespace {

using Mask = Image<unsigned char>;
using Flat = OrthographicCamera<double>;

template <class S>
OrthographicCamera<S> as(const Flat& c) {
  return {S(c.center_x_px), S(c.center_y_px), S(c.pitch_mm)};
}
template <class S>
Camera<S> as(const Camera<double>& c) {
  return test::as<S>(c);
}

template <class S>
Image<S> as(const Image<double>& image) {
  Image<S> out(image.rows(), image.cols());
  for (std::size_t k = 0; k < image.cells.size(); ++k) {
    out.cells[k] = S(image.cells[k]);
  }
  return out;
}

template <class Model, class CameraType, class S>
auto fit(const CameraType& camera, const Image<S>& depth, const Mask& mask, Index least = 1) {
  const SurfaceFit<Model, CameraType> surface(depth.rows(), depth.cols(), camera,
                                              {.min_px = least});
  return surface(depth, mask);
}

/// The lower half of a sphere around the image's center, as a map of heights: (x, y) in px.
Image<double> bowl(Index rows, Index cols, double pitch_mm, double curvature, double noise_mm = 0) {
  Image<double> depth(rows, cols);
  test::Random random(9);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const double y = pitch_mm * (static_cast<double>(i) - static_cast<double>(rows - 1) / 2);
      const double x = pitch_mm * (static_cast<double>(j) - static_cast<double>(cols - 1) / 2);
      const double r_sq = x * x + y * y;
      const double s = std::sqrt(1 - curvature * curvature * r_sq);
      depth(i, j) =
          9 + curvature * r_sq / (1 + s) + (noise_mm > 0 ? noise_mm * random.normal() : 0);
    }
  }
  return depth;
}

Flat centered_on(Index rows, Index cols, double pitch_mm) {
  return {static_cast<double>(cols - 1) / 2, static_cast<double>(rows - 1) / 2, pitch_mm};
}

double error(double a, const Digits50& b) {
  return std::abs(static_cast<double>(Digits50(a) - b));
}
double error(const Point3<double>& a, const Point3<Digits50>& b) {
  return error(a.x, b.x) + error(a.y, b.y) + error(a.z, b.z);
}

/// Pixels of a patch that is smooth, tilted and curved at random, with noise.
Image<double> any_patch(Index rows, Index cols, double pitch_mm) {
  const double slope_x = test::uniform(-1, 1), slope_y = test::uniform(-1, 1);
  const double bend = test::uniform(-0.05, 0.05), twist = test::uniform(-0.05, 0.05);
  const double noise = test::log_uniform(1e-9, 0.1);
  Image<double> depth(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < cols; ++j) {
      const double x = pitch_mm * static_cast<double>(j), y = pitch_mm * static_cast<double>(i);
      depth(i, j) = 9 + slope_x * x + slope_y * y + bend * x * x + twist * (x * y - y * y) +
                    test::uniform(-noise, noise);
    }
  }
  return depth;
}

template <class CameraType>
void follows_50_digits(const CameraType& camera) {
  const Index rows = test::whole(6, 16), cols = test::whole(6, 16);
  const Image<double> depth = any_patch(rows, cols, 0.3);
  const Mask mask(rows, cols, 1);
  const auto exact_camera = as<Digits50>(camera);
  const Image<Digits50> exact_depth = as<Digits50>(depth);
  const auto plane = fit<Plane<>>(camera, depth, mask);
  const auto sphere = fit<Sphere<>>(camera, depth, mask);
  const auto quadric = fit<Quadric<>>(camera, depth, mask);
  const auto exact_plane = fit<Plane<>>(exact_camera, exact_depth, mask);
  const auto exact_sphere = fit<Sphere<>>(exact_camera, exact_depth, mask);
  const auto exact_quadric = fit<Quadric<>>(exact_camera, exact_depth, mask);
  RC_ASSERT((plane.ok() && sphere.ok() && quadric.ok()));
  RC_ASSERT((exact_plane.ok() && exact_sphere.ok() && exact_quadric.ok()));
  RC_ASSERT(error(plane.shape.normal, exact_plane.shape.normal) < 1e-11);
  RC_ASSERT(error(plane.shape.distance_mm, exact_plane.shape.distance_mm) < 1e-11);
  RC_ASSERT(error(plane.rms_mm, exact_plane.rms_mm) < 1e-6);
  RC_ASSERT(error(plane.shape.tilt_sd_rad, exact_plane.shape.tilt_sd_rad) < 1e-6);
  RC_ASSERT(error(sphere.shape.curvature_per_mm, exact_sphere.shape.curvature_per_mm) < 1e-11);
  RC_ASSERT(error(sphere.shape.point_mm, exact_sphere.shape.point_mm) < 1e-10);
  RC_ASSERT(error(sphere.rms_mm, exact_sphere.rms_mm) < 1e-6);
  const auto& q = quadric.shape;
  const auto& e = exact_quadric.shape;
  RC_ASSERT(error(q.mean_curvature_per_mm(), e.mean_curvature_per_mm()) < 1e-10);
  RC_ASSERT(error(q.point_mm, e.point_mm) < 1e-10);
  RC_ASSERT(error(q.normal, e.normal) < 1e-10);
  RC_ASSERT(error(quadric.rms_mm, exact_quadric.rms_mm) < 1e-6);
}

}  // namespace

TEST_CASE("object surface: fits follow 50 digits", "[surface]") {
  rc::prop("seen along rays", [] {
    Camera<double> camera = test::any_camera();
    camera.plate_distance_mm = 50;
    camera.plate_thickness_mm = 0;
    camera.pitch_mm = 0.3;
    camera.center_x_px = test::uniform(-60, 60);
    camera.center_y_px = test::uniform(-60, 60);
    follows_50_digits(camera);
  });
  rc::prop("as a map of heights", [] {
    follows_50_digits(Flat{test::uniform(-100, 100), test::uniform(-100, 100), 0.3});
  });
}

TEST_CASE("object surface: numbers whose sums are expressions", "[surface]") {
  const Image<test::Digits50> depth = as<test::Digits50>(bowl(9, 9, 0.5, 0.05));
  const OrthographicCamera<test::Digits50> camera = as<test::Digits50>(centered_on(9, 9, 0.5));
  const Mask mask(9, 9, 1);
  const auto curvature = [](const auto& k) { return static_cast<double>(k); };
  CHECK(fit<Plane<>>(camera, depth, mask).ok());
  CHECK(curvature(fit<Sphere<>>(camera, depth, mask).shape.curvature_per_mm) == Approx(0.05));
  CHECK(curvature(fit<Quadric<>>(camera, depth, mask).shape.curvature_1_per_mm) == Approx(0.05));
}

TEST_CASE("object surface: the sphere is the one of least square distance", "[surface]") {
  // A step in any single number increases the sum of squares, except for a ten-thousandth of the
  // effect of one standard error.
  for (const double curvature : {1 / 18.0, -1 / 18.0, 1 / 6.0, 0.0}) {
    const Index size = 33;
    const Flat camera = centered_on(size, size, 0.2);
    const Image<double> depth = bowl(size, size, 0.2, curvature, 0.05);
    const Mask mask(size, size, 1);
    const auto r = fit<Sphere<>>(camera, depth, mask);
    REQUIRE(r.ok());
    const auto sum_sq = [&](const Sphere<double>& s) {
      double sum = 0;
      for (Index i = 0; i < size; ++i) {
        for (Index j = 0; j < size; ++j) {
          sum += square(s.stands_out(
              point_at(camera, static_cast<double>(i), static_cast<double>(j), depth(i, j))));
        }
      }
      return sum;
    };
    const double least = sum_sq(r.shape) - 1e-4 * square(r.rms_mm);
    const auto f = detail::SurfaceFrame<double>::around(r.shape.normal);
    for (const double sign : {-1.0, 1.0}) {
      for (const double step : {1e-3, 1e-2, 1e-1}) {
        Sphere<double> bent = r.shape, moved = r.shape, rotated = r.shape, other = r.shape;
        bent.curvature_per_mm += sign * step * r.shape.curvature_sd_per_mm;
        moved.point_mm = moved.point_mm + sign * step * 0.0015 * f.n;
        rotated.normal = normalized(f.n + sign * step * 0.0008 * f.u);
        other.normal = normalized(f.n + sign * step * 0.0008 * f.v);
        CHECK(sum_sq(bent) > least);
        CHECK(sum_sq(moved) > least);
        CHECK(sum_sq(rotated) > least);
        CHECK(sum_sq(other) > least);
      }
    }
  }
}

TEST_CASE("object surface: nearly flat, and flat", "[surface]") {
  const Index size = 41;
  const Flat camera = centered_on(size, size, 0.2);
  const Mask mask(size, size, 1);
  for (const double radius : {1e6, -1e6, 1e9}) {
    const auto s = fit<Sphere<>>(camera, bowl(size, size, 0.2, 1 / radius), mask);
    const auto q = fit<Quadric<>>(camera, bowl(size, size, 0.2, 1 / radius), mask);
    REQUIRE((s.ok() && q.ok()));
    CHECK(std::abs(s.shape.curvature_per_mm - 1 / radius) < 1e-15);
    CHECK(std::abs(q.shape.mean_curvature_per_mm() - 1 / radius) < 1e-15);
  }
  const Image<double> flat(size, size, 9);
  const auto p = fit<Plane<>>(camera, flat, mask);
  const auto s = fit<Sphere<>>(camera, flat, mask);
  const auto q = fit<Quadric<>>(camera, flat, mask);
  REQUIRE((p.ok() && s.ok() && q.ok()));
  CHECK(p.shape.distance_mm == 9);
  CHECK(p.rms_mm == 0);
  CHECK(std::abs(s.shape.curvature_per_mm) < 1e-15);
  CHECK(s.shape.point_mm.z == Approx(9));
  CHECK(std::abs(q.shape.curvature_1_per_mm) < 1e-15);
  CHECK(q.shape.normal.z == Approx(1));
}

TEST_CASE("object surface: a patch of ten pixels, and one far from the axis", "[surface]") {
  Mask tiny(20, 20, 0);
  for (Index j = 8; j < 11; ++j) {
    tiny(9, j) = tiny(10, j) = tiny(11, j) = 1;
  }
  tiny(12, 9) = 1;
  const Flat camera = centered_on(20, 20, 0.08);
  const Image<double> depth = bowl(20, 20, 0.08, 1 / 18.0);
  const auto s = fit<Sphere<>>(camera, depth, tiny);
  const auto q = fit<Quadric<>>(camera, depth, tiny);
  REQUIRE((s.ok() && q.ok()));
  CHECK(s.shape.radius_mm() == Approx(18).epsilon(1e-8));
  CHECK(1 / q.shape.curvature_1_per_mm == Approx(18).epsilon(1e-8));
  CHECK(fit<Plane<>>(camera, depth, tiny).ok());

  const Flat far{-1e4, 2e4, 0.08};  // a kilometre of image away from the patch
  const Mask all(20, 20, 1);
  const auto f = fit<Sphere<>>(far, bowl(20, 20, 0.08, 1 / 18.0), all);
  REQUIRE(f.ok());
  CHECK(f.shape.radius_mm() == Approx(18).epsilon(1e-7));
  Camera<double> oblique;  // 50 degrees from the axis
  oblique.center_x_px = -600;
  oblique.center_y_px = -400;
  const Image<double> level(20, 20, 9);
  const auto p = fit<Plane<>>(oblique, level, all);
  REQUIRE(p.ok());
  CHECK(std::hypot(p.shape.normal.x, p.shape.normal.y) < 1e-12);
  CHECK(p.shape.distance_mm == Approx(9).epsilon(1e-13));
}

TEST_CASE("object surface: pixels in one line determine nothing", "[surface]") {
  const auto refused = [](const auto& camera, const Mask& mask) {
    for (const double noise : {0.0, 0.05}) {
      const Image<double> depth = bowl(40, 40, 0.08, 0.05, noise);
      CHECK(fit<Plane<>>(camera, depth, mask).status == SurfaceStatus::degenerate);
      CHECK(fit<Sphere<>>(camera, depth, mask).status == SurfaceStatus::degenerate);
      CHECK(fit<Quadric<>>(camera, depth, mask).status == SurfaceStatus::degenerate);
    }
  };
  Mask row(40, 40, 0), col(40, 40, 0), diagonal(40, 40, 0), rows(40, 40, 0), dot(40, 40, 0);
  for (Index k = 0; k < 40; ++k) {
    row(7, k) = col(k, 31) = diagonal(k, 39 - k) = 1;
    rows(7, k) = rows(8, k) = 1;
  }
  for (const Mask* line : {&row, &col, &diagonal}) {
    refused(Camera<double>(), *line);
    refused(centered_on(40, 40, 0.08), *line);
  }
  // two lines: where they are level, the curvature across them is undetermined
  const Flat camera = centered_on(40, 40, 0.08);
  const Image<double> depth = bowl(40, 40, 0.08, 0.05);
  CHECK(fit<Plane<>>(camera, depth, rows).ok());
  CHECK(fit<Sphere<>>(camera, depth, rows).shape.curvature_per_mm == Approx(0.05));
  CHECK(fit<Quadric<>>(camera, Image<double>(40, 40, 9), rows).status == SurfaceStatus::degenerate);
  dot(3, 4) = 1;
  CHECK(fit<Plane<>>(camera, depth, dot).status == SurfaceStatus::too_few);
  CHECK(fit<Plane<>>(camera, depth, dot).pixels == 1);
}

TEST_CASE("object surface: depths beyond all reason are missing", "[surface]") {
  const Flat camera = centered_on(20, 20, 0.08);
  const Mask mask(20, 20, 1);
  const auto with = [&](double z) {
    Image<double> depth = bowl(20, 20, 0.08, 0.05);
    depth(5, 6) = z;
    return std::array{fit<Plane<>>(camera, depth, mask).rms_mm,
                      fit<Sphere<>>(camera, depth, mask).rms_mm,
                      fit<Quadric<>>(camera, depth, mask).rms_mm};
  };
  for (const double z : {1e300, -1e300, 1e160, 100.0, -100.0}) {
    CHECK(with(z) == with(test::nan));
  }
}
