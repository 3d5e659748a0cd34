// SPDX-FileCopyrightText: 2026 The fingerpad authors
// SPDX-License-Identifier: MIT
// Properties for every patch, both cameras.
#include "fingerpad/contact/surface.hpp"

#include <algorithm>
#include <array>
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
bool is_moved(const SurfaceResult& a, const SurfaceResult& b, const Move& move, double bend) {
  return near(b.normal, move(a.normal, false), 1e-8) &&
         near(b.point_mm, move(a.point_mm, true), 1e-8) &&
         near(b.curvature_1_per_mm, bend * a.curvature_1_per_mm, 1e-8) &&
         near(b.curvature_2_per_mm, bend * a.curvature_2_per_mm, 1e-8) &&
         near(b.curvature_1_sd_per_mm, bend * a.curvature_1_sd_per_mm, 1e-7) &&
         near(b.curvature_2_sd_per_mm, bend * a.curvature_2_sd_per_mm, 1e-7) &&
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
        RC_ASSERT(is_moved(before, after, move, 1));
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

TEST_CASE("surface: a scene of another size, or higher up", "[surface]") {
  rc::prop("lengths scale, curvatures by the inverse", [] {
    const Patch patch = any_patch();
    const double c = test::log_uniform(0.2, 5);
    Image<double> scaled = patch.depth;
    for (double& z : scaled.cells) {
      z *= c;
    }
    for_both([&](auto kind) {
      const auto camera = camera_for<decltype(kind)>(patch.size);
      auto larger = camera;
      larger.pitch_mm *= c;
      if constexpr (requires { larger.plate_distance_mm; }) {
        larger.plate_distance_mm *= c;
      }
      const auto before = fit_surface(camera, patch.depth, patch.mask);
      const auto after = fit_surface(larger, scaled, patch.mask);
      RC_ASSERT((before.ok() && after.ok()));
      RC_ASSERT(near(after.rms_mm, c * before.rms_mm, 1e-6));
      RC_ASSERT(is_moved(
          before, after, [&](const Point& p, bool place) { return (place ? c : 1) * p; }, 1 / c));
    });
  });
  rc::prop("a map of heights may be lifted", [] {
    const Patch patch = any_patch();
    const double lift = test::uniform(-5, 5);
    Image<double> lifted = patch.depth;
    for (double& z : lifted.cells) {
      z += lift;
    }
    const auto camera = camera_for<OrthographicCamera<double>>(patch.size);
    const auto before = fit_surface(camera, patch.depth, patch.mask);
    const auto after = fit_surface(camera, lifted, patch.mask);
    RC_ASSERT((before.ok() && after.ok()));
    RC_ASSERT(is_moved(
        before, after,
        [&](const Point& p, bool place) {
          return Point{p.x, p.y, p.z + (place ? lift : 0)};
        },
        1));
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
