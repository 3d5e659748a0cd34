// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/contact/surface.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "fingerpad/optics/orthographic_camera.hpp"
#include "support/catch.hpp"
#include "support/digest.hpp"
#include "support/foreign_image.hpp"
#include "support/generators.hpp"
#include "support/numbers.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Image;

namespace {

using Point = Point3<double>;
using Mask = Image<unsigned char>;

constexpr int height = 60;
constexpr int width = 80;

/// n.q = (k1 (a.q)^2 + k2 (b.q)^2) / 2 + g (n.q)^2 with q from `foot` describes every object here.
struct Object {
  Point foot = {0.4, -0.3, 9};
  Point n = {0, 0, 1};
  Point a = {1, 0, 0};
  Point b = {0, 1, 0};
  double k1 = 0;
  double k2 = 0;
  double g = 0;

  static Object plane(const Point& normal) {
    Object object;
    object.n = normalized(normal);
    object.b = normalized(cross(object.n, Point{1, 0, 0}));
    object.a = cross(object.b, object.n);
    return object;
  }
  static Object sphere(const Point& normal, double radius_mm) {
    Object object = plane(normal);
    object.k1 = object.k2 = 1 / radius_mm;
    object.g = 0.5 / radius_mm;
    return object;
  }
  /// A cylinder whose axis is rotated by `angle` in the tangent plane.
  static Object cylinder(const Point& normal, double radius_mm, double angle) {
    Object object = saddle(normal, 1 / radius_mm, 0, angle);
    object.g = 0.5 / radius_mm;
    return object;
  }
  static Object saddle(const Point& normal, double k1, double k2, double angle) {
    const Object flat = plane(normal);
    Object object = flat;
    object.a = -std::sin(angle) * flat.a + std::cos(angle) * flat.b;
    object.b = std::cos(angle) * flat.a + std::sin(angle) * flat.b;
    object.k1 = k1;
    object.k2 = k2;
    return object;
  }

  double miss(const Point& p) const {
    const Point q = p - foot;
    const double along = dot(n, q);
    return along - 0.5 * (k1 * square(dot(a, q)) + k2 * square(dot(b, q))) - g * square(along);
  }
  /// Depth at which the pixel's straight ray meets the object near the foot; `miss` is quadratic.
  template <class CameraType>
  double depth(const CameraType& camera, Index row, Index col) const {
    const auto at = [&](double z) {
      return miss(point_at(camera, static_cast<double>(row), static_cast<double>(col), z));
    };
    const double z0 = foot.z;
    const double c = at(z0), ahead = at(z0 + 1), behind = at(z0 - 1);
    const double b1 = (ahead - behind) / 2;
    const double a1 = (ahead + behind) / 2 - c;
    return z0 - 2 * c / (b1 + std::copysign(std::sqrt(b1 * b1 - 4 * a1 * c), b1));
  }
  template <class CameraType>
  Image<double> depths(const CameraType& camera) const {
    Image<double> out(height, width);
    for (Index i = 0; i < height; ++i) {
      for (Index j = 0; j < width; ++j) {
        out(i, j) = depth(camera, i, j);
      }
    }
    return out;
  }
};

/// A disc in contact.
Mask disc(Index row, Index col, Index radius) {
  Mask mask(height, width, 0);
  for (Index i = 0; i < height; ++i) {
    for (Index j = 0; j < width; ++j) {
      mask(i, j) = (i - row) * (i - row) + (j - col) * (j - col) <= radius * radius ? 255 : 0;
    }
  }
  return mask;
}

template <class CameraType>
CameraType small_camera() {
  CameraType camera;
  camera.center_x_px = 38.5;
  camera.center_y_px = 30.25;
  camera.pitch_mm = 0.2;
  return camera;
}

/// Angle between the lines along two unit vectors.
double angle_between(const Point& p, const Point& q) {
  return std::asin((std::min)(1.0, norm(cross(p, q))));
}

const std::vector<Point> normals = {{0, 0, 1}, {0.2, -0.1, 1}, {-0.5, 0.4, 1}};

}  // namespace

