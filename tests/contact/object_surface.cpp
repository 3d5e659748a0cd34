// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
#include "fingerpad/contact/object_surface.hpp"

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "fingerpad/adapt/eigen.hpp"
#include "fingerpad/adapt/opencv.hpp"
#include "support/catch.hpp"
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
    const auto frame = detail::SurfaceFrame<double>::around(normalized(normal));
    Object object;
    object.n = frame.n;
    object.a = frame.u;
    object.b = frame.v;
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
    Object object = plane(normal);
    const auto f = detail::SurfaceFrame<double>{object.a, object.b, object.n};
    object.a = f.from_frame({-std::sin(angle), std::cos(angle), 0});
    object.b = f.from_frame({std::cos(angle), std::sin(angle), 0});
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

template <class Model, class CameraType, class Depth, class Contact>
auto fit(const CameraType& camera,
         const Depth& depth,
         const Contact& mask,
         const SurfaceOptions& options = {}) {
  return SurfaceFit<Model, CameraType>(height, width, camera, options)(depth, mask);
}

double apart(const Point& p, const Point& q) {
  const Point d = p - q;
  return std::sqrt(dot(d, d));
}
/// Angle between the lines along two unit vectors.
double angle_between(const Point& p, const Point& q) {
  const Point c = cross(p, q);
  return std::asin((std::min)(1.0, std::sqrt(dot(c, c))));
}

const std::vector<Point> normals = {{0, 0, 1}, {0.2, -0.1, 1}, {-0.5, 0.4, 1}};

template <class Result>
bool is_empty(const Result& r) {
  return !r.accepted() && !r.ok() && r.pixels == 0 && std::isnan(r.rms_mm);
}

