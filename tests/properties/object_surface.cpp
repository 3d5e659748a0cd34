// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every patch, every model and both cameras.
#include "fingerpad/contact/object_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "support/catch.hpp"
#include "support/generators.hpp"
#include "support/pad.hpp"

using namespace fingerpad;
using test::Image;

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

using Point = Point3<double>;
using Mask = Image<unsigned char>;

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

/// Whether `b` is `a` moved by `move`, with curvatures times `bend` and lengths times 1 / bend.
template <class Move>
bool is_moved(const Plane<double>& a, const Plane<double>& b, const Move& move, double) {
  return near(b.normal, move(a.normal, false)) && near(b.center_mm, move(a.center_mm, true));
}
template <class Move>
bool is_moved(const Sphere<double>& a, const Sphere<double>& b, const Move& move, double bend) {
  return near(b.normal, move(a.normal, false)) && near(b.point_mm, move(a.point_mm, true)) &&
         near(b.curvature_per_mm, bend * a.curvature_per_mm) &&
         near(b.curvature_sd_per_mm, bend * a.curvature_sd_per_mm, 1e-7);
}
template <class Move>
bool is_moved(const Quadric<double>& a, const Quadric<double>& b, const Move& move, double bend) {
  return near(b.normal, move(a.normal, false), 1e-8) &&
         near(b.point_mm, move(a.point_mm, true), 1e-8) &&
         near(b.curvature_1_per_mm, bend * a.curvature_1_per_mm, 1e-8) &&
         near(b.curvature_2_per_mm, bend * a.curvature_2_per_mm, 1e-8) &&
         along(b.direction_1, move(a.direction_1, false), 1e-5);
}

struct Everything {
  template <class Check>
  void operator()(const Check& check) const {
    using Flat = OrthographicCamera<double>;
    check(Plane<>(), Camera<double>());
    check(Sphere<>(), Camera<double>());
    check(Quadric<>(), Camera<double>());
    check(Plane<>(), Flat());
    check(Sphere<>(), Flat());
    check(Quadric<>(), Flat());
  }
};

template <class Model, class CameraType>
auto fit(const CameraType& camera, const Image<double>& depth, const Mask& mask) {
  return SurfaceFit<Model, CameraType>(depth.rows(), depth.cols(), camera, {.min_px = 1})(depth,
                                                                                          mask);
}

bool all_finite(const Plane<double>& p) {
  return detail::PlaneModel::is_finite_shape(p);
}
bool all_finite(const Sphere<double>& s) {
  return detail::SphereModel::is_finite_shape(s);
}
bool all_finite(const Quadric<double>& q) {
  return detail::QuadricModel::is_finite_shape(q);
}

}  // namespace

TEST_CASE("object surface: rotated and mirrored scenes give rotated and mirrored shapes",
          "[surface]") {
  rc::prop("a quarter turn about the axis, and a mirror", [] {
    const Patch patch = any_patch();
    const Index last = patch.size - 1;
    Everything()([&](auto model, auto kind) {
      using Model = decltype(model);
      const auto camera = camera_for<decltype(kind)>(patch.size);
      const auto before = fit<Model>(camera, patch.depth, patch.mask);
      RC_ASSERT(before.ok());
      // x to y, y to -x
      const auto turn = [&](Index i, Index j) { return std::pair<Index, Index>(j, last - i); };
      const auto rotated = fit<Model>(camera, placed(patch.depth, turn), placed(patch.mask, turn));
      RC_ASSERT(rotated.ok());
      RC_ASSERT(near(rotated.rms_mm, before.rms_mm, 1e-7));
      RC_ASSERT(is_moved(
          before.shape, rotated.shape,
          [](const Point& p, bool) {
            return Point{-p.y, p.x, p.z};
          },
          1));
      const auto mirror = [&](Index i, Index j) { return std::pair<Index, Index>(i, last - j); };
      const auto mirrored =
          fit<Model>(camera, placed(patch.depth, mirror), placed(patch.mask, mirror));
      RC_ASSERT(mirrored.ok());
      RC_ASSERT(is_moved(
          before.shape, mirrored.shape,
          [](const Point& p, bool) {
            return Point{-p.x, p.y, p.z};
          },
          1));
    });
  });
}