TEMPLATE_TEST_CASE("surface: a plane is found with its tilt and distance",
                   "[surface]",
                   Camera<double>,
                   OrthographicCamera<double>) {
  const auto camera = small_camera<TestType>();
  for (const Point& normal : normals) {
    const Object object = Object::plane(normal);
    const auto r = fit_surface(camera, object.depths(camera), disc(28, 41, 20));
    REQUIRE(r.ok());
    CHECK(r.pixels == 1257);
    CHECK(norm(r.normal - object.n) < 1e-13);
    CHECK(dot(r.normal, r.point_mm) == Approx(dot(object.n, object.foot)).epsilon(1e-13));
    CHECK(std::abs(r.curvature_1_per_mm) < 1e-13);
    CHECK(r.rms_mm < 1e-7);
  }
}

TEMPLATE_TEST_CASE("surface: spheres that dent the pad and hollow ones",
                   "[surface]",
                   Camera<double>,
                   OrthographicCamera<double>) {
  const auto camera = small_camera<TestType>();
  for (const double radius : {18.0, 12.0, -25.0, 1000.0, -1e6}) {
    for (const Point& normal : normals) {
      const Object object = Object::sphere(normal, radius);
      const auto r = fit_surface(camera, object.depths(camera), disc(28, 41, 20));
      REQUIRE(r.ok());
      CHECK(std::abs(r.curvature_1_per_mm - 1 / radius) < 1e-12);
      CHECK(std::abs(r.curvature_2_per_mm - 1 / radius) < 1e-12);
      CHECK(std::abs(object.miss(r.point_mm)) < 1e-11);
      CHECK(r.rms_mm < 1e-7);
      if (std::abs(radius) < 100) {
        const Point middle = r.point_mm + radius * r.normal;
        CHECK(norm(middle - (object.foot + radius * object.n)) < 1e-10);
      }
    }
  }
}

TEMPLATE_TEST_CASE("surface: a cylinder is found with its axis",
                   "[surface]",
                   Camera<double>,
                   OrthographicCamera<double>) {
  const auto camera = small_camera<TestType>();
  for (const double radius : {12.0, -30.0}) {
    for (const double angle : {0.0, 0.6, 1.5707963267948966, 2.5}) {
      for (const Point& normal : normals) {
        const Object object = Object::cylinder(normal, radius, angle);
        const auto r = fit_surface(camera, object.depths(camera), disc(28, 41, 20));
        REQUIRE(r.ok());
        CHECK(r.curvature_1_per_mm * radius == Approx(1).epsilon(2e-3));
        CHECK(std::abs(r.curvature_2_per_mm) < 1e-4);
        CHECK(angle_between(r.direction_2, object.b) < 2e-3);
        CHECK(std::abs(dot(r.direction_1, r.direction_2)) < 1e-12);
        CHECK(std::abs(dot(r.direction_1, r.normal)) < 1e-12);
      }
    }
  }
}

TEMPLATE_TEST_CASE("surface: a saddle bends both ways",
                   "[surface]",
                   Camera<double>,
                   OrthographicCamera<double>) {
  const auto camera = small_camera<TestType>();
  for (const double angle : {0.0, 0.6, 2.5}) {
    const Object object = Object::saddle({0, 0, 1}, 0.04, -0.03, angle);
    // the closed form holds at the foot: a small patch around it
    const auto at = pixel_of(camera, object.foot);
    const Mask mask = disc(std::lround(at.y), std::lround(at.x), 10);
    const auto r = fit_surface(camera, object.depths(camera), mask);
    REQUIRE(r.ok());
    CHECK(r.curvature_1_per_mm == Approx(0.04).epsilon(0.01));
    CHECK(r.curvature_2_per_mm == Approx(-0.03).epsilon(0.01));
    CHECK(angle_between(r.direction_2, object.b) < 5e-3);
    CHECK(r.rms_mm < 1e-3);
  }
}

TEST_CASE("surface: grids of different sizes are refused", "[surface]") {
  const auto r = fit_surface(Camera<double>(), Image<double>(5, 4, 9), Mask(4, 5, 1));
  CHECK_FALSE(r.ok());
  CHECK(r.pixels == 0);
  CHECK(std::isnan(r.rms_mm));
}