std::string refusal(Index r, Index c, const SurfaceOptions& options, double pitch_mm = 0.1) {
  try {
    OrthographicCamera<double> camera;
    camera.pitch_mm = pitch_mm;
    const SurfaceFit<Plane<>, OrthographicCamera<double>> made(r, c, camera, options);
  } catch (const parameter_error& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("the frame of a normal is right-handed, and u lies in its plane with an axis", "[math]") {
  rc::prop("whatever the normal", [] {
    const Point n =
        normalized(Point{test::uniform(-1, 1), test::uniform(-1, 1), test::uniform(0.01, 1)});
    const auto frame = detail::SurfaceFrame<double>::around(n);
    const bool steep = n.x * n.x > 0.5;
    const auto is_near = [](double a, double b) { return std::abs(a - b) < 1e-14; };
    RC_ASSERT((frame.n.x == n.x && frame.n.y == n.y && frame.n.z == n.z));
    RC_ASSERT(is_near(squared_norm(frame.u), 1));
    RC_ASSERT(is_near(squared_norm(frame.v), 1));
    RC_ASSERT(is_near(dot(frame.u, frame.v), 0));
    RC_ASSERT(is_near(dot(cross(frame.u, frame.v), n), 1));
    // v is perpendicular to the axis
    RC_ASSERT((steep ? frame.v.y : frame.v.x) == 0);
    RC_ASSERT((steep ? frame.u.y : frame.u.x) > 0);
  });
}

TEMPLATE_TEST_CASE("object surface: a plane is found with its tilt and distance",
                   "[surface]",
                   Camera<double>,
                   OrthographicCamera<double>) {
  const auto camera = small_camera<TestType>();
  const Mask mask = disc(28, 41, 20);
  for (const Point& normal : normals) {
    const Object object = Object::plane(normal);
    Image<double> residual(height, width);
    const auto r =
        SurfaceFit<Plane<>, TestType>(height, width, camera)(object.depths(camera), mask, residual);
    REQUIRE(r.ok());
    CHECK(r.pixels == 1257);
    CHECK(apart(r.shape.normal, object.n) < 1e-13);
    CHECK(r.shape.distance_mm == Approx(dot(object.n, object.foot)).epsilon(1e-13));
    CHECK(r.rms_mm < 1e-13);
    CHECK(std::abs(r.largest_mm) < 1e-12);
  }
}

TEMPLATE_TEST_CASE("object surface: spheres that dent the pad and hollow ones",
                   "[surface]",
                   Camera<double>,
                   OrthographicCamera<double>) {
  const auto camera = small_camera<TestType>();
  const Mask mask = disc(28, 41, 20);
  for (const double radius : {18.0, 12.0, -25.0, 1000.0, -1e6}) {
    for (const Point& normal : normals) {
      const Object object = Object::sphere(normal, radius);
      Image<double> residual(height, width);
      const auto r = SurfaceFit<Sphere<>, TestType>(height, width, camera)(object.depths(camera),
                                                                           mask, residual);
      REQUIRE(r.ok());
      CHECK(r.shape.is_convex() == (radius > 0));
      CHECK(std::abs(r.shape.curvature_per_mm - 1 / radius) < 1e-13);
      CHECK(r.rms_mm < 1e-12);
      CHECK(std::abs(object.miss(r.shape.point_mm)) < 1e-12);
      if (std::abs(radius) < 100) {
        CHECK(apart(r.shape.center_mm(), object.foot + radius * object.n) < 1e-10);
      }
      const auto q = fit<Quadric<>>(camera, object.depths(camera), mask);
      REQUIRE(q.ok());
      CHECK(std::abs(q.shape.curvature_1_per_mm - 1 / radius) < 1e-12);
      CHECK(std::abs(q.shape.curvature_2_per_mm - 1 / radius) < 1e-12);
    }
  }
}

TEMPLATE_TEST_CASE("object surface: a cylinder is found with its axis",
                   "[surface]",
                   Camera<double>,
                   OrthographicCamera<double>) {
  const auto camera = small_camera<TestType>();
  const Mask mask = disc(28, 41, 20);
  for (const double radius : {12.0, -30.0}) {
    for (const double angle : {0.0, 0.6, 1.5707963267948966, 2.5}) {
      for (const Point& normal : normals) {
        const Object object = Object::cylinder(normal, radius, angle);
        const auto q = fit<Quadric<>>(camera, object.depths(camera), mask);
        REQUIRE(q.ok());
        CHECK(q.shape.curvature_1_per_mm * radius == Approx(1).epsilon(2e-3));
        CHECK(std::abs(q.shape.curvature_2_per_mm) < 1e-4);
        CHECK(angle_between(q.shape.direction_2, object.b) < 2e-3);
        CHECK(std::abs(dot(q.shape.direction_1, q.shape.direction_2)) < 1e-12);
      }
    }
  }
}

TEMPLATE_TEST_CASE("object surface: a saddle bends both ways",
                   "[surface]",
                   Camera<double>,
                   OrthographicCamera<double>) {
  const auto camera = small_camera<TestType>();
  for (const double angle : {0.0, 0.6, 2.5}) {
    const Object object = Object::saddle({0, 0, 1}, 0.04, -0.03, angle);
    Image<double> residual(height, width);
    // the closed form holds at the foot: a small patch around it
    const auto at = pixel_of(camera, object.foot);
    const Mask mask = disc(std::lround(at.y), std::lround(at.x), 10);
    const SurfaceFit<Quadric<>, TestType> surface(height, width, camera);
    const auto q = surface(object.depths(camera), mask, residual);
    REQUIRE(q.ok());
    CHECK(q.shape.curvature_1_per_mm == Approx(0.04).epsilon(0.01));
    CHECK(q.shape.curvature_2_per_mm == Approx(-0.03).epsilon(0.01));
    CHECK(angle_between(q.shape.direction_2, object.b) < 5e-3);
    CHECK(q.rms_mm < 1e-3);
  }
}

TEST_CASE("object surface: what stands out into the pad is positive", "[surface]") {
  const auto camera = small_camera<OrthographicCamera<double>>();
  const Mask mask = disc(28, 41, 20);
  for (const double bump : {0.05, -0.05}) {
    const auto check = [&](auto model, const Object& object) {
      Image<double> depth = object.depths(camera);
      depth(25, 44) -= bump;  // toward the plate: out of the object
      Image<double> residual(height, width);
      const SurfaceFit<decltype(model), OrthographicCamera<double>> surface(height, width, camera);
      const auto r = surface(depth, mask, residual);
      REQUIRE(r.ok());
      CHECK(r.largest_mm == Approx(bump).epsilon(0.02));
      CHECK(r.largest_row == 25);
      CHECK(r.largest_col == 44);
      CHECK(residual(25, 44) == r.largest_mm);
      CHECK(r.rms_mm == Approx(std::abs(bump) / std::sqrt(1257.0)).epsilon(0.02));
    };
    check(Plane<>(), Object::plane({0.05, 0, 1}));
    check(Sphere<>(), Object::sphere({0.05, 0, 1}, 18));
    check(Sphere<>(), Object::sphere({0.05, 0, 1}, -18));
    check(Quadric<>(), Object::sphere({0.05, 0, 1}, 18));
  }
}

TEMPLATE_TEST_CASE("object surface: the residual map is written where the fit looked",
                   "[surface]",
                   Plane<>,
                   Sphere<>,
                   Quadric<>) {
  const auto camera = small_camera<Camera<double>>();
  Mask mask = disc(28, 41, 20);
  Image<double> depth = Object::sphere({0, 0, 1}, 18).depths(camera);
  depth(28, 41) = test::nan;
  depth(30, 30) = std::numeric_limits<double>::infinity();
  const SurfaceFit<TestType> surface(height, width, camera);
  Image<double> residual(height, width, 7);
  const auto r = surface(depth, mask, residual);
  REQUIRE(r.ok());
  CHECK(r.pixels == 1255);
  double sum_sq = 0;
  for (Index i = 0; i < height; ++i) {
    for (Index j = 0; j < width; ++j) {
      const bool used = mask(i, j) != 0 && std::isfinite(depth(i, j));
      CHECK(std::isnan(residual(i, j)) == !used);
      sum_sq += used ? square(residual(i, j)) : 0;
      if (used) {
        const Point p =
            point_at(camera, static_cast<double>(i), static_cast<double>(j), depth(i, j));
        CHECK(std::abs(residual(i, j) - r.shape.stands_out(p)) < 1e-13);
      }
    }
  }
  CHECK(r.rms_mm == Approx(std::sqrt(sum_sq / 1255)).margin(1e-15));
  const auto without = surface(depth, mask);
  CHECK(without.rms_mm == Approx(r.rms_mm).margin(1e-7));
  CHECK(std::isnan(without.largest_mm));
  Image<double> both = depth;
  (void)surface(both, mask, both);
  CHECK(test::same_bits(both, residual));
  mask.cells.assign(mask.cells.size(), 0);
  CHECK_FALSE(surface(depth, mask, residual).ok());
  CHECK(std::all_of(residual.cells.begin(), residual.cells.end(),
                    [](double x) { return std::isnan(x); }));
}

TEST_CASE("object surface: another size is refused and nothing written", "[surface]") {
  const SurfaceFit<> surface(4, 5, Camera<double>());
  const Image<double> good(4, 5, 9), bad(5, 4, 9);
  const Mask mask(4, 5, 1), other(4, 6, 1);
  Image<double> out(4, 5, 7), small(3, 5, 7);
  CHECK(is_empty(surface(bad, mask)));
  CHECK(is_empty(surface(good, other)));
  CHECK(is_empty(surface(bad, mask, out)));
  CHECK(is_empty(surface(good, other, out)));
  CHECK(is_empty(surface(good, mask, small)));
  CHECK(out.cells == std::vector<double>(20, 7));
  CHECK(small.cells == std::vector<double>(15, 7));
}

TEST_CASE("object surface: bad parameters are refused by name", "[surface]") {
  CHECK(refusal(0, 4, {}) == "SurfaceFit: rows = 0, must be in [1, 1000000]");
  CHECK(refusal(4, -1, {}) == "SurfaceFit: cols = -1, must be in [1, 1000000]");
  CHECK(refusal(4, 4, {.min_px = 0}) == "SurfaceOptions: min_px = 0, must be >= 1");
  CHECK(refusal(4, 4, {.border_px = -1}) == "SurfaceOptions: border_px = -1, must be in [0, 1000]");
  CHECK(refusal(4, 4, {}, 0).find("OrthographicCamera: pitch_mm = 0") == 0);
  CHECK(refusal(1, 1, {}) == "accepted");
}

TEMPLATE_TEST_CASE("object surface: every kind of grid gives the same bits",
                   "[surface]",
                   Plane<>,
                   Sphere<>,
                   Quadric<>) {
  const auto camera = small_camera<Camera<double>>();
  const Mask mask = disc(28, 41, 20);
  Image<float> depth(height, width);
  const Image<double> exact = Object::sphere({0.1, 0, 1}, 18).depths(camera);
  std::copy(exact.cells.begin(), exact.cells.end(), depth.cells.begin());
  const SurfaceFit<TestType> surface(height, width, camera);
  Image<float> expected(height, width);
  const auto r = surface(depth, mask, expected);
  REQUIRE(r.ok());

  Eigen::ArrayXXf depth_e(height, width);
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> mask_e(height, width);
  cv::Mat_<float> depth_c(height, width);
  cv::Mat_<unsigned char> mask_c(height, width);
  test::ForeignImage<float> depth_f(height, width);
  test::ForeignImage<int> mask_f(height, width);
  std::vector<unsigned char> wide(static_cast<std::size_t>(height * width * 3), 99);
  for (Index i = 0; i < height; ++i) {
    for (Index j = 0; j < width; ++j) {
      depth_e(i, j) = depth_c(static_cast<int>(i), static_cast<int>(j)) = depth(i, j);
      mask_e(i, j) = mask(i, j) != 0;
      mask_c(static_cast<int>(i), static_cast<int>(j)) = mask(i, j);
      grid_traits<test::ForeignImage<float>>::at(depth_f, i, j) = depth(i, j);
      grid_traits<test::ForeignImage<int>>::at(mask_f, i, j) = mask(i, j);
      wide[static_cast<std::size_t>((i * width + j) * 3 + 1)] = mask(i, j);
    }
  }
  const auto same = [&](const auto& d, const auto& m) {
    Image<float> out(height, width);
    const auto other = surface(d, m, out);
    CHECK(other.rms_mm == r.rms_mm);
    CHECK(other.largest_mm == r.largest_mm);
    CHECK(test::same_bits(out, expected));
  };
  same(depth_e, mask_e);
  same(depth_c, mask_c);
  same(depth_f, mask_f);
  same(depth_e, interleaved_channel(wide.data(), height, width, 3, 1, 3 * width));
  same(depth,
       LazyView(height, width, [&](Index i, Index j) { return mask(i, j) != 0 ? 1.0F : 0; }));
}

TEST_CASE("object surface: points in mm, as a view", "[surface]") {
  const auto camera = small_camera<Camera<double>>();
  const Mask mask = disc(28, 41, 20);
  Image<double> depth = Object::sphere({0.1, 0, 1}, 18).depths(camera);
  depth(28, 41) = test::nan;
  const auto points = surface_points(camera, depth, mask);
  REQUIRE(same_size(points, depth));
  static_assert(spatial_dot_grid<decltype(points)>);
  CHECK(count_present(points) == 1256);
  const Point p = point_at(camera, 30.0, 40.0, depth(30, 40));
  CHECK(apart(points(30, 40), p) == 0);
  CHECK_FALSE(is_present(points(28, 41)));

  const Mask other(2, 2, 1);
  CHECK(surface_points(camera, depth, other).rows() == 0);
  CHECK(surface_points(camera, depth, other).cols() == 0);
}

TEST_CASE("object surface: a strip along the border is left out", "[surface]") {
  const auto camera = small_camera<OrthographicCamera<double>>();
  Image<double> depth = Object::plane({0.1, 0, 1}).depths(camera);
  const Mask mask = disc(28, 41, 20);
  for (Index i = 0; i < height; ++i) {
    for (Index j = 0; j < width; ++j) {
      const bool outer = (i - 28) * (i - 28) + (j - 41) * (j - 41) > 16 * 16;
      depth(i, j) += outer ? 1 : 0;  // where the membrane leaves the object
    }
  }
  CHECK(fit<Plane<>>(camera, depth, mask).rms_mm > 0.1);
  const auto inner = fit<Plane<>>(camera, depth, mask, {.border_px = 5});
  CHECK(inner.rms_mm < 1e-6);
  Index expected = 0;  // as defined: 5 px along rows and columns, 4 px and 4 px along diagonals
  for (Index i = 5; i < height - 5; ++i) {
    for (Index j = 5; j < width - 5; ++j) {
      const bool straight = mask(i, j - 5) && mask(i, j + 5) && mask(i - 5, j) && mask(i + 5, j);
      const bool oblique =
          mask(i - 4, j - 4) && mask(i - 4, j + 4) && mask(i + 4, j - 4) && mask(i + 4, j + 4);
      expected += mask(i, j) && straight && oblique ? 1 : 0;
    }
  }
  CHECK(inner.pixels == expected);
  const auto frame = fit<Plane<>>(camera, depth, Mask(height, width, 1), {.border_px = 5});
  CHECK(frame.pixels == height * width);  // contact may continue beyond the image
  CHECK(fit<Plane<>>(camera, depth, mask, {.border_px = 30}).pixels == 0);
}

TEST_CASE("object surface: too few pixels", "[surface]") {
  const auto camera = small_camera<Camera<double>>();
  const Image<double> depth = Object::sphere({0, 0, 1}, 18).depths(camera);
  Mask mask(height, width, 0);
  const auto status = [&](auto model, Index least) {
    const auto r = fit<decltype(model)>(camera, depth, mask, {.min_px = least});
    CHECK(r.accepted());
    CHECK(r.ok() == std::isfinite(r.rms_mm));
    return r.status;
  };
  CHECK(status(Plane<>(), 1) == SurfaceStatus::too_few);
  for (const Index j : {30, 35, 43}) {
    mask(20, j) = mask(31, j - 4) = mask(44, j + 3) = 1;
  }
  CHECK(status(Plane<>(), 9) == SurfaceStatus::ok);
  CHECK(status(Sphere<>(), 9) == SurfaceStatus::ok);
  CHECK(status(Quadric<>(), 9) == SurfaceStatus::ok);
  CHECK(status(Plane<>(), 10) == SurfaceStatus::too_few);
}

TEST_CASE("object surface: noise leaves the errors that are reported", "[surface]") {
  // Over noisy frames: the plane's distance, the sphere's and the quadric's curvature.
  const auto camera = small_camera<OrthographicCamera<double>>();
  const double noise_mm = 0.05;
  test::Random random(4);
  double before = 0;
  for (const Index radius_px : {7, 14, 28}) {
    const Mask mask = disc(29, 40, radius_px);
    const Image<double> flat = Object::plane({0, 0, 1}).depths(camera);
    const Image<double> round = Object::sphere({0, 0, 1}, 18).depths(camera);
    const SurfaceFit<Plane<>, OrthographicCamera<double>> plane(height, width, camera);
    const SurfaceFit<Sphere<>, OrthographicCamera<double>> sphere(height, width, camera);
    const SurfaceFit<Quadric<>, OrthographicCamera<double>> quadric(height, width, camera);
    double distance = 0, curvature = 0, bias = 0, bent = 0, reported[3] = {0, 0, 0};
    const int frames = 60;
    for (int k = 0; k < frames; ++k) {
      Image<double> a = flat, b = round;
      for (std::size_t c = 0; c < a.cells.size(); ++c) {
        a.cells[c] += noise_mm * random.normal();
        b.cells[c] += noise_mm * random.normal();
      }
      const auto p = plane(a, mask);
      const auto s = sphere(b, mask);
      const auto q = quadric(b, mask);
      REQUIRE((p.ok() && s.ok() && q.ok()));
      CHECK(p.rms_mm == Approx(noise_mm).epsilon(0.25));
      distance += square(dot(p.shape.normal, p.shape.center_mm) - 9 * p.shape.normal.z);
      curvature += square(s.shape.curvature_per_mm - 1 / 18.0);
      bias += s.shape.curvature_per_mm - 1 / 18.0;
      bent += square(q.shape.mean_curvature_per_mm() - 1 / 18.0);
      reported[0] += square(p.shape.distance_sd_mm);
      reported[1] += square(s.shape.curvature_sd_per_mm);
      reported[2] += square(q.shape.curvature_1_sd_per_mm);
    }
    CHECK(std::sqrt(distance / reported[0]) == Approx(1).epsilon(0.35));
    CHECK(std::sqrt(curvature / reported[1]) == Approx(1).epsilon(0.35));
    CHECK(std::sqrt(bent / reported[2]) < 1.2);
    const double of_mean = std::sqrt(curvature) / frames;
    CHECK(std::abs(bias / frames) < 4 * of_mean);
    // n^(-1/2) for the number of pixels, 1/A^2 for the lever arm
    const double now = std::sqrt(curvature / frames);
    CHECK((before == 0 || (before / now > 5 && before / now < 13)));
    before = now;
  }
}

TEST_CASE("object surface: float depth maps keep their digits", "[surface]") {
  const auto camera = small_camera<Camera<double>>();
  const Image<double> exact = Object::sphere({0.1, 0, 1}, 18).depths(camera);
  Image<float> depth(height, width);
  std::copy(exact.cells.begin(), exact.cells.end(), depth.cells.begin());
  const auto r = fit<Sphere<>>(camera, depth, disc(28, 41, 20));
  REQUIRE(r.ok());
  CHECK(r.shape.radius_mm() == Approx(18).epsilon(1e-6));
  CHECK(r.rms_mm < 5e-7);  // 9 mm in float: 4.8e-7 between neighbouring numbers
}

TEST_CASE("object surface: a camera of float has its sums in double", "[surface]") {
  const auto camera = small_camera<Camera<double>>();
  const Object saddle = Object::saddle({0.1, 0, 1}, 0.05, -0.03, 0.4);
  const Mask mask = disc(28, 41, 20);
  const auto off = [](const auto& a, const Point& b) { return norm(cast<double>(a) - b); };
  const auto compare = [&]<class Shape>(const Object& object, Shape) {
    const Image<double> depth = object.depths(camera);
    const auto wide = fit<Shape>(camera, depth, mask);
    Image<float> residual(height, width);
    const auto narrow =
        SurfaceFit<Shape, Camera<float>>(height, width, cast<float>(camera))(depth, mask, residual);
    static_assert(std::same_as<decltype(narrow.rms_mm), float>);
    REQUIRE(wide.ok());
    REQUIRE(narrow.ok());
    CHECK(narrow.pixels == wide.pixels);
    CHECK(off(narrow.shape.normal, wide.shape.normal) < 1e-6);
    CHECK(std::abs(narrow.largest_mm) < 1e-5F + 2 * static_cast<float>(wide.rms_mm) * 10);
    CHECK(is_finite(residual(28, 41)));
    return std::pair(wide.shape, narrow.shape);
  };
  const auto [plane, float_plane] = compare(Object::plane({0.1, 0.2, 1}), Plane<>());
  CHECK(float_plane.distance_mm == Approx(plane.distance_mm).epsilon(1e-6));
  CHECK(off(float_plane.center_mm, plane.center_mm) < 1e-5);
  const auto [ball, float_ball] = compare(Object::sphere({0.1, 0, 1}, 18), Sphere<>());
  CHECK(float_ball.radius_mm() == Approx(ball.radius_mm()).epsilon(1e-5));
  CHECK(off(float_ball.point_mm, ball.point_mm) < 1e-5);
  const auto [bent, float_bent] = compare(saddle, Quadric<>());
  CHECK(float_bent.curvature_1_per_mm == Approx(bent.curvature_1_per_mm).epsilon(1e-4));
  CHECK(float_bent.curvature_2_per_mm == Approx(bent.curvature_2_per_mm).epsilon(1e-4));
  CHECK(off(float_bent.direction_1, bent.direction_1) < 1e-3);
  CHECK(off(float_bent.origin_mm, bent.origin_mm) < 1e-5);
  CHECK(static_cast<double>(float_bent.coefficients[3]) ==
        Approx(bent.coefficients[3]).margin(1e-5));
}

TEST_CASE("object surface: derivatives pass through the fit", "[surface]") {
  using Dual = test::Dual<double>;
  const auto camera = small_camera<OrthographicCamera<double>>();
  const OrthographicCamera<Dual> dual_camera{Dual(38.5), Dual(30.25), Dual(0.2)};
  const Mask mask = disc(28, 41, 20);
  // d/dk of a sphere's curvature when the depths grow by k r^2 / 2
  const auto curvature = [&](const auto& cam, auto seed) {
    using S = decltype(seed);
    Image<S> depth(height, width);
    for (Index i = 0; i < height; ++i) {
      for (Index j = 0; j < width; ++j) {
        const double r_sq =
            0.04 * (square(static_cast<double>(i) - 28) + square(static_cast<double>(j) - 41));
        depth(i, j) = S(9 + 0.01 * r_sq) + seed * S(r_sq / 2);
      }
    }
    const auto r = fit<Sphere<>>(cam, depth, mask);
    REQUIRE(r.ok());
    return r.shape.curvature_per_mm;
  };
  const double slope = curvature(dual_camera, Dual(0.01, 1)).d;
  const double step = 1e-5;
  const double expected = (curvature(camera, 0.01 + step) - curvature(camera, 0.01 - step)) / 2e-5;
  CHECK(slope == Approx(expected).epsilon(1e-6));
}

TEST_CASE("object surface: distance from a quadric grows by 1 mm per mm across it", "[surface]") {
  Quadric<> quadric;
  quadric.origin_mm = {1, -2, 3};
  quadric.u = {0.6, 0.8, 0};
  quadric.v = {-0.8, 0.6, 0};
  quadric.w = {0, 0, 1};
  quadric.coefficients = {0.1, 0.3, -0.2, 0.05, 0.08, -0.06};
  quadric.g_per_mm = 0.04;
  for (const double x : {-2.0, 0.0, 1.5}) {
    for (const double y : {-1.0, 0.5, 2.0}) {
      CAPTURE(x, y);
      const auto at = [&](double z) {
        return quadric.origin_mm + x * quadric.u + y * quadric.v + z * quadric.w;
      };
      double low = -5, high = 5;  // the surface lies between: its distance falls along w
      for (int k = 0; k < 60; ++k) {
        const double middle = (low + high) / 2;
        (quadric.stands_out(at(middle)) > 0 ? low : high) = middle;
      }
      const Point on = at(low);
      constexpr double step = 1e-4;
      const auto slope = [&](const Point& along) {
        return (quadric.stands_out(on + step * along) - quadric.stands_out(on + -step * along)) /
               (2 * step);
      };
      const double squares =
          square(slope({1, 0, 0})) + square(slope({0, 1, 0})) + square(slope({0, 0, 1}));
      CHECK(std::sqrt(squares) == Approx(1).epsilon(1e-6));
    }
  }
}