TEST_CASE("object surface: a scene of another size, or higher up", "[surface]") {
  rc::prop("lengths scale, curvatures by the inverse", [] {
    const Patch patch = any_patch();
    const double c = test::log_uniform(0.2, 5);
    Image<double> scaled = patch.depth;
    for (double& z : scaled.cells) {
      z *= c;
    }
    Everything()([&](auto model, auto kind) {
      using Model = decltype(model);
      const auto camera = camera_for<decltype(kind)>(patch.size);
      auto larger = camera;
      larger.pitch_mm *= c;
      if constexpr (requires { larger.plate_distance_mm; }) {
        larger.plate_distance_mm *= c;
      }
      const auto before = fit<Model>(camera, patch.depth, patch.mask);
      const auto after = fit<Model>(larger, scaled, patch.mask);
      RC_ASSERT((before.ok() && after.ok()));
      RC_ASSERT(near(after.rms_mm, c * before.rms_mm, 1e-6));
      RC_ASSERT(is_moved(
          before.shape, after.shape,
          [&](const Point& p, bool place) {
            return place ? Point{c * p.x, c * p.y, c * p.z} : p;
          },
          1 / c));
    });
  });
  rc::prop("a map of heights may be lifted", [] {
    const Patch patch = any_patch();
    const double lift = test::uniform(-5, 5);
    Image<double> lifted = patch.depth;
    for (double& z : lifted.cells) {
      z += lift;
    }
    const auto check = [&](auto model) {
      using Model = decltype(model);
      const auto camera = camera_for<OrthographicCamera<double>>(patch.size);
      const auto before = fit<Model>(camera, patch.depth, patch.mask);
      const auto after = fit<Model>(camera, lifted, patch.mask);
      RC_ASSERT((before.ok() && after.ok()));
      RC_ASSERT(is_moved(
          before.shape, after.shape,
          [&](const Point& p, bool place) {
            return Point{p.x, p.y, p.z + (place ? lift : 0)};
          },
          1));
    };
    check(Plane<>());
    check(Sphere<>());
    check(Quadric<>());
  });
}

TEST_CASE("object surface: a pixel without depth is as one without contact", "[surface]") {
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
    Everything()([&](auto model, auto kind) {
      const auto camera = camera_for<decltype(kind)>(patch.size);
      const SurfaceFit<decltype(model), decltype(kind)> surface(patch.size, patch.size, camera,
                                                                {.min_px = 1});
      Image<double> a(patch.size, patch.size), b = a, c = a;
      const auto with_nan = surface(holed, patch.mask, a);
      const auto unset = surface(patch.depth, without, b);
      const auto garbage = surface(other, without, c);
      RC_ASSERT(with_nan.pixels == unset.pixels);
      RC_ASSERT((test::same_bits(a, b) && test::same_bits(a, c)));
      RC_ASSERT(test::same_bits(with_nan.rms_mm, unset.rms_mm));
      RC_ASSERT(test::same_bits(garbage.largest_mm, unset.largest_mm));
    });
  });
}

TEST_CASE("object surface: a model with more unknowns fits no worse", "[surface]") {
  rc::prop("plane, sphere, quadric", [] {
    const Patch patch = any_patch();
    const auto camera = camera_for<OrthographicCamera<double>>(patch.size);
    const auto plane = fit<Plane<>>(camera, patch.depth, patch.mask);
    const auto sphere = fit<Sphere<>>(camera, patch.depth, patch.mask);
    const auto quadric = fit<Quadric<>>(camera, patch.depth, patch.mask);
    RC_ASSERT((plane.ok() && sphere.ok() && quadric.ok()));
    // a single Gauss-Newton step with distances to first order leaves a share of the curved part
    RC_ASSERT(sphere.rms_mm <= 1.01 * plane.rms_mm + 1e-7);
    RC_ASSERT(quadric.rms_mm <= 1.01 * sphere.rms_mm + 1e-7);
  });
}

TEST_CASE("object surface: whatever comes in, an ok result holds finite numbers", "[surface]") {
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
    const SurfaceOptions options{test::whole(1, 8), test::whole(0, 2)};
    const double pitch_mm = test::whole(0, 3) == 0 ? test::log_uniform(1e-150, 1e150) : 0.1;
    Everything()([&](auto model, auto camera) {
      camera.pitch_mm = pitch_mm;
      camera.center_x_px = test::uniform(-10, 10);
      const SurfaceFit<decltype(model), decltype(camera)> surface(rows, cols, camera, options);
      Image<double> residual(rows, cols, 7);
      const auto r = surface(depth, mask, residual);
      RC_ASSERT(r.accepted());
      const auto numbers = std::count_if(residual.cells.begin(), residual.cells.end(),
                                         [](double x) { return std::isfinite(x); });
      if (r.ok()) {
        RC_ASSERT(all_finite(r.shape));
        RC_ASSERT((std::isfinite(r.rms_mm) && std::isfinite(r.largest_mm)));
        RC_ASSERT(numbers == r.pixels);
        RC_ASSERT(r.shape.normal.z > 0);
      } else {
        RC_ASSERT((std::isnan(r.rms_mm) && std::isnan(r.largest_mm)));
        RC_ASSERT(std::isnan(r.shape.normal.x));
        RC_ASSERT(numbers == 0);
      }
    });
  });
}