TEST_CASE("surface: a camera of another number is computed in double", "[surface]") {
  const auto camera = small_camera<Camera<double>>();
  const Image<double> depth = Object::saddle({0.1, 0, 1}, 0.05, -0.03, 0.4).depths(camera);
  const auto wide = fit_surface(camera, depth, disc(28, 41, 20));
  const auto narrow = fit_surface(cast<float>(camera), depth, disc(28, 41, 20));
  REQUIRE((wide.ok() && narrow.ok()));
  CHECK(narrow.pixels == wide.pixels);
  CHECK(norm(narrow.normal - wide.normal) < 1e-6);
  CHECK(narrow.curvature_1_per_mm == Approx(wide.curvature_1_per_mm).epsilon(1e-4));
  CHECK(narrow.curvature_2_per_mm == Approx(wide.curvature_2_per_mm).epsilon(1e-4));
}

TEST_CASE("surface: too few pixels", "[surface]") {
  const auto camera = small_camera<Camera<double>>();
  const Image<double> depth = Object::sphere({0, 0, 1}, 18).depths(camera);
  Mask mask(height, width, 0);
  CHECK_FALSE(fit_surface(camera, depth, mask).ok());
  for (const Index j : {30, 35}) {
    mask(20, j) = mask(31, j - 4) = mask(44, j + 3) = 1;
  }
  const auto six = fit_surface(camera, depth, mask);
  CHECK_FALSE(six.ok());
  CHECK(six.pixels == 6);
  mask(20, 43) = mask(31, 39) = mask(44, 46) = 1;
  CHECK(fit_surface(camera, depth, mask).ok());
}

TEST_CASE("surface: noise leaves the errors that are reported", "[surface]") {
  // Over noisy frames of a sphere and of a cylinder: both curvatures.
  const auto camera = small_camera<OrthographicCamera<double>>();
  const double noise_mm = 0.05;
  test::Random random(4);
  double before = 0;
  for (const Index radius_px : {7, 14, 28}) {
    const Mask mask = disc(29, 40, radius_px);
    const Image<double> round = Object::sphere({0, 0, 1}, 18).depths(camera);
    const Image<double> rod = Object::cylinder({0, 0, 1}, 12, 0.6).depths(camera);
    double error = 0, bias = 0, reported = 0;
    double across = 0, reported_across = 0, along = 0, reported_along = 0;
    const int frames = 60;
    for (int k = 0; k < frames; ++k) {
      Image<double> a = round, b = rod;
      for (std::size_t c = 0; c < a.cells.size(); ++c) {
        a.cells[c] += noise_mm * random.normal();
        b.cells[c] += noise_mm * random.normal();
      }
      const auto s = fit_surface(camera, a, mask), r = fit_surface(camera, b, mask);
      REQUIRE((s.ok() && r.ok()));
      CHECK(s.rms_mm == Approx(noise_mm).epsilon(0.25));
      const double off = (s.curvature_1_per_mm + s.curvature_2_per_mm) / 2 - 1 / 18.0;
      error += square(off);
      bias += off;
      reported += square(s.curvature_1_sd_per_mm);
      across += square(r.curvature_1_per_mm - 1 / 12.0);
      reported_across += square(r.curvature_1_sd_per_mm);
      along += square(r.curvature_2_per_mm);
      reported_along += square(r.curvature_2_sd_per_mm);
    }
    CHECK(std::sqrt(error / reported) < 1.2);
    if (radius_px > 7) {  // with less the curvatures of a cylinder are not told apart
      CHECK(std::sqrt(across / reported_across) == Approx(1).epsilon(0.35));
      CHECK(std::sqrt(along / reported_along) == Approx(1).epsilon(0.35));
    }
    CHECK(std::abs(bias / frames) < 4 * std::sqrt(error) / frames);
    // n^(-1/2) for the number of pixels, 1/A^2 for the lever arm
    const double now = std::sqrt(error / frames);
    CHECK((before == 0 || (before / now > 5 && before / now < 13)));
    before = now;
  }
}

TEST_CASE("surface: nearly flat, flat, tiny and far from the axis", "[surface]") {
  const auto bowl = [](Index size, double pitch_mm, double curvature) {
    Image<double> depth(size, size);
    for (Index i = 0; i < size; ++i) {
      for (Index j = 0; j < size; ++j) {
        const double y = pitch_mm * (static_cast<double>(i) - static_cast<double>(size - 1) / 2);
        const double x = pitch_mm * (static_cast<double>(j) - static_cast<double>(size - 1) / 2);
        const double r_sq = x * x + y * y;
        depth(i, j) = 9 + curvature * r_sq / (1 + std::sqrt(1 - curvature * curvature * r_sq));
      }
    }
    return depth;
  };
  const auto mean = [](const SurfaceResult& r) {
    return (r.curvature_1_per_mm + r.curvature_2_per_mm) / 2;
  };
  const Mask all(41, 41, 1);
  const OrthographicCamera<double> camera{20, 20, 0.2};
  for (const double radius : {1e6, -1e6, 1e9}) {
    CHECK(std::abs(mean(fit_surface(camera, bowl(41, 0.2, 1 / radius), all)) - 1 / radius) < 1e-15);
  }
  const auto flat = fit_surface(camera, Image<double>(41, 41, 9), all);
  REQUIRE(flat.ok());
  CHECK(std::abs(flat.curvature_1_per_mm) < 1e-15);
  CHECK(flat.normal.z == Approx(1));
  CHECK(flat.rms_mm < 1e-7);

  Mask ten(20, 20, 0);
  for (Index j = 8; j < 11; ++j) {
    ten(9, j) = ten(10, j) = ten(11, j) = 1;
  }
  ten(12, 9) = 1;
  const Image<double> small = bowl(20, 0.08, 1 / 18.0);
  const auto tiny = fit_surface(OrthographicCamera<double>{9.5, 9.5, 0.08}, small, ten);
  CHECK(1 / tiny.curvature_1_per_mm == Approx(18).epsilon(1e-8));
  // a kilometre of image away from the patch
  const Mask square(20, 20, 1);
  const auto far = fit_surface(OrthographicCamera<double>{-1e4, 2e4, 0.08}, small, square);
  CHECK(1 / mean(far) == Approx(18).epsilon(1e-7));
  Camera<double> oblique;  // 50 degrees from the axis
  oblique.center_x_px = -600;
  oblique.center_y_px = -400;
  const auto level = fit_surface(oblique, Image<double>(20, 20, 9), square);
  REQUIRE(level.ok());
  CHECK(std::hypot(level.normal.x, level.normal.y) < 1e-12);
  CHECK(level.point_mm.z == Approx(9).epsilon(1e-13));
}

TEST_CASE("surface: pixels in one line, or in two level lines, determine nothing", "[surface]") {
  Mask row(height, width, 0), col = row, diagonal = row, rows = row;
  for (Index k = 0; k < 40; ++k) {
    row(7, k) = col(k, 31) = diagonal(k, 39 - k) = 1;
    rows(7, k) = rows(8, k) = 1;
  }
  const auto check = [&](const auto& camera) {
    test::Random random(9);
    for (const double noise : {0.0, 0.05}) {
      Image<double> depth = Object::sphere({0, 0, 1}, 20).depths(camera);
      for (double& z : depth.cells) {
        z += noise * random.normal();
      }
      for (const Mask* line : {&row, &col, &diagonal}) {
        const auto r = fit_surface(camera, depth, *line);
        CHECK_FALSE(r.ok());
        CHECK(r.pixels == 40);
        CHECK(std::isnan(r.normal.x));
      }
    }
  };
  check(small_camera<Camera<double>>());
  check(small_camera<OrthographicCamera<double>>());
  const Image<double> level(height, width, 9);
  const auto flat = small_camera<OrthographicCamera<double>>();
  CHECK_FALSE(fit_surface(flat, level, rows).ok());
}

TEST_CASE("surface: depths beyond all reason are missing", "[surface]") {
  const auto camera = small_camera<OrthographicCamera<double>>();
  const auto with = [&](double z) {
    Image<double> depth = Object::sphere({0, 0, 1}, 20).depths(camera);
    depth(25, 36) = z;
    return fit_surface(camera, depth, disc(28, 41, 20)).rms_mm;
  };
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double z : {1e300, -1e300, 1e160, 100.0, -100.0, infinite}) {
    CHECK(with(z) == with(test::nan));
  }
}

// Properties for every patch, both cameras.

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// A square image, so that it can be rotated about its center.
struct Patch {
  Index size;
  Image<double> depth;
  Mask mask;
};

Patch any_patch() {
  const Index size = test::whole(8, 22);
  Patch patch{size, Image<double>(size, size), Mask(size, size, 0)};
  const double slope_x = test::uniform(-0.5, 0.5), slope_y = test::uniform(-0.5, 0.5);
  const double bend = test::uniform(0.005, 0.02), twist = test::uniform(0.03, 0.05);
  const double noise = test::uniform(0, 0.02);
  for (Index i = 0; i < size; ++i) {
    for (Index j = 0; j < size; ++j) {
      const double x = 0.4 * static_cast<double>(j - size / 2);
      const double y = 0.4 * static_cast<double>(i - size / 2);
      patch.depth(i, j) = 9 + slope_x * x + slope_y * y + bend * x * x + twist * y * y +
                          test::uniform(-noise, noise);
      patch.mask(i, j) = test::whole(0, 9) > 0 ? 1 : 0;
    }
  }
  return patch;
}

template <class CameraType>
CameraType camera_for(Index size) {
  CameraType camera;
  camera.center_x_px = camera.center_y_px = static_cast<double>(size - 1) / 2;
  camera.pitch_mm = 0.4;
  return camera;
}

template <class T, class Place>
Image<T> placed(const Image<T>& image, const Place& place) {
  Image<T> out(image.rows(), image.cols());
  for (Index i = 0; i < image.rows(); ++i) {
    for (Index j = 0; j < image.cols(); ++j) {
      const auto [r, c] = place(i, j);
      out(r, c) = image(i, j);
    }
  }
  return out;
}

bool near(double a, double b, double by = 1e-9) {
  return std::abs(a - b) <= by;
}
bool near(const Point& a, const Point& b, double by = 1e-9) {
  return near(a.x, b.x, by) && near(a.y, b.y, by) && near(a.z, b.z, by);
}
/// Whether two directions are equal up to sign.
bool along(const Point& a, const Point& b, double by) {
  return near(a, b, by) || near(a, Point{-b.x, -b.y, -b.z}, by);
}

/// Whether `b` is `a` moved by `move`.
template <class Move>
bool is_moved(const SurfaceResult& a, const SurfaceResult& b, const Move& move) {
  return near(b.normal, move(a.normal, false), 1e-8) &&
         near(b.point_mm, move(a.point_mm, true), 1e-8) &&
         near(b.curvature_1_per_mm, a.curvature_1_per_mm, 1e-8) &&
         near(b.curvature_2_per_mm, a.curvature_2_per_mm, 1e-8) &&
         near(b.curvature_1_sd_per_mm, a.curvature_1_sd_per_mm, 1e-7) &&
         near(b.curvature_2_sd_per_mm, a.curvature_2_sd_per_mm, 1e-7) &&
         along(b.direction_1, move(a.direction_1, false), 1e-5) &&
         along(b.direction_2, move(a.direction_2, false), 1e-5);
}

/// For both cameras.
template <class Check>
void for_both(const Check& check) {
  check(Camera<double>());
  check(OrthographicCamera<double>());
}

}  // namespace

TEST_CASE("surface: rotated and mirrored scenes give rotated and mirrored shapes", "[surface]") {
  rc::prop("a quarter turn about the axis, and a mirror", [] {
    const Patch patch = any_patch();
    const Index last = patch.size - 1;
    for_both([&](auto kind) {
      const auto camera = camera_for<decltype(kind)>(patch.size);
      const auto before = fit_surface(camera, patch.depth, patch.mask);
      RC_ASSERT(before.ok());
      const auto check = [&](const auto& place, const auto& move) {
        const auto after =
            fit_surface(camera, placed(patch.depth, place), placed(patch.mask, place));
        RC_ASSERT(after.ok());
        RC_ASSERT(near(after.rms_mm, before.rms_mm, 1e-7));
        RC_ASSERT(is_moved(before, after, move));
      };
      // x to y, y to -x
      check([&](Index i, Index j) { return std::pair<Index, Index>(j, last - i); },
            [](const Point& p, bool) {
              return Point{-p.y, p.x, p.z};
            });
      check([&](Index i, Index j) { return std::pair<Index, Index>(i, last - j); },
            [](const Point& p, bool) {
              return Point{-p.x, p.y, p.z};
            });
    });
  });
}

TEST_CASE("surface: a pixel without depth is as one without contact", "[surface]") {
  rc::prop("and neither changes anything else", [] {
    const Patch patch = any_patch();
    Image<double> holed = patch.depth, other = patch.depth;
    Mask without = patch.mask;
    for (Index i = 0; i < patch.size; ++i) {
      for (Index j = 0; j < patch.size; ++j) {
        if (test::whole(0, 5) == 0) {
          holed(i, j) = test::whole(0, 1) == 0 ? test::nan : -infinite;
          without(i, j) = 0;
        }
        if (without(i, j) == 0) {
          other(i, j) = 1e9;
        }
      }
    }
    for_both([&](auto kind) {
      const auto camera = camera_for<decltype(kind)>(patch.size);
      const auto with_nan = fit_surface(camera, holed, patch.mask);
      const auto unset = fit_surface(camera, patch.depth, without);
      const auto garbage = fit_surface(camera, other, without);
      RC_ASSERT(with_nan.pixels == unset.pixels);
      RC_ASSERT(test::same_bits(with_nan.rms_mm, unset.rms_mm));
      RC_ASSERT(test::same_bits(garbage.curvature_1_per_mm, unset.curvature_1_per_mm));
    });
  });
}

TEST_CASE("surface: whatever comes in, an ok result holds finite numbers", "[surface]") {
  rc::prop("any depths, any mask", [] {
    const Index rows = test::whole(1, 9), cols = test::whole(1, 9);
    Image<double> depth(rows, cols);
    Mask mask(rows, cols, 0);
    const std::vector<double> odd = {test::nan, infinite, -infinite, 0,      -0.0, 1e300, -1e300,
                                     1e-310,    1e80,     1e-80,     1e-160, -4,   1e10};
    const auto oddness = test::whole(0, 10);
    const double base = odd[static_cast<std::size_t>(test::whole(3, 12))];
    for (Index i = 0; i < rows; ++i) {
      for (Index j = 0; j < cols; ++j) {
        const bool is_odd = test::whole(0, 9) < oddness;
        depth(i, j) =
            is_odd ? odd[static_cast<std::size_t>(test::whole(0, 12))] : base + test::uniform(0, 1);
        mask(i, j) = test::whole(0, 4) > 0 ? 1 : 0;
      }
    }
    const double pitch_mm = test::whole(0, 3) == 0 ? test::log_uniform(1e-150, 1e150) : 0.1;
    for_both([&](auto camera) {
      camera.pitch_mm = pitch_mm;
      camera.center_x_px = test::uniform(-10, 10);
      const auto r = fit_surface(camera, depth, mask);
      const std::array numbers = {r.curvature_1_per_mm,
                                  r.curvature_2_per_mm,
                                  r.curvature_1_sd_per_mm,
                                  r.curvature_2_sd_per_mm,
                                  r.direction_1.x,
                                  r.direction_2.y,
                                  r.point_mm.x,
                                  r.point_mm.z,
                                  r.normal.x,
                                  r.rms_mm};
      RC_ASSERT(std::all_of(numbers.begin(), numbers.end(),
                            [&](double x) { return r.ok() ? std::isfinite(x) : std::isnan(x); }));
      RC_ASSERT((!r.ok() || r.normal.z > 0));
    });
  });
}

TEST_CASE("unchanged: a ball seen with noise", "[unchanged]") {
  const OrthographicCamera<double> camera{39.5, 29.5, 0.1};
  test::Random random(4);
  test::Digest d;
  for (const double radius_mm : {3.0, 6.0, 40.0}) {
    Image<double> depth(height, width);
    Mask mask(height, width);
    for (Index i = 0; i < height; ++i) {
      for (Index j = 0; j < width; ++j) {
        const double x = 0.1 * (double(j) - 43), y = 0.1 * (double(i) - 27), sq = x * x + y * y;
        mask(i, j) = sq < 5 ? 1 : 0;
        depth(i, j) = 9 - radius_mm + std::sqrt(radius_mm * radius_mm - std::fmin(sq, 5.0)) +
                      0.02 * random.normal();
      }
    }
    const auto r = fit_surface(camera, depth, mask);
    d.all(r.pixels, r.curvature_1_per_mm, r.curvature_2_per_mm, r.curvature_1_sd_per_mm,
          r.curvature_2_sd_per_mm, r.point_mm, r.normal, r.rms_mm);
  }
  CHECK(d.sum() == test::same(323.681));
}
